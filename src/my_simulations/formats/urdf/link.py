"""URDF links: inertia, collisions, visuals, materials."""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Dict, Optional, Sequence

from ...description.model import Inertial, Link
from ...description.shapes import Collision, Empty, Geometry, Material, Visual
from ...description.validate import closest_name_hint
from ...geometry import IDENTITY, Pose
from ..sdf.collision_visual import check_shape, unknown_shape
from ..sdf.material_files import check_texture_uri
from ..xml.binding import BAD, fill
from ..xml.source import FaultLevel, Source
from .kinematic_tree import Body
from .urdf_tables import (
    COLLISION,
    GEOMETRIES,
    INERTIAL,
    LINK,
    MATERIAL,
    ORIGIN,
    VISUAL,
    Origin,
    Paint,
)

Palette = Dict[str, Material]
"""Materials by name; a visual may refer to one that is defined elsewhere in the file."""


def read_origin(elements: Sequence[Any], source: Source,
                level: Optional[FaultLevel] = None) -> Pose:
    """The pose of the first `<origin>`; identity if there is none."""
    for element in elements:
        origin = Origin()
        fill(origin, element, ORIGIN, source, [], level)
        return Pose(origin.xyz, origin.rpy)
    return IDENTITY


def read_body(element: Any, source: Source, static: bool, palette: Palette) -> Body:
    """A link. Source: URDF specification, link."""
    link = Link(element.get("name", ""))
    body = Body(link, element)
    found = fill(link, element, LINK, source, [])
    for child in found.get("inertial", ()):
        body.inertial = _inertial(child, source, static)
    for child in found.get("collision", ()):
        collision = Collision("", Empty())
        inside = fill(collision, child, COLLISION, source, [])
        collision.pose = read_origin(inside.get("origin", ()), source)
        geometry = _geometry(inside.get("geometry", ()), child, source, True)
        if geometry is not None:
            collision.geometry = geometry
            body.collisions.append((child.get("name") or link.name, collision))
    for child in found.get("visual", ()):
        visual = Visual("", Empty())
        inside = fill(visual, child, VISUAL, source, [])
        visual.pose = read_origin(inside.get("origin", ()), source, FaultLevel.WARNING)
        geometry = _geometry(inside.get("geometry", ()), child, source, False)
        if geometry is not None:
            visual.geometry = geometry
            for material in inside.get("material", ()):
                visual.material = read_material(material, source, palette)
            body.visuals.append((child.get("name") or link.name, visual))
    return body


def _inertial(element: Any, source: Source, static: bool) -> Inertial:
    level = FaultLevel.WARNING if static else FaultLevel.FATAL
    inertial = Inertial(0.0)
    found = fill(inertial, element, INERTIAL, source, [], level)
    inertial.pose = read_origin(found.get("origin", ()), source, level)
    for tag in ("mass", "inertia"):
        if element.find(tag) is None:
            source.report(level, f"{tag}-missing", f"<inertial> has no <{tag}>", element)
    inertia = element.find("inertia")
    missing = [n for n in ("ixx", "iyy", "izz") if inertia is not None and inertia.get(n) is None]
    if missing:
        source.report(level, "inertia-missing", f"<inertia> has no {', '.join(missing)}", inertia)
    return inertial


def _geometry(elements: Sequence[Any], owner: Any, source: Source,
              collides: bool) -> Optional[Geometry]:
    level = FaultLevel.ERROR if collides else FaultLevel.WARNING
    shapes = [child for element in elements for child in element]
    if not shapes:
        source.report(level, "geometry-missing", f"<{owner.tag}> has no shape", owner)
        return None
    shape = shapes[0]
    if shape.tag not in GEOMETRIES:
        unknown_shape(shape, owner.tag, level, source, list(GEOMETRIES))
        return None
    table, needed = GEOMETRIES[shape.tag]
    missing = [name for name in needed if not (shape.get(name) or "").strip()]
    if missing:
        what = f"<{shape.tag}> has no {' and no '.join(missing)}"
        source.report(level, "attribute-missing", f"{what}; this {owner.tag} is skipped", shape)
        return None
    geometry: Geometry = table.of()
    if BAD in fill(geometry, shape, table, source, [], level):
        return None
    return check_shape(geometry, shape, owner.tag, source)


def read_palette(elements: Sequence[Any], source: Source) -> Palette:
    """The materials defined at the top level of the file."""
    palette: Palette = {}
    for element in elements:
        read_material(element, source, palette)
    return palette


def read_material(element: Any, source: Source, palette: Palette) -> Material:
    """A material; one with a name and content is added to the palette.

    Unlike Gazebo, which ignores colours of URDF, they are used.
    """
    paint = Paint()
    fill(paint, element, MATERIAL, source, [])
    if paint.color is None and not paint.texture:
        if paint.name not in palette:
            source.warn("material-unknown", f"there is no material {paint.name!r}", element,
                        closest_name_hint(paint.name, list(palette)))
            return Material()
        return replace(palette[paint.name])
    if paint.texture:
        check_texture_uri(paint.texture, element, source)
    material = Material(ambient=paint.color, diffuse=paint.color, texture=paint.texture)
    if paint.name:
        palette.setdefault(paint.name, material)
    return replace(material)
