"""Geometry, surface and appearance of a collision or a visual."""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Dict, List, Optional, Tuple, Union

from ..geometry import IDENTITY, Pose, Vec3

Color = Tuple[float, float, float, float]


@dataclass
class Box:
    """A box centred on the origin.

    Attributes:
        size: full edge lengths along x, y, z, m.
    """

    size: Vec3 = (1.0, 1.0, 1.0)


@dataclass
class Sphere:
    """A sphere centred on the origin.

    Attributes:
        radius: m.
    """

    radius: float = 1.0


@dataclass
class Cylinder:
    """A cylinder along z, centred on the origin.

    Attributes:
        radius: m.
        length: full length, m.
    """

    radius: float = 1.0
    length: float = 1.0


@dataclass
class Plane:
    """A plane through the origin; as a collision it is an infinite half-space.

    Attributes:
        normal: unit vector out of the solid side.
        size: edge lengths of what is drawn, m.
    """

    normal: Vec3 = (0.0, 0.0, 1.0)
    size: Tuple[float, float] = (1.0, 1.0)


@dataclass
class Mesh:
    """A triangle mesh.

    Attributes:
        uri: as written in the file.
        path: absolute path it resolved to; "" where it was not found.
        scale: scale along x, y, z, applied in the mesh's own frame, no unit.
        submesh: name of the part to use, "" for all.
        center: shift the part so that its bounding box is centred on the origin.
    """

    uri: str = ""
    path: str = ""
    scale: Vec3 = (1.0, 1.0, 1.0)
    submesh: str = ""
    center: bool = False


@dataclass
class Capsule:
    """A cylinder along z with half-spheres on both ends, centred on the origin (SDF 1.8).

    Attributes:
        radius: m.
        length: length of the cylinder without the half-spheres, m.
    """

    radius: float = 0.5
    length: float = 1.0


@dataclass
class Ellipsoid:
    """An ellipsoid centred on the origin (SDF 1.8).

    Attributes:
        radii: half axes along x, y, z, m.
    """

    radii: Vec3 = (1.0, 1.0, 1.0)


@dataclass
class Cone:
    """A cone along z, apex up, centred between base and apex (SDF 1.11).

    Attributes:
        radius: radius of the base, m.
        length: height, m.
    """

    radius: float = 0.5
    length: float = 1.0


@dataclass
class TerrainTexture:
    """A texture of a terrain. Source: SDF spec 1.7, heightmap/texture.

    Attributes:
        diffuse: URI of the image, "" for none; relative ones are made absolute when read.
        normal: URI of the normal map, "" for none.
        size: edge length of one repetition, m.
        extra: XML of child elements that no field holds.
    """

    diffuse: str = ""
    normal: str = ""
    size: float = 10.0
    extra: List[str] = field(default_factory=list)


@dataclass
class TerrainBlend:
    """Where the next texture of a terrain begins. Source: SDF spec 1.7, heightmap/blend.

    Attributes:
        min_height: height above the lowest level of the image from which on it is seen, m.
        fade_dist: height over which it replaces the texture before it, m.
        extra: XML of child elements that no field holds.
    """

    min_height: float = 0.0
    fade_dist: float = 0.0
    extra: List[str] = field(default_factory=list)


@dataclass
class Heightmap:
    """A terrain from a grey image. Source: SDF spec 1.7, geometry/heightmap.

    Attributes:
        uri: URI of the image, as written in the file.
        path: absolute path of the image; "" where it was not found.
        size: extent along x and y, and the height of white above black, m.
        position: position of the centre in the frame of the collision or visual, m.
        sampling: subdivisions of a pixel.
        textures: what it is covered with, from the lowest part upwards.
        blends: where the second and later textures begin.
        extra: XML of child elements that no field holds.
    """

    uri: str = ""
    path: str = ""
    size: Vec3 = (1.0, 1.0, 1.0)
    position: Vec3 = (0.0, 0.0, 0.0)
    sampling: int = 2
    textures: List[TerrainTexture] = field(default_factory=list)
    blends: List[TerrainBlend] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)


@dataclass
class Polyline:
    """Closed polygons in the x-y plane, extruded along z from 0. Source: SDF spec 1.7, polyline.

    Attributes:
        loops: corners of each polygon, m; the first is the outline, the others are holes.
        height: height of the solid, m.
    """

    loops: List[List[Tuple[float, float]]] = field(default_factory=list)
    height: float = 1.0


@dataclass
class ImageMap:
    """A map image whose dark pixels become boxes. Source: SDF spec 1.7, geometry/image.

    Attributes:
        uri: URI of the image, as written in the file.
        path: absolute path of the image; "" where it was not found.
        scale: edge length of a pixel, m.
        threshold: grey value, 0..255, below which a pixel becomes a box.
        height: height of the boxes, m.
        granularity: edge length of a box, pixels.
    """

    uri: str = ""
    path: str = ""
    scale: float = 1.0
    threshold: int = 200
    height: float = 1.0
    granularity: int = 1


@dataclass
class Empty:
    """No geometry."""


Geometry = Union[Box, Sphere, Cylinder, Plane, Mesh, Capsule, Ellipsoid, Cone, Heightmap,
                 Polyline, ImageMap, Empty]

Solid = Union[Mesh, Heightmap, Polyline, ImageMap]
"""Geometry that collides as a loaded mesh, found by `mesh_key`."""

