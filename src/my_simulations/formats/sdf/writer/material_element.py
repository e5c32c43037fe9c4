"""`<material>` of visuals and roads. Source: SDF spec 1.7, material."""
from __future__ import annotations

from typing import Any, Optional

from lxml import etree

from ....description.compare import BUILT_IN
from ....description.shapes import Material
from ...xml.values import TEXT
from ..model_tables import MATERIAL
from .fields import fill_element
from .xml_text import write_value


def write_material(parent: Any, material: Optional[Material]) -> None:
    """`<material>`; a script without a `<uri>` gets the URI of Gazebo's own materials."""
    if material is None:
        return
    element = etree.SubElement(parent, "material")
    fill_element(element, material, MATERIAL, {}, [])
    script = element.find("script")
    if script is not None and script.find("uri") is None:
        write_value(script, "uri", TEXT, BUILT_IN)  # required by the format
        script.insert(0, script[-1])
