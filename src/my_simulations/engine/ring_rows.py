"""Assigns rows of the ring to the links and joint axes of a model."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List

from ..description.model import Joint, Model

AXES = {"revolute": 1, "continuous": 1, "prismatic": 1, "fixed": 0, "ball": 0, "universal": 2,
        "revolute2": 2, "screw": 1}
"""Number of axes with a row, by type of joints in a tree.

A ball joint has no axis; the position of a screw joint is its angle. Gearboxes connect joints.
"""


@dataclass(frozen=True)
class AxisRow:
    """One row of the joint table: `name` is the joint's, with `::1` for its second axis."""

    name: str
    joint: Joint
    number: int


def axis_rows(model: Model) -> List[AxisRow]:
    """The rows of a model's joint axes, in the description's order."""
    return [AxisRow(row_name(joint.name, number), joint, number)
            for joint in model.joints for number in range(AXES.get(joint.type, 0))]


def row_name(joint: str, number: int) -> str:
    return f"{joint}::{number}" if number else joint
