"""Things that stand or fall, as loose pieces: for the laws, and for the bench."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Callable, Dict, List, Tuple

import numpy as np
from conftest import Lab, inertial_of_box, link_of

from my_simulations.description.model import Model
from my_simulations.description.shapes import Box, Geometry, Mesh, MeshData, Surface, mesh_key

Triple = Tuple[float, float, float]


@dataclass(frozen=True)
class Piece:
    """A box, or a wedge of eight corners, whose edges lie along the axes in its initial pose.

    Attributes:
        size: of the box, m; of a wedge its bounding box, from which its inertia is taken.
        position: of its centre of mass, m.
        corners: of a wedge, seen from its centre of mass; none for a box.
    """

    name: str
    size: Triple
    mass: float
    mu: float
    position: Triple
    corners: Tuple[Triple, ...] = ()


def stacks(count: int, height: int = 10) -> List[Piece]:
    """Stacks of unit boxes of 1 kg."""
    return [Piece(f"b{s}_{n}", (1.0, 1.0, 1.0), 1.0, 1.0, (4.0 * s, 0.0, 0.5 + n))
            for s in range(count) for n in range(height)]


def wall(rows: int = 20, columns: int = 10) -> List[Piece]:
    """Bricks of 0.2 x 0.1 x 0.1 m and 4 kg; every other row begins and ends with half a brick."""
    pieces = []
    for row in range(rows):
        places = [(0.2, 0.2 * n) for n in range(columns)]
        if row % 2:
            places = [(0.1, -0.05), *((0.2, 0.1 + 0.2 * n) for n in range(columns - 1)),
                      (0.1, 0.2 * columns - 0.15)]
        pieces += [Piece(f"b{row}_{n}", (length, 0.1, 0.1), 20.0 * length, 0.6,
                         (x, 0.0, 0.05 + 0.1 * row)) for n, (length, x) in enumerate(places)]
    return pieces


def cards(count: int = 20) -> List[Piece]:
    """Cards of 2 g, 2 mm thick, on each other."""
    return [Piece(f"card{n}", (0.06, 0.09, 0.002), 0.002, 0.5, (0.0, 0.0, 0.001 + 0.002 * n))
            for n in range(count)]


def arch(stones: int = 11, inner: float = 1.0, outer: float = 1.4, width: float = 0.5
         ) -> List[Piece]:
    """A half circle of wedges; an odd number has a keystone. Stands for any mu above 0.4."""
    pieces, turn = [], math.pi / stones
    for n in range(stones):
        ring = [(radius * math.cos(at), radius * math.sin(at))
                for at in (n * turn, (n + 1) * turn) for radius in (inner, outer)]
        (ax, az), (bx, bz), (cx, cz), (dx, dz) = ring
        # The centre of a symmetric trapezium, from its parallel sides and the way between them.
        near, far = math.dist((ax, az), (cx, cz)), math.dist((bx, bz), (dx, dz))
        low, high = ((ax + cx) / 2, (az + cz) / 2), ((bx + dx) / 2, (bz + dz) / 2)
        share = (near + 2 * far) / (3 * (near + far))
        middle = (low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1]))
        corners = tuple((x - middle[0], y, z - middle[1]) for y in (-width / 2, width / 2)
                        for x, z in ring)
        span = np.ptp(np.array(corners), axis=0)
        volume = (near + far) / 2 * math.dist(low, high) * width
        pieces.append(Piece(f"stone{n}", (float(span[0]), float(span[1]), float(span[2])),
                            2000.0 * volume, 0.7, (middle[0], 0.0, middle[1]), corners))
    return pieces


def pile(count: int = 80) -> List[Piece]:
    """Boxes of three sizes that fall on each other."""
    sizes = ((0.2, 0.2, 0.2), (0.3, 0.2, 0.1), (0.1, 0.1, 0.4))
    return [Piece(f"p{n}", sizes[n % 3], 1.0, 0.6,
                  (0.13 * (n % 4), 0.11 * (n // 4 % 4), 0.3 + 0.45 * (n // 16)
                   + 0.02 * (n % 16))) for n in range(count)]


def dominoes(count: int = 40) -> List[Piece]:
    """In a row; the first, which a heavy box lands on sideways, knocks over the others."""
    row = [Piece(f"d{n}", (0.02, 0.1, 0.2), 0.5, 0.5, (0.1 * n, 0.0, 0.1)) for n in range(count)]
    return row + [Piece("pusher", (0.05, 0.1, 0.05), 3.0, 0.5, (-0.022, 0.0, 0.23))]


SCENES: Dict[str, Callable[[], List[Piece]]] = {
    "a stack of 10": lambda: stacks(1), "200 boxes in stacks": lambda: stacks(20),
    "a wall of 200 bricks": wall, "a pile of 80": pile, "20 cards of 2 g": cards,
    "an arch of 11": arch, "40 dominoes": dominoes}


def model_of(piece: Piece, asleep: bool = False) -> Tuple[Model, Dict[str, MeshData]]:
    """A piece as a model of one link, with the mesh it needs. `asleep`: whether it may sleep."""
    surface, meshes = Surface(mu=piece.mu), {}
    geometry: Geometry = Box(piece.size)
    if piece.corners:
        points = np.array(piece.corners)
        geometry = Mesh(piece.name, f"/{piece.name}")
        meshes[mesh_key(geometry)] = MeshData(points, np.array(
            [(0, n, n + 1) for n in range(1, len(points) - 1)], dtype=np.int32))
    return Model(piece.name, allow_auto_disable=asleep, links=[link_of(
        geometry, inertial_of_box(piece.mass, *piece.size), surface)]), meshes


def load(lab: Lab, pieces: List[Piece]) -> List[Tuple[int, Piece]]:
    """Put pieces into a world, awake for ever; their numbers."""
    loaded = []
    for piece in pieces:
        model, meshes = model_of(piece)
        loaded.append((lab.load(model, piece.position, meshes=meshes), piece))
    return loaded
