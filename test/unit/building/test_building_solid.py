"""The solids of a building against a rasterisation of its plan."""
from __future__ import annotations

import math
import random

import numpy as np
import pytest
from building_plans import link, one_wall, two_rooms

from my_simulations.building.building_plan import Floor, Level, Opening, Plan, Roof, Stairs, Wall
from my_simulations.building.plan_to_model import building_model
from my_simulations.building.rectangles import loop_of, rectangles
from my_simulations.description.shapes import Box
from my_simulations.formats.mesh.terrain import solid_mesh
from my_simulations.geometry import compose, inverse, rotate, transform


def solids_of(model):
    """The model's collisions, each with the transform from the world into its own frame."""
    return [(part, inverse(compose(model.pose, compose(found.pose, part.pose))))
            for found in model.links for part in found.collisions]


def holds(solids, point):
    """True when a point is in one of the collisions."""
    return any(_inside(part, transform(into, point)) for part, into in solids)


def _inside(part, local):
    geometry = part.geometry
    if isinstance(geometry, Box):
        return all(abs(value) < size / 2 for value, size in zip(local, geometry.size))
    if not 0 < local[2] < geometry.height:
        return False
    return sum(_is_in_loop(loop, local) for loop in geometry.loops) % 2 == 1


def _is_in_loop(loop, point):
    x, y = point[:2]
    edges = zip(loop, [*loop[1:], loop[0]])
    return sum((a[1] > y) != (b[1] > y) and x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
               for a, b in edges) % 2 == 1


def drawn(plan, point):
    """True where the plan says that there is something, told without any cutting."""
    x, y, z = point
    below = []
    for level, base in zip(plan.levels, plan.bases()):
        up = z - base
        if any(_in_wall(level, wall, x, y, up) for wall in level.walls):
            return True
        if any(_on_step(stairs, x, y, up) for stairs in level.stairs):
            return True
        for floor in level.floors:
            if (0 < up < floor.thickness and _is_in_loop(floor.outline, (x, y))
                    and not any(_is_in_loop(hole, (x, y)) for hole in floor.holes)
                    and not any(_is_in_loop(s.corners(), (x, y)) for s in below)):
                return True
        below = level.stairs
    return False


def _in_wall(level, wall, x, y, up):
    dx, dy = ((b - a) / wall.length for a, b in zip(wall.start, wall.end))
    along = (x - wall.start[0]) * dx + (y - wall.start[1]) * dy
    across = (y - wall.start[1]) * dx - (x - wall.start[0]) * dy
    half = wall.thickness / 2
    if not (-half < along < wall.length + half and abs(across) < half and 0 < up < wall.height):
        return False
    return not any(opening.wall == wall.id and abs(along - opening.along) < opening.width / 2
                   and opening.elevation < up < opening.elevation + opening.height
                   for _, opening in level.openings())


def _on_step(stairs, x, y, up):
    dx, dy = x - stairs.position[0], y - stairs.position[1]
    cos, sin = math.cos(stairs.yaw), math.sin(stairs.yaw)
    across, along = dx * cos + dy * sin, dy * cos - dx * sin + stairs.depth / 2
    if abs(across) >= stairs.width / 2 or not 0 < along < stairs.depth:
        return False
    step = int(along / stairs.depth * stairs.steps)
    return stairs.height * step / stairs.steps < up < stairs.height * (step + 1) / stairs.steps


def oblique():
    """Walls at odd angles, L-shaped and many-cornered floors, turned stairs, a hole in a floor."""
    turn = math.radians(37)
    ground = Level("Level 1", 3.0, [
        Wall(0, (0.0, 0.0), (4.0, 1.3), 0.2, 2.7), Wall(1, (4.0, 1.3), (1.0, 5.0)),
        Wall(2, (1.0, 5.0), (0.0, 0.0), 0.1, 2.0)],
        windows=[Opening(0, 0.7, 0.6, 0.4, wall=0, along=1.0),
                 Opening(1, 0.7, 0.5, 1.4, wall=0, along=1.1)],
        doors=[Opening(0, 0.9, 2.0, wall=1, along=2.2)],
        stairs=[Stairs(0, (1.5, 2.5), turn, 0.8, 2.0, 3.0, 9)],
        floors=[Floor(0, [(0.0, 0.0), (4.0, 1.3), (1.0, 5.0)], thickness=0.05)])
    upper = Level("Level 2", floors=[
        Floor(1, [(-1.0, -1.0), (5.0, -1.0), (5.0, 2.0), (3.0, 2.0), (3.0, 5.0), (-1.0, 5.0)],
              holes=[[(4.0, 0.0), (4.5, 0.0), (4.5, 1.0), (4.0, 1.0)]])])
    return Plan("Oblique", [ground, upper])


def right_angled():
    """Floors and stair holes that are cut into boxes."""
    ground = Level("Level 1", stairs=[
        Stairs(0, (1.0, 2.0), 0.0, 1.0, 3.0), Stairs(1, (3.0, 2.5), math.pi / 2, 0.8, 2.0)])
    upper = Level("Level 2", floors=[Floor(0, [(0.0, 0.0), (5.0, 0.0), (5.0, 2.0), (4.0, 2.0),
                                               (4.0, 4.0), (0.0, 4.0)])])
    return Plan("Right", [ground, upper])


@pytest.mark.parametrize("plan", [two_rooms(), oblique(), right_angled()],
                         ids=lambda plan: plan.name)
def test_every_point_is_solid_exactly_where_the_plan_has_something(plan):
    solids = solids_of(building_model(plan))
    rng = random.Random(7)
    hits = 0
    for _ in range(6000):
        point = (rng.uniform(-1.5, 6.5), rng.uniform(-1.5, 5.5), rng.uniform(-0.2, 5.2))
        solid = drawn(plan, point)
        hits += solid
        assert holds(solids, point) == solid, point
    assert hits > 40


