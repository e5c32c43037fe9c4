"""Plugin elements of a file, and the grippers of models, which a plugin simulates."""
from __future__ import annotations

from dataclasses import dataclass, field

GRIPPER_LIBRARY = "libmy_simulations_gripper.so"
"""The library that simulates `<gripper>` elements."""


@dataclass
class PluginSpec:
    """A `<plugin>`, or the `<gripper>` of a model. Source: SDF spec 1.7, plugin, gripper.

    Attributes:
        name: unique name of the plugin in its parent.
        filename: shared library of Gazebo; `GRIPPER_LIBRARY` for a gripper.
        xml: the whole element as text.
        file, line: where the element begins.
    """

    name: str
    filename: str
    xml: str = ""
    file: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)
