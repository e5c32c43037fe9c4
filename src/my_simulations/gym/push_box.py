"""The lab robot pushes a box to a mark."""
from __future__ import annotations

import math
import os
from typing import Any, Dict, Optional, Tuple

import gymnasium
import numpy as np

from ..geometry import Pose, rpy_from_quat
from ..python_api import OpenWorld, Randomisation, RobotOptions, WorldChoice
from ..resources.package_files import own_directory
from .task_models import world_file
from .world_env import (
    Evaluation,
    View,
    WorldEnv,
    clipped_action,
    clipped_observation,
    symmetric_box,
)

FASTEST = 0.5     # m/s
TURNS = 2.0       # rad/s
NEAR = 0.1        # m: the box has arrived
_SEPARATION, _RADIUS, _TORQUE = 0.24, 0.05, 2.0  # of urdf/robo.urdf
_FARTHEST = 10.0  # m: the box or the robot is out of the game
_FAR, _FAST = 30.0, 50.0  # bounds of observations, m and m/s or rad/s

_BOX = """<sdf version="1.6"><model name="box"><link name="link">
<inertial><mass>0.5</mass><inertia><ixx>0.0033</ixx><iyy>0.0033</iyy><izz>0.0033</izz></inertia>
</inertial>
<collision name="collision"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
<surface><friction><ode><mu>0.3</mu><mu2>0.3</mu2></ode></friction></surface></collision>
<visual name="visual"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
<material><ambient>0.8 0.5 0.2 1</ambient><diffuse>0.8 0.5 0.2 1</diffuse></material></visual>
</link></model></sdf>"""
_MARK = """<sdf version="1.6"><model name="mark"><static>1</static><link name="link">
<visual name="visual"><pose>0 0 0.002 0 0 0</pose>
<geometry><cylinder><radius>0.1</radius><length>0.004</length></cylinder></geometry>
<material><ambient>0.1 0.7 0.2 1</ambient><diffuse>0.1 0.7 0.2 1</diffuse></material></visual>
</link></model></sdf>"""


class PushBox:
    """Task: push the box until its centre is within 0.1 m of the mark's.

    Action: forward speed and turn rate, each -1 to 1 of the robot's most (0.5 m/s, 2 rad/s).
    Observation, 11 numbers: x, y, cos(yaw), sin(yaw) of the robot, its forward speed and turn rate,
    x, y of the box, x, y of the mark (m, m/s, rad/s, world frame), distance from box to mark (m).
    Reward: metres by which the box came nearer to the mark and, a tenth as much, the robot to the
    box; 1 more on arrival.

    `accurate_friction` selects Coulomb's friction for the wheels; see doc/gymnasium.md.
    """

    period = 0.1
    view = View((-1.6, -2.4, 2.2), (0.6, 0.0, 0.0))

    def __init__(self, accurate_friction: bool = False) -> None:
        robot = os.path.join(own_directory(), "urdf", "robo.urdf")
        self.choice = WorldChoice(world_file(accurate_friction), models=(
            ("robo", robot, Pose()), ("box", _BOX, Pose()), ("mark", _MARK, Pose())))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.observation_space = symmetric_box([_FAR, _FAR, 1.0, 1.0, _FAST, _FAST, *4 * [_FAR],
                                                _FAR])
        self._before: Optional[Tuple[float, float]] = None
        self._apart = (0.0, 0.0)  # m from the box to the mark, from the robot to the box

    def begin(self, world: OpenWorld, random: np.random.Generator, options: Dict[str, Any]) -> None:
        """Put the box ahead of the robot and the mark behind the box, at random."""
        box: Any = random.uniform((0.5, -0.3), (0.9, 0.3))
        mark: Any = box + random.uniform((0.5, -0.3), (1.0, 0.3))
        world.set_pose("box", [*box, 0.1])
        world.set_pose("mark", [*mark, 0.0])
        self._before = None

    def act(self, world: OpenWorld, action: Any) -> None:
        forward, turn = clipped_action(action).tolist()
        ahead, aside = forward * FASTEST, turn * TURNS * _SEPARATION / 2.0
        world.robot("robo").drive({"left_wheel_joint": (ahead - aside) / _RADIUS,
                                   "right_wheel_joint": (ahead + aside) / _RADIUS}, effort=_TORQUE)

    def observe(self, world: OpenWorld) -> np.ndarray:
        states = world.states()
        poses: Any = states.pose
        robot, box, mark = (poses[name] for name in ("robo", "box", "mark"))
        vx, vy, _, _, _, turn = states.twist["robo"]
        yaw = rpy_from_quat(tuple(robot[3:]))[2]
        forward = vx * math.cos(yaw) + vy * math.sin(yaw)
        self._apart = math.dist(box[:2], mark[:2]), math.dist(box[:2], robot[:2])
        self._before = self._before or self._apart
        return clipped_observation(self.observation_space, [
            robot[0], robot[1], math.cos(yaw), math.sin(yaw), forward, turn,
            box[0], box[1], mark[0], mark[1], self._apart[0]])

    def evaluate(self, world: OpenWorld, action: Any) -> Evaluation:
        to_mark, to_box = self._apart
        before, self._before = self._before or self._apart, self._apart
        reward = before[0] - to_mark + 0.1 * (before[1] - to_box)
        arrived = to_mark < NEAR
        lost = max(to_mark, to_box) > _FARTHEST
        return Evaluation(reward + arrived, arrived or lost, {"is_success": arrived})


def make(render_mode: Optional[str] = None, randomisation: Optional[Randomisation] = None,
         accurate_friction: bool = False) -> WorldEnv:
    """The environment `my_simulations/PushBox-v0`."""
    return WorldEnv(PushBox(accurate_friction), render_mode, RobotOptions(plugins=False),
                    randomisation)
