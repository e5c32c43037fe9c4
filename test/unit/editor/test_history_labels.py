"""What the undo history says."""
import pytest

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Box, Collision, Visual
from my_simulations.editor.editing.history_labels import (
    apply_wrench,
    join_names,
    set_joint,
    set_property,
)


@pytest.mark.parametrize("target, path, value, label", [
    ("unit_box::link::collision:collision", "surface.mu", 0.5,
     "Set friction of unit_box::link::collision to 0.5"),
    ("unit_box::link::visual:visual", "material.diffuse", [1, 0, 0, 1],
     "Set material diffuse of unit_box::link::visual"),
    ("unit_box", "static", True, "Set static of unit_box to true"),
    ("box::link", "inertial.mass", 2, "Set mass of box::link to 2"),
    ("arm::hinge", "axis2.lower", -1.5, "Set axis2 lower of arm::hinge to -1.5"),
    ("sun", "type", "spot", "Set type of sun to 'spot'"),
    ("", "gravity", [0, 0, -1.6], "Set gravity"),
    ("", "physics.max_step_size", 0.002, "Set max step size to 0.002"),
    ("", "scene.fog.color", [1, 1, 1, 1], "Set fog color"),
    ("", "gui_camera", None, "Set GUI camera"),
    ("box", "plugin", "x" * 100, "Set plugin of box")])
def test_a_changed_property_is_named_with_its_value(target, path, value, label):
    assert set_property(target, path, value) == label


@pytest.mark.parametrize("target, label", [
    ("unit_box::link::collision:collision", "Set friction of unit_box to 0.5"),
    ("unit_box::link::visual:visual", "Set friction of unit_box to 0.5"),
    ("unit_box::link", "Set friction of unit_box to 0.5"),
    ("unit_box", "Set friction of unit_box to 0.5")])
def test_a_model_of_one_link_goes_by_its_name(target, label):
    collision, visual = Collision("collision", Box()), Visual("visual", Box())
    model = Model("unit_box", links=[Link("link", collisions=[collision], visuals=[visual])])
    assert set_property(target, "surface.mu", 0.5, model) == label


def test_what_has_several_parts_is_named_in_full():
    model = Model("box", links=[Link("link", collisions=[Collision("a", Box()),
                                                         Collision("b", Box())])])
    assert set_property("box::link::collision:a", "surface.mu", 1, model) == \
        "Set friction of box::link::a to 1"
    robot = Model("box", links=[Link("link"), Link("wheel")])
    assert set_property("box::wheel", "gravity", True, robot) == "Set gravity of box::wheel to true"


@pytest.mark.parametrize("kind, mode, value, label", [
    ("revolute", "velocity", 2, "Set velocity target of arm::hinge: 2 rad/s"),
    ("revolute", "position", 1.5, "Set position target of arm::hinge: 1.5 rad"),
    ("continuous", "force", 0, "Set effort of arm::hinge: 0 N m"),
    ("prismatic", "velocity", -0.25, "Set velocity target of arm::hinge: -0.25 m/s"),
    ("prismatic", "position", 1, "Set position target of arm::hinge: 1 m"),
    ("prismatic", "force", 3, "Set effort of arm::hinge: 3 N")])
def test_a_joint_target_is_told_with_its_unit(kind, mode, value, label):
    assert set_joint("arm::hinge", kind, mode, value) == label


@pytest.mark.parametrize("force, torque, label", [
    ((1, 0, 0), (0, 0, 0), "Apply force to box::link"),
    ((0, 0, 0), (0, 0, 1), "Apply torque to box::link"),
    ((1, 0, 0), (0, 0, 1), "Apply force and torque to box::link"),
    ((0, 0, 0), (0, 0, 0), "Apply force to box::link")])
def test_a_wrench_is_told_by_what_acts(force, torque, label):
    assert apply_wrench("box::link", force, torque) == label


def test_many_names_are_cut_short():
    assert join_names(["a", "b"]) == "a, b"
    assert join_names(["a", "b", "c", "d", "e"]) == "a, b, c and 2 more"