SOLIDS = (Mesh, Heightmap, Polyline, ImageMap)


@dataclass
class MeshData:
    """A loaded mesh, in metres, in the frame of the file (no up-axis rotation, as Gazebo).

    Attributes:
        vertices: float64 array (n, 3), scale already applied.
        triangles: int32 array (m, 3) of vertex indices.
        parts: convex parts of the solid, for a dynamic body; None for its convex hull.
    """

    vertices: Any
    triangles: Any
    parts: Optional[List["MeshData"]] = None


@dataclass
class Surface:
    """Contact properties of a collision. Source: SDF spec 1.7, collision/surface.

    Attributes:
        mu: Coulomb friction coefficient, no unit; with `fdir1` in the first direction.
        mu2: coefficient in the second direction; used with `fdir1`.
        fdir1: first friction direction, in the collision frame; zero for none.
        slip1, slip2: slip velocity by friction force along `fdir1` and across it, m/(N s); without
            `fdir1` slip1 holds in all directions.
        restitution: coefficient of restitution, 0 to 1.
        bounce_threshold: impact velocity below which nothing bounces, m/s.
        kp: contact stiffness, N/m.
        kd: contact damping, N s/m.
        max_vel: greatest velocity that corrects penetration, m/s.
        min_depth: penetration below which it is not corrected, m; kept.
        collide_without_contact: whether contacts are found without forces.
        collide_bitmask: collisions collide if their bit masks have a common bit.
        torsion: coefficient of torsional friction, no unit.
        patch_radius: radius of the contact patch for torsional friction, m.
        surface_radius: radius of a sphere instead of a patch, m; kept.
    """

    mu: float = 1.0
    mu2: float = 1.0
    fdir1: Vec3 = (0.0, 0.0, 0.0)
    slip1: float = 0.0
    slip2: float = 0.0
    torsion: float = 1.0
    patch_radius: float = 0.0
    surface_radius: float = 0.0
    use_patch_radius: bool = True
    restitution: float = 0.0
    bounce_threshold: float = 100000.0
    kp: float = 1e12
    kd: float = 1.0
    max_vel: float = 0.01
    min_depth: float = 0.0
    collide_without_contact: bool = False
    collide_bitmask: int = 65535


@dataclass
class Material:
    """Appearance of a visual. Source: SDF spec 1.7, material.

    Attributes:
        ambient, diffuse, specular, emissive: colours, r, g, b, a in 0..1; None where not given.
        script_uris: URIs of Ogre material scripts.
        script_name: name of a material in the scripts, "" for none.
        texture: URI of a texture image as written in a URDF file, "" for none.
        double_sided: cameras see its faces from behind, too.
    """

    ambient: Optional[Color] = None
    diffuse: Optional[Color] = None
    specular: Optional[Color] = None
    emissive: Optional[Color] = None
    script_uris: List[str] = field(default_factory=list)
    script_name: str = ""
    texture: str = ""
    double_sided: bool = False


@dataclass
class Collision:
    """A shape of a link that collides. Source: SDF spec 1.7, collision.

    Attributes:
        name: unique among the collisions of its link.
        geometry: the shape.
        pose: pose of the shape in the link frame.
        surface: contact properties.
        max_contacts: greatest number of contacts with another collision; kept.
        laser_retro: intensity that laser sensors report.
        extra: XML of child elements that no field holds.
    """

    name: str
    geometry: Geometry
    pose: Pose = IDENTITY
    surface: Surface = field(default_factory=Surface)
    max_contacts: int = 10
    laser_retro: float = 0.0
    extra: List[str] = field(default_factory=list)


@dataclass
class Visual:
    """A shape of a link that is drawn. Source: SDF spec 1.7, visual.

    Attributes:
        name: unique among the visuals of its link.
        geometry: the shape.
        pose: pose of the shape in the link frame.
        material: appearance; None for the default.
        cast_shadows: whether the shape casts shadows.
        transparency: 0 opaque to 1 invisible.
        laser_retro: intensity that laser sensors report.
        layer: layer that the editor can hide (`meta/layer`; in buildings the storey); None for
            none.
        extra: XML of child elements that no field holds.
    """

    name: str
    geometry: Geometry
    pose: Pose = IDENTITY
    material: Optional[Material] = None
    cast_shadows: bool = True
    transparency: float = 0.0
    laser_retro: float = 0.0
    layer: Optional[int] = None
    extra: List[str] = field(default_factory=list)


MeshTable = Dict[str, MeshData]
"""Loaded collision meshes by `mesh_key`."""


def is_mesh_without_file(geometry: object) -> bool:
    """Whether the reader of a model did not find the file of this mesh, and has reported it."""
    return isinstance(geometry, Mesh) and not geometry.path


def mesh_key(solid: Solid) -> str:
    """Key of a loaded mesh: file, scale and submesh, or the numbers that define it."""
    if isinstance(solid, Heightmap):
        return repr(replace(solid, textures=[], blends=[], extra=[]))
    if not isinstance(solid, Mesh):
        return repr(solid)
    part = f"#{solid.submesh}{'@' if solid.center else ''}" if solid.submesh else ""
    return f"{solid.path}*{solid.scale[0]!r},{solid.scale[1]!r},{solid.scale[2]!r}{part}"
