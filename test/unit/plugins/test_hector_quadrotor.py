"""hector's quadrotor: controller, motors and drag, against their formulas."""
from __future__ import annotations

import math

import pytest
from robot_control import Arm

from my_simulations.description.model import Inertial
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.messages import Time
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.flight.filtered_pid import FilteredPid
from my_simulations.plugins.flight.quadrotor_propulsion import (
    QuadrotorAerodynamics,
    QuadrotorPropulsion,
    rotor_speeds_along,
)
from my_simulations.plugins.flight.quadrotor_simple_controller import QuadrotorSimpleController
from my_simulations.plugins.parameters import Parameters
from my_simulations.plugins.testing import FakeContext, Message

MASS = 1.5
MOTOR = {"Psi": 0.0072, "J_M": 2.6e-5, "R_A": 0.2, "k_t": 0.0153, "k_m": 1e-5, "alpha_m": 0.105,
         "beta_m": 0.55, "CT2s": 0.0, "CT1s": -2.5e-4, "CT0s": 1.54e-5, "l_m": 0.275}
DRAG = {"C_wxy": 0.12, "C_wz": 0.1, "C_mxy": 0.074, "C_mz": 0.051}


def loaded(cls, inside="", parameters=None, inertial=None):
    context = FakeContext(f"<plugin>{inside}</plugin>")
    context.ros_parameters = parameters or {}
    context.link("").inertial = inertial or Inertial(MASS, ixx=0.01, iyy=0.02, izz=0.03)
    return context, context.load(cls)


def push(context):
    return context.wrenches["base"]


# -- the controller ------------------------------------------------------------------------------



def command(x=0.0, y=0.0, z=0.0, yaw=0.0):
    return {"linear": {"x": x, "y": y, "z": z}, "angular": {"x": 0.0, "y": 0.0, "z": yaw}}


def test_the_filter_of_a_command_has_its_time_constant():
    pid = FilteredPid(Parameters("<plugin><aProportionalGain>1</aProportionalGain><aTimeConstant>"
                                 "0.5</aTimeConstant><aLimit>2</aLimit></plugin>"), "a")
    for _ in range(500):
        found = pid.update(5.0, 0.0, 0.0, 0.001)
    assert found == pytest.approx(2.0 * (1.0 - math.exp(-1.0)), rel=2e-3)


def test_motors_start_with_a_command_to_rise():
    context, _ = loaded(QuadrotorSimpleController,
                        "<velocityZProportionalGain>5</velocityZProportionalGain>")
    context.deliver("cmd_vel", **command(x=1.0))
    context.advance(0.01)
    assert not context.wrenches
    context.deliver("cmd_vel", **command(z=0.5))
    context.advance(0.01)
    assert push(context)[0] == pytest.approx((0.0, 0.0, MASS * (9.8 + 5.0 * 0.5)))
    assert context.published["wrench_out"][-1].force.z == pytest.approx(MASS * 12.3)


def test_a_tilted_body_carries_its_weight():
    context, _ = loaded(QuadrotorSimpleController)
    context.link("").pose = Pose(orientation=quat_from_rpy(0.0, 0.3, 0.0))
    context.deliver("cmd_vel", **command(z=0.5))
    context.advance(0.01)
    force = push(context)[0]
    assert force[2] == pytest.approx(MASS * 9.8)
    assert force[0] == pytest.approx(MASS * 9.8 * math.tan(0.3))


def test_thrust_acts_at_the_origin_of_the_link_and_is_limited():
    context, _ = loaded(QuadrotorSimpleController, "<maxForce>10</maxForce>",
                        inertial=Inertial(MASS, Pose((0.1, 0.0, 0.0))))
    context.deliver("cmd_vel", **command(z=0.5))
    context.advance(0.001)
    assert push(context)[0][2] == pytest.approx(10.0)
    assert push(context)[1] == pytest.approx((0.0, 1.0, 0.0))   # -(0.1, 0, 0) x (0, 0, 10)


