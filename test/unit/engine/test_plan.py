"""Which bodies a model becomes."""
from __future__ import annotations

from dataclasses import replace

import pytest

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.engine.body_plan import BASE, BodyPlanError, open_joints, plan_bodies
from my_simulations.geometry import Pose


def model(names: str, *joints: str, static: bool = False, kind: str = "revolute") -> Model:
    """`model("abc", "a>b", "world>c")`: joints parent>child."""
    made = []
    for text in joints:
        parent, child = text.split(">")
        made.append(Joint(text, kind, parent, child, axis=JointAxis()))
    return Model("m", static=static, joints=made,
                 links=[Link(name, Pose((float(n), 0, 0))) for n, name in enumerate(names)])


def shape(planned):
    return [([link.index for link in body.links], body.fixed_base) for body in planned]


def kinematic(made: Model, *names: str) -> Model:
    return replace(made, links=[replace(link, kinematic=link.name in names)
                                for link in made.links])


@pytest.mark.parametrize("made, bodies", [
    (model("abc", "c>a", "c>b"), [([2, 0, 1], False)]),
    (model("abcd", "a>b", "c>d"), [([0, 1], False), ([2, 3], False)]),
    (model("ab", "a>b", static=True), [([0], False), ([1], False)]),
    (model("ab", "a>b", kind="gearbox"), [([0], False), ([1], False)]),
    (model("abc", "a>b", "b>c", "c>a"), [([0, 1, 2], False)]),
    (kinematic(model("ab"), "a"), [([0], False), ([1], False)]),
], ids=["a tree begins at the link that no joint has as child", "separate trees", "a static model",
        "joint types that connect nothing", "a ring begins at the first link",
        "a kinematic link without joints"])
def test_links_become_bodies(made, bodies):
    assert shape(plan_bodies(made)) == bodies


def test_links_without_joints_are_rigid_bodies():
    bodies = plan_bodies(model("abc"))
    assert shape(bodies) == [([0], False), ([1], False), ([2], False)]
    assert all(body.is_rigid for body in bodies)


def test_a_joint_to_the_world_makes_a_fixed_base():
    bodies = plan_bodies(model("ab", "world>a", "a>b"))
    assert shape(bodies) == [([0, 1], True)]
    assert bodies[0].links[0].parent == BASE and bodies[0].links[1].parent == 0


def test_a_loop_is_cut_and_the_open_joint_named():
    looped = model("abc", "a>b", "b>c", "a>c")
    bodies = plan_bodies(looped)
    assert shape(bodies) == [([0, 1, 2], False)]
    assert [joint.name for joint in open_joints(looped, bodies)] == ["b>c"]


def test_a_child_with_two_parents_hangs_the_second_parent_on_the_reversed_joint():
    planned = plan_bodies(model("abc", "a>c", "b>c"))
    assert shape(planned) == [([0, 2, 1], False)]
    assert planned[0].links[1].axis == (0.0, 0.0, 1.0)
    assert planned[0].links[2].axis == (-0.0, -0.0, -1.0)


@pytest.mark.parametrize("text", ["nobody>a", "a>nobody"])
def test_a_joint_to_a_missing_link_is_an_error_that_names_it(text):
    with pytest.raises(BodyPlanError, match="nobody"):
        plan_bodies(model("a", text))


def test_a_kinematic_link_with_joints_is_fixed_and_carries_its_tree():
    bodies = plan_bodies(kinematic(model("abc", "b>a", "a>c"), "a"))
    assert shape(bodies) == [([0, 1, 2], True)]
    assert bodies[0].links[0].joint is None and bodies[0].links[0].parent == BASE


def test_kinematic_links_that_are_connected_are_fixed_to_one_base():
    made = kinematic(model("abc", "a>b", "b>c"), "a", "c")
    bodies = plan_bodies(made)
    assert shape(bodies) == [([0, 1, 2], True)]
    assert [link.parent for link in bodies[0].links] == [BASE, 0, BASE]
    assert [joint.name for joint in open_joints(made, bodies)] == ["b>c"]


def test_a_kinematic_link_that_a_tree_of_the_world_reaches_is_fixed_to_its_base():
    made = kinematic(model("abc", "world>a", "a>b", "b>c"), "b")
    bodies = plan_bodies(made)
    assert shape(bodies) == [([0, 1, 2], True)]
    assert [joint.name for joint in open_joints(made, bodies)] == ["a>b"]


def test_a_joint_between_kinematic_links_or_to_the_world_connects_nothing():
    made = kinematic(model("ab", "world>a", "a>b"), "a", "b")
    bodies = plan_bodies(made)
    assert shape(bodies) == [([0], False), ([1], False)]
    assert open_joints(made, bodies) == []
