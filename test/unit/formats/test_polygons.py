"""Triangles and convex pieces of polygons with holes cover what the loops enclose, once."""
from __future__ import annotations

import math
import random

import pytest

from my_simulations.formats.mesh.polygons import (
    convex_pieces,
    orient_loops,
    signed_area,
    triangulate,
)

SQUARE = [(-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0)]
PLACES = [(x, y) for x in (-3.0, 0.0, 3.0) for y in (-3.0, 0.0, 3.0)]


def square_hole(x, y):
    return [(x - 1, y - 1), (x + 1, y - 1), (x + 1, y + 1), (x - 1, y + 1)]


def star(draw, x, y, radius, corners):
    lengths = [radius * draw.uniform(0.4, 1.0) for _ in range(corners)]
    return [(x + length * math.cos(2 * math.pi * k / corners),
             y + length * math.sin(2 * math.pi * k / corners))
            for k, length in enumerate(lengths)]


def areas(loops):
    """What the loops enclose, and what triangles and pieces of them cover."""
    loops = orient_loops(loops)
    points, triangles = triangulate(loops)
    shapes = (triangles, convex_pieces(points, triangles))
    return sum(map(signed_area, loops)), [
        sum(signed_area([points[i] for i in corners]) for corners in shape) for shape in shapes]


@pytest.mark.parametrize("holes", range(10))
def test_holes_in_rows_and_columns_are_left_open(holes):
    enclosed, covered = areas([SQUARE, *(square_hole(*place) for place in PLACES[:holes])])
    assert enclosed == pytest.approx(144 - 4 * holes)
    assert covered == pytest.approx([enclosed, enclosed])


@pytest.mark.parametrize("seed", range(60))
def test_holes_of_any_form_are_left_open(seed):
    draw = random.Random(seed)
    holes = [star(draw, x, y, draw.uniform(0.3, 1.4), draw.randint(3, 9))
             for x, y in PLACES if draw.random() < 0.6]
    enclosed, covered = areas([SQUARE, *holes])
    assert covered == pytest.approx([enclosed, enclosed])
