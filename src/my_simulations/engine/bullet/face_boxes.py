"""Replace the flat faces of static meshes by boxes.

Bodies that slide over inner edges of triangles lose speed and are lifted: a box of 20 cm at
0.7 m/s lost 70 % of its speed in 3 s on a level floor without friction. Bullet can correct the
normals at such edges (GEOM_CONCAVE_INTERNAL_EDGE), but only for static bodies of its multibody
solver. Contacts of that solver have no split impulses, and upright cylinders are still lifted.
Boxes have no inner edges and no margin, and give four contact points at once.
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
"""Thickness of a face box, m: Bullet's margin of 1 mm must fit on both sides."""


_MOST_TRIANGLES = 500_000
"""Larger meshes keep all triangles: the search for flat faces takes 1 s for so many."""


class FaceBoxes:
    """Caches the flat faces of meshes by mesh key; height maps are not searched."""

    def __init__(self) -> None:
        self._faces: Dict[str, Optional[FlatFaces]] = {}   # None: the mesh has no flat faces

    def replace_faces(self, solid: Sequence[Collision], meshes: MeshTable,
                      ) -> Tuple[List[Collision], List[Collision], Dict[str, MeshData]]:
        """Return the unchanged collisions, the boxes, and the meshes without their flat faces."""
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
        """Return the flat faces of a mesh; None if it has none or is not loaded."""
        if key not in self._faces and key in meshes:
            found = (flat_faces(meshes[key])
                     if len(meshes[key].triangles) <= _MOST_TRIANGLES else None)
            self._faces[key] = found if found is not None and found.rectangles else None
        return self._faces.get(key)


def _place(face: Rectangle) -> Pose:
    """Return the pose of the box: the face is its top, or its middle for a two-sided face."""
    depth = 0.0 if face.from_both else 0.5 * _THIN
    x, y, z = (face.centre - depth * face.axes[2]).tolist()
    return Pose((x, y, z), quat_of(face.axes.T))
