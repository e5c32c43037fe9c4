"""Writes GUI, roads and actors of a world. Source: SDF spec 1.7.

Each function writes its element below the given `<world>`, or nothing if all values are defaults.
`world_tables.SURROUNDINGS` has the other surroundings.
"""
from __future__ import annotations

from typing import Any, List, Optional

from lxml import etree

from ....description.actor import Actor
from ....description.model import PluginSpec
from ....description.surroundings import Gui, GuiCamera, Road
from ...xml.tables import Table
from ..world_tables import ACTOR, GUI, GUI_CAMERA, ROAD
from .fields import fill_element
from .material_element import write_material
from .xml_text import append_fragment, parse_fragment


def write_gui(parent: Any, gui: Gui, camera: Optional[GuiCamera]) -> None:
    """`<gui>` with its `<camera>`."""
    if camera is not None or gui != Gui():
        fill_element(_element(parent, "gui"), gui, GUI, {
            "camera": lambda at: _write_camera(at, camera),
            "plugin": lambda at: write_plugins(at, gui.plugins, GUI),
        }, gui.extra)


def write_road(parent: Any, road: Road) -> None:
    fill_element(_element(parent, "road", road.name), road, ROAD, {
        "material": lambda at: write_material(at, road.material),
    }, road.extra, required=("width",))


def write_actor(parent: Any, actor: Actor) -> None:
    """`<actor>`, or the `<include>` that it was read from."""
    if actor.include:
        parent.append(parse_fragment(actor.include))
        return
    element = _element(parent, "actor", actor.name)
    fill_element(element, actor, ACTOR, {
        "plugin": lambda at: write_plugins(at, actor.plugins, ACTOR),
    }, actor.extra, required=("skin/filename",) if actor.skin else ())
    if element.find("script") is None:
        etree.SubElement(element, "script")  # required by the format


def write_plugins(parent: Any, plugins: List[PluginSpec], table: Table) -> None:
    """The `<plugin>` elements, as read."""
    for plugin in plugins:
        append_fragment(parent, plugin.xml, table)


def _write_camera(parent: Any, camera: Optional[GuiCamera]) -> None:
    if camera is not None:
        fill_element(_element(parent, "camera"), camera, GUI_CAMERA, {}, camera.extra,
                     required=("@name", "pose"))


def _element(parent: Any, tag: str, name: Optional[str] = None) -> Any:
    element = etree.SubElement(parent, tag)
    if name is not None:
        element.set("name", name)
    return element
