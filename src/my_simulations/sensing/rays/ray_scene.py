"""What rays can meet: one instance a link, moved by its transform, and endless planes.

All instances are one array of Embree's, which takes their transforms from a table: to move a
hundred links costs one call, and the tree above them is made faster than of a hundred geometries.
"""
from __future__ import annotations

import ctypes
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from ...description.shapes import Plane, is_mesh_without_file
from ...errors import InputError
from ..api import NO_ROW, SetScenery
from ..poses import matrices, matrix, transforms
from ..scenery import Scenery
from .embree import (
    BODY,
    DIRECTION,
    FAR,
    FIELDS,
    GEOMETRY,
    INDEX,
    INSTANCES,
    MASK,
    MATRIX,
    NEAR,
    NORMAL,
    NOTHING,
    ORIGIN,
    PACKET,
    TIME,
    TRANSFORM,
    UINT,
    Embree,
)
from .ray_shapes import RayShape, buffers_of, triangle_buffers

_ALIGNED = 64
_PARALLEL = -1e-300
_STILL = np.eye(4)
_MOST_BACK_FACES = 64  # that a ray passes; it meets the next one
_PASSED = 1e-5         # m behind a back face at which its ray goes on


@dataclass
class _Parts:
    """A scene of the shapes of a link, shared by all links with the same."""

    scene: int
    retro: List[float]
    double_sided: List[bool]
    users: int = 0


@dataclass
class _Instance:
    row: int
    key: str


@dataclass
class _PlaneOnLink:
    row: int
    point: np.ndarray  # in the link frame
    normal: np.ndarray
    retro: float
    # Where it is in the world, as long as its link stands still.
    place: bytes = b""
    world_point: np.ndarray = field(default_factory=lambda: np.zeros(3))
    world_normal: np.ndarray = field(default_factory=lambda: np.zeros(3))


@dataclass
class _Model:
    instances: List[_Instance] = field(default_factory=list)
    planes: List[_PlaneOnLink] = field(default_factory=list)


