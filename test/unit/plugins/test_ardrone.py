"""The AR.Drone of tum_simulator: its states, thrust, navdata and cameras, against its formulas."""
from __future__ import annotations

import math
import os

import pytest
from robot_control import hide_package

from my_simulations.description.model import Inertial
from my_simulations.description.plugin import PluginSpec
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.flight.ardrone import ArdroneStateController
from my_simulations.plugins.flight.flight_states import FlightState
from my_simulations.plugins.flight.quadrotor_simple_controller import QuadrotorSimpleController
from my_simulations.plugins.testing import FakeContext

MASS = 1.5
WEIGHT = MASS * 9.8
OFF = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
SONAR = "<sonarTopic>sonar_height</sonarTopic>"
LIBRARY = "libhector_gazebo_quadrotor_state_controller.so"


def controller(inside="", state=""):
    context = FakeContext(f"<plugin>{inside}</plugin>")
    context.link("").inertial = Inertial(MASS, ixx=0.01, iyy=0.02, izz=0.03)
    context.description.plugins.append(
        PluginSpec("state", LIBRARY, f"<plugin>{state}</plugin>"))
    plugin = QuadrotorSimpleController(context)
    plugin.load()
    return context, plugin


def drop_timers(context):
    """Do what a change of the clock does to calls at a time."""
    for one in list(context._calls):
        if one._rate is None:
            one.end()


def thrust(context):
    return context.wrenches.get("base", OFF)[0][2]


@pytest.fixture
def messages(tmp_path, monkeypatch):
    """A package ardrone_autonomy whose Navdata has the fields that the plugin writes."""
    package = tmp_path / "ardrone_autonomy"
    (package / "msg").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>ardrone_autonomy</name></package>")
    (package / "msg" / "Navdata.msg").write_text("\n".join((
        "std_msgs/Header header", "uint32 state", "int32 altd", *(
            f"float32 {name}" for name in "batteryPercent rotX rotY rotZ vx vy vz ax ay az tm"
            .split()))))
    monkeypatch.setenv("ROS_PACKAGE_PATH", os.pathsep.join(
        (str(tmp_path), os.environ.get("ROS_PACKAGE_PATH", ""))))


def state_plugin(inside=""):
    context = FakeContext(f"<plugin>{inside}</plugin>")
    plugin = ArdroneStateController(context)
    plugin.load()
    return context, plugin


def navdata(context):
    return context.published["/ardrone/navdata"][-1]


def test_the_sonar_ends_take_off_and_landing_and_each_state_has_its_thrust():
    context, _ = controller(state=SONAR)
    context.deliver("cmd_vel", linear={"z": 1.0})
    context.advance(0.01)
    assert thrust(context) == 0.0    # a command to rise starts hector's motors, not these
    context.deliver("cmd_vel")
    context.deliver("/ardrone/takeoff")
    context.advance(0.9)
    assert thrust(context) == pytest.approx(1.5 * WEIGHT)
    context.deliver("sonar_height", range=0.6)
    context.advance(0.01)
    assert thrust(context) == pytest.approx(WEIGHT)
    context.deliver("/ardrone/land")
    context.advance(0.01)
    assert thrust(context) == pytest.approx(0.8 * WEIGHT)
    context.deliver("sonar_height", range=0.1)
    context.advance(0.01)
    assert context.wrenches["base"] == OFF and context.stops == 0


def test_times_end_take_off_and_landing_without_a_sonar():
    context, _ = controller()
    context.deliver("/ardrone/takeoff")
    context.advance(0.4)
    assert thrust(context) == pytest.approx(1.5 * WEIGHT)
    context.advance(0.2)
    assert thrust(context) == pytest.approx(WEIGHT)
    context.deliver("/ardrone/land")
    context.advance(0.9)
    assert thrust(context) == pytest.approx(0.8 * WEIGHT)
    context.advance(0.2)
    assert context.wrenches["base"] == OFF


def test_a_landing_that_the_sonar_does_not_see_ends_after_five_seconds():
    context, _ = controller(state=SONAR)
    context.deliver("/ardrone/takeoff")
    context.deliver("/ardrone/land")
    context.advance(4.9)
    assert thrust(context) > 0.0
    context.advance(0.2)
    assert context.wrenches["base"] == OFF


def test_it_takes_off_again_while_it_lands():
    context, _ = controller()
    context.deliver("/ardrone/takeoff")
    context.advance(0.6)
    context.deliver("/ardrone/land")
    context.advance(0.5)
    context.deliver("/ardrone/takeoff")
    context.advance(0.6)
    assert thrust(context) == pytest.approx(WEIGHT)


def test_the_topics_are_those_of_the_state_controller():
    context, _ = controller(state="<takeoffTopic>up</takeoffTopic><landTopic>down</landTopic>")
    context.deliver("up")
    context.advance(0.1)
    assert thrust(context) > 0.0
    context.deliver("down")
    context.advance(1.2)
    assert context.wrenches["base"] == OFF


