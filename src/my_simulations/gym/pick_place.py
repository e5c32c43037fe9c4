"""A six-axis arm picks up a cube and puts it on a mark."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Dict, Optional

import gymnasium
import numpy as np

from ..geometry import Pose
from ..python_api import OpenWorld, Randomisation, RobotOptions, WorldChoice
from ..python_api.kinematics import damped_step
from . import arm_scene
from .task_models import box, disc
from .world_env import (
    Evaluation,
    View,
    WorldEnv,
    clipped_action,
    clipped_observation,
    symmetric_box,
)

SIZE = 0.04          # m, of the cube
FASTEST = 0.3        # m/s, of the tool
NEAR = 0.03          # m, from the cube's centre to the mark's
_UPRIGHT = 6.0       # rad/s of correction for each rad by which the hand leans or turns
_DAMPING = 0.02      # of the inverse of the Jacobian, m or rad
_FAR = 10.0          # m, bound of observations
_AT_REST = 0.01      # m/s and rad/s


@dataclass(frozen=True)
class _Scene:
    """The arm and the cube after a step; m, m/s and rad/s, world frame."""

    arm: arm_scene.ArmState
    cube: np.ndarray
    twist: np.ndarray
    mark: np.ndarray

    def distance(self) -> float:
        """From the tool to the cube, and from there to its place; m."""
        return math.dist(self.arm.tool, self.cube) + math.dist(self.cube, self.mark)

    def is_at_rest(self) -> bool:
        """Whether the cube lies on the mark, at rest."""
        return math.dist(self.cube, self.mark) < NEAR and float(
            np.abs(self.twist).max()) < _AT_REST


class PickAndPlace:
    """Task: put the cube on the mark and let go. The hand points down all the time.

    Action: speeds of the tool along x, y and z of the world, each -1 to 1 of 0.3 m/s; and the
    fingers, above 0 to close with 10 N each, below to open.
    Observation, 17 numbers: the point between the fingers (m), positions of the fingers (m), the
    cube, the mark, cube minus tool, mark minus cube (m, world frame). With `camera`, a dictionary:
    "state", these numbers; "camera", the picture of the camera in the hand, uint8 (64, 64, 3).
    Reward: metres by which the fingers came nearer to the cube and the cube nearer to its place; 1
    more on success.
    """

    period = 0.05
    view = View((0.9, -0.9, 0.8), (0.25, 0.0, 0.1))

    def __init__(self, camera: bool = False) -> None:
        self.choice = WorldChoice(models=(
            arm_scene.document(),
            ("cube", box("cube", 3 * (SIZE,), "0.8 0.1 0.1 1", mass=0.1), Pose((0.3, 0.2, 0.02))),
            ("mark", disc("mark", NEAR, "0.1 0.7 0.2 1"), Pose())))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
        self._numbers = symmetric_box(17 * [_FAR])
        self.observation_space = arm_scene.observation_space(self._numbers, camera)
        self._camera = camera
        self._mark = np.zeros(3)
        self._scene: Optional[_Scene] = None
        self._before = 0.0  # m, as `_Scene.distance`, a step ago

    def begin(self, world: OpenWorld, random: np.random.Generator, options: Dict[str, Any]) -> None:
        """Put cube and mark on the ground at random, apart from each other."""
        side = 1.0 if random.random() < 0.5 else -1.0
        cube, mark = (np.array([random.uniform(0.28, 0.4), sign * side * random.uniform(0.06, 0.2),
                                SIZE / 2]) for sign in (1.0, -1.0))
        world.set_pose("cube", cube.tolist())
        world.set_pose("mark", [*mark[:2], 0.0])
        self._mark, self._scene = mark, None
        arm_scene.drive_axes(world, np.zeros(6))
        arm_scene.drive_fingers(world, False)

    def act(self, world: OpenWorld, action: Any) -> None:
        *speeds, grip = clipped_action(action).tolist()
        arm_scene.drive_axes(world, _axis_rates(world, np.array(speeds) * FASTEST))
        arm_scene.drive_fingers(world, grip > 0.0)

    def observe(self, world: OpenWorld) -> Any:
        picture = arm_scene.request_picture(world) if self._camera else None
        links = world.links()
        scene = _Scene(arm_scene.read_arm(world, links), links.pose["cube::link"][:3],
                       links.twist["cube::link"], self._mark)
        self._before = (self._scene or scene).distance()
        self._scene = scene
        numbers = clipped_observation(self._numbers, [
            *scene.arm.tool, *scene.arm.fingers, *scene.cube, *scene.mark,
            *(scene.cube - scene.arm.tool), *(scene.mark - scene.cube)])
        return arm_scene.observation(numbers, picture)

    def evaluate(self, world: OpenWorld, action: Any) -> Evaluation:
        assert self._scene is not None, "observe is called before judge"
        placed = self._scene.is_at_rest() and not _is_cube_held(world)
        return Evaluation(self._before - self._scene.distance() + placed, placed,
                         {"is_success": placed})


def _axis_rates(world: OpenWorld, velocity: np.ndarray) -> np.ndarray:
    """Rates in rad/s at which the tool has a velocity (m/s) and the hand stays level.

    The rates are reduced in proportion where one exceeds `arm_scene.FASTEST`.
    """
    hand = world.links().pose["arm::hand"]   # it may be elsewhere than observed: after a restore
    lean = -2.0 * np.sign(hand[6] or 1.0) * hand[3:6]  # to the orientation 0, for small angles
    jacobian = world.robot("arm").jacobian("hand", arm_scene.TOOL)[:, :6]
    wanted = np.concatenate((velocity, _UPRIGHT * lean))
    rates = damped_step(jacobian, wanted, _DAMPING)
    return rates / max(1.0, float(np.abs(rates).max()) / arm_scene.FASTEST)


def _is_cube_held(world: OpenWorld) -> bool:
    """Whether the gripper touches the cube."""
    return any("cube::link" in pair and any(link.startswith("arm::") for link in pair)
               for pair in world.contact_forces())


def make(render_mode: Optional[str] = None, camera: bool = False,
         randomisation: Optional[Randomisation] = None) -> WorldEnv:
    """The environment `my_simulations/PickAndPlace-v0`."""
    return WorldEnv(PickAndPlace(camera), render_mode, RobotOptions(plugins=False), randomisation)
