"""Buildings as they are made from plans: one goes through doors, not through walls."""
from __future__ import annotations

import math

import pytest
from conftest import Lab, ball, ground

from my_simulations.building.building_plan import Floor, Level, Opening, Plan, Roof, Stairs, Wall
from my_simulations.building.plan_to_model import building_model
from my_simulations.description.shapes import SOLIDS, mesh_key
from my_simulations.formats.mesh.terrain import solid_mesh


def plan() -> Plan:
    """Two rooms with a door between; upstairs a floor of six corners with a stair hole."""
    corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)]
    walls = [Wall(n, corners[n], corners[(n + 1) % 4]) for n in range(4)]
    walls.append(Wall(4, (3.0, 0.0), (3.0, 4.0)))
    below = Level("Level 1", walls=walls, doors=[Opening(0, 0.9, 2.0, wall=4, along=2.0)],
                  stairs=[Stairs(0, (5.0, 2.0), 0.0, 1.0, 3.0)])
    above = Level("Level 2", floors=[Floor(0, [(0.0, 0.0), (6.5, 0.5), (6.0, 4.0), (2.0, 4.0),
                                               (2.0, 2.0), (0.0, 2.0)])])
    return Plan("house", [below, above])


def load(lab: Lab, made: Plan) -> int:
    model = building_model(made)
    meshes = {mesh_key(part.geometry): solid_mesh(part.geometry) for link in model.links
              for part in link.collisions if isinstance(part.geometry, SOLIDS)}
    return lab.load(model, model.pose.position, meshes=meshes)


@pytest.fixture
def house(lab: Lab) -> Lab:
    lab.configure(gravity=(0.0, 0.0, -9.8))
    lab.load(ground(1.0))
    load(lab, plan())
    return lab


def rolled(lab: Lab, start, velocity, seconds: float = 2.0):
    thrown = lab.load(ball(radius=0.2), start)
    lab.push(thrown, velocity)
    lab.seconds(seconds)
    return lab.pose(thrown).position


def test_a_ball_rolls_through_the_door(house: Lab):
    x, y, z = rolled(house, (1.0, 2.0, 0.2), (2.0, 0.0, 0.0))
    assert x > 3.2 and y == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("y", [1.0, 1.5, 3.0])
def test_a_ball_is_stopped_by_the_wall_beside_the_door(house: Lab, y: float):
    x, _, _ = rolled(house, (1.0, y, 0.2), (2.0, 0.0, 0.0))
    assert x <= 3.0 - 0.075 - 0.2 + 0.01


def test_a_ball_thrown_higher_than_the_door_is_stopped_by_the_lintel(house: Lab):
    x, _, _ = rolled(house, (2.0, 2.0, 2.3), (6.0, 0.0, 0.0), 0.3)
    assert x <= 3.0 - 0.075 - 0.2 + 0.01


def test_a_polygon_floor_holds_where_it_is_and_not_beside_it(house: Lab):
    assert rolled(house, (3.5, 3.0, 3.0), (0, 0, 0), 1.5)[2] == pytest.approx(2.8, abs=0.01)
    assert rolled(house, (6.1, 0.8, 3.0), (0, 0, 0), 1.5)[2] == pytest.approx(2.8, abs=0.01)
    assert rolled(house, (1.0, 3.0, 3.0), (0, 0, 0), 1.5)[2] == pytest.approx(0.2, abs=0.01)


def test_one_falls_through_the_stair_hole_onto_the_stairs(house: Lab):
    assert rolled(house, (5.0, 1.5, 3.0), (0, 0, 0), 1.0)[2] < 2.4


def test_roofs_keep_things_out(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, -9.8))
    for n, kind in enumerate(("flat", "gable")):
        made = plan()
        made.levels = made.levels[:1]
        made.roof = Roof(kind, pitch=math.radians(20))
        for wall in made.levels[0].walls:
            wall.start, wall.end = ((x + 20 * n, y) for x, y in (wall.start, wall.end))
        made.levels[0].stairs[0].position = (5.0 + 20 * n, 2.0)
        load(lab, made)
        thrown = lab.load(ball(radius=0.2), (1.0 + 20 * n, 2.0, 4.0))
        lab.seconds(0.8)
        assert lab.pose(thrown).position[2] > 2.5
