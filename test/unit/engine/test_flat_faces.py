"""The flat faces of a mesh: which are found, as which rectangles, and what is left."""
from __future__ import annotations

import math
from typing import Any, Callable, List, Sequence, Tuple

import numpy as np
import pytest

from my_simulations.description.shapes import MeshData
from my_simulations.engine.convex.flat_faces import FlatFaces, Rectangle, flat_faces

Cell = Tuple[int, int]


def grid(columns: int, rows: int, without: Sequence[Cell] = (), edge: float = 1.0,
         height: Callable[[float, float], float] = lambda x, y: 0.0) -> MeshData:
    """Squares of two triangles each, seen from above, from the origin along x and y."""
    points = [(edge * x, edge * y, height(edge * x, edge * y))
              for x in range(columns + 1) for y in range(rows + 1)]
    faces: List[Tuple[int, int, int]] = []
    for x in range(columns):
        for y in range(rows):
            if (x, y) not in without:
                a, b = x * (rows + 1) + y, (x + 1) * (rows + 1) + y
                faces += [(a, b, a + 1), (a + 1, b, b + 1)]
    return MeshData(np.array(points, float), np.array(faces, np.int32))


def turned(mesh: MeshData, angle: float) -> MeshData:
    """A mesh turned about a skew axis, and moved."""
    x, y, z = np.array([1.0, 2.0, 3.0]) / math.sqrt(14.0)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + math.sin(angle) * skew + (1.0 - math.cos(angle)) * skew @ skew
    return MeshData(mesh.vertices @ turn.T + (5.0, -3.0, 2.0), mesh.triangles)


def sizes(found: FlatFaces) -> List[Tuple[float, float]]:
    return sorted((round(min(each.size), 6), round(max(each.size), 6))
                  for each in found.rectangles)


def area(rectangles: Sequence[Rectangle]) -> float:
    return sum(each.size[0] * each.size[1] for each in rectangles)


def covers(rectangles: Sequence[Rectangle], point: Any) -> int:
    """How many rectangles a place of their plane lies in."""
    count = 0
    for each in rectangles:
        x, y, _ = each.axes @ (np.asarray(point) - each.centre)
        count += abs(x) < each.size[0] / 2 and abs(y) < each.size[1] / 2
    return count


@pytest.mark.parametrize("columns, rows", [(1, 1), (20, 20), (7, 3), (60, 60)])
def test_a_level_floor_is_one_rectangle_that_looks_up(columns: int, rows: int):
    found = flat_faces(grid(columns, rows))
    assert found.rest is None and sizes(found) == [(min(columns, rows), max(columns, rows))]
    (floor,) = found.rectangles
    assert floor.centre == pytest.approx([columns / 2, rows / 2, 0.0])
    assert floor.axes[2] == pytest.approx([0.0, 0.0, 1.0])


def test_the_side_is_that_of_the_order_of_corners():
    floor = grid(2, 2)
    (below,) = flat_faces(MeshData(floor.vertices, floor.triangles[:, ::-1])).rectangles
    assert below.axes[2] == pytest.approx([0.0, 0.0, -1.0])
    both = np.concatenate([floor.triangles, floor.triangles[:, ::-1]])
    found = flat_faces(MeshData(floor.vertices, both))
    assert found.rest is None
    assert sorted(each.axes[2][2] for each in found.rectangles) == pytest.approx([-1.0, 1.0])
    assert not below.from_both and all(each.from_both for each in found.rectangles)


