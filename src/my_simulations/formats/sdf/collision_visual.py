"""SDF collisions and visuals: geometry, surface, material."""
from __future__ import annotations

import os
from typing import Any, List, Optional, Sequence, Tuple, Union

from ...appearance.terrain_layers import substitute_pattern
from ...description.shapes import (
    Collision,
    Empty,
    Geometry,
    Heightmap,
    ImageMap,
    Material,
    Mesh,
    Polyline,
    TerrainTexture,
    Visual,
)
from ...description.validate import closest_name_hint, geometry_fault, has_zero_size
from ...resources.resolver import ResourceNotFoundError
from ..xml.binding import BAD, REFUSED, Found, fill, read_text, to_xml
from ..xml.source import FaultLevel, Source
from ..xml.values import VECTOR2
from .material_files import check_script
from .model_tables import COLLISION, GEOMETRIES, MATERIAL, VISUAL


def read_collision(
    element: Any, source: Source, kept: List[str]
) -> Optional[Tuple[Collision, Found]]:
    """A collision; None if it is skipped, with its XML added to `kept`.

    Source: SDF spec 1.7, link/collision.
    """
    collision = Collision(element.get("name", ""), Empty())
    found = fill(collision, element, COLLISION, source, collision.extra)
    geometry = _geometry(found.get("geometry", ()), element, source, True, collision.extra)
    if geometry is None:
        kept.append(to_xml(element))
        return None
    collision.geometry = geometry
    return collision, found


def read_visual(element: Any, source: Source, kept: List[str]) -> Optional[Tuple[Visual, Found]]:
    """A visual; None if it is skipped, with its XML added to `kept`.

    Source: SDF spec 1.7, link/visual.
    """
    visual = Visual(element.get("name", ""), Empty())
    found = fill(visual, element, VISUAL, source, visual.extra)
    geometry = _geometry(found.get("geometry", ()), element, source, False, visual.extra)
    if geometry is None:
        kept.append(to_xml(element))
        return None
    visual.geometry = geometry
    for child in found.get("material", ()):
        visual.material = fill_material(child, source, visual.extra)
    return visual, found


def fill_material(element: Any, source: Source, extra: List[str]) -> Material:
    """A `<material>`; elements without a field go to `extra`. Source: SDF spec, material."""
    material = Material()
    kept: List[str] = []
    fill(material, element, MATERIAL, source, kept)
    extra += [f"<material>{xml}</material>" for xml in kept]
    material.script_uris = [_make_absolute(uri, source.base_dir) for uri in material.script_uris]
    check_script(material, element, source)
    return material


def _make_absolute(uri: str, base_dir: str) -> str:
    """A relative URI as an absolute path below `base_dir`."""
    if base_dir and "://" not in uri and not os.path.isabs(uri):
        path = os.path.join(base_dir, uri)
        return path if os.path.exists(path) else uri
    return uri


def _geometry(
    elements: Sequence[Any], owner: Any, source: Source, collides: bool, kept: List[str],
) -> Optional[Geometry]:
    level = FaultLevel.ERROR if collides else FaultLevel.WARNING
    shapes = [child for element in elements for child in element if isinstance(child.tag, str)]
    if not elements:
        source.report(level, "geometry-missing", f"<{owner.tag}> has no <geometry>", owner)
        return None
    if not shapes:
        return Empty()
    shape = shapes[0]
    if len(shapes) > 1 and shape.tag != "polyline":
        source.warn("geometry-many", f"<geometry> contains several shapes; <{shape.tag}> is used",
                    shapes[1])
    table = GEOMETRIES.get(shape.tag)
    if table is None:
        unknown_shape(shape, owner.tag, level, source, list(GEOMETRIES))
        return None
    geometry: Geometry = table.of()
    extra: List[str] = geometry.extra if isinstance(geometry, Heightmap) else []
    found = fill(geometry, shape, table, source, extra, level)
    if BAD in found:
        return None
    if extra and not isinstance(geometry, Heightmap):
        kept += [f"<geometry><{shape.tag}>{xml}</{shape.tag}></geometry>" for xml in extra]
    if isinstance(geometry, Polyline) and not _loops(geometry, shapes, source, level):
        return None
    if isinstance(geometry, Heightmap) and not collides:
        check_textures(geometry, shape, source)
    return check_shape(geometry, shape, owner.tag, source)


def _loops(polyline: Polyline, shapes: Sequence[Any], source: Source, level: FaultLevel) -> bool:
    """The corners (m) of all sibling polylines: the first is the outline, the others are holes."""
    for shape in shapes:
        loop: List[Tuple[float, float]] = []
        for point in shape.iterfind("point") if shape.tag == "polyline" else ():
            found = read_text(VECTOR2, point.text or "", "<point>", point, source, level)
            if found is REFUSED:
                return False
            loop.append(found)
        if len(loop) > 1 and max(abs(loop[0][0] - loop[-1][0]), abs(loop[0][1] - loop[-1][1])
                                 ) < _CLOSED:
            loop.pop()
        if shape.tag == "polyline":
            polyline.loops.append(loop)
    return True


