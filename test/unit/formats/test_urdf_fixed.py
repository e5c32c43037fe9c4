"""Fixed joints: the child becomes part of the parent, mass and all."""
import math
import random

import pytest
from reading import URDF_INERTIAL, codes, errors, robot_joint, robot_link, robot_of

from my_simulations.description.model import Inertial
from my_simulations.formats.inertia import combine_inertia
from my_simulations.geometry import Pose, add, quat_from_rpy, rotate, scale

BOX = '<geometry><box size="1 1 1"/></geometry>'
SHAPES = f"<collision>{BOX}</collision><visual>{BOX}</visual>"


def test_three_chained_fixed_links_are_one_with_the_summed_mass():
    model, issues = robot_of(
        "".join(robot_link(n, URDF_INERTIAL + SHAPES) for n in "abcd")
        + robot_joint("ab", "a", "b", xyz="0 0 1") + robot_joint("bc", "b", "c", xyz="0 0 1")
        + robot_joint("cd", "c", "d", xyz="0 0 1"))
    assert issues == []
    (link,) = model.links
    assert (link.name, model.joints) == ("a", [])
    assert link.inertial.mass == pytest.approx(4)
    assert link.inertial.pose.position == pytest.approx((0, 0, 1.5))
    # Four points of 1 kg at -1.5, -0.5, 0.5, 1.5 m, and the 0.1 of each.
    assert link.inertial.ixx == pytest.approx(0.4 + 5.0)
    assert link.inertial.izz == pytest.approx(0.4)
    assert [c.pose.position[2] for c in link.collisions] == [0, 1, 2, 3]


def test_lumped_parts_are_named_after_both_links():
    model, _ = robot_of(
        "".join(robot_link(n, URDF_INERTIAL + SHAPES) for n in "abc")
        + robot_joint("ab", "a", "b") + robot_joint("bc", "b", "c"))
    assert [c.name for c in model.links[0].collisions] == [
        "a_collision", "a_fixed_joint_lump__b_collision_1", "a_fixed_joint_lump__c_collision_2"]
    assert [v.name for v in model.links[0].visuals] == [
        "a_visual", "a_fixed_joint_lump__b_visual_1", "a_fixed_joint_lump__c_visual_2"]


def test_a_massless_root_takes_the_mass_of_what_is_fixed_to_it():
    model, issues = robot_of(
        robot_link("base_footprint", "") + robot_link("base_link", URDF_INERTIAL + SHAPES)
        + robot_joint("j", "base_footprint", "base_link", xyz="0 0 0.3"))
    assert issues == []
    (link,) = model.links
    assert (link.name, link.inertial.mass) == ("base_footprint", 1)
    assert link.inertial.pose.position == (0, 0, 0.3)
    assert link.collisions[0].name == "base_footprint_fixed_joint_lump__base_link_collision"


def test_joints_of_a_lumped_link_move_to_the_link_it_is_part_of():
    model, issues = robot_of(
        "".join(map(robot_link, "abc")) + robot_joint("ab", "a", "b", xyz="1 0 0")
        + robot_joint("bc", "b", "c", "continuous", xyz="0 1 0"))
    assert issues == []
    assert [link.name for link in model.links] == ["a", "c"]
    assert (model.joints[0].parent, model.joints[0].child) == ("a", "c")
    assert model.links[1].pose.position == (1, 1, 0)


def test_order_is_that_of_the_tree_before_lumping():
    model, _ = robot_of(
        "".join(map(robot_link, "abcd")) + robot_joint("m", "a", "b")
        + robot_joint("x", "b", "c", "continuous") + robot_joint("k", "a", "d", "continuous"))
    assert [link.name for link in model.links] == ["a", "d", "c"]


def keep(tag, value="true"):
    return f'<gazebo reference="j"><{tag}>{value}</{tag}></gazebo>'


def test_preserve_fixed_joint_keeps_a_fixed_joint():
    for word in ("true", "1", "Yes"):
        model, issues = robot_of(robot_link("a") + robot_link("b") + robot_joint("j", "a", "b")
                                 + keep("preserveFixedJoint", word))
        assert [(j.name, j.type, j.axis) for j in model.joints] == [("j", "fixed", None)]
        assert len(model.links) == 2 and issues == []


def test_disable_fixed_joint_lumping_makes_a_locked_hinge():
    model, _ = robot_of(robot_link("a") + robot_link("b") + robot_joint("j", "a", "b")
                        + keep("disableFixedJointLumping"))
    (joint,) = model.joints
    assert (joint.type, joint.axis.lower, joint.axis.upper) == ("revolute", 0, 0)


