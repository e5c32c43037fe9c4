"""Plugins as a file names them."""
from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class PluginSpec:
    """A `<plugin>` as written: `xml` is the whole element, which begins at `line` of `file`."""

    name: str
    filename: str
    xml: str = ""
    file: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)
