"""Robots: links, joints, order, what is dropped."""
import math

import pytest
from reading import (
    URDF_INERTIAL,
    VALID,
    codes,
    errors,
    robot_joint,
    robot_link,
    robot_of,
    warnings,
)

from my_simulations.description.model import INFINITE, JointAxis
from my_simulations.description.shapes import Box, Cylinder, Mesh, Sphere
from my_simulations.errors import Severity
from my_simulations.formats.reading import read_entity
from my_simulations.geometry import quat_from_rpy
from my_simulations.resources.resolver import Resolver

AB = robot_link("a") + robot_link("b")


def joint_of(kind, inside="", **options):
    model, issues = robot_of(AB + robot_joint("j", "a", "b", kind, inside, **options))
    return model.joints[0] if model.joints else None, issues


def test_a_box_is_read():
    model, issues = robot_of(robot_link(
        "body", '<inertial><origin xyz="0 0 0.1" rpy="0 0 0.5"/><mass value="2"/><inertia ixx="1"'
        ' ixy="0.1" ixz="0.2" iyy="2" iyz="0.3" izz="2.5"/></inertial>'
        '<visual><geometry><box size="1 2 3"/></geometry></visual>'
        '<collision><origin xyz="0 0 1" rpy="0 0 0"/><geometry><box size="1 2 3"/></geometry>'
        "</collision>"))
    assert issues == []
    (link,) = model.links
    inertial = link.inertial
    assert (inertial.mass, inertial.pose.position) == (2, (0, 0, 0.1))
    assert inertial.pose.orientation == quat_from_rpy(0, 0, 0.5)
    assert (inertial.ixx, inertial.ixy, inertial.ixz) == (1, 0.1, 0.2)
    assert (inertial.iyy, inertial.iyz, inertial.izz) == (2, 0.3, 2.5)
    assert link.collisions[0].geometry == link.visuals[0].geometry == Box((1, 2, 3))
    assert link.collisions[0].pose.position == (0, 0, 1)
    assert (model.name, model.static, model.pose.position) == ("r", False, (0, 0, 0))


def test_every_shape_is_read():
    shapes = ('<sphere radius="2"/>', '<cylinder radius="1" length="3"/>',
              '<mesh filename="package://p/cube.stl" scale="1 2 3"/>',
              f'<mesh filename="file://{VALID}/cube.stl"/>')
    inside = "".join(f"<collision><geometry>{s}</geometry></collision>" for s in shapes)
    model, issues = robot_of(robot_link("l", URDF_INERTIAL + inside),
                             Resolver(find_package={"p": VALID}.get))
    assert issues == []
    path = f"{VALID}/cube.stl"
    assert [c.geometry for c in model.links[0].collisions] == [
        Sphere(2), Cylinder(1, 3), Mesh("package://p/cube.stl", path, (1, 2, 3)),
        Mesh(f"file://{path}", path)]


def test_collisions_and_visuals_are_named_after_the_link_or_their_own_name():
    one = '<{0}{1}><geometry><box size="1 1 1"/></geometry></{0}>'
    inside = (one.format("collision", "") + one.format("collision", ' name="foot"')
              + one.format("collision", "") + one.format("visual", "") * 2)
    model, _ = robot_of(robot_link("leg", URDF_INERTIAL + inside))
    link = model.links[0]
    assert [c.name for c in link.collisions] == [
        "leg_collision", "leg_fixed_joint_lump__foot_collision_1", "leg_collision_2"]
    assert [v.name for v in link.visuals] == ["leg_visual", "leg_visual_1"]


def test_colours_are_found_by_name_wherever_they_are_defined():
    visual = '<visual><geometry><box size="1 1 1"/></geometry><material name="{}"{}</visual>'
    model, issues = robot_of(
        robot_link("l", URDF_INERTIAL + visual.format("red", "/>")
                   + visual.format("own", '><color rgba="0 0 1 .5"/></material>')
                   + visual.format("photo", '><texture filename="package://p/a.png"/></material>')
                   + visual.format("gone", "/>"))
        + '<material name="red"><color rgba="1 0 0 1"/></material>')
    materials = [v.material for v in model.links[0].visuals]
    assert materials[0].diffuse == (1, 0, 0, 1)
    assert materials[1].diffuse == (0, 0, 1, 0.5)
    assert materials[2].texture == "package://p/a.png"
    assert materials[3].diffuse is None
    assert warnings(issues) == ["image-not-found", "material-unknown"]


