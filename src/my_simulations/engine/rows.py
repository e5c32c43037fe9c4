"""How many rows of the ring a model takes, and which belongs to what."""
from __future__ import annotations

from typing import List

from ..description.model import Joint, Model

AXES = {"revolute": 1, "continuous": 1, "prismatic": 1, "fixed": 0}
"""Degrees of freedom by joint type, of the types the engine moves."""


def moving_joints(model: Model) -> List[Joint]:
    """The joints that have a row each: one-axis joints, in the description's order."""
    return [joint for joint in model.joints if AXES.get(joint.type, 0)]
