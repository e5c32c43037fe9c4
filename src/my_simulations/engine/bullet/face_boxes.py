"""Boxes in place of the flat faces of static meshes.

What slides over the inner edges of triangles is stopped and thrown up: a box of 20 cm at 0.7 m/s
lost 70 % of its speed in 3 s on a level floor without friction. Bullet can correct the normals at
such edges (GEOM_CONCAVE_INTERNAL_EDGE), but for static bodies of its multibody solver only, whose
contacts know no split impulses; upright cylinders are thrown up none the less. Boxes have no inner
edges, no margin, and give four points of contact at once.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Dict, List, Optional, Sequence, Tuple

from ...description.shapes import (
    Box,
    Collision,
    ImageMap,
    Mesh,
    MeshData,
    MeshTable,
    Polyline,
    mesh_key,
)
from ...geometry import Pose, compose
from ..convex.flat_faces import FlatFaces, Rectangle, flat_faces
from ..principal_inertia import quat_of

_THIN = 2.2e-3
"""Thickness of such a box, m: Bullet's margin of 1 mm must fit on both sides."""


_MOST_TRIANGLES = 500_000
"""Larger meshes keep all their triangles: looking for flat faces takes 1 s for so many."""


class FaceBoxes:
    """Knows the flat faces of meshes, by their keys. Height maps have none of their own."""

    def __init__(self) -> None:
        self._faces: Dict[str, Optional[FlatFaces]] = {}   # None: none, so nothing is kept

    def parted(self, solid: Sequence[Collision],
               meshes: MeshTable) -> Tuple[List[Collision], List[Collision], Dict[str, MeshData]]:
        """What collides as before, the boxes, and the meshes without their flat faces."""
        left: List[Collision] = []
        boxes: List[Collision] = []
        rest = dict(meshes)
        for collision in solid:
            geometry = collision.geometry
            key = (mesh_key(geometry) if isinstance(geometry, (Mesh, Polyline, ImageMap))
                   else "")
            found = self._known(key, meshes)
            if found is None:
                left.append(collision)
                continue
            boxes += [replace(collision, geometry=Box((*each.size, _THIN)),
                              pose=compose(collision.pose, _place(each)))
                      for each in found.rectangles]
            if found.rest is not None:
                rest[key] = found.rest
                left.append(collision)
        return left, boxes, rest

    def _known(self, key: str, meshes: MeshTable) -> Optional[FlatFaces]:
        """The flat faces of a mesh, None if it has none or was not loaded."""
        if key not in self._faces and key in meshes:
            found = (flat_faces(meshes[key])
                     if len(meshes[key].triangles) <= _MOST_TRIANGLES else None)
            self._faces[key] = found if found is not None and found.rectangles else None
        return self._faces.get(key)


def _place(face: Rectangle) -> Pose:
    """The middle of the box: its top is the face, or the face is in its middle."""
    depth = 0.0 if face.from_both else 0.5 * _THIN
    x, y, z = (face.centre - depth * face.axes[2]).tolist()
    return Pose((x, y, z), quat_of(face.axes.T))
