"""`<geometry>` of a shape."""
from __future__ import annotations

from typing import Any, Dict

from lxml import etree

from ....description.shapes import Geometry, Polyline
from ...xml.tables import Table
from ...xml.values import FLOAT, TEXT, VECTOR2
from ..model_tables import GEOMETRIES
from .fields import fill_element
from .xml_text import write_value


def write_geometry(parent: Any, geometry: Geometry) -> None:
    """`<geometry>` with one shape, sizes included even if they are the defaults.

    A relative URI, which is valid in its own file only, is replaced by the absolute path it
    resolved to; `model://`, `package://` and `file://` URIs are kept (Gazebo behaviour).
    """
    holder = etree.SubElement(parent, "geometry")
    if isinstance(geometry, Polyline):
        _write_polyline(holder, geometry)
        return
    table = tables_by_shape()[type(geometry)]
    element = etree.SubElement(holder, table.name)
    needed = tuple(path for path, value, _ in table.values() if path in _ALWAYS)
    fill_element(element, geometry, table, {}, getattr(geometry, "extra", []), required=needed,
                 leave_out=("uri", "filename"))
    if hasattr(geometry, "uri"):
        write_value(element, "uri", TEXT, uri_of(geometry))
        element.insert(0, element[-1])


_ALWAYS = ("size", "radius", "length", "normal", "radii")


def tables_by_shape() -> Dict[Any, Table]:
    return {table.of: table for table in GEOMETRIES.values()}


def uri_of(geometry: Any) -> str:
    """A URI that does not depend on the location of the file."""
    uri: str = geometry.uri
    if "://" in uri or not geometry.path:
        return uri
    return str(geometry.path)


def _write_polyline(holder: Any, polyline: Polyline) -> None:
    for loop in polyline.loops:
        element = etree.SubElement(holder, "polyline")
        for point in loop:
            write_value(element, "point", VECTOR2, point)
        write_value(element, "height", FLOAT, polyline.height)


