"""Make the collision shapes of a link in PyBullet."""
from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np
import pybullet

from ...description.model import Model
from ...description.shapes import (
    SOLIDS,
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Empty,
    Geometry,
    Mesh,
    MeshData,
    MeshTable,
    Plane,
    Sphere,
    mesh_key,
)
from ...geometry import IDENTITY, IDENTITY_QUAT, ZERO3, Pose, compose, multiply, rotate
from ..api import CommandRefusedError
from ..surface_pieces import by_surface
from .face_boxes import FaceBoxes
from .shape_files import HullFile, ShapeFiles

MAX_SHAPES = 16
"""Shapes in one compound; one more crashes the process (measured, PyBullet 3.2.7)."""

MAX_TRIANGLES = 100_000
"""Triangles of a static shape; larger meshes are divided. Bullet needs 0.15 s for so many."""

_MARGIN = 1e-3
"""Margin of a hull in a compound, m; the margin of a single hull can be removed."""

_FLOOR = 1e6
"""Half the edge of the box that stands below a plane, m."""

_R3 = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
"""Steps of the additive recurrence R3, which fills a cube evenly (M. Roberts, 2018)."""

_MESH: Dict[str, Any] = {
    "shapeTypes": pybullet.GEOM_MESH, "halfExtents": ZERO3, "radii": 0.0, "lengths": 0.0,
    "fileNames": "", "meshScales": (1.0, 1.0, 1.0), "planeNormals": (0.0, 0.0, 1.0), "flags": 0,
    "collisionFramePositions": ZERO3, "collisionFrameOrientations": IDENTITY_QUAT}
"""The arguments of createCollisionShapeArray for a mesh in the body's frame."""


class ShapeError(CommandRefusedError):
    """PyBullet rejects a collision; the message is one sentence for the user."""


@dataclass(frozen=True)
class Recipe:
    """The arguments with which PyBullet makes a compound shape, any number of times.

    Attributes:
        role: "plane", "floor" for the box that stands below a plane, "faces" for boxes in place of
            the flat faces of meshes, "empty" for a link without collisions, or "" (see
            `collision_groups`).
        is_hull: whether it is one convex hull of points.
        frame: pose of its body in the frame of the link's body.
        hulls: the file that only this recipe and equal ones use.
    """

    names: str
    arguments: Dict[str, Any]
    role: str = ""
    is_hull: bool = False
    frame: Pose = IDENTITY
    hulls: Optional[HullFile] = field(default=None, compare=False)

    @functools.cached_property
    def key(self) -> str:
        """Equal for recipes of equal compounds."""
        return repr((self.arguments, self.is_hull))

    def make(self) -> int:
        """Make a shape and return its PyBullet number. Raises ShapeError."""
        shape: int = pybullet.createCollisionShapeArray(**self.arguments)
        if shape < 0:
            raise ShapeError(f"the physics engine refused the collision shapes {self.names}")
        return shape


