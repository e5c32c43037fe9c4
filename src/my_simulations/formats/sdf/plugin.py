"""`<plugin>` elements, which are kept as written."""
from __future__ import annotations

from typing import Any

from ...description.model import PluginSpec
from ..xml.binding import to_xml


def read_plugin(element: Any) -> PluginSpec:
    """A `<plugin>` with its whole XML. Source: SDF spec 1.7, plugin."""
    return PluginSpec(element.get("name", ""), element.get("filename", ""), to_xml(element))