class RayScene:
    """A top-level scene. Not thread safe.

    `report_problem` is told of shapes that cannot be read, which rays then pass through.
    """

    def __init__(self, embree: Embree, trouble: Callable[[str], None]) -> None:
        self._embree = embree
        self._trouble = trouble
        self._top = embree.scene(dynamic=True)
        self._parts: Dict[str, _Parts] = {}
        self._models: Dict[str, _Model] = {}
        self._scenery = Scenery()
        self._scenic: List[_Instance] = []
        self._surfaces: List[Tuple[int, int]] = []   # Embree's, of each part of the scenery
        self._changed = True
        self._array: Optional[Tuple[ctypes.c_void_p, int]] = None  # handle, number in the scene
        self._which = np.zeros(0, dtype=np.uint32)                 # its tables: read by Embree
        self._transforms = np.zeros((0, 4, 3), dtype=np.float32)
        self._rows = np.zeros(0, dtype=np.int64)
        self._most_row = NO_ROW
        self._last = np.zeros((0, 7))
        self._poses = np.zeros((0, 7))
        self._ns = -1
        self._buffer = _packets(PACKET)

    def add(self, name: str, links: Sequence[Tuple[int, Sequence[RayShape]]]) -> None:
        """A model of links with rows; it is seen once `move` has given it a place."""
        self.remove(name)
        model = _Model()
        self._models[name] = model
        for row, shapes in links:
            for shape in shapes:
                if shape.endless and isinstance(shape.geometry, Plane):
                    frame = matrix(shape.pose)
                    normal = frame[:3, :3] @ np.array(shape.geometry.normal)
                    model.planes.append(_PlaneOnLink(row, frame[:3, 3], normal, shape.retro))
            solid = tuple(s for s in shapes if not (s.endless and isinstance(s.geometry, Plane)))
            if solid:
                model.instances.append(self._instantiate(row, solid))
        self._changed = True

    def remove(self, name: str) -> None:
        """A model has gone; nothing happens where there is none."""
        model = self._models.pop(name, None)
        for instance in model.instances if model else ():
            parts = self._parts[instance.key]
            parts.users -= 1
            if not parts.users:
                self._embree.rtcReleaseScene(parts.scene)  # the array keeps it as long as it needs
                del self._parts[instance.key]
        self._changed = True

    def clear(self) -> None:
        for name in list(self._models):
            self.remove(name)
        self.set_scenery(SetScenery())

    def set_scenery(self, scenery: SetScenery) -> None:
        """Roads and actors; they are seen once `move` has given them a place."""
        if scenery == self._scenery.told:
            return
        for instance in self._scenic:
            self._embree.rtcReleaseScene(self._parts.pop(instance.key).scene)
        self._scenic, self._surfaces = [], []
        self._scenery = Scenery(scenery, self._trouble, "rays")
        for n, part in enumerate(self._scenery.parts):
            scene = self._embree.scene(dynamic=True)
            kind, (vertices, triangles) = triangle_buffers(_STILL, part.piece.rows[:, :3],
                                                     part.piece.triangles)
            self._surfaces.append(self._embree.attach(scene, kind, (triangles, vertices)))
            self._embree.rtcCommitScene(scene)
            self._embree.check()
            self._scenic.append(_Instance(part.row, f"scenery {n}"))
            self._parts[f"scenery {n}"] = _Parts(scene, [0.0], [part.piece.surface.double_sided])
        self._changed = True

    def _reshape(self, ns: int) -> bool:
        """Give scenery the shape that it has at a sim time; whether it had another."""
        found = self._scenery.take_reshaped_parts(ns)
        for part, rows in found:
            vertices = np.ascontiguousarray(rows[:, :3])
            self._embree.reshape(*self._surfaces[part], vertices)
            self._embree.rtcCommitScene(self._parts[self._scenic[part].key].scene)
        return bool(found)

    def _instantiate(self, row: int, shapes: Tuple[RayShape, ...]) -> _Instance:
        key = repr(shapes)
        parts = self._parts.get(key)
        if parts is None:
            parts = self._parts[key] = self._build(shapes)
        parts.users += 1
        return _Instance(row, key)

    def _build(self, shapes: Tuple[RayShape, ...]) -> _Parts:
        scene = self._embree.scene(dynamic=False)
        retro: List[float] = []
        double_sided: List[bool] = []
        for shape in shapes:
            if is_mesh_without_file(shape.geometry):
                continue
            try:
                made = buffers_of(shape)
            except InputError as fault:
                self._trouble(f"rays do not see a shape: {fault}")
                continue
            for kind, buffers in made:
                self._embree.attach(scene, kind, buffers)
                retro.append(shape.retro)
                double_sided.append(shape.double_sided)
        self._embree.rtcCommitScene(scene)
        self._embree.check()
        return _Parts(scene, retro, double_sided)

    def move(self, poses: np.ndarray, ns: int = 0) -> None:
        """Put every link where (n, 7) poses of link rows say, and actors where they are at `ns`.

        A link without a row is not seen.
        """
        if poses is self._poses and ns == self._ns and not self._changed:
            return  # another sensor in the same state
        if self._changed:
            self._index()
        reshaped = bool(self._scenic) and self._reshape(ns)
        placed = self._scenery.append_poses(poses, ns)
        if self._most_row < len(poses):
            now: Any = placed.take(self._rows, axis=0)
        else:
            here = self._rows < len(poses)
            now = np.full((len(self._rows), 7), np.nan)
            now[here] = placed[self._rows[here]]
        moved = np.flatnonzero((now != self._last).any(axis=1))
        if len(moved) or self._changed or reshaped:
            self._place(moved, now)
            self._embree.rtcCommitScene(self._top)
        self._last, self._changed, self._poses, self._ns = now, False, poses, ns

    def _index(self) -> None:
        """Tables by place in the array of instances, after a change of the scene."""
        instances = [one for model in self._models.values() for one in model.instances]
        instances += self._scenic
        scenes = {key: n for n, key in enumerate(self._parts)}
        self._rows = np.array([one.row for one in instances], dtype=np.int64)
        self._most_row = int(self._rows.max(initial=NO_ROW))
        self._last = np.full((len(instances), 7), np.inf)
        self._planes = [plane for model in self._models.values() for plane in model.planes]
        first: Dict[str, int] = {}
        retro: List[float] = []
        double_sided: List[bool] = []
        for key, parts in self._parts.items():
            first[key] = len(retro)
            retro += parts.retro
            double_sided += parts.double_sided
        # What has met nothing has numbers of -1: the last ones of these tables.
        # Scenery has a row below that, and is no link either.
        self._row_of = np.array([*(max(one.row, NO_ROW) for one in instances), NO_ROW],
                                dtype=np.int32)
        self._first = np.array([*(first[one.key] for one in instances), len(retro) + 1],
                               dtype=np.int64)
        self._retro = np.array([*retro, 0.0], dtype=np.float32)
        self._double_sided = np.array([*double_sided, True])
        self._culls = not self._double_sided.all()
        # What follows is Embree's while it builds and looks; it reads whole 16 bytes.
        which = np.zeros(len(instances) + 4, dtype=np.uint32)
        which[:len(instances)] = [scenes[one.key] for one in instances]
        places = np.full((len(instances) + 1, 4, 3), np.nan, dtype=np.float32)
        self._make_array(len(instances), which, places)
        self._which, self._transforms = which, places

    def _make_array(self, count: int, which: np.ndarray, places: np.ndarray) -> None:
        embree = self._embree
        if self._array is not None:
            embree.rtcDetachGeometry(self._top, self._array[1])
            embree.rtcReleaseGeometry(self._array[0])
            self._array = None
        if not count:
            return
        made = ctypes.c_void_p(embree.rtcNewGeometry(embree.device, INSTANCES))
        scenes = (ctypes.c_void_p * len(self._parts))(*(one.scene for one in self._parts.values()))
        embree.rtcSetGeometryInstancedScenes(made, scenes, len(scenes))
        for use, form, table in ((INDEX, UINT, which), (TRANSFORM, MATRIX, places)):
            embree.rtcSetSharedGeometryBuffer(made, use, 0, form, table.ctypes.data, 0,
                                              table.strides[0], count)
        embree.rtcCommitGeometry(made)
        embree.check()
        self._array = (made, embree.rtcAttachGeometry(self._top, made))

    def _place(self, moved: np.ndarray, now: np.ndarray) -> None:
        """Say where instances are; one that is at no finite place is left out by Embree."""
        if self._array is None:
            return
        columns = transforms(now if len(moved) == len(now) else now[moved])
        if len(moved) == len(now):
            self._transforms[:len(now)] = columns
        else:
            self._transforms[moved] = columns
        self._embree.rtcUpdateGeometryBuffer(self._array[0], TRANSFORM, 0)
        self._embree.rtcCommitGeometry(self._array[0])

    def cast(self, origins: np.ndarray, directions: np.ndarray, near: float, far: float,
             ) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Ranges (float64, inf for nothing), retro (float32) and link rows (int32) of rays.

        `origins` (3,) or (n, 3) and unit `directions` (n, 3), in the world. Call `move` before.
        """
        ranges, body, shape = self._nearest(origins, directions, near, far)
        rows, retro = self._row_of[body], self._retro[shape]
        for plane in self._planes:
            self._intersect_plane(plane, origins, directions, near, far, (ranges, retro, rows))
        return ranges, retro, rows

    def _nearest(self, origins: np.ndarray, directions: np.ndarray, near: float, far: float,
                 ) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Ranges, instances and shapes of the first faces that rays meet.

        A back face of a shape that is not double-sided is passed: the ray goes on behind it.
        """
        ranges, body, shape, normals = self._intersect(origins, directions, near, far)
        if not self._culls:
            return ranges, body, shape
        which = np.arange(len(directions))
        for _ in range(_MOST_BACK_FACES):
            which = which[self._back_faces(directions[which], body[which], shape[which], normals)]
            if not len(which):
                break
            start = origins if origins.ndim == 1 else origins[which]
            ranges[which], body[which], shape[which], normals = self._intersect(
                start, directions[which], ranges[which] + _PASSED, far)
        return ranges, body, shape

    def _back_faces(self, directions: np.ndarray, body: np.ndarray, shape: np.ndarray,
                    normals: np.ndarray) -> np.ndarray:
        """Which rays have met a back face; normals (n, 3) in the frames of the links."""
        turns = self._transforms[body, :3]  # rows: the axes of the link in the world
        along = np.einsum("ni,nij,nj->n", normals, turns, directions)
        found: np.ndarray = (along > 0.0) & (body >= 0) & ~self._double_sided[shape]
        return found

    def _intersect(self, origins: np.ndarray, directions: np.ndarray,
                   near: Union[float, np.ndarray], far: float,
                   ) -> Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Ranges, instances, shapes, and normals in link frames of what rays meet first.

        `near`: one for all rays, or (n,).
        """
        count = len(directions)
        packets = -(-count // PACKET)
        if len(self._buffer) < packets:
            self._buffer = _packets(packets)
        buffer = self._buffer[:packets]
        words = buffer.view(np.uint32)
        _fill(buffer[:, ORIGIN:ORIGIN + 3], origins, count)
        _fill(buffer[:, DIRECTION:DIRECTION + 3], directions, count)
        if isinstance(near, np.ndarray):
            _fill(buffer[:, NEAR:NEAR + 1], near[:, None], count)
        else:
            buffer[:, NEAR] = near
        buffer[:, FAR] = far
        buffer[:, TIME] = 0.0
        words[:, MASK] = NOTHING
        words[:, GEOMETRY:] = NOTHING
        intersect, top, valid = self._embree.rtcIntersect16, self._top, _ALL.ctypes.data
        at, size = buffer.ctypes.data, FIELDS * PACKET * 4
        for n in range(packets):
            intersect(valid, top, at + n * size, None)
        numbers = buffer.view(np.int32)
        body = numbers[:, BODY].ravel()[:count]
        ranges: Any = buffer[:, FAR].ravel()[:count].astype(np.float64)
        ranges[body < 0] = np.inf
        shape = self._first[body] + numbers[:, GEOMETRY].ravel()[:count]
        normals = buffer[:, NORMAL:NORMAL + 3].transpose(0, 2, 1).reshape(-1, 3)[:count]
        return ranges, body, shape, normals

    def _intersect_plane(self, plane: _PlaneOnLink, origins: np.ndarray, directions: np.ndarray,
                         near: float, far: float,
                         found: Tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
        """An endless plane, from both sides (Gazebo's ODE), to the last digit."""
        if plane.row >= len(self._poses):
            return
        place = self._poses[plane.row].tobytes()
        if place != plane.place:
            frame = matrices(self._poses[plane.row:plane.row + 1])[0]
            plane.place, plane.world_normal = place, frame[:3, :3] @ plane.normal
            plane.world_point = frame[:3, :3] @ plane.point + frame[:3, 3]
        height = (origins - plane.world_point) @ plane.world_normal
        along = directions @ plane.world_normal
        ranges, retro, rows = found
        # What runs along the plane never meets it.
        distance = -height / np.where(along == 0.0, _PARALLEL, along)
        nearer = (distance >= near) & (distance <= far) & (distance < ranges)
        if nearer.any():
            ranges[nearer], retro[nearer] = distance[nearer], plane.retro
            rows[nearer] = plane.row


def _packets(count: int) -> np.ndarray:
    """Room for packets, where Embree wants it: at a multiple of 64 bytes."""
    raw = np.zeros(count * FIELDS * PACKET + _ALIGNED // 4, dtype=np.float32)
    first = -raw.ctypes.data % _ALIGNED // ctypes.sizeof(ctypes.c_float)
    return raw[first:first + count * FIELDS * PACKET].reshape(count, FIELDS, PACKET)


_ALL = _packets(1)[0, 0].view(np.int32)  # of a packet's rays, every one is valid; aligned, too
_ALL[:] = -1


def _fill(fields: np.ndarray, values: np.ndarray, count: int) -> None:
    """Put (k,) or (n, k) values into (packets, k, PACKET); the rest repeats the last ones."""
    if values.ndim == 1:
        fields[:] = values[None, :, None]
        return
    whole = count // PACKET
    fields[:whole] = values[:whole * PACKET].reshape(
        whole, PACKET, values.shape[1]).transpose(0, 2, 1)
    if whole < len(fields):
        rest = values[whole * PACKET:]
        fields[whole, :, :len(rest)] = rest.T
        fields[whole, :, len(rest):] = rest[-1][:, None]
