"""`<plugin>` and `<gripper>` elements, which are kept as written."""
from __future__ import annotations

from dataclasses import replace
from typing import Any

from ...description.plugin import GRIPPER_LIBRARY, PluginSpec
from ..xml.binding import to_xml
from ..xml.source import Source


def read_plugin(element: Any, source: Source) -> PluginSpec:
    """A `<plugin>` with its whole XML, file and line. Source: SDF spec 1.7, plugin."""
    return PluginSpec(element.get("name", ""), element.get("filename", ""), to_xml(element),
                      source.file, element.sourceline or 0)


def read_gripper(element: Any, source: Source) -> PluginSpec:
    """Return a `<gripper>` as a plugin of its model. Source: SDF spec 1.7, gripper."""
    return replace(read_plugin(element, source), filename=GRIPPER_LIBRARY)
