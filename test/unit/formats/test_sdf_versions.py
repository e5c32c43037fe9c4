"""What older documents mean, and newer ones."""
import math

import pytest
from reading import INERTIAL, codes, errors, link_of, model_of, warnings, world_of

from my_simulations.formats.reading import read_entity
from my_simulations.resources.resolver import Resolver

TURNED = (f'<link name="a">{INERTIAL}</link><link name="b">'
          f"<pose>1 0 0 0 0 1.5707963267948966</pose>{INERTIAL}</link>")


def axis_of(version, axis, parent="a", joint_pose=""):
    model, issues = model_of(
        TURNED + f'<joint name="j" type="revolute"><parent>{parent}</parent><child>b</child>'
        f"{joint_pose}<axis>{axis}</axis></joint>", version)
    assert errors(issues) == []
    return model.joints[0].axis.xyz


def test_an_axis_of_1_4_is_in_the_model_frame_and_of_1_6_in_the_joint_frame():
    assert axis_of("1.4", "<xyz>1 0 0</xyz>") == pytest.approx((0, -1, 0))
    assert axis_of("1.6", "<xyz>1 0 0</xyz>") == pytest.approx((1, 0, 0))
    assert axis_of("1.7", "<xyz>1 0 0</xyz>") == pytest.approx((1, 0, 0))


def test_use_parent_model_frame_counts_from_1_5_on():
    flag = "<use_parent_model_frame>{}</use_parent_model_frame>"
    assert axis_of("1.5", "<xyz>1 0 0</xyz>" + flag.format("true")) == pytest.approx((0, -1, 0))
    assert axis_of("1.6", "<xyz>1 0 0</xyz>" + flag.format("1")) == pytest.approx((0, -1, 0))
    assert axis_of("1.6", "<xyz>1 0 0</xyz>" + flag.format("0")) == pytest.approx((1, 0, 0))


def test_the_default_axis_of_1_4_is_the_models_z():
    model, _ = model_of(
        f'<link name="a">{INERTIAL}</link>'
        f'<link name="b"><pose>0 0 0 1.5707963267948966 0 0</pose>{INERTIAL}</link>'
        '<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis/></joint>', "1.4")
    assert model.joints[0].axis.xyz == pytest.approx((0, 1, 0))


def test_an_axis_counts_the_turn_of_the_joint_too():
    pose = "<pose>0 0 0 0 0 1.5707963267948966</pose>"
    assert axis_of("1.4", "<xyz>1 0 0</xyz>", joint_pose=pose) == pytest.approx((-1, 0, 0))


def test_expressed_in_names_the_frame_of_an_axis_in_1_7():
    assert axis_of("1.7", '<xyz expressed_in="__model__">1 0 0</xyz>') == pytest.approx((0, -1, 0))
    assert axis_of("1.7", '<xyz expressed_in="a">0 2 0</xyz>') == pytest.approx((1, 0, 0))


def test_an_old_axis_of_a_joint_to_the_world_is_in_world_axes():
    model, issues = model_of(
        f'<pose>0 0 0 0 0 1.5707963267948966</pose><link name="b">{INERTIAL}</link>'
        '<joint name="j" type="prismatic"><parent>world</parent><child>b</child>'
        "<axis><xyz>1 0 0</xyz></axis></joint>", "1.4")
    assert errors(issues) == []
    assert model.joints[0].axis.xyz == pytest.approx((0, -1, 0))


def test_gravity_inside_physics_is_the_worlds_up_to_1_5():
    physics = '<physics type="ode"><gravity>0 0 -1.6</gravity></physics>'
    assert world_of(physics, "1.5")[0].gravity == (0, 0, -1.6)
    world, issues = world_of("<gravity>0 0 -1.6</gravity>", "1.6")
    assert world.gravity == (0, 0, -1.6) and issues == []


def test_rates_and_steps_of_1_2_have_their_new_names():
    world, issues = world_of(
        '<physics type="ode"><update_rate>500</update_rate><ode><solver><dt>0.002</dt>'
        "<iters>20</iters></solver></ode></physics>", "1.2")
    assert issues == []
    assert world.physics.real_time_update_rate == 500
    assert world.physics.max_step_size == 0.002
    assert world.physics.ode.iters == 20


def test_origin_with_a_pose_is_a_pose_in_1_2():
    link, issues = link_of('<origin pose="1 2 3 0 0 0"/>', "1.2")
    assert link.pose.position == (1, 2, 3) and issues == []


