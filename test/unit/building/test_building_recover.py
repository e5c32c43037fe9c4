"""Plans read back from the SDF of a building."""
from __future__ import annotations

import math
import os

import pytest
from building_plans import one_wall, two_rooms
from reading import VALID, codes, model_of

from my_simulations.building.building_plan import Opening, Roof
from my_simulations.building.model_to_plan import plan_from_model
from my_simulations.building.plan_to_model import building_model
from my_simulations.description.compare import differences
from my_simulations.errors import InputError
from my_simulations.formats.reading import read_entity, read_file
from my_simulations.formats.sdf.writer.entities import write_entity
from my_simulations.resources.resolver import Resolver


@pytest.fixture(scope="module")
def cottage():
    model, _ = read_file(os.path.join(VALID, "gazebo_building.sdf"), Resolver())
    return plan_from_model(model)


def test_walls_lie_where_the_model_has_them(cottage):
    plan, issues = cottage
    assert issues == []
    plain, cut = plan.levels[0].walls
    assert (plain.id, plain.start, plain.end) == (0, (-2.0, 0.0), (4.0, 0.0))
    assert (plain.thickness, plain.height, plain.texture) == (0.15, 2.5, "Gazebo/Bricks")
    assert cut.id == 3 and cut.color == "#c3a9a0"
    assert cut.start == pytest.approx((1.0, 0.0), abs=1e-4)
    assert cut.end == pytest.approx((1.0, 4.0), abs=1e-4)


def test_openings_are_what_the_boxes_leave_out(cottage):
    plan, _ = cottage
    (door,), (free, window) = plan.levels[0].doors, sorted(
        plan.levels[0].windows, key=lambda found: found.wall is not None)
    assert (door.wall, door.elevation) == (3, 0.0)
    assert (door.along, door.width, door.height) == pytest.approx((1.8917, 0.9, 2.0), abs=2e-3)
    assert window.wall == 3
    assert (window.along, window.width, window.elevation, window.height) == pytest.approx(
        (3.1417, 0.8, 0.5, 0.8), abs=2e-3)
    assert (free.id, free.wall, free.position, free.elevation) == (2, None, (-1.0, 3.0), 0.5)
    assert window.id == 3


def test_stairs_levels_and_floors_are_read(cottage):
    plan, _ = cottage
    stairs = plan.levels[0].stairs[0]
    assert (stairs.position, stairs.yaw, stairs.steps) == ((3.0, 2.0), 0.0, 2)
    assert (stairs.width, stairs.depth, stairs.height) == (1.2, 2.0, 2.0)
    assert [level.height for level in plan.levels] == [2.5, 2.5]
    floor = plan.levels[1].floors[0]
    assert sorted(floor.outline) == [(-2.0, 0.0), (-2.0, 4.0), (4.0, 0.0), (4.0, 4.0)]
    assert floor.holes == [] and floor.thickness == 0.1


def test_what_is_read_back_makes_the_same_building():
    model = building_model(two_rooms())
    read, _ = read_entity(write_entity(model), Resolver())
    plan, issues = plan_from_model(read)
    assert issues == []
    assert differences(building_model(plan), model, 2e-5) == []


def test_openings_beside_and_above_each_other_are_told_apart():
    plan = one_wall(Opening(0, 0.8, 0.5, 0.5, wall=0, along=1.0),
                    Opening(1, 0.8, 0.5, 1.5, wall=0, along=1.0),
                    Opening(2, 0.6, 0.5, 0.5, wall=0, along=3.5))
    back, _ = plan_from_model(building_model(plan))
    found = sorted((o.along, o.elevation, o.width, o.height) for o in back.levels[0].windows)
    assert found == [(1.0, 0.5, 0.8, 0.5), (1.0, 1.5, 0.8, 0.5), (3.5, 0.5, 0.6, 0.5)]


def test_levels_without_layers_are_told_by_their_height():
    model = building_model(two_rooms())
    for link in model.links:
        for visual in link.visuals:
            visual.layer = None
    plan, _ = plan_from_model(model)
    assert [len(level.walls) for level in plan.levels] == [5, 4]
    assert len(plan.levels[1].floors) == 1 and len(plan.levels[0].stairs) == 1


def test_turned_stairs_keep_their_direction():
    plan = two_rooms()
    plan.levels[0].stairs[0].yaw = math.pi / 2
    back, _ = plan_from_model(building_model(plan))
    assert back.levels[0].stairs[0].yaw == pytest.approx(math.pi / 2, abs=1e-5)
    assert back.levels[0].stairs[0].position == pytest.approx((4.5, 2.0))


def test_what_is_no_part_of_a_building_is_mentioned():
    plan = two_rooms()
    plan.roof = Roof()
    model = building_model(plan)
    _, issues = plan_from_model(model)
    assert codes(issues) == ["building-link-left-out"] and "Roof_0" in issues[0].message


def test_a_model_that_is_no_building_is_refused():
    model, _ = model_of('<link name="l"/>')
    with pytest.raises(InputError) as caught:
        plan_from_model(model)
    assert codes(caught.value.issues) == ["building-unknown"]


def test_a_free_opening_without_a_layer_belongs_to_the_level_below_it():
    plan = two_rooms()
    plan.levels[0].windows.append(Opening(7, 0.8, 0.8, elevation=0.5, position=(1.0, 9.0)))
    model = building_model(plan)
    for link in model.links:
        for visual in link.visuals:
            visual.layer = None
    read, _ = plan_from_model(model)
    layered, _ = plan_from_model(building_model(plan))
    assert [(level.height, len(level.walls)) for level in read.levels] == [
        (level.height, len(level.walls)) for level in layered.levels]
    (free,) = [window for window in read.levels[0].windows if window.wall is None]
    assert (free.position, free.elevation) == ((1.0, 9.0), 0.5)