_CLOSED = 1e-4
"""Largest distance (m) between first and last point of an explicitly closed loop (Gazebo)."""


def unknown_shape(shape: Any, owner: str, level: FaultLevel, source: Source,
                  known: Sequence[str]) -> None:
    """Report a shape that is skipped."""
    source.report(level, "geometry-unknown",
                  f"<{shape.tag}> is not a known shape; this {owner} is skipped", shape,
                  closest_name_hint(shape.tag, list(known)))


def check_shape(geometry: Geometry, shape: Any, owner: str, source: Source) -> Optional[Geometry]:
    """Find the mesh of a shape and check its sizes; report an unusable shape and return None."""
    collides = owner == "collision"
    if isinstance(geometry, (Mesh, Heightmap, ImageMap)) and not find_mesh(
            geometry, shape, source, collides):
        return None
    if isinstance(geometry, Mesh):
        _thicken(geometry, shape, owner, source)
    problem = geometry_fault(geometry)
    if problem:
        # ODE geometries of size 0 have no contacts; files use them as placeholders.
        mild = not collides or has_zero_size(geometry)
        say = source.warn if mild else source.tolerate
        say("bad-shape", f"{problem}; this {owner} is skipped", shape)
        return None
    return geometry


THINNEST_SCALE = 1e-3
"""Scale of a mesh axis in place of 0: flat meshes collide in Gazebo, too."""


def _thicken(mesh: Mesh, shape: Any, owner: str, source: Source) -> None:
    """Give a mesh scaled to a plane a small thickness; one scaled to a point is skipped."""
    if 0.0 not in mesh.scale or not any(mesh.scale):
        return
    shown = " ".join(f"{value:g}" for value in mesh.scale)
    x, y, z = (value or THINNEST_SCALE for value in mesh.scale)
    mesh.scale = (x, y, z)
    source.tolerate("scale-zero", f"the scale {shown} makes the mesh of this {owner} flat;"
                    f" {THINNEST_SCALE:g} is used for 0", shape)


def find_mesh(mesh: Union[Mesh, Heightmap, ImageMap], element: Any, source: Source,
              collides: bool) -> bool:
    """Set the path of the mesh or image; False if its collision or visual must be skipped.

    A visual whose file is missing is kept without a path, so that saving keeps it.
    """
    try:
        mesh.path = source.resolve(mesh.uri, element)
    except ResourceNotFoundError as missing:
        owner = "collision" if collides else "visual"
        kind = "mesh" if isinstance(mesh, Mesh) else "image"
        say = source.tolerate if collides else source.warn
        without = "; this collision is skipped" if collides else ""
        text, hint = source.resolver.explain(
            missing, "check the path, GAZEBO_MODEL_PATH and ROS_PACKAGE_PATH")
        say(f"{kind}-not-found", f"the {kind} of this {owner} {text}{without}", element, hint=hint)
        return not collides
    return True


_PLACEHOLDER = "__default__"


def check_textures(heightmap: Heightmap, shape: Any, source: Source) -> None:
    """Report images that are missing, sizes and numbers that cannot be drawn.

    URIs that are relative to the file become absolute. Source: SDF spec 1.7, heightmap.

    Args:
        heightmap: of a visual, with its textures and blends as written.
        shape: the element `<heightmap>`.
        source: receives warnings.
    """
    for texture, element in zip(heightmap.textures, shape.iterfind("texture")):
        texture.diffuse = _resolve_uri(texture.diffuse, "texture", element, source)
        texture.normal = _resolve_uri(texture.normal, "normal map", element, source)
        if texture.size <= 0.0:
            usual = TerrainTexture().size
            source.warn("bad-value", f"<size> of <texture> must be greater than 0;"
                        f" {usual:g} m is used", element)
            texture.size = usual
    textures, blends = len(heightmap.textures), len(heightmap.blends)
    if textures and blends != textures - 1:
        source.warn("terrain-blends", f"a heightmap of {textures} textures needs"
                    f" {textures - 1} <blend>, not {blends}; "
                    + ("the last ones are unused" if blends >= textures else
                       "the last textures are not seen"), shape)


def _resolve_uri(uri: str, what: str, element: Any, source: Source) -> str:
    """The URI, absolute where it is a path; with a warning where it leads nowhere."""
    if not uri or uri == _PLACEHOLDER:
        return ""
    try:
        path = source.resolve(uri, element)
    except ResourceNotFoundError as missing:
        if substitute_pattern(uri) is None:
            without = "grey is shown instead" if what == "texture" else "it is left out"
            text, hint = source.resolver.explain(
                missing, "check the path, GAZEBO_MODEL_PATH and GAZEBO_RESOURCE_PATH")
            source.warn("image-not-found", f"the {what} of this heightmap {text}; {without}",
                        element, hint)
        return uri
    return uri if "://" in uri else path