def test_a_hinge_is_read():
    joint, issues = joint_of(
        "revolute", '<axis xyz="0 3 4"/><limit lower="-1" upper="2" effort="3" velocity="4"/>'
        '<dynamics damping="5" friction="6"/>', xyz="1 0 0", rpy="0 0 1")
    assert issues == []
    assert joint.axis == JointAxis((0, 0.6000000000000001, 0.8), -1, 2, 3, 4, 5, 6)
    assert (joint.type, joint.parent, joint.child) == ("revolute", "a", "b")
    # The joint frame is the child's link frame.
    assert joint.pose.position == (0, 0, 0)


def test_the_axis_is_x_and_the_bounds_are_0_where_they_are_not_given():
    joint, _ = joint_of("prismatic", '<limit effort="3" velocity="4"/>')
    assert joint.axis == JointAxis((1, 0, 0), 0, 0, 3, 4)


def test_reversed_limits_are_exchanged_with_a_warning():
    joint, issues = joint_of("revolute", '<limit lower="2" upper="-1" effort="1" velocity="1"/>')
    assert (joint.axis.lower, joint.axis.upper) == (-1, 2)
    assert codes(issues) == ["joint-limits-reversed"] and not errors(issues)


def test_a_continuous_joint_has_no_bounds():
    joint, issues = joint_of("continuous", '<limit effort="3" velocity="4"/>')
    assert (joint.type, joint.axis.lower, joint.axis.upper) == ("revolute", -INFINITE, INFINITE)
    assert (joint.axis.effort, joint.axis.velocity) == (3, 4) and issues == []


def test_a_mimic_of_no_joint_is_a_warning():
    joint, issues = joint_of("continuous", '<mimic joint="other"/>')
    assert joint.axis.mimic.joint == "other" and codes(issues) == ["mimic-joint-unknown"]


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_floating_and_planar_joints_hold_nothing(kind):
    model, issues = robot_of(AB + robot_joint("j", "a", "b", kind))
    assert [link.name for link in model.links] == ["a", "b"] and model.joints == []
    assert codes(issues) == ["joint-unsupported"] and not errors(issues)


def test_link_poses_are_in_the_model_frame():
    model, _ = robot_of(
        robot_link("a") + robot_link("b") + robot_link("c")
        + robot_joint("ab", "a", "b", "continuous", xyz="1 0 0", rpy=f"0 0 {math.pi / 2}")
        + robot_joint("bc", "b", "c", "continuous", xyz="1 0 0"))
    at = {link.name: link.pose.position for link in model.links}
    assert at["b"] == (1, 0, 0)
    assert at["c"] == pytest.approx((1, 1, 0))


def test_links_come_depth_first_with_siblings_by_joint_name():
    model, _ = robot_of(
        "".join(map(robot_link, "dcbae"))
        + robot_joint("z", "e", "a", "continuous") + robot_joint("m", "e", "b", "continuous")
        + robot_joint("y", "b", "c", "continuous") + robot_joint("x", "b", "d", "continuous"))
    assert [link.name for link in model.links] == ["e", "b", "d", "c", "a"]
    assert [joint.name for joint in model.joints] == ["m", "x", "y", "z"]


def test_the_origin_of_a_robot_is_the_models_pose():
    model, issues = robot_of(robot_link("a") + '<origin xyz="1 2 3" rpy="0 0 1"/>')
    assert issues == []
    assert model.pose.position == (1, 2, 3)
    assert model.pose.orientation == quat_from_rpy(0, 0, 1)


def test_a_link_without_mass_is_left_out_with_all_below_it():
    model, issues = robot_of(
        robot_link("a") + robot_link("b", "") + robot_link("c") + robot_link("d")
        + robot_joint("ab", "a", "b", "continuous") + robot_joint("bc", "b", "c", "continuous")
        + robot_joint("cd", "c", "d"))
    assert [link.name for link in model.links] == ["a"] and model.joints == []
    assert codes(issues) == ["link-massless"]
    assert "2 links below" in issues[0].message and not errors(issues)


def test_a_link_without_mass_stays_in_a_static_model():
    model, issues = robot_of(
        robot_link("a", "") + "<gazebo><static>true</static></gazebo>")
    assert [link.name for link in model.links] == ["a"] and issues == []