def test_preserve_wins_over_disable_and_false_keeps_nothing():
    both = keep("disableFixedJointLumping") + keep("preserveFixedJoint")
    model, _ = robot_of(robot_link("a") + robot_link("b") + robot_joint("j", "a", "b") + both)
    assert model.joints[0].type == "fixed"
    model, _ = robot_of(robot_link("a") + robot_link("b") + robot_joint("j", "a", "b")
                        + keep("preserveFixedJoint", "false"))
    assert model.joints == []


def test_the_places_of_lumped_links_are_kept_as_frames():
    model, _ = robot_of(robot_link("a") + robot_link("b")
                        + robot_joint("j", "a", "b", xyz="0 0 2"))
    assert model.extra == [
        '<frame name="j" attached_to="a"><pose>0 0 2 0 0 0</pose></frame>',
        '<frame name="b" attached_to="j"/>']


def test_a_sensor_of_a_lumped_link_moves_along_with_its_pose():
    model, issues = robot_of(
        robot_link("a") + robot_link("b") + robot_joint("j", "a", "b", xyz="0 0 2")
        + '<gazebo reference="b"><sensor name="s" type="ray"><pose>1 0 0 0 0 0</pose></sensor>'
        "</gazebo>")
    assert codes(issues) == []
    assert model.links[0].extra == [
        '<sensor name="s" type="ray"><pose>1 0 2 0 0 0</pose></sensor>']


def test_the_frame_of_a_sensors_plugin_stays_and_that_of_the_models_moves():
    plugin = '<plugin name="p" filename="p.so"><frameName>b</frameName></plugin>'
    model, issues = robot_of(
        robot_link("a") + robot_link("b") + robot_joint("j", "a", "b", xyz="0 0 2")
        + f'<gazebo reference="b"><sensor name="s" type="ray">{plugin}</sensor></gazebo>'
        f"<gazebo>{plugin}</gazebo>")
    assert codes(issues) == []
    (sensor,), (of_model,) = model.links[0].sensors, model.plugins
    assert "<frameName>b<" in sensor.plugins[0].xml
    assert "<frameName>a<" in of_model.xml and "<xyzOffset>0 0 2<" in of_model.xml


def test_friction_of_a_lumped_link_stays_with_its_own_collisions():
    model, _ = robot_of(
        robot_link("a", URDF_INERTIAL + SHAPES) + robot_link("b", URDF_INERTIAL + SHAPES)
        + robot_joint("j", "a", "b")
        + '<gazebo reference="b"><mu1>0.1</mu1></gazebo>'
        + '<gazebo reference="a"><mu1>0.9</mu1></gazebo>')
    assert [c.surface.mu for c in model.links[0].collisions] == [0.9, 0.1]


def test_a_link_is_kinematic_with_what_is_lumped_into_it():
    model, _ = robot_of(
        robot_link("a") + robot_link("b") + robot_joint("j", "a", "b")
        + '<gazebo reference="b"><kinematic>true</kinematic></gazebo>')
    assert model.links[0].kinematic


def test_a_massless_lumped_link_adds_its_shapes_and_no_mass():
    model, issues = robot_of(robot_link("a") + robot_link("b", SHAPES) + robot_joint("j", "a", "b"))
    assert model.links[0].inertial.mass == 1
    assert len(model.links[0].collisions) == 1
    assert errors(issues) == [] and codes(issues) == []


def _points(inertial):
    """Six point masses with the mass, centre and tensor of a body."""
    trace = (inertial.ixx + inertial.iyy + inertial.izz) / 2
    spread = [trace - inertial.ixx, trace - inertial.iyy, trace - inertial.izz]
    each = inertial.mass / 6
    points = []
    for axis, second in enumerate(spread):
        arm = math.sqrt(second / (2 * each))
        for sign in (1, -1):
            local = tuple(sign * arm if k == axis else 0.0 for k in range(3))
            points.append((each, add(inertial.pose.position,
                                     rotate(inertial.pose.orientation, local))))
    return points


