"""A world's surroundings changed: its fields, and the XML that is kept of them.

The fields from `scene` to `spherical_coordinates` show what XML in `World.extra` says, and it is
that XML that is written. A change renews what the tables know of it and leaves the rest alone.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Callable, Dict, List

from ...description.world import World
from ..xml.binding import Group, Part, Table, Value, to_xml
from .world_tables import ATMOSPHERE, FOG, GUI_CAMERA, SCENE, SKY, SPHERICAL, WIND
from .writer.fields import fill_element
from .writer.xml_text import parsed_fragment

_TAGS = {"scene": "scene", "gui_camera": "gui", "wind": "wind", "atmosphere": "atmosphere",
         "spherical_coordinates": "spherical_coordinates"}


def with_surroundings(world: World, **fields: Any) -> World:
    """The world with other values of some fields; its `extra` says the same.

    `None` for a field that may be None takes its element out.
    """
    extra = list(world.extra)
    for name, value in fields.items():
        if name in _TAGS:
            extra = _renewed(extra, _TAGS[name], name, value)
    return replace(world, extra=extra, **fields)


def _renewed(extra: List[str], tag: str, field: str, value: Any) -> List[str]:
    from lxml import etree

    places = [n for n, xml in enumerate(extra) if parsed_fragment(xml).tag == tag]
    element = parsed_fragment(extra[places[-1]]) if places else etree.Element(tag)
    if field == "gui_camera":
        _renew_child(element, "camera", value, _write_camera)
    elif value is None:
        return [xml for n, xml in enumerate(extra) if n not in places]
    else:
        _WRITERS[field](element, value)
    text = to_xml(element)
    if not places:
        return extra + [text]
    return extra[:places[-1]] + [text] + extra[places[-1] + 1:]


def _renew_child(parent: Any, tag: str, value: Any,
                 write: Callable[[Any, Any], None]) -> None:
    from lxml import etree

    child = parent.find(tag)
    if value is None:
        if child is not None:
            parent.remove(child)
        return
    write(etree.SubElement(parent, tag) if child is None else child, value)


def _strip(element: Any, table: Table) -> None:
    """Take out what the table's values say; what is only kept stays."""
    for name in table.attributes:
        element.attrib.pop(name, None)
    _strip_children(element, table.children)


def _strip_children(element: Any, children: Any) -> None:
    for child in list(element):
        entry = children.get(child.tag)
        if isinstance(entry, Value):
            element.remove(child)
        elif isinstance(entry, Group):
            for name in entry.attributes:
                child.attrib.pop(name, None)
            _strip_children(child, entry.children)
            if not len(child) and not child.attrib:
                element.remove(child)


def _write(element: Any, value: Any, table: Table, required: tuple = ()) -> None:
    _strip(element, table)
    kept = [child for child in element
            if not isinstance(table.children.get(child.tag), Part)]
    for child in kept:
        element.remove(child)
    fill_element(element, value, table, {}, [to_xml(child) for child in kept], required=required)


def _write_scene(element: Any, scene: Any) -> None:
    _write(element, scene, SCENE, ("ambient", "background", "shadows"))
    _renew_child(element, "sky", scene.sky, lambda at, sky: _write(at, sky, SKY))
    _renew_child(element, "fog", scene.fog, lambda at, fog: _write(at, fog, FOG, ("type",)))


def _write_camera(element: Any, camera: Any) -> None:
    _write(element, camera, GUI_CAMERA, ("@name", "pose"))


_WRITERS: Dict[str, Callable[[Any, Any], None]] = {
    "scene": _write_scene,
    "wind": lambda at, value: _write(at, value, WIND, ("linear_velocity",)),
    "atmosphere": lambda at, value: _write(at, value, ATMOSPHERE, ("@type",)),
    "spherical_coordinates": lambda at, value: _write(at, value, SPHERICAL, (
        "surface_model", "latitude_deg", "longitude_deg", "elevation", "heading_deg")),
}


