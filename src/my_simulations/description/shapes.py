"""Geometry, surface and appearance of a collision or a visual."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple, Union

from ..geometry import IDENTITY, Pose, Vec3

Color = Tuple[float, float, float, float]


@dataclass
class Box:
    """`size`: full edge lengths in metres, centred on the origin."""

    size: Vec3 = (1.0, 1.0, 1.0)


@dataclass
class Sphere:
    """`radius` in metres."""

    radius: float = 1.0


@dataclass
class Cylinder:
    """Axis z, centred; metres."""

    radius: float = 1.0
    length: float = 1.0


@dataclass
class Plane:
    """Collides as a half-space whatever its size; `size` is that of the visual."""

    normal: Vec3 = (0.0, 0.0, 1.0)
    size: Tuple[float, float] = (1.0, 1.0)


@dataclass
class Mesh:
    """A triangle mesh.

    Attributes:
        uri: as written in the file.
        path: absolute path it resolved to; "" where it was not found.
        scale: per axis, applied in the mesh's own frame.
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
    """A cylinder along z with half-spheres on both ends; `length` without them (SDF 1.8)."""

    radius: float = 0.5
    length: float = 1.0


@dataclass
class Ellipsoid:
    """`radii` along x, y, z (SDF 1.8)."""

    radii: Vec3 = (1.0, 1.0, 1.0)


@dataclass
class Cone:
    """Axis z, apex up, centred between base and apex (SDF 1.11)."""

    radius: float = 0.5
    length: float = 1.0


@dataclass
class Heightmap:
    """A terrain from a grey image.

    `size`: extent along x and y, and the height of white above black; `position`: of the centre in
    the link frame; `sampling`: subdivisions of a pixel. `extra` keeps textures and blends.
    """

    uri: str = ""
    path: str = ""
    size: Vec3 = (1.0, 1.0, 1.0)
    position: Vec3 = (0.0, 0.0, 0.0)
    sampling: int = 2
    extra: List[str] = field(default_factory=list)


@dataclass
class Polyline:
    """Closed polygons in the x-y plane, the first outer and the others holes, extruded along z."""

    loops: List[List[Tuple[float, float]]] = field(default_factory=list)
    height: float = 1.0


@dataclass
class ImageMap:
    """A map image: every pixel darker than `threshold` (0..255) stands as a box `height` high.

    `scale` is metres a pixel; `granularity` pixels a box.
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
"""Geometry that collides as a mesh made ready beforehand, found by `mesh_key`."""

SOLIDS = (Mesh, Heightmap, Polyline, ImageMap)


@dataclass
class MeshData:
    """A loaded mesh, in metres, in the frame of the file (no up-axis rotation, as Gazebo).

    Attributes:
        vertices: float64 array (n, 3), scale already applied.
        triangles: int32 array (m, 3) of vertex indices.
        parts: convex pieces that together are the solid, for a body that moves; None: its hull.
    """

    vertices: Any
    triangles: Any
    parts: Optional[List["MeshData"]] = None


@dataclass
class Surface:
    """Contact properties; defaults are SDF's (collision/surface).

    `mu`, `mu2` Coulomb coefficients; `restitution` 0..1, used for impacts faster than
    `bounce_threshold` m/s; `kp` N/m, `kd` N s/m, `max_vel` m/s, `min_depth` m. `fdir1`, in the
    collision frame, is the direction in which `mu` and `slip1` hold. `torsion` is the coefficient
    of torsional friction on a patch of `patch_radius` m, or one of a sphere of `surface_radius` m.
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
    """Appearance, kept for the editor. Colours are r, g, b, a in 0..1; None where unset."""

    ambient: Optional[Color] = None
    diffuse: Optional[Color] = None
    specular: Optional[Color] = None
    emissive: Optional[Color] = None
    script_uris: List[str] = field(default_factory=list)
    script_name: str = ""
    texture: str = ""


@dataclass
class Collision:
    """One collision of a link; `pose` in the link frame."""

    name: str
    geometry: Geometry
    pose: Pose = IDENTITY
    surface: Surface = field(default_factory=Surface)
    max_contacts: int = 10
    laser_retro: float = 0.0
    extra: List[str] = field(default_factory=list)


@dataclass
class Visual:
    """One visual of a link; `pose` in the link frame; `transparency` 0 opaque to 1 invisible."""

    name: str
    geometry: Geometry
    pose: Pose = IDENTITY
    material: Optional[Material] = None
    cast_shadows: bool = True
    transparency: float = 0.0
    laser_retro: float = 0.0
    extra: List[str] = field(default_factory=list)


MeshTable = Dict[str, MeshData]
"""Loaded collision meshes by `mesh_key`."""


def mesh_key(solid: Solid) -> str:
    """What identifies a loaded mesh: file, scale and part, or the numbers that make it."""
    if not isinstance(solid, Mesh):
        return repr(solid)
    part = f"#{solid.submesh}{'@' if solid.center else ''}" if solid.submesh else ""
    return f"{solid.path}*{solid.scale[0]!r},{solid.scale[1]!r},{solid.scale[2]!r}{part}"