def test_the_frame_of_a_pose_is_relative_to_in_1_6():
    model, issues = model_of(
        '<link name="a"><pose>1 0 0 0 0 0</pose></link>'
        '<link name="b"><pose frame="a">1 0 0 0 0 0</pose></link>'
        '<link name="c"><pose frame="">5 0 0 0 0 0</pose></link>', "1.6")
    assert [link.pose.position[0] for link in model.links] == [1, 2, 5]
    assert errors(issues) == []


def test_an_old_gazebo_root_is_read_as_sdf():
    text = '<gazebo version="1.2"><model name="m"><link name="l"/></model></gazebo>'
    model, _ = read_entity(text, Resolver())
    assert model.links[0].name == "l"


def test_a_newer_version_is_read_with_one_warning():
    _, issues = model_of('<link name="l"/>', "1.9")
    assert codes(issues) == ["sdf-newer"]


def test_degrees_and_quaternions_of_1_9_are_read():
    model, issues = model_of(
        '<link name="a"><pose degrees="true">0 0 0 0 0 90</pose></link>'
        '<link name="b"><pose rotation_format="quat_xyzw">0 0 0 0 0 1 1</pose></link>', "1.9")
    half = math.sqrt(0.5)
    for link in model.links:
        assert link.pose.orientation == pytest.approx((0, 0, half, half))
    assert errors(issues) == []


def test_a_missing_version_warns_and_counts_as_1_7():
    model, issues = read_entity('<sdf><model name="m"><link name="l"/></model></sdf>', Resolver())
    assert warnings(issues) == ["sdf-version"] and model.name == "m"


def test_a_bitmask_of_1_4_is_1_where_another_one_is_given():
    def masks(version, given):
        body = '<collision name="{}"><geometry><box/></geometry>{}</collision>'
        mask = "<surface><contact><collide_bitmask>2</collide_bitmask></contact></surface>"
        link, issues = link_of(body.format("a", mask if given else "") + body.format("b", ""),
                               version)
        assert errors(issues) == []
        return [collision.surface.collide_bitmask for collision in link.collisions]

    assert masks("1.4", True) == [2, 1] and masks("1.5", True) == [2, 65535]
    assert masks("1.4", False) == [65535, 65535]


def test_the_noise_of_an_imu_becomes_one_for_each_axis():
    link, _ = link_of(
        '<sensor name="s" type="imu"><imu><noise><type>gaussian</type><rate><mean>1</mean><stddev>2'
        "</stddev></rate><accel><bias_mean>3</bias_mean></accel></noise></imu></sensor>", "1.5")
    noise = '<{0}><noise type="gaussian">{1}</noise></{0}>'
    rate = "".join(noise.format(a, "<mean>1</mean><stddev>2</stddev>") for a in "xyz")
    accel = "".join(noise.format(a, "<bias_mean>3</bias_mean>") for a in "xyz")
    assert link.extra == [
        f'<sensor name="s" type="imu"><imu><angular_velocity>{rate}</angular_velocity>'
        f"<linear_acceleration>{accel}</linear_acceleration></imu></sensor>"]


def test_a_force_torque_sensor_of_1_4_measures_in_the_parent():
    xml = '<sensor name="s" type="force_torque"><force_torque>{}</force_torque></sensor>'
    assert link_of(xml.format(""), "1.4")[0].extra == [xml.format("<frame>parent</frame>")]
    assert link_of(xml.format("<frame>child</frame>"), "1.4")[0].extra == [
        xml.format("<frame>child</frame>")]


PARAMETERS = ('<pose frame="odom">1 2 3 0 0 0</pose><joint><axis><xyz>0 0 1</xyz></axis></joint>'
              '<physics><update_rate>5</update_rate></physics><origin pose="1 2 3 0 0 0"/>'
              "<force_torque/><imu><noise><rate><mean>1</mean></rate></noise></imu>"
              '<pose degrees="true">0 0 0 90 0 0</pose>')


@pytest.mark.parametrize("version", ["1.3", "1.4", "1.5", "1.6", "1.7", "1.9"])
def test_the_parameters_of_a_plugin_stay_as_they_are_written(version):
    model, _ = model_of(f'<link name="a">{INERTIAL}</link><plugin name="p" filename="f.so">'
                        f"{PARAMETERS}</plugin>", version)
    assert PARAMETERS in model.plugins[0].xml
