"""The six-axis arm of the tasks: where its hand is, its motors and its camera."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Optional, Tuple

import gymnasium
import numpy as np

from ..geometry import Pose, rotate
from ..python_api import OpenWorld, PictureRequest, Readings
from ..resources.package_files import own_directory

AXES = ("turn", "lift", "elbow", "roll", "pitch", "hand_turn")
FINGERS = ("left_finger", "right_finger")
TOOL = (0.0, 0.0, -0.08)   # m, in the frame of the hand: between the ends of the fingers
FASTEST = 1.5              # rad/s, of an axis
PIXELS = 64                # of each side of the camera's picture
_GRIP, _OPENING = 10.0, 0.15  # N of each finger, m/s
_CAMERA = (0.09, 0.0, 0.02, 0.0, 0.8, np.pi)  # pose in the frame of the hand


def document() -> Tuple[str, str, Pose]:
    """Name, file and pose of the arm, for `WorldChoice.models`."""
    return "arm", os.path.join(own_directory(), "models", "six_axis_arm", "model.sdf"), Pose()


@dataclass(frozen=True)
class ArmState:
    """The arm after a step.

    Attributes:
        positions, rates: of the six axes, rad and rad/s, shape (6,).
        fingers: positions of both, m; 0 is open, 0.044 closed.
        tool: position of `TOOL` in the world, m.
    """

    positions: np.ndarray
    rates: np.ndarray
    fingers: np.ndarray
    tool: np.ndarray


def read_arm(world: OpenWorld, links: Readings) -> ArmState:
    """`links`: of the world, as it is now."""
    joints = world.joints()
    first = joints.position.names.index("arm::turn")
    axes, fingers = slice(first, first + 6), slice(first + 6, first + 8)
    hand = links.pose["arm::hand"]
    tool = hand[:3] + rotate(tuple(hand[3:].tolist()), TOOL)
    return ArmState(joints.position.array[axes], joints.rate.array[axes],
                    joints.position.array[fingers], tool)


def drive_axes(world: OpenWorld, rates: np.ndarray) -> None:
    """Drive the six axes at rates in rad/s, shape (6,)."""
    world.robot("arm").drive(dict(zip(AXES, rates.tolist())))


def drive_fingers(world: OpenWorld, close: bool) -> None:
    rate = _OPENING if close else -_OPENING
    world.robot("arm").drive({finger: rate for finger in FINGERS}, effort=_GRIP)


def observation_space(numbers: gymnasium.spaces.Box, camera: bool) -> "gymnasium.Space[Any]":
    if not camera:
        return numbers
    return gymnasium.spaces.Dict({
        "state": numbers, "camera": gymnasium.spaces.Box(0, 255, (PIXELS, PIXELS, 3), np.uint8)})


def request_picture(world: OpenWorld) -> PictureRequest:
    """Request a picture of the camera of the hand; it is drawn while the task computes."""
    return world.request_picture(_CAMERA, frame="arm::hand", width=PIXELS, height=PIXELS, hfov=1.2)


def observation(numbers: np.ndarray, picture: Optional[PictureRequest]) -> Any:
    """The numbers; with a picture a dictionary of both."""
    if picture is None:
        return numbers
    return {"state": numbers, "camera": picture.result().rgb}