@pytest.mark.parametrize("seed", range(10))
def test_merging_two_bodies_equals_the_sum_over_their_mass_points(seed):
    rng = random.Random(seed)

    def some_pose():
        return Pose(tuple(rng.uniform(-2, 2) for _ in range(3)),
                    quat_from_rpy(*(rng.uniform(-3, 3) for _ in range(3))))

    def some_body():
        a, b, c = (rng.uniform(0.1, 2) for _ in range(3))
        return Inertial(rng.uniform(0.5, 5), some_pose(), ixx=b + c, iyy=a + c, izz=a + b)

    first, second, between = some_body(), some_body(), some_pose()
    points = _points(first) + [
        (m, add(between.position, rotate(between.orientation, p))) for m, p in _points(second)]
    mass = sum(m for m, _ in points)
    centre = (0.0, 0.0, 0.0)
    for m, p in points:
        centre = add(centre, scale(p, m / mass))
    arms = [(m, tuple(p[k] - centre[k] for k in range(3))) for m, p in points]
    total = combine_inertia(first, second, between)
    assert total.mass == pytest.approx(mass)
    assert total.pose.position == pytest.approx(centre)
    assert total.pose.orientation == (0, 0, 0, 1)
    assert total.ixx == pytest.approx(sum(m * (r[1] ** 2 + r[2] ** 2) for m, r in arms))
    assert total.izz == pytest.approx(sum(m * (r[0] ** 2 + r[1] ** 2) for m, r in arms))
    assert total.ixy == pytest.approx(sum(-m * r[0] * r[1] for m, r in arms), abs=1e-9)
    assert total.iyz == pytest.approx(sum(-m * r[1] * r[2] for m, r in arms), abs=1e-9)


@pytest.mark.parametrize("base, tip, wanted", [
    ("<turnGravityOff>true</turnGravityOff>", "<turnGravityOff>false</turnGravityOff>",
     {"gravity": True}),
    ("<turnGravityOff>false</turnGravityOff>", "<turnGravityOff>true</turnGravityOff>",
     {"gravity": False}),
    ("<turnGravityOff>true</turnGravityOff>", "", {"gravity": False}),
    ("<selfCollide>false</selfCollide>", "<selfCollide>true</selfCollide>",
     {"self_collide": True}),
    ("<selfCollide>true</selfCollide>", "", {"self_collide": True}),
    ("<dampingFactor>0</dampingFactor>", "<dampingFactor>0.3</dampingFactor>",
     {"linear_decay": 0.0, "angular_decay": 0.0}),
    ("", "<dampingFactor>0.3</dampingFactor>", {"linear_decay": 0.3}),
    ('<dampingFactor>0.1</dampingFactor></gazebo><gazebo reference="a">'
     "<dampingFactor>0.2</dampingFactor>", "", {"linear_decay": 0.1})])
def test_of_what_lumped_links_set_the_same_counts_as_in_gazebo(base, tip, wanted):
    model, issues = robot_of(
        robot_link("a") + robot_link("b") + robot_joint("j", "a", "b")
        + f'<gazebo reference="a">{base}</gazebo><gazebo reference="b">{tip}</gazebo>')
    assert errors(issues) == []
    (link,) = model.links
    assert {name: getattr(link, name) for name in wanted} == wanted


def test_a_name_that_begins_with_the_links_gets_no_prefix():
    model, _ = robot_of(
        robot_link("base", URDF_INERTIAL + SHAPES) + robot_link("base_cap", URDF_INERTIAL + SHAPES)
        + robot_joint("j", "base", "base_cap"))
    (link,) = model.links
    assert [c.name for c in link.collisions] == ["base_collision", "base_cap_collision_1"]
    assert [v.name for v in link.visuals] == ["base_visual", "base_cap_visual_1"]


@pytest.mark.parametrize("base, tip, warned", [
    ("", "<turnGravityOff>true</turnGravityOff>", True),
    ("<turnGravityOff>false</turnGravityOff>", "<turnGravityOff>true</turnGravityOff>", True),
    ("<turnGravityOff>true</turnGravityOff>", "<turnGravityOff>true</turnGravityOff>", False),
    ("", "<turnGravityOff>false</turnGravityOff>", False)])
def test_a_sensor_link_that_takes_the_gravity_of_its_robot_is_warned_of(base, tip, warned):
    _, issues = robot_of(
        robot_link("a") + robot_link("b") + robot_joint("j", "a", "b")
        + f'<gazebo reference="a">{base}</gazebo><gazebo reference="b">{tip}</gazebo>')
    found = [issue.message for issue in issues if issue.code == "lumped-gravity"]
    assert found == (["link 'b' has no gravity, so 'a' has none either: a fixed joint connects"
                      " them, as in Gazebo"] if warned else [])