def test_a_time_that_is_set_back_does_not_keep_the_drone_in_its_take_off():
    context, plugin = controller()
    context.deliver("/ardrone/takeoff")
    drop_timers(context)
    plugin.clock_set()
    context.advance(0.6)
    assert thrust(context) == pytest.approx(WEIGHT)


def test_a_reset_stops_the_motors():
    context, plugin = controller()
    context.deliver("/ardrone/takeoff")
    context.advance(0.6)
    plugin.reset()
    context.advance(0.6)
    assert context.wrenches["base"] == OFF and context.stops == 0


def test_the_thrust_acts_at_the_centre_of_mass():
    context, _ = controller()
    context.link("").inertial = Inertial(MASS, Pose((0.02, 0.0, 0.01)), 0.01, iyy=0.02,
                                         izz=0.03)
    context.deliver("/ardrone/takeoff")
    context.advance(0.6)
    # Gazebo's function for the force at a link's centre of mass: no moment about it.
    assert context.wrenches["base"][1] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_commands_have_noise_within_its_bounds():
    noise = "<motionSmallNoise>0.05</motionSmallNoise><motionDriftNoise>0.03</motionDriftNoise>" \
        "<motionDriftNoiseTime>0.1</motionDriftNoiseTime>" \
        "<velocityZProportionalGain>5</velocityZProportionalGain>"
    context, _ = controller(noise)
    context.deliver("/ardrone/takeoff")
    context.advance(0.6)
    found = set()
    for _ in range(200):
        context.deliver("cmd_vel")
        context.advance(0.001)
        found.add(thrust(context))
    assert len(found) > 100
    assert max(abs(one - WEIGHT) for one in found) <= MASS * 5.0 * 0.08 + 1e-9


def test_navdata_show_state_attitude_height_and_motion(messages):
    context, _ = state_plugin(SONAR)
    context.link("").pose = Pose((1.0, 2.0, 3.0), quat_from_rpy(0.0, 0.1, math.pi / 2))
    context.advance(0.005)
    context.link("").twist = Twist((0.0, 2.0, 0.5))     # forwards, as it looks along y
    context.deliver("sonar_height", range=0.75)
    context.deliver("/ardrone/takeoff")
    context.advance(0.005)
    data = navdata(context)
    assert data.state == FlightState.FLYING == 3 and data.altd == 750
    assert (data.rotX, data.rotY, data.rotZ) == pytest.approx(
        (0.0, math.degrees(0.1), 90.0), abs=1e-5)
    assert (data.vx, data.vy, data.vz) == pytest.approx((2000.0, 0.0, 500.0), abs=1e-5)
    assert (data.ax, data.ay, data.az) == pytest.approx((40.0, 0.0, 11.0), abs=1e-5)
    assert data.tm == pytest.approx(10_000.0)
    assert data.header.frame_id == "ardrone_base_link"
    assert len(context.published["/ardrone/navdata"]) == 2      # at 200 Hz


def test_without_a_sonar_navdata_have_the_height_in_the_world(messages):
    context, _ = state_plugin()
    context.link("").pose = Pose((0.0, 0.0, 1.25))
    context.advance(0.005)
    assert navdata(context).altd == 1250 and navdata(context).state == FlightState.LANDED == 2


def test_the_battery_lasts_twenty_minutes_of_flight_and_is_new_in_each_flight(messages):
    context, _ = state_plugin()
    context.deliver("/ardrone/takeoff")
    context.advance(6.0)
    assert navdata(context).batteryPercent == pytest.approx(99.5)
    context.deliver("/ardrone/land")
    context.advance(6.0)      # it has landed after 1 s
    assert navdata(context).batteryPercent == pytest.approx(100.0 - 700.0 / 1200.0)
    context.deliver("/ardrone/takeoff")
    context.advance(0.005)
    assert navdata(context).batteryPercent == pytest.approx(100.0, abs=0.001)


def test_the_service_switches_between_the_two_cameras():
    context, _ = state_plugin()
    context.advance(0.3)
    context.deliver("/ardrone/front/camera_info", width=640)
    assert [one.width for one in context.published["/ardrone/camera_info"]] == [640]
    context.call("ardrone/togglecam")
    context.deliver("/ardrone/bottom/camera_info", width=320)
    assert [one.width for one in context.published["/ardrone/camera_info"]] == [640, 320]
    with pytest.raises(PluginError):
        context.deliver("/ardrone/front/camera_info", width=640)


def test_cameras_without_subscribers_are_not_read():
    context, _ = state_plugin()
    context.unwanted.update(("/ardrone/image_raw", "/ardrone/camera_info"))
    context.advance(0.3)
    with pytest.raises(PluginError):
        context.deliver("/ardrone/front/image_raw")


def test_the_drone_flies_without_the_package_of_its_messages():
    context = FakeContext("<plugin/>")
    hide_package(context, "ardrone_autonomy")
    ArdroneStateController(context).load()
    assert any("no navdata" in text for text in context.log_messages)