def volume(found):
    total = 0.0
    for part in found.collisions:
        if isinstance(part.geometry, Box):
            total += math.prod(part.geometry.size)
        else:
            mesh = solid_mesh(part.geometry)
            corners = np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]
            a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
            total += float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6
    return total


def raster_volume(low, high, cell, is_solid):
    counts = [round((b - a) / cell) for a, b in zip(low, high)]
    return sum(is_solid(*(a + (n + 0.5) * cell for a, n in zip(low, index)))
               for index in np.ndindex(*counts)) * cell ** 3


def test_a_wall_with_openings_has_the_volume_of_its_raster():
    plan = one_wall(Opening(0, 0.8, 0.8, 0.5, wall=0, along=1.0),
                    Opening(1, 0.6, 0.4, 1.5, wall=0, along=1.2),
                    Opening(2, 0.9, 2.0, 0.0, wall=0, along=3.0), thickness=0.2)
    level = plan.levels[0]
    expected = raster_volume((-0.1, -0.1, 0.0), (4.1, 0.1, 2.5), 0.1,
                             lambda x, y, z: _in_wall(level, level.walls[0], x, y, z))
    assert volume(link(building_model(plan), "Wall_0")) == pytest.approx(expected, rel=1e-9)


def test_a_polygon_floor_with_turned_stairs_has_the_area_that_is_left():
    plan = oblique()
    whole = 6 * 6 - 2 * 3 - 0.5
    model = building_model(plan)
    assert volume(link(model, "Floor_1")) == pytest.approx((whole - 0.8 * 2.0) * 0.1, rel=1e-6)


def test_the_hole_in_a_floor_is_the_footprint_of_the_stairs_and_no_more():
    plan = right_angled()
    floor = link(building_model(plan), "Floor_0")
    assert all(isinstance(part.geometry, Box) for part in floor.collisions)
    assert volume(floor) == pytest.approx((5 * 4 - 1 * 2 - 1.0 * 3.0 - 0.8 * 2.0) * 0.1)


def test_no_part_of_a_wall_overlaps_another():
    rng = random.Random(3)
    for _ in range(50):
        holes = [loop_of((x, y, x + rng.uniform(0.1, 2), y + rng.uniform(0.1, 2)))
                 for x, y in ((rng.uniform(-1, 4), rng.uniform(-1, 2)) for _ in range(5))]
        pieces = rectangles(loop_of((0.0, 0.0, 4.0, 2.5)), holes)
        covered = sum((c - a) * (d - b) for a, b, c, d in pieces)
        points = [(rng.uniform(0, 4), rng.uniform(0, 2.5)) for _ in range(300)]
        for x, y in points:
            times = sum(a < x < c and b < y < d for a, b, c, d in pieces)
            assert times == (not any(_is_in_loop(hole, (x, y)) for hole in holes))
        assert covered <= 10.0 + 1e-9


@pytest.mark.parametrize(("openings", "parts"), [
    ([], 1),
    ([Opening(0, 0.8, 0.8, 0.5, wall=0, along=2.0)], 4),
    ([Opening(0, 0.9, 2.0, 0.0, wall=0, along=2.0)], 3),
    ([Opening(0, 0.9, 2.5, 0.0, wall=0, along=2.0)], 2),
    ([Opening(0, 4.0, 1.0, 0.5, wall=0, along=2.0)], 4),
])
def test_a_wall_is_cut_into_few_boxes(openings, parts):
    assert len(link(building_model(one_wall(*openings)), "Wall_0").collisions) == parts


def test_a_gable_roof_closes_above_the_walls():
    plan = two_rooms()
    plan.roof = Roof("gable", pitch=math.radians(45), overhang=0.3)
    roof = link(building_model(plan), "Roof_0")
    assert roof.pose.position[2] == pytest.approx(5.0)
    half = (4.0 + 0.15) / 2
    slopes = [part for part in roof.collisions if isinstance(part.geometry, Box)]
    assert len(slopes) == 2
    for slope in slopes:
        # The lower face goes through the ridge and through the upper edge of the walls.
        normal = rotate(slope.pose.orientation, (0.0, 0.0, 1.0))
        below = tuple(p - n * 0.05 for p, n in zip(slope.pose.position, normal))
        side = math.copysign(1.0, below[1])
        for point in ((0.0, 0.0, half), (0.0, side * half, 0.0)):
            away = sum(n * (p - q) for n, p, q in zip(normal, point, below))
            assert away == pytest.approx(0.0, abs=1e-5)
    gables = [part for part in roof.collisions if not isinstance(part.geometry, Box)]
    assert holds_local(roof, (3.0, 0.0, 1.0)) and holds_local(roof, (-3.0, 0.0, 1.0))
    assert not holds_local(roof, (0.0, 0.0, 1.0)) and len(gables) == 2


def holds_local(found, point):
    return any(_inside(part, transform(inverse(part.pose), point)) for part in found.collisions)


def test_a_flat_roof_follows_the_outline_of_the_walls():
    corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 2.0), (3.0, 2.0), (3.0, 5.0), (0.0, 5.0)]
    walls = [Wall(n, corners[n], corners[(n + 1) % 6]) for n in range(6)]
    plan = Plan("L", [Level("Level 1", walls=walls)], Roof("flat", 0.2))
    roof = link(building_model(plan), "Roof_0")
    # The outline runs half a wall outside of the middle lines.
    area = 6 * 2 + 3 * 3 + 0.075 * 22 + 4 * 0.075 ** 2
    assert volume(roof) == pytest.approx(area * 0.2, rel=1e-5)
    assert roof.pose.position[2] == pytest.approx(2.5)