def test_a_static_robot_may_have_zero_inertia_and_flat_boxes():
    zero = ('<inertial><mass value="1"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'
            "</inertial>")
    flat = '<collision><geometry><box size="1 1 0"/></geometry></collision>'
    model, issues = robot_of(robot_link("a", zero + flat)
                             + "<gazebo><static>1</static></gazebo>")
    assert model.static and model.links[0].collisions == []
    assert [(i.code, i.severity) for i in issues] == [("bad-shape", Severity.WARNING)]


ZERO = ('<inertial><mass value="{}"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'
        "</inertial>")


def test_a_placeholder_box_of_no_size_is_dropped_with_a_warning():
    model, issues = robot_of(robot_link(
        "a", URDF_INERTIAL + '<collision><geometry><box size="0 0 0"/></geometry></collision>'))
    assert model.links[0].collisions == []
    assert [(i.code, i.severity) for i in issues] == [("bad-shape", Severity.WARNING)]


@pytest.mark.parametrize("shape, tensor", [
    ('<box size="1 2 3"/>', (13.0, 10.0, 5.0)),
    ('<sphere radius="0.5"/>', (1.2, 1.2, 1.2)),
    ('<cylinder radius="1" length="2"/>', (7.0, 7.0, 6.0)),
])
def test_an_inertia_of_zeros_becomes_that_of_the_shapes_with_a_warning(shape, tensor):
    model, issues = robot_of(robot_link(
        "a", ZERO.format(12) + f"<collision><geometry>{shape}</geometry></collision>"))
    inertial = model.links[0].inertial
    assert inertial.mass == 12
    assert (inertial.ixx, inertial.iyy, inertial.izz) == pytest.approx(tensor)
    assert [(i.code, i.severity) for i in issues] == [("inertia-zero", Severity.WARNING)]


def test_shapes_share_the_mass_by_their_volume():
    collision = ('<collision><origin xyz="{} 0 0"/><geometry><box size="1 1 1"/></geometry>'
                 "</collision>")
    model, _ = robot_of(robot_link(
        "a", ZERO.format(2) + collision.format(-1) + collision.format(1)))
    inertial = model.links[0].inertial
    assert inertial.ixx == pytest.approx(2 / 6)
    assert inertial.iyy == pytest.approx(2 / 6 + 2)


def test_a_root_called_world_is_the_world():
    model, issues = robot_of(
        '<link name="world"/>' + AB + robot_joint("wa", "world", "a", xyz="1 0 0")
        + robot_joint("wb", "world", "b", "continuous", xyz="0 1 0"))
    assert issues == []
    assert [link.name for link in model.links] == ["a", "b"]
    assert [(j.name, j.type, j.parent, j.child) for j in model.joints] == [
        ("wa", "fixed", "world", "a"), ("wb", "revolute", "world", "b")]
    assert model.links[0].pose.position == (1, 0, 0)


def test_a_robot_of_nothing_but_the_world_is_a_model_without_links():
    model, issues = robot_of('<link name="world"/>')
    assert (model.name, model.links, issues) == ("r", [], [])


def test_a_static_attribute_of_the_robot_means_nothing():
    model, issues = read_entity(f'<robot name="r" static="true">{robot_link("a")}</robot>',
                                Resolver())
    assert not model.static and issues == []


def test_a_missing_visual_mesh_is_a_warning():
    model, issues = robot_of(robot_link(
        "a", URDF_INERTIAL + '<visual><geometry><mesh filename="package://gone/a.dae"/></geometry>'
        "</visual>"))
    assert [(i.code, i.severity) for i in issues] == [("mesh-not-found", Severity.WARNING)]
    assert model.links[0].visuals[0].geometry == Mesh("package://gone/a.dae")


def test_a_name_may_be_missing_where_the_request_brings_one():
    model, issues = read_entity(f"<robot>{robot_link('a')}</robot>", Resolver())
    assert model.name == "unnamed" and codes(issues) == ["name-missing"]


def test_text_of_a_chain_as_long_as_a_program_stack_is_read():
    count = 2000
    model, issues = robot_of(
        "".join(robot_link(f"l{n}") for n in range(count))
        + "".join(robot_joint(f"j{n}", f"l{n}", f"l{n + 1}", "fixed") for n in range(count - 1)))
    assert len(model.links) == 1 and issues == []
    assert model.links[0].inertial.mass == pytest.approx(count)