class ShapeFactory:
    """Makes shapes. It passes meshes to PyBullet in scratch files, which `close` removes.

    Attributes:
        moments: principal moments of a new rigid body, kg m^2, by its shape number and mass.
    """

    def __init__(self) -> None:
        self._files = ShapeFiles()
        self._faces = FaceBoxes()
        self._visual_shape = -1
        self._unused: Dict[str, List[int]] = {}
        self.moments: Dict[Tuple[int, float], Tuple[float, float, float]] = {}

    def close(self) -> None:
        """Remove the mesh files."""
        self._files.close()

    @property
    def visual_shape(self) -> int:
        """A visual shape of one triangle for all bodies of a world; nothing is rendered here.

        Without it PyBullet makes a textured visual shape for every collision shape: a sphere or
        a plane then takes three times as long to create, and a mesh is read twice (measured).
        """
        if self._visual_shape < 0:
            self._visual_shape = pybullet.createVisualShape(
                pybullet.GEOM_MESH, vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)], indices=[0, 1, 2])
        return self._visual_shape

    def take_shape(self, recipe: Recipe) -> int:
        """Return the PyBullet number of a shape that no body uses. Raises ShapeError.

        PyBullet keeps the shapes of removed bodies and cannot remove them. With a new shape for
        each body, memory grows by 3.5 kB per body; with reuse, by 0.9 kB (measured, 3.2.7).
        """
        unused = self._unused.get(recipe.key)
        return unused.pop() if unused else recipe.make()

    def store_shapes(self, taken: Sequence[Tuple[Recipe, int]]) -> None:
        """Store the shapes of a removed body, so that `take_shape` can return them again."""
        for recipe, number in taken:
            self._unused.setdefault(recipe.key, []).append(number)

    def forget_world(self) -> None:
        """Discard the shapes after a reset of the simulation; mesh files stay."""
        self._visual_shape = -1
        self._unused.clear()
        self.moments.clear()

    def recipes(self, collisions: Sequence[Collision], meshes: MeshTable, frame: Pose,
                static: bool, whole: bool = False) -> List[Recipe]:
        """Return the recipes of a link, mesh files written; only a static link can have several.

        Args:
            collisions: the collisions of the link, with poses in the link frame.
            meshes: loaded meshes by `mesh_key`.
            frame: pose of the link frame in the frame in which the body is built.
            static: meshes of a static link collide as triangles, with boxes for their flat
                faces. Meshes of other links collide as convex hulls.
            whole: use all triangles of static meshes, without boxes.

        Raises:
            ShapeError: a geometry has no collision shape.
        """
        if static:
            return list(self.static_recipes(collisions, meshes, frame, whole))
        solid = [c for c in collisions if not isinstance(c.geometry, Empty)]
        if len(solid) <= MAX_SHAPES:
            return [self._recipe(solid, meshes, frame, static)] if solid else []
        # A moving link must be one body. Shapes beyond the limit become hulls in one file.
        solid.sort(key=lambda c: isinstance(c.geometry, (Box, Mesh)))
        kept, rest = solid[:MAX_SHAPES - 1], solid[MAX_SHAPES - 1:]
        return [self._recipe(kept, meshes, frame, static, self._files.hulls(rest, meshes, frame))]

    def static_recipes(self, collisions: Sequence[Collision], meshes: MeshTable, frame: Pose,
                       whole: bool = False) -> Iterator[Recipe]:
        """Yield the recipes of a static link one by one; each takes less than a second.

        A mesh of more than `MAX_TRIANGLES` is divided into pieces with a recipe each.
        """
        solid = [c for c in collisions if not isinstance(c.geometry, (Empty, Plane))]
        for plane in (c for c in collisions if isinstance(c.geometry, Plane)):
            yield replace(self._recipe([plane], meshes, frame, True), role="plane")
            yield self._floor(plane, meshes, frame)
        faces: List[Collision] = []
        if not whole:
            solid, faces, meshes = self._faces.replace_faces(solid, meshes)
            large = [c for c in solid if _triangles(c, meshes) > MAX_TRIANGLES]
            solid = [c for c in solid if _triangles(c, meshes) <= MAX_TRIANGLES]
            for collision in large:
                for piece, mesh in _divided(collision, meshes):
                    yield self._recipe([piece], mesh, frame, True)
        for at in range(0, len(solid), MAX_SHAPES):
            yield self._recipe(solid[at:at + MAX_SHAPES], meshes, frame, True)
        for at in range(0, len(faces), MAX_SHAPES):
            yield replace(self._recipe(faces[at:at + MAX_SHAPES], meshes, frame, True),
                          role="faces")

    def prepare(self, model: Model, meshes: MeshTable) -> Iterator[None]:
        """Make the shapes of a static model in advance, one for each value of the iterator.

        `take_shape` returns them later, so that the build of the model takes little time. Raises
        ShapeError: a shape cannot be made.
        """
        for link in model.links:
            for collision in link.collisions:
                self._faces.replace_faces([collision], meshes)
                yield
            for carrier in by_surface(link):
                for recipe in self.static_recipes(carrier.collisions, meshes, IDENTITY):
                    self.store_shapes([(recipe, recipe.make())])
                    yield

    def _floor(self, plane: Collision, meshes: MeshTable, frame: Pose) -> Recipe:
        """Return the box whose top is a plane; its own body has its origin in the box centre.

        With an offset shape instead, Bullet makes a compound. Steps with boxes on it then take
        10 % more instructions, for bit-identical results (measured).
        """
        assert isinstance(plane.geometry, Plane)
        turn = _to_z(plane.geometry)
        below = compose(plane.pose, Pose(rotate(turn, (0.0, 0.0, -_FLOOR)), turn))
        box = replace(plane, geometry=Box((2.0 * _FLOOR,) * 3), pose=IDENTITY)
        return replace(self._recipe([box], meshes, IDENTITY, True), role="floor",
                       frame=compose(frame, below))

    def empty(self, row: int) -> Recipe:
        """Return the shape of a link without collisions, by the row of the link.

        Bullet sorts the bounding boxes of all bodies into a tree by the distance of their centers
        (btDbvt). Boxes with one center form a list instead: a step took time proportional to the
        square of their number, 1.2 s for 4000 bodies without a shape, and 7 ms with these
        (measured). So the centers of these boxes are scattered in a cube of 100 m around the body.
        Their size is negative: each lower bound is 2 km above the upper one, so they overlap
        nothing.
        """
        x, y, z = (100.0 * (row * step % 1.0 - 0.5) for step in _R3)
        nowhere = Collision("", Box((-2000.0,) * 3), Pose((x, y, z)))
        return replace(self._recipe([nowhere], {}, IDENTITY, True), role="empty")

    def _recipe(self, collisions: Sequence[Collision], meshes: MeshTable, frame: Pose,
                static: bool, hulls: Optional[HullFile] = None) -> Recipe:
        is_hull = (len(collisions) == 1 and hulls is None
                   and _is_hull(collisions[0], meshes, static))
        margin = 0.0 if is_hull or static else _MARGIN
        shapes = []
        for collision in collisions:
            at, turn = compose(frame, collision.pose)
            if isinstance(collision.geometry, Plane):
                turn = multiply(turn, _to_z(collision.geometry))
            shapes.append({**_MESH, **self._geometry(collision.geometry, meshes, static, margin),
                           "collisionFramePositions": at, "collisionFrameOrientations": turn})
        if hulls is not None:
            shapes.append({**_MESH, "fileNames": hulls.path})
        return Recipe(", ".join(c.name for c in collisions),
                      {name: [shape[name] for shape in shapes] for name in _MESH},
                      is_hull=is_hull, hulls=hulls)

    def _geometry(self, geometry: Geometry, meshes: MeshTable, static: bool,
                  margin: float) -> Dict[str, Any]:
        """Return the arguments that differ from those of `_MESH`."""
        if isinstance(geometry, Box):
            return {"shapeTypes": pybullet.GEOM_BOX,
                    "halfExtents": tuple(s / 2.0 for s in geometry.size)}
        if isinstance(geometry, Sphere):
            return {"shapeTypes": pybullet.GEOM_SPHERE, "radii": geometry.radius}
        if isinstance(geometry, (Capsule, Cylinder)):
            return {"shapeTypes": pybullet.GEOM_CAPSULE if isinstance(geometry, Capsule)
                    else pybullet.GEOM_CYLINDER, "radii": geometry.radius,
                    "lengths": geometry.length}
        if isinstance(geometry, Plane):
            return {"shapeTypes": pybullet.GEOM_PLANE}
        if isinstance(geometry, (Ellipsoid, Cone)):
            return {"fileNames": self._files.hull_of(geometry)}
        if isinstance(geometry, SOLIDS):
            key = mesh_key(geometry)
            if key not in meshes:
                raise ShapeError(f"the shape {key} was not made ready")
            return {"fileNames": self._files.mesh(key, meshes[key], static, margin),
                    "flags": pybullet.GEOM_FORCE_CONCAVE_TRIMESH if static else 0}
        raise ShapeError(f"no collision shape for {type(geometry).__name__}")


