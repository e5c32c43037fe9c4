"""What a building's SDF says: names, poses, materials, layers."""
from __future__ import annotations

import math

import pytest
from building_plans import link, one_wall, two_rooms
from reading import codes, errors

from my_simulations.building.building_plan import Level, Opening, Plan, Stairs, Wall
from my_simulations.building.plan_to_model import building_model
from my_simulations.description.compare import differences
from my_simulations.description.picture_size import picture_size_of
from my_simulations.errors import InputError
from my_simulations.formats.reading import read_entity
from my_simulations.formats.sdf.writer.entities import write_entity
from my_simulations.geometry import compose, rpy_from_quat, transform
from my_simulations.resources.resolver import Resolver


def test_each_item_is_a_link_that_gazebo_would_name_the_same():
    model = building_model(two_rooms())
    assert [found.name for found in model.links] == [
        "Wall_0", "Wall_1", "Wall_2", "Wall_3", "Wall_4", "Stairs_0",
        "Wall_5", "Wall_6", "Wall_7", "Wall_8", "Floor_0"]
    assert (model.name, model.static) == ("Two_rooms", True)
    assert [part.name for part in link(model, "Wall_1").visuals] == ["Wall_1_Visual"]
    assert [part.name for part in link(model, "Wall_1").collisions] == ["Wall_1_Collision"]
    assert [part.name for part in link(model, "Wall_4").visuals] == [
        "Wall_4_Visual_0", "Wall_4_Visual_1", "Wall_4_Visual_2"]
    assert len(link(model, "Stairs_0").collisions) == 15


def test_the_model_stands_at_the_middle_of_the_plan_and_links_relative_to_it():
    model = building_model(two_rooms())
    assert model.pose.position == pytest.approx((3.0, 2.0, 0.0))
    wall = link(model, "Wall_1")
    assert compose(model.pose, wall.pose).position == pytest.approx((6.0, 2.0, 0.0))
    assert rpy_from_quat(wall.pose.orientation)[2] == pytest.approx(math.pi / 2)
    assert link(model, "Wall_5").pose.position[2] == pytest.approx(2.5)


def test_a_plain_wall_is_longer_by_its_thickness_and_stands_on_its_base():
    wall = link(building_model(one_wall()), "Wall_0").visuals[0]
    assert wall.geometry.size == pytest.approx((4.15, 0.15, 2.5))
    assert wall.pose.position == pytest.approx((0.0, 0.0, 1.25))


def test_stairs_start_at_their_foot_and_climb_step_by_step():
    plan = Plan("s", [Level("Level 1", stairs=[
        Stairs(0, (2.0, 1.0), math.pi / 2, 1.0, 3.0, 1.5, 3)])])
    model = building_model(plan)
    stairs = link(model, "Stairs_0")
    world = compose(model.pose, stairs.pose)
    assert world.position == pytest.approx((3.5, 1.0, 0.0))
    steps = [transform(world, part.pose.position) for part in stairs.visuals]
    assert [step[0] for step in steps] == pytest.approx([3.0, 2.0, 1.0])
    assert [step[2] for step in steps] == pytest.approx([0.25, 0.75, 1.25])
    assert {part.geometry.size for part in stairs.visuals} == {(1.0, 1.0, 0.5)}


def test_colours_textures_and_layers_are_written():
    plan = two_rooms()
    plan.levels[0].walls[0].texture = "Gazebo/Bricks"
    model = building_model(plan)
    painted, bricks = link(model, "Wall_4").visuals[0], link(model, "Wall_0").visuals[0]
    assert painted.material.ambient == pytest.approx((194 / 255, 169 / 255, 160 / 255, 1), abs=1e-6)
    assert painted.material.script_name == "Gazebo/Grey"
    assert bricks.material.script_name == "Gazebo/Bricks"
    assert painted.layer == 0 and painted.extra == []
    assert picture_size_of(painted) is None and picture_size_of(bricks) == 1.0
    assert link(model, "Floor_0").visuals[0].layer == 1


def test_a_free_window_is_a_link_and_makes_no_hole():
    plan = one_wall(Opening(3, 0.8, 0.8, 0.5, position=(2.0, 0.0)))
    model = building_model(plan)
    assert len(link(model, "Wall_0").collisions) == 1
    window = link(model, "Window_3")
    assert window.visuals[0].geometry.size == (0.8, 0.17, 0.8)
    assert window.pose.position[2] == pytest.approx(0.5)


def test_what_is_written_reads_back_as_the_same_model():
    model = building_model(two_rooms())
    read, issues = read_entity(write_entity(model), Resolver())
    assert codes(issues) == []
    assert differences(model, read, 1e-9) == []


def faults(plan):
    with pytest.raises(InputError) as caught:
        building_model(plan)
    return caught.value.issues


@pytest.mark.parametrize(("opening", "code"), [
    (Opening(0, 4.5, 1.0, 0.5, wall=0, along=2.0), "opening-wider-than-wall"),
    (Opening(0, 1.0, 1.0, 0.5, wall=0, along=0.4), "opening-outside-wall"),
    (Opening(0, 1.0, 2.5, 0.5, wall=0, along=2.0), "opening-taller-than-wall"),
    (Opening(0, 1.0, 1.0, 0.5, wall=7, along=2.0), "opening-wall-unknown"),
])
def test_an_opening_that_does_not_fit_is_refused_by_name(opening, code):
    issues = faults(one_wall(opening))
    assert errors(issues) == [code]
    assert "Window_0" in issues[0].message and issues[0].xpath == "levels[0].windows"


def test_openings_that_overlap_are_refused_and_those_above_each_other_not():
    first = Opening(0, 1.0, 0.8, 0.2, wall=0, along=1.5)
    assert errors(faults(one_wall(first, Opening(1, 1.0, 0.8, 0.5, wall=0, along=2.0)))) == [
        "openings-overlap"]
    above = one_wall(first, Opening(1, 1.0, 0.8, 1.2, wall=0, along=2.0))
    assert len(link(building_model(above), "Wall_0").collisions) > 4


def test_a_wall_without_length_is_refused():
    plan = one_wall()
    plan.levels[0].walls.append(Wall(1, (1.0, 1.0), (1.0, 1.001)))
    issues = faults(plan)
    assert errors(issues) == ["wall-zero-length"]
    assert issues[0].xpath == "levels[0].walls[1]"


def test_a_floor_that_crosses_itself_is_refused():
    from my_simulations.building.building_plan import Floor

    plan = one_wall()
    plan.levels[0].floors.append(Floor(0, [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]))
    assert errors(faults(plan)) == ["floor-outline"]


def test_walls_that_cross_or_overlap_are_mentioned_and_built():
    from my_simulations.building.plan_check import check_plan

    plan = one_wall()
    plan.levels[0].walls += [Wall(1, (2.0, -1.0), (2.0, 1.0)), Wall(2, (3.0, 0.0), (5.0, 0.0)),
                             Wall(3, (1.0, 0.0), (1.0, 2.0)), Wall(4, (5.0, 0.0), (7.0, 0.0))]
    assert codes(check_plan(plan)) == ["walls-cross", "walls-overlap"]
    assert len(building_model(plan).links) == 5
