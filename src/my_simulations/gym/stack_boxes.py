"""A gripper on three linear axes puts one box on another."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any, Dict, Optional

import gymnasium
import numpy as np

from ..geometry import Pose
from ..python_api import OpenWorld, Randomisation, RobotOptions, WorldChoice
from ..resources.package_files import own_directory
from .world_env import (
    Evaluation,
    View,
    WorldEnv,
    clipped_action,
    clipped_observation,
    symmetric_box,
)

SIZE = 0.05       # m, of a box
FASTEST = 0.25    # m/s, of an axis
GRIP = 10.0       # N, of each finger
AXES = ("x", "y", "z")
FINGERS = ("left_finger", "right_finger")
_DRIVE = 200.0    # N, of an axis
_OPENING = 0.2    # m/s, of a finger
_FAR = 10.0       # m, bound of observations
_CENTRED, _LEVEL = 0.015, 0.004  # m, how well the upper box must stand

_BOX = """<sdf version="1.6"><model name="{name}"><link name="link">
<inertial><mass>0.1</mass><inertia><ixx>4.2e-5</ixx><iyy>4.2e-5</iyy><izz>4.2e-5</izz></inertia>
</inertial>
<collision name="collision"><geometry><box><size>0.05 0.05 0.05</size></box></geometry>
<surface><friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction></surface></collision>
<visual name="visual"><geometry><box><size>0.05 0.05 0.05</size></box></geometry>
<material><ambient>{colour}</ambient><diffuse>{colour}</diffuse></material></visual>
</link></model></sdf>"""


@dataclass(frozen=True)
class _Scene:
    """Where all is, read once a step; positions in m, twist in m/s and rad/s, world frame."""

    middle: np.ndarray  # between the fingers
    red: np.ndarray
    blue: np.ndarray
    red_twist: np.ndarray

    def distance(self) -> float:
        """From between the fingers to the red box, and from there to its place; m."""
        goal = self.blue + np.array([0.0, 0.0, SIZE])
        return math.dist(self.middle, self.red) + math.dist(self.red, goal)

    def is_at_rest(self) -> bool:
        """Whether red lies on blue, at rest."""
        apart = self.red - self.blue
        level = abs(apart[2] - SIZE) < _LEVEL and float(np.abs(apart[:2]).max()) < _CENTRED
        return level and float(np.abs(self.red_twist).max()) <= 0.01


def _scene_of(world: OpenWorld) -> _Scene:
    links = world.links()  # boxes have their link at the origin of the model
    pose = links.pose
    left, right = (pose[f"gripper::{finger}"][:3] for finger in FINGERS)
    return _Scene((left + right) / 2, pose["red::link"][:3], pose["blue::link"][:3],
                  links.twist["red::link"])


class StackBoxes:
    """Task: put the red box on the blue one and let go.

    Action: speeds of the x, y and z axes, each -1 to 1 of 0.25 m/s; and the fingers, above 0 to
    close with 10 N each, below to open.
    Observation, 14 numbers: positions of the axes and of both fingers (m), of the red and of the
    blue box (m, world frame), and red minus blue.
    Reward: metres by which the fingers came nearer to the red box and the red box nearer to its
    place on the blue one; 1 more on success.
    """

    period = 0.05
    view = View((0.7, -0.7, 0.6), (0.0, 0.0, 0.1))

    def __init__(self) -> None:
        gripper = os.path.join(own_directory(), "models", "gantry_gripper", "model.sdf")
        self.choice = WorldChoice(models=(
            ("gripper", gripper, Pose()),
            ("red", _BOX.format(name="red", colour="0.8 0.1 0.1 1"), Pose()),
            ("blue", _BOX.format(name="blue", colour="0.1 0.2 0.8 1"), Pose((0.2, 0.0, 0.025)))))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
        self.observation_space = symmetric_box(14 * [_FAR])
        self._left: Optional[float] = None
        self._scene: Optional[_Scene] = None

    def begin(self, world: OpenWorld, random: np.random.Generator, options: Dict[str, Any]) -> None:
        """Lay the boxes on the ground at random, apart from each other."""
        red: Any = random.uniform((-0.25, -0.2), (-0.05, 0.2))
        blue: Any = random.uniform((0.05, -0.2), (0.25, 0.2))
        world.set_pose("red", [*red, SIZE / 2])
        world.set_pose("blue", [*blue, SIZE / 2])
        self.act(world, np.array([0.0, 0.0, 0.0, -1.0]))
        self._left = None

    def act(self, world: OpenWorld, action: Any) -> None:
        *speeds, grip = clipped_action(action).tolist()
        gripper, opening = world.robot("gripper"), _OPENING if grip > 0.0 else -_OPENING
        gripper.drive({axis: speed * FASTEST for axis, speed in zip(AXES, speeds)}, effort=_DRIVE)
        gripper.drive({finger: opening for finger in FINGERS}, effort=GRIP)

    def observe(self, world: OpenWorld) -> np.ndarray:
        scene = self._scene = _scene_of(world)
        if self._left is None:
            self._left = scene.distance()
        position = world.joints().position
        axes = [float(position[f"gripper::{joint}"]) for joint in (*AXES, *FINGERS)]
        return clipped_observation(self.observation_space,
                    [*axes, *scene.red, *scene.blue, *(scene.red - scene.blue)])

    def evaluate(self, world: OpenWorld, action: Any) -> Evaluation:
        scene = self._scene or _scene_of(world)
        left = scene.distance()
        nearer = 0.0 if self._left is None else self._left - left
        self._left = left
        stands = scene.is_at_rest() and not self._is_box_held(world)
        return Evaluation(nearer + stands, stands, {"is_success": stands})

    @staticmethod
    def _is_box_held(world: OpenWorld) -> bool:
        """Whether the gripper touches the red box."""
        return any("red::link" in contact.links and contact.force > 0.0
                   and any(link.startswith("gripper::") for link in contact.links)
                   for contact in world.contacts())


def make(render_mode: Optional[str] = None,
         randomisation: Optional[Randomisation] = None) -> WorldEnv:
    """The environment `my_simulations/StackBoxes-v0`."""
    return WorldEnv(StackBoxes(), render_mode, RobotOptions(plugins=False), randomisation)
