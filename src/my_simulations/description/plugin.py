"""Plugin elements of a file."""
from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class PluginSpec:
    """A `<plugin>`. Source: SDF spec 1.7, plugin.

    Attributes:
        name: unique name of the plugin in its parent.
        filename: shared library of Gazebo.
        xml: the whole element as text.
        file, line: where the element begins.
    """

    name: str
    filename: str
    xml: str = ""
    file: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)