def test_where_some_triangles_of_a_floor_look_down_its_side_is_unknown():
    floor = grid(4, 2)
    faces = floor.triangles.copy()
    faces[:4] = faces[:4, ::-1]   # the first metre
    found = flat_faces(MeshData(floor.vertices, faces))
    assert sizes(found) == [(1.0, 2.0), (2.0, 3.0)] and found.rest is None
    assert all(each.from_both for each in found.rectangles)
    apart = grid(4, 2, height=lambda x, y: 0.0 if x < 2.5 else 1.0)
    assert not any(each.from_both for each in flat_faces(apart).rectangles)


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
def test_a_floor_with_a_hole_and_a_bay_is_covered_once_however_it_is_turned(angle: float):
    without = [(3, 2), (3, 3), (7, 0), (7, 1)]
    plain = grid(8, 6, without)
    found = flat_faces(turned(plain, angle))
    assert found.rest is None and len(found.rectangles) <= 7
    assert area(found.rectangles) == pytest.approx(48 - 4)
    for x in range(8):
        for y in range(6):
            middle = turned(MeshData(np.array([[x + 0.5, y + 0.4, 0.0]]), plain.triangles), angle)
            assert covers(found.rectangles, middle.vertices[0]) == ((x, y) not in without)


def test_corners_that_are_not_shared_do_not_part_a_floor():
    soup = grid(4, 4)
    found = flat_faces(MeshData(soup.vertices[soup.triangles].reshape(-1, 3),
                                np.arange(3 * len(soup.triangles)).reshape(-1, 3)))
    assert sizes(found) == [(4.0, 4.0)] and found.rest is None


def test_a_wall_that_stands_on_the_edges_of_a_floor_does_not_part_it():
    floor = grid(4, 4)
    wall = [(2.0, y, z) for y in range(5) for z in (0.0, 3.0)]
    faces = [face for y in range(4) for face in (
        (2 * y, 2 * y + 2, 2 * y + 1), (2 * y + 1, 2 * y + 2, 2 * y + 3))]
    found = flat_faces(MeshData(np.concatenate([floor.vertices, wall]), np.concatenate(
        [floor.triangles, np.array(faces) + len(floor.vertices)]).astype(np.int32)))
    assert sizes(found) == [(3.0, 4.0), (4.0, 4.0)] and found.rest is None


@pytest.mark.parametrize("mesh", [
    grid(20, 20, height=lambda x, y: 0.05 * math.sin(x) * math.cos(y)),
    grid(12, 2, edge=0.2, height=lambda x, y: math.sqrt(9.0 - (x - 1.2) ** 2)),
    grid(20, 20, height=lambda x, y: 3e-3 * ((x + y) % 2)),
    grid(3, 3, edge=0.005),
    MeshData(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1, 2]])),
    MeshData(np.array([[0, 0, 0], [2, 0, 0], [1.5, 1, 0], [0.5, 1, 0.0]]),
             np.array([[0, 1, 2], [0, 2, 3]])),
    MeshData(np.zeros((3, 3)), np.array([[0, 1, 2]])),
    MeshData(np.zeros((0, 3)), np.zeros((0, 3), np.int32)),
], ids=["terrain", "vault", "rough", "small", "triangle", "trapezium", "point", "nothing"])
def test_what_is_bent_small_or_oblique_stays_as_it_is(mesh: MeshData):
    found = flat_faces(mesh)
    assert found.rectangles == [] and found.rest is mesh


def test_what_is_not_flat_is_left_with_its_corners():
    """A level floor before a twisted slope."""
    found = flat_faces(grid(12, 4, height=lambda x, y: max(0.0, x - 7.0) * (1.0 + 0.3 * y)))
    assert found.rest is not None and sizes(found) == [(4.0, 7.0)]
    left = found.rest.vertices[found.rest.triangles]
    assert len(left) == 2 * 4 * 5
    assert left[:, :, 0].min() == pytest.approx(7.0) and left[:, :, 0].max() == pytest.approx(12.0)


def test_triangles_without_area_do_not_matter():
    floor = grid(3, 3)
    slivers = np.array([[0, 0, 1], [0, 1, 2]], np.int32)
    found = flat_faces(MeshData(floor.vertices, np.concatenate([floor.triangles, slivers])))
    assert sizes(found) == [(3.0, 3.0)] and found.rest is None
