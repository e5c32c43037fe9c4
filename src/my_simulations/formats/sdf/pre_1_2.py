"""Upgrades SDF 1.0 and 1.1, with values in attributes, to 1.2, with values in elements.

Source: documents of 2011 and 2012; the format's own conversion rules begin later.
"""
from __future__ import annotations

import os
from typing import Any, Mapping

_STAYS = ("name", "version", "type")
_NOT_TYPED = ("solver", "fog")
_TEXT = ("rgba", "angle", "link", "enabled")
"""Attributes that become the text of their element."""

_TEXT_OF: Mapping[str, str] = {"gravity": "xyz", "direction": "xyz", "linear_velocity": "xyz"}
_RENAMED: Mapping[str, str] = {"color": "diffuse"}
_BUILT_IN = "file://media/materials/scripts/gazebo.material"


def values_to_elements(root: Any) -> None:
    """Upgrade a document of version 1.0 or 1.1 to 1.2, in place."""
    for element in list(root):
        _convert(element)


def includes_by_uri(root: Any) -> None:
    """Convert `<include filename="name.model"/>` (before 1.3) to the URI of a database model."""
    from lxml import etree

    for include in root.iter("include"):
        name = include.attrib.pop("filename", None)
        if name and include.find("uri") is None:
            stem = os.path.splitext(name)[0]
            etree.SubElement(include, "uri").text = name if "://" in name else f"model://{stem}"


def _convert(element: Any) -> None:
    from lxml import etree

    if not isinstance(element.tag, str) or element.tag == "plugin":
        return
    for child in list(element):
        _convert(child)
    for name, value in list(element.items()):
        # `save`, of a camera, still has an attribute in 1.7.
        if element.tag in ("include", "save") or (name == "pose" and element.tag == "origin") or (
                name in _STAYS and element.tag not in _NOT_TYPED):
            continue
        del element.attrib[name]
        if element.tag == "shadows" and name != "enabled":
            continue
        if element.tag == "material" and name == "script":
            script = etree.SubElement(element, "script")
            etree.SubElement(script, "uri").text = _BUILT_IN
            etree.SubElement(script, "name").text = value
        elif element.tag == "material" and name == "normal_map":
            shader = etree.SubElement(element, "shader", type="normal_map_tangent_space")
            etree.SubElement(shader, name).text = value
        elif (name in _TEXT and not (element.tag == "fog")) or _TEXT_OF.get(element.tag) == name:
            element.text = value
        elif element.find(name) is None:
            etree.SubElement(element, "color" if name == "rgba" else name).text = value
    parent = element.getparent()
    if parent is not None:
        _convert_inside(element, parent)


def _convert_inside(element: Any, parent: Any) -> None:
    """Conversions that depend on the parent of an element."""
    if parent.tag == "contact" and element.tag == "collision":
        element.text = element.attrib.pop("name", element.text)  # of a contact sensor
    if parent.tag == "material":
        element.tag = _RENAMED.get(element.tag, element.tag)
    if element.tag == "damping" and parent.tag == "inertial":
        element.tag = "velocity_decay"
        parent.getparent().append(element)
