"""What Python does for a command does not grow with the bodies that are there."""
from __future__ import annotations

import pybullet
import pytest
from conftest import Lab, ball, box, ground
from work_count import lines_run

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import Box, Collision
from my_simulations.engine.commands import LoadModel, RemoveModel
from my_simulations.engine.timed_forces import FOREVER, AddTimedForces, TimedWrench
from my_simulations.geometry import Pose

FEW, MANY = 20, 220


@pytest.mark.parametrize("make", [box, ball])
def test_a_body_that_comes_or_goes_costs_no_look_at_the_others(lab, make):
    lab.load(ground(1.0))
    lab.steps(1)
    came, gone, numbers = {}, {}, []
    for n in range(MANY):
        numbers.append(n + 2)
        load = LoadModel(n + 2, make(f"b{n}"), Pose((3.0 * n, 0.0, 0.5)), n + 1, 0, {})
        came[n + 1] = lines_run(lambda load=load: lab.apply(load))
        lab.backend.read()
    while numbers:
        model = numbers.pop(len(numbers) // 2)
        gone[len(numbers) + 1] = lines_run(lambda model=model: lab.apply(RemoveModel(model)))
    assert abs(came[MANY] - came[FEW]) < 20 and came[FEW] > 500
    assert abs(gone[MANY] - gone[FEW]) < 20 and gone[FEW] > 100


def test_a_body_that_is_read_out_after_a_command_is_the_only_one(lab):
    lab.load(ground(1.0))
    read = {}
    for n in range(MANY):
        lab.apply(LoadModel(n + 2, box(f"b{n}"), Pose((3.0 * n, 0.0, 0.5)), n + 1, 0, {}))
        read[n + 1] = lines_run(lab.backend.read)
    assert read[MANY] - read[FEW] < 20


def _loading(lab, model):
    links = len(model.links)
    return lines_run(lambda: lab.apply(LoadModel(1, model, Pose(), 0, 0, {}))) / links


@pytest.mark.parametrize("shapes", [0, 1])
def test_a_link_without_collisions_costs_no_look_at_the_others_of_its_model(lab, shapes):
    def model(count):
        solid = [Collision("c", Box((0.1, 0.1, 0.1)))] * shapes
        return Model("m", links=[Link(f"l{n}", Pose((0.2 * n, 0, 1)), collisions=solid)
                                 if n < 2 else Link(f"l{n}") for n in range(count)])

    few = _loading(lab, model(FEW))
    lab.apply(RemoveModel(1))
    assert _loading(lab, model(MANY)) < 1.1 * few


def test_a_static_link_of_many_shapes_costs_as_much_a_shape_as_one_of_few(lab):
    def load(count):
        link = Link("link", collisions=[Collision(f"c{n}", Box((0.1, 0.1, 0.1)), Pose((n, 0, 0)))
                                        for n in range(count)])
        return _loading(lab, Model("m", static=True, links=[link])) / count

    few = load(100)
    lab.apply(RemoveModel(1))
    assert load(1000) < 1.1 * few


def test_links_without_collisions_meet_nothing(lab, monkeypatch):
    # Bullet keeps a pair for any two bodies at one place whose filters let them meet.
    filters = []
    monkeypatch.setattr(pybullet, "setCollisionFilterGroupMask",
                        lambda uid, index, group, mask: filters.append((group, mask)))
    lab.load(Model("m", links=[Link(f"l{n}") for n in range(4)]))
    assert filters == [(0, 0)] * 4


def test_links_without_collisions_at_one_place_are_apart_in_bullets_tree(lab):
    # The tree sorts bounding boxes by their centers; equal centers make it a list.
    lab.load(Model("m", links=[Link(f"l{n}") for n in range(500)]))
    lab.steps(3)
    bounds = [pybullet.getAABB(pybullet.getBodyUniqueId(n), -1)
              for n in range(pybullet.getNumBodies())]
    centers = {tuple(round(a + b, 3) for a, b in zip(low, high)) for low, high in bounds}
    assert len(centers) == len(bounds) == 500
    assert all(low[i] > high[i] + 1000.0 for low, high in bounds for i in range(3))
    assert not pybullet.getOverlappingObjects((-200.0,) * 3, (200.0,) * 3)


def test_a_link_without_collisions_falls_and_turns_by_its_own_inertia(lab):
    model = lab.load(Model("m", links=[Link("link", inertial=Inertial(2.0, ixx=0.1, iyy=0.2,
                                                                      izz=0.3))]), (0, 0, 9))
    lab.apply(AddTimedForces((TimedWrench(1, lab.rows[model, "link"], lab.step, FOREVER,
                                          force=(1.0, 0, 0), torque=(0, 0, 0.06)),)))
    lab.steps(1000)
    assert lab.pose(model).position == pytest.approx((0.25, 0.0, 9.0 - 4.9), abs=0.01)
    assert lab.twist(model).angular == pytest.approx((0.0, 0.0, 0.2), abs=1e-3)


def _lines_of_a_fall(step_size: float) -> int:
    """How many lines half a second of 27 balls takes that fall on each other."""
    lab = Lab()
    lab.backend.read()
    lab.configure(step_size=step_size)
    lab.load(ground(1.0))
    for n in range(27):
        lab.load(ball(f"b{n}", 0.1), (0.25 * (n % 3), 0.25 * (n // 3 % 3) + 0.02 * (n // 9),
                                      0.3 + 0.3 * (n // 9)))
    lines = lines_run(lambda: lab.seconds(0.5))
    lab.backend.close()
    return lines


def test_larger_steps_take_hardly_more_lines_for_the_same_time():
    """Bullet's share falls with the number of steps; what looks ahead must not look farther."""
    usual = _lines_of_a_fall(0.001)
    assert _lines_of_a_fall(0.005) < 1.5 * usual
    assert _lines_of_a_fall(0.01) < 2.0 * usual
