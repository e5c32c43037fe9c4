"""Joints of SDF."""
import pytest
from reading import INERTIAL, codes, errors, model_of, warnings

from my_simulations.description.model import INFINITE, JointAxis

LINKS = f'<link name="a">{INERTIAL}</link><link name="b"><pose>1 0 0 0 0 0</pose>{INERTIAL}</link>'


def joint_of(kind, inside="<axis/>", parent="a", child="b"):
    model, issues = model_of(
        LINKS + f'<joint name="j" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
        f"{inside}</joint>")
    return model.joints[0], issues


def test_limits_and_dynamics_are_read():
    joint, issues = joint_of(
        "revolute", "<axis><xyz>0 2 0</xyz><limit><lower>-1</lower><upper>2</upper>"
        "<effort>3</effort><velocity>4</velocity></limit><dynamics><damping>5</damping>"
        "<friction>6</friction><spring_reference>7</spring_reference>"
        "<spring_stiffness>8</spring_stiffness></dynamics></axis>")
    assert issues == []
    assert joint.axis == JointAxis((0, 1, 0), -1, 2, 3, 4, 5, 6, 7, 8)


def test_an_axis_has_the_defaults_of_the_format():
    joint, issues = joint_of("prismatic")
    assert joint.axis == JointAxis((0, 0, 1)) and issues == []


@pytest.mark.parametrize("text", ["1e+16", "1.79769e+308", "inf"])
def test_huge_limits_are_unlimited(text):
    joint, issues = joint_of("revolute", f"<axis><limit><upper>{text}</upper></limit></axis>")
    assert joint.axis.upper >= INFINITE and issues == []


def test_a_continuous_joint_is_a_revolute_one_without_limits():
    joint, issues = joint_of(
        "continuous", "<axis><limit><lower>0</lower><upper>0</upper></limit></axis>")
    assert joint.type == "revolute" and issues == []
    assert (joint.axis.lower, joint.axis.upper) == (-INFINITE, INFINITE)


def test_a_fixed_joint_has_no_axis():
    joint, issues = joint_of("fixed", "<axis><xyz>0 0 0</xyz></axis>")
    assert joint.axis is None and issues == []


@pytest.mark.parametrize("kind", ["ball", "universal", "revolute2", "screw", "gearbox"])
def test_rarer_types_are_read(kind):
    joint, issues = joint_of(kind)
    assert joint.type == kind and issues == []


def test_a_piston_is_kept_with_a_warning():
    joint, issues = joint_of("piston")
    assert joint.type == "piston" and codes(issues) == ["joint-unsupported"]
    assert warnings(issues)


def test_reversed_limits_are_a_warning():
    _, issues = joint_of("revolute",
                         "<axis><limit><lower>1</lower><upper>-1</upper></limit></axis>")
    assert errors(issues) == [] and warnings(issues) == ["joint-limits-reversed"]


def test_a_joint_may_hold_a_link_to_the_world():
    joint, issues = joint_of("revolute", "<axis><xyz>1 0 0</xyz></axis>", parent="world")
    assert (joint.parent, joint.child, issues) == ("world", "b", [])


def test_a_joint_with_the_world_as_child_is_turned_round():
    joint, issues = joint_of("revolute", "<pose>5 0 0 0 0 0</pose><axis><xyz>1 0 0</xyz></axis>",
                             parent="b", child="world")
    assert errors(issues) == []
    assert (joint.parent, joint.child) == ("world", "b")
    assert joint.axis.xyz == (-1, 0, 0)
    # The pose of a joint to the world is in the model's frame; link b is at x = 1.
    assert joint.pose.position == (4, 0, 0)


def test_the_physics_block_of_a_joint_is_kept_without_a_warning():
    joint, issues = joint_of("revolute", "<axis/><physics><ode><cfm_damping>1</cfm_damping></ode>"
                                         "</physics>")
    assert issues == [] and joint.extra[0].startswith("<physics>")