def _triangles(collision: Collision, meshes: MeshTable) -> int:
    """The number of triangles of a static collision; 0 for a shape without a mesh."""
    if not isinstance(collision.geometry, SOLIDS):
        return 0
    mesh = meshes.get(mesh_key(collision.geometry))
    return 0 if mesh is None else len(mesh.triangles)


def _divided(collision: Collision, meshes: MeshTable) -> Iterator[Tuple[Collision, MeshTable]]:
    """Divide a mesh collision into collisions of at most `MAX_TRIANGLES`, each with its mesh."""
    assert isinstance(collision.geometry, SOLIDS)
    key = mesh_key(collision.geometry)
    mesh = meshes[key]
    for at in range(0, len(mesh.triangles), MAX_TRIANGLES):
        piece = Mesh(path=f"{key} from {at}")
        yield replace(collision, geometry=piece), {
            mesh_key(piece): MeshData(mesh.vertices, mesh.triangles[at:at + MAX_TRIANGLES])}


def _is_hull(collision: Collision, meshes: MeshTable, static: bool) -> bool:
    """Whether a collision becomes one convex hull."""
    geometry = collision.geometry
    if isinstance(geometry, (Ellipsoid, Cone)):
        return True
    return (not static and isinstance(geometry, SOLIDS)
            and len(meshes[mesh_key(geometry)].parts or ()) <= 1)


def _to_z(plane: Plane) -> "tuple[float, float, float, float]":
    """The rotation that turns z into the plane's normal."""
    n = np.asarray(plane.normal, dtype=float)
    n = n / np.linalg.norm(n)
    if n[2] < -1.0 + 1e-12:
        return (1.0, 0.0, 0.0, 0.0)
    q = np.array([-n[1], n[0], 0.0, 1.0 + n[2]])
    q /= np.linalg.norm(q)
    return (float(q[0]), float(q[1]), float(q[2]), float(q[3]))