def test_a_forward_command_pitches_along_the_heading():
    context, _ = loaded(QuadrotorSimpleController,
                        "<velocityXYProportionalGain>4.9</velocityXYProportionalGain>"
                        "<rollpitchProportionalGain>10</rollpitchProportionalGain>")
    context.link("").pose = Pose(orientation=quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.deliver("cmd_vel", **command(x=1.0, z=0.2))
    context.advance(0.001)
    # 0.5 rad of pitch wanted; the y axis of the body is the -x axis of the world
    assert push(context)[1] == pytest.approx((-0.02 * 10.0 * 0.5, 0.0, 0.0), abs=1e-12)


def test_services_start_and_stop_motors():
    context, plugin = loaded(QuadrotorSimpleController)
    context.services["engage"](Message(), Message())
    context.advance(0.01)
    assert push(context)[0][2] == pytest.approx(MASS * 9.8)
    context.services["shutdown"](Message(), Message())
    assert push(context) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    context.services["engage"](Message(), Message())
    plugin.reset()
    context.advance(0.01)
    assert push(context) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_a_landed_body_stops_its_motors():
    context, _ = loaded(QuadrotorSimpleController)
    context.deliver("cmd_vel", **command(z=0.5))
    context.advance(0.1)
    context.deliver("cmd_vel", **command(z=-0.5))
    context.advance(1.5)
    assert push(context)[0][2] > 0.0
    context.advance(1.0)   # the integral of the error is below -1 m, and it stands
    assert push(context)[0][2] == 0.0


# -- motors --------------------------------------------------------------------------------------

def steady(voltage):
    """Speed of a rotor at rest in the air at which torques balance, rad/s, by bisection."""
    low, high = 0.0, 3000.0
    for _ in range(100):
        w = (low + high) / 2.0
        # I^2 R - I (U beta - Psi w) - U alpha = 0
        b = voltage * MOTOR["beta_m"] - MOTOR["Psi"] * w
        current = (b + math.sqrt(b * b + 4.0 * MOTOR["R_A"] * voltage * MOTOR["alpha_m"])) / (
            2.0 * MOTOR["R_A"])
        load = MOTOR["k_t"] * MOTOR["CT0s"] * w * w + MOTOR["k_m"] * w
        low, high = (w, high) if MOTOR["Psi"] * current > load else (low, w)
    return low


def propelled(inside="", **more):
    return loaded(QuadrotorPropulsion, inside, {"quadrotor_propulsion": {**MOTOR, **more}})


def voltages(*values, ns=0):
    return {"header": {"stamp": Time.of_ns(ns)}, "voltage": list(values)}


def pwm(*values, ns=0):
    return {"header": {"stamp": Time.of_ns(ns)}, "pwm": list(values)}


def test_rotors_reach_the_speed_at_which_torques_balance():
    context, _ = propelled()
    context.deliver("motor_pwm", **pwm(128, 128, 128, 128))
    context.advance(2.0)
    speed = steady(14.8 * 128 / 255)
    status = context.published["motor_status"][-1]
    assert status.on and status.running
    assert status.frequency == pytest.approx([speed] * 4, rel=1e-6)
    assert push(context)[0][2] == pytest.approx(4.0 * MOTOR["CT0s"] * speed ** 2, rel=1e-6)
    assert push(context)[1] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_the_order_of_motors_gives_roll_pitch_and_yaw():
    for order, way in (((0, 1, 0, -1), 0), ((-1, 0, 1, 0), 1), ((1, -1, 1, -1), 2)):
        context, _ = propelled()
        signs = [-one if way == 0 else one for one in order]
        context.deliver("motor_pwm", **pwm(*(128 + 20 * sign for sign in signs)))
        context.advance(1.0)
        torque = push(context)[1]
        assert torque[way] > 0.01
        others = [torque[axis] for axis in range(2) if axis != way]
        assert others == pytest.approx([0.0] * len(others), abs=1e-9)


def test_rising_rotors_meet_more_air():
    assert rotor_speeds_along((0.0, 0.0, 2.0), (0.5, 1.0, 0.0), 0.2) == pytest.approx(
        (2.0 - 0.2, 2.0 - 0.1, 2.0 + 0.2, 2.0 + 0.1))
    context, _ = propelled()
    context.link("").twist = Twist((0.0, 0.0, 1.0))
    context.deliver("motor_pwm", **pwm(128, 128, 128, 128))
    context.advance(2.0)
    status = context.published["motor_status"][-1]
    thrust = sum(MOTOR["CT0s"] * w * w + MOTOR["CT1s"] * w for w in status.frequency)
    assert push(context)[0][2] == pytest.approx(thrust, rel=1e-6)


def test_a_command_acts_after_its_delay():
    context, _ = propelled("<controlDelay>0.05</controlDelay>")
    context.advance(0.02)
    context.deliver("command/motor", **voltages(7.4, 7.4, 7.4, 7.4, ns=20 * 10 ** 6))
    context.advance(0.045)
    assert context.published["motor_status"][-1].voltage == [0.0] * 4
    context.advance(0.01)
    assert context.published["motor_status"][-1].voltage == pytest.approx([7.4] * 4, abs=0.06)


def test_motors_stop_without_commands():
    context, _ = propelled("<controlRate>100</controlRate>")
    context.deliver("motor_pwm", **pwm(255, 255, 255, 255))
    context.advance(0.9)
    assert context.published["motor_status"][-1].on
    context.advance(0.2)
    assert not context.published["motor_status"][-1].on
    assert any("no motor command" in text for text in context.log_messages)
    assert len(context.published["quadro/trigger"]) == 110


def test_a_missing_parameter_is_named():
    with pytest.raises(PluginError, match="quadrotor_propulsion/alpha_m"):
        loaded(QuadrotorPropulsion, "", {"quadrotor_propulsion": {
            name: value for name, value in MOTOR.items() if name != "alpha_m"}})


# -- drag ----------------------------------------------------------------------------------------

def test_drag_grows_with_the_square_of_the_speed_through_the_air():
    context, _ = loaded(QuadrotorAerodynamics, "", {"quadrotor_aerodynamics": DRAG})
    context.link("").twist = Twist((3.0, 0.0, 4.0), (0.0, 0.0, 2.0))
    context.advance(0.001)
    force, torque = push(context)
    assert force == pytest.approx((-0.12 * 5.0 * 3.0, 0.0, -0.1 * 5.0 * 4.0))
    assert torque == pytest.approx((0.0, 0.0, -0.051 * 4.0))
    context.deliver("/wind", x=3.0, y=0.0, z=4.0)
    context.advance(0.001)
    assert push(context)[0] == pytest.approx((0.0, 0.0, 0.0))


def test_drag_is_that_of_the_axes_of_the_body():
    context, _ = loaded(QuadrotorAerodynamics, "", {"quadrotor_aerodynamics": DRAG})
    context.link("").pose = Pose(orientation=quat_from_rpy(math.pi / 2, 0.0, 0.0))
    context.link("").twist = Twist((0.0, 2.0, 0.0))
    context.advance(0.001)
    assert push(context)[0] == pytest.approx((0.0, -0.1 * 4.0, 0.0), abs=1e-12)
    assert context.published["aerodynamics/wrench"][-1].wrench.force.z == pytest.approx(0.4)


# -- the chain of controllers --------------------------------------------------------------------

LOOPS = {
    "position": {"type": "hector_quadrotor_controllers/PositionController",
                 **{axis: {"p": 2.0} for axis in ("x", "y", "z", "yaw")}},
    "velocity": {"type": "hector_quadrotor_controllers/VelocityController",
                 **{axis: {"p": 2.0} for axis in "xyz"}},
    "attitude": {"type": "hector_quadrotor_controllers/AttitudeController",
                 "max_roll_pitch": 0.5, "roll": {"p": 100.0}, "pitch": {"p": 100.0},
                 "yawrate": {"p": 5.0, "max": 1.0}}}


def chain(*names, inside="<robotSimType>hector_quadrotor_controller_gazebo/QuadrotorHardwareSim"
          "</robotSimType><controlPeriod>0.01</controlPeriod>", **parameters):
    robot = Arm(inside=inside, parameters={"world_frame": "world", **parameters}, **LOOPS)
    robot.context.link("").inertial = Inertial(MASS, ixx=0.01, iyy=0.02, izz=0.03)
    robot.run(*names)
    return robot


def start(robot, running=True):
    response = Message()
    robot.context.services["robot/enable_motors"](Message(enable=running), response)
    assert response.success


def test_nothing_pushes_until_the_motors_run():
    robot = chain("velocity", "attitude")
    robot.deliver("cmd_vel", **command(z=1.0))
    robot.context.advance(0.1)
    assert not robot.context.wrenches
    start(robot)
    robot.context.advance(0.1)
    assert push(robot.context)[0][2] == pytest.approx(MASS * 9.8065)
    robot.deliver("cmd_vel", **command(z=1.0))
    robot.context.advance(0.1)
    assert push(robot.context)[0][2] == pytest.approx(MASS * (2.0 + 9.8065))
    start(robot, False)
    assert push(robot.context)[0][2] == 0.0


def test_a_velocity_is_given_in_the_axes_of_the_heading():
    robot = chain("velocity", "attitude")
    robot.context.link("").pose = Pose(orientation=quat_from_rpy(0.0, 0.0, math.pi / 2))
    start(robot)
    robot.deliver("cmd_vel", **command(x=1.0))
    robot.context.advance(0.1)
    pitch = math.asin(2.0 / 9.8065)
    # a torque about the y axis of the body, which is -x of the world
    assert push(robot.context)[1] == pytest.approx((-0.02 * 100.0 * math.sin(pitch), 0.0, 0.0),
                                                   abs=1e-9)


def test_tilt_and_yaw_rate_are_limited():
    robot = chain("attitude")
    start(robot)
    for name, value in (("attitude", {"roll": 0.0, "pitch": 2.0}), ("yawrate", {"turnrate": 9.0}),
                        ("thrust", {"thrust": 7.0})):
        robot.deliver(f"command/{name}", header={"stamp": Time()}, **value)
    robot.context.advance(0.1)
    force, torque = push(robot.context)
    assert force == (0.0, 0.0, 7.0)
    assert torque == pytest.approx((0.0, 0.02 * 100.0 * math.sin(0.5), 0.03 * 5.0 * 1.0))
    robot.deliver("estop", data=True)
    robot.context.advance(1.0)
    assert push(robot.context)[0][2] == pytest.approx(7.0 - MASS * 1.0, abs=0.05)


def test_a_velocity_ends_position_control_and_standing_still_does_not():
    robot = chain("position", "velocity", "attitude")
    start(robot)
    robot.deliver("command/pose", header={"frame_id": "world", "stamp": Time()}, pose={
        "position": {"x": 0.0, "y": 0.0, "z": 1.0},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}})
    robot.deliver("cmd_vel", **command())
    robot.context.advance(0.1)
    assert push(robot.context)[0][2] == pytest.approx(MASS * (2.0 * 2.0 + 9.8065))
    robot.deliver("command/twist_limit", **command(z=0.5))
    robot.context.advance(0.1)
    assert push(robot.context)[0][2] == pytest.approx(MASS * (0.5 * 2.0 + 9.8065))
    robot.deliver("cmd_vel", **command(z=-0.5))
    robot.context.advance(0.1)
    assert push(robot.context)[0][2] == pytest.approx(MASS * (-0.5 * 2.0 + 9.8065))


def test_commands_in_other_frames_are_ignored():
    robot = chain("position", "velocity", "attitude")
    start(robot)
    robot.deliver("command/pose", header={"frame_id": "map", "stamp": Time()}, pose={
        "position": {"x": 0.0, "y": 0.0, "z": 1.0},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}})
    robot.context.advance(0.1)
    assert push(robot.context)[0][2] == pytest.approx(MASS * 9.8065)
    assert any("world" in text and "map" in text for text in robot.context.log_messages)


def test_controllers_of_quadrotors_need_their_hardware():
    robot = Arm(**LOOPS)
    assert not robot.load("attitude")
    assert any("QuadrotorHardwareSim" in text for text in robot.context.log_messages)
