"""Meshes centred and scaled to a longest edge of 1, and their parts that need no decomposition."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Sequence

from ...description.shapes import MeshData
from .cache import Decomposition

FLAT, NOT_DIVIDED = "mesh-flat", "mesh-not-decomposed"
"""Codes of the notices of a decomposition."""

_THICKNESS_M = (0.001, 0.01)  # a flat mesh gets 1/100 of its extent, within these


@dataclass(frozen=True)
class Frame:
    """A mesh centred and scaled to a longest edge of 1, and the inverse transform.

    Attributes:
        points: float64 (n, 3), scaled vertices, without unit.
        centre: of the bounding box of the mesh, m.
        size: longest edge of that box, m.
    """

    points: Any
    centre: Any
    size: float

    def result(self, solids: Sequence[Any], notice: str = "") -> Decomposition:
        """Transform solids of this frame to parts in the frame of the mesh."""
        return Decomposition([MeshData(solid.vertices * self.size + self.centre, solid.faces)
                              for solid in solids], notice)

    def parts_at_once(self, triangles: Any) -> Optional[Decomposition]:
        """The parts of a mesh that need not be decomposed; None for other meshes."""
        from . import hulls

        if hulls.is_flat(self.points):
            least, most = _THICKNESS_M
            thickness = min(max(self.size / 100, least), most) / self.size
            return self.result([hulls.thicken_points(self.points, thickness)], FLAT)
        mesh = hulls.clean_mesh(self.points, triangles)
        if not len(mesh.faces):
            return self.result([hulls.hull_of(self.points)], NOT_DIVIDED)
        if hulls.is_convex(mesh):
            return self.result([hulls.hull_of(mesh.vertices)])
        pieces = hulls.convex_pieces(mesh)
        return self.result(pieces) if pieces else None


def frame_of(vertices: Any) -> Frame:
    """The frame of a mesh with these vertices, float64 (n, 3), m."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre, size = (low + high) / 2, max(float((high - low).max()), 1e-9)
    return Frame((vertices - centre) / size, centre, size)
