"""A six-axis arm reaches a point."""
from __future__ import annotations

import math
from typing import Any, Dict, Optional

import gymnasium
import numpy as np

from ..geometry import Pose
from ..python_api import OpenWorld, Randomisation, RobotOptions, WorldChoice
from . import arm_scene
from .task_models import ball, world_file
from .world_env import (
    Evaluation,
    View,
    WorldEnv,
    clipped_action,
    clipped_observation,
    symmetric_box,
)

NEAR = 0.03         # m: the tool has arrived
_FAR, _FAST = 10.0, 20.0  # bounds of observations, m or rad, rad/s


class Reach:
    """Task: bring the point between the fingers within 3 cm of the target.

    Action: rates of the six axes, each -1 to 1 of 1.5 rad/s.
    Observation, 18 numbers: positions and rates of the axes (rad, rad/s), the point between the
    fingers, and the target (m, world frame). With `camera`, a dictionary: "state", these numbers;
    "camera", the picture of the camera in the hand, uint8 (64, 64, 3).
    Reward: metres by which the point came nearer to the target; 1 more on arrival.
    """

    period = 0.05
    view = View((1.1, -1.0, 0.9), (0.2, 0.0, 0.25))

    def __init__(self, camera: bool = False) -> None:
        self.choice = WorldChoice(world_file(accurate_friction=False), models=(
            arm_scene.document(), ("target", ball("target", 0.02, "0.9 0.1 0.1 1"), Pose())))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (6,), np.float32)
        self._numbers = symmetric_box([*6 * [_FAR], *6 * [_FAST], *6 * [_FAR]])
        self.observation_space = arm_scene.observation_space(self._numbers, camera)
        self._camera = camera
        self._target = np.zeros(3)
        self._left: Optional[float] = None
        self._before = 0.0  # m to the target, a step ago

    def begin(self, world: OpenWorld, random: np.random.Generator, options: Dict[str, Any]) -> None:
        """Put the target somewhere within reach, in front of the arm."""
        distance, bearing = random.uniform(0.25, 0.5), random.uniform(-1.5, 1.5)
        self._target = np.array([distance * math.cos(bearing), distance * math.sin(bearing),
                                 random.uniform(0.1, 0.5)])
        world.set_pose("target", self._target.tolist())
        arm_scene.drive_axes(world, np.zeros(6))
        arm_scene.drive_fingers(world, False)
        self._left = None

    def act(self, world: OpenWorld, action: Any) -> None:
        arm_scene.drive_axes(world, clipped_action(action) * arm_scene.FASTEST)

    def observe(self, world: OpenWorld) -> Any:
        picture = arm_scene.request_picture(world) if self._camera else None
        arm = arm_scene.read_arm(world, world.links())
        left = math.dist(arm.tool, self._target)
        self._before, self._left = left if self._left is None else self._left, left
        numbers = clipped_observation(self._numbers,
                                      [*arm.positions, *arm.rates, *arm.tool, *self._target])
        return arm_scene.observation(numbers, picture)

    def evaluate(self, world: OpenWorld, action: Any) -> Evaluation:
        left = math.inf if self._left is None else self._left
        arrived = left < NEAR
        return Evaluation(self._before - left + arrived, arrived, {"is_success": arrived})


def make(render_mode: Optional[str] = None, camera: bool = False,
         randomisation: Optional[Randomisation] = None) -> WorldEnv:
    """The environment `my_simulations/Reach-v0`."""
    return WorldEnv(Reach(camera), render_mode, RobotOptions(plugins=False), randomisation)
