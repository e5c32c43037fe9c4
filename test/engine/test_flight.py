"""Quadrotors with real physics: hovering, commands, terminal velocities."""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from plugin_case import PluginCase, kept
from wheeled_robots import plugin

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.geometry import Pose, rotate, rpy_from_quat
from my_simulations.plugins.testing import Message

MASS, G = 1.5, 9.8
GAINS = {"rollpitchProportionalGain": 10.0, "rollpitchDifferentialGain": 5.0, "rollpitchLimit": 0.5,
         "yawProportionalGain": 2.0, "yawLimit": 1.5,
         "velocityXYProportionalGain": 5.0, "velocityXYDifferentialGain": 1.0,
         "velocityXYLimit": 2.0,
         "velocityZProportionalGain": 5.0, "velocityZLimit": 0.5, "maxForce": 30.0}
MOTOR = {"Psi": 0.0072, "J_M": 2.6e-5, "R_A": 0.2, "k_t": 0.0153, "k_m": 1e-5, "alpha_m": 0.105,
         "beta_m": 0.55, "CT2s": 0.0, "CT1s": -1e-3, "CT0s": 1.54e-5, "l_m": 0.275}


def quadrotor(*plugins, z=0.1):
    body = Link("base_link", inertial=Inertial(MASS, ixx=0.0116, iyy=0.0116, izz=0.0218),
                collisions=[Collision("c", Box((0.4, 0.4, 0.1)))])
    return Model("quadrotor", Pose((0.0, 0.0, z)), links=[body], plugins=list(plugins))


def simple_controller():
    return plugin("libhector_gazebo_quadrotor_simple_controller.so", "".join(
        f"<{name}>{value}</{name}>" for name, value in GAINS.items()))


@pytest.fixture
def case():
    yield from kept(lambda *models, parameters=None: PluginCase(
        World(models=list(models), gravity=(0.0, 0.0, -G)), BulletBackend, parameters=parameters))


def fly(one, seconds, x=0.0, y=0.0, z=0.0, yaw=0.0, topic="cmd_vel"):
    one.deliver(topic, linear={"x": x, "y": y, "z": z}, angular={"x": 0.0, "y": 0.0, "z": yaw})
    one.sim.clock.advance(round(seconds * 1000))
    return one.sim.states.model_state("quadrotor")


def test_a_quadrotor_rises_hovers_and_follows_velocity_commands(case):
    one = case(quadrotor(simple_controller()))
    pose, twist = fly(one, 2.0, z=0.5)
    # A first-order lag of 1 / 5 s: v = 0.5 (1 - exp(-5 t)), so that 0.1 m are missing.
    assert twist.linear[2] == pytest.approx(0.5, rel=0.01)
    assert pose.position[2] == pytest.approx(0.1 + 0.5 * 2.0 - 0.1, abs=0.01)
    before = fly(one, 2.0)[0]
    pose, twist = fly(one, 1.0)
    assert pose.position == pytest.approx(before.position, abs=1e-3)   # it hovers
    assert twist.linear == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
    assert one.graph.on("wrench_out")[-1].force.z == pytest.approx(MASS * G, rel=1e-3)
    height = pose.position[2]
    pose, twist = fly(one, 3.0, x=1.0, y=-0.5)
    assert twist.linear == pytest.approx((1.0, -0.5, 0.0), abs=0.02)
    assert pose.position[2] == pytest.approx(height, abs=0.1)
    pose, twist = fly(one, 3.0, yaw=0.5)
    assert twist.angular[2] == pytest.approx(0.5, rel=0.01)
    yaw = rpy_from_quat(pose.orientation)[2]
    fly(one, 2.0)
    heading = rpy_from_quat(fly(one, 0.001)[0].orientation)[2]
    assert heading > yaw + 0.1
    _, twist = fly(one, 3.0, x=0.8)   # forward is where the body looks
    assert twist.linear[:2] == pytest.approx((0.8 * math.cos(heading), 0.8 * math.sin(heading)),
                                             abs=0.02)


def fly_drone(one, seconds, **command):
    return fly(one, seconds, topic="/cmd_vel", **command)


def test_an_sjtu_drone_takes_off_hovers_flies_to_a_place_and_lands(case):
    gains = {**GAINS, "velocityXYDifferentialGain": 2.3, "velocityZDifferentialGain": 1.0,
             "yawDifferentialGain": 1.0, "positionXYProportionalGain": 1.1,
             "positionXYDifferentialGain": 0.0, "positionXYLimit": 5.0,
             "positionZProportionalGain": 1.0, "positionZDifferentialGain": 0.2}
    one = case(quadrotor(plugin("libplugin_drone.so", "".join(
        f"<{name}>{value}</{name}>" for name, value in gains.items()))))
    assert fly_drone(one, 0.1, z=1.0)[1].linear[2] == pytest.approx(-0.98)   # its motors are off
    one.deliver("drone/takeoff")
    fly_drone(one, 1.0)
    before = fly_drone(one, 4.0)[0]
    # It hovers, but for g / 2 per step: its loop of gain 1 for the acceleration is not damped.
    assert fly_drone(one, 1.0)[0].position == pytest.approx(before.position, abs=0.006)
    assert fly_drone(one, 3.0, x=0.5)[1].linear == pytest.approx((0.5, 0.0, 0.0), abs=0.02)
    one.deliver("drone/posctrl", data=True)
    pose, _ = fly_drone(one, 9.0, x=1.0, y=-0.5, z=1.2)
    assert pose.position == pytest.approx((1.0, -0.5, 1.2), abs=0.02)
    one.deliver("drone/land")
    sinking = fly_drone(one, 2.0)[1].linear[2]
    assert fly_drone(one, 1.0)[1].linear[2] == pytest.approx(sinking - G)   # its motors are off


def balance(voltage):
    """Rotor speed and rising velocity at which torques and weight balance, by bisection."""
    def speed_at(climb):
        low, high = 0.0, 3000.0
        for _ in range(80):
            w = (low + high) / 2.0
            drive = voltage * MOTOR["beta_m"] - MOTOR["Psi"] * w
            current = (drive + math.sqrt(drive ** 2 + 4.0 * MOTOR["R_A"] * voltage
                                         * MOTOR["alpha_m"])) / (2.0 * MOTOR["R_A"])
            load = MOTOR["k_t"] * thrust(w, climb) + MOTOR["k_m"] * w
            low, high = (w, high) if MOTOR["Psi"] * current > load else (low, w)
        return low

    def thrust(w, climb):
        return MOTOR["CT0s"] * w * w + MOTOR["CT1s"] * w * climb

    low, high = -20.0, 20.0
    for _ in range(80):
        climb = (low + high) / 2.0
        rises = 4.0 * thrust(speed_at(climb), climb) > MASS * G
        low, high = (climb, high) if rises else (low, climb)
    return speed_at(low), low


class Stamp:
    def to_nsec(self):
        return 0


def test_a_quadrotor_rises_at_the_velocity_at_which_its_propellers_carry_it(case):
    steps = 162
    one = case(quadrotor(plugin("libhector_gazebo_quadrotor_propulsion.so", ""), z=200.0),
               parameters={"quadrotor_propulsion": MOTOR})
    one.deliver("motor_pwm", header=Message(stamp=Stamp()), pwm=[steps] * 4)
    one.sim.clock.advance(8500)
    speed, climb = balance(14.8 * steps / 255)
    pose, twist = one.sim.states.model_state("quadrotor")
    assert twist.linear[2] == pytest.approx(climb, abs=0.01)
    assert one.graph.on("motor_status")[-1].frequency == pytest.approx([speed] * 4, rel=1e-3)
    assert rpy_from_quat(pose.orientation) == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_a_falling_quadrotor_reaches_the_velocity_at_which_drag_carries_it(case):
    one = case(quadrotor(plugin("libhector_gazebo_quadrotor_aerodynamics.so", ""), z=500.0),
               parameters={"quadrotor_aerodynamics": {
                   "C_wxy": 0.12, "C_wz": 0.1, "C_mxy": 0.074, "C_mz": 0.05}})
    one.sim.clock.advance(2000)
    terminal = math.sqrt(MASS * G / 0.1)
    # v = v_t tanh(g t / v_t)
    fall = one.sim.states.model_state("quadrotor")[1].linear[2]
    assert fall == pytest.approx(-terminal * math.tanh(G * 2.0 / terminal), rel=2e-3)
    one.deliver("/wind", x=0.0, y=0.0, z=terminal)
    one.sim.clock.advance(6000)
    assert one.sim.states.model_state("quadrotor")[1].linear[2] == pytest.approx(0.0, abs=0.02)


AXIS = {"p": 2.0, "i": 1.0, "d": 0.0, "antiwindup": True, "i_clamp": 5.0}
CHAIN = {
    "position": {"type": "hector_quadrotor_controllers/PositionController",
                 **{axis: {"p": 2.0, "i": 0.0, "d": 0.0} for axis in ("x", "y", "z", "yaw")}},
    "velocity": {"type": "hector_quadrotor_controllers/VelocityController", "max_xy": 10.0,
                 "x": AXIS, "y": AXIS, "z": {**AXIS, "p": 5.0, "max": 5.0}},
    "attitude": {"type": "hector_quadrotor_controllers/AttitudeController", "max_roll_pitch": 0.8,
                 "roll": {"p": 100.0, "i": 0.0, "d": 20.0},
                 "pitch": {"p": 100.0, "i": 0.0, "d": 20.0},
                 "yawrate": {"p": 5.0, "i": 0.0, "d": 0.5, "max": 3.14}}}


def controlled():
    """A quadrotor with the chain of controllers of hector_quadrotor, and its motors running."""
    return quadrotor(plugin("libgazebo_ros_control.so", "<robotNamespace>/</robotNamespace>"
                            "<controlPeriod>0.01</controlPeriod><robotSimType>hector_quadrotor_"
                            "controller_gazebo/QuadrotorHardwareSim</robotSimType>"))


@pytest.fixture
def flying(case):
    one = case(controlled(), parameters={
        "controller": CHAIN, "world_frame": "world", "command_timeout": 0.5,
        "wrench_limits": {"force": {"z": {"min": 0.0, "max": 30.0}}}})
    names = [f"controller/{name}" for name in CHAIN]
    for name in names:
        assert one.ask("/controller_manager/load_controller", name=name).ok, one.issues
    assert one.ask("/controller_manager/switch_controller", start_controllers=names,
                   stop_controllers=[], strictness=2).ok, one.issues
    assert one.ask("/enable_motors", enable=True).success
    return one


def turned(yaw):
    return {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2.0), "w": math.cos(yaw / 2.0)}


def test_hectors_controllers_hover_at_a_pose_and_follow_velocities(flying):
    flying.deliver("/command/pose", header={"frame_id": "world", "stamp": Stamp()},
                pose={"position": {"x": 1.0, "y": -0.5, "z": 2.0}, "orientation": turned(0.7)})
    flying.sim.clock.advance(10000)
    pose, twist = flying.sim.states.model_state("quadrotor")
    assert pose.position == pytest.approx((1.0, -0.5, 2.0), abs=0.02)
    assert rpy_from_quat(pose.orientation) == pytest.approx((0.0, 0.0, 0.7), abs=0.01)
    assert twist.linear == pytest.approx((0.0, 0.0, 0.0), abs=0.01)
    force = flying.graph.on("/command/wrench")[-1].wrench.force
    assert force.z == pytest.approx(MASS * G, rel=1e-3)
    for _ in range(25):   # ends position control; commands last for 0.5 s
        flying.deliver("/cmd_vel", linear={"x": 1.0, "y": 0.0, "z": 0.2},
                    angular={"x": 0.0, "y": 0.0, "z": 0.0})
        flying.sim.clock.advance(200)
    _, twist = flying.sim.states.model_state("quadrotor")
    assert twist.linear == pytest.approx((math.cos(0.7), math.sin(0.7), 0.2), abs=0.03)
    before = twist.linear[2]
    flying.sim.clock.advance(1500)   # 0.3 s later the command is too old, and it sinks
    pose, twist = flying.sim.states.model_state("quadrotor")
    assert twist.linear[2] == pytest.approx(before - 0.5 * 1.2 ** 2, abs=0.05)
    assert rpy_from_quat(pose.orientation)[:2] == pytest.approx((0.0, 0.0), abs=0.05)
    assert flying.ask("/enable_motors", enable=False).success
    flying.sim.clock.advance(1000)
    assert flying.sim.states.model_state("quadrotor")[1].linear[2] == pytest.approx(
        twist.linear[2] - G, abs=0.05)


# -- RotorS --------------------------------------------------------------------------------------

THRUST, MOMENT, ARM, ROTOR_MASS = 8.54858e-06, 0.016, 0.2, 0.005
ARMS = ((ARM, 0.0), (0.0, ARM), (-ARM, 0.0), (0.0, -ARM))
WAYS = (1.0, -1.0, 1.0, -1.0)   # counter-clockwise and clockwise
TOTAL = MASS + 4 * ROTOR_MASS


def rotors_model():
    """A body with four rotors, and the plugins of RotorS."""
    body = Link("base_link", inertial=Inertial(MASS, ixx=0.03, iyy=0.03, izz=0.06),
                collisions=[Collision("c", Box((0.3, 0.3, 0.1)))])
    links, joints, plugins = [body], [], []
    for number, ((x, y), way) in enumerate(zip(ARMS, WAYS)):
        links.append(Link(f"rotor_{number}", Pose((x, y, 0.0)),
                          Inertial(ROTOR_MASS, ixx=1e-6, iyy=4e-5, izz=4e-5)))
        joints.append(Joint(f"rotor_{number}_joint", "continuous", "base_link", f"rotor_{number}",
                            axis=JointAxis((0.0, 0.0, 1.0))))
        plugins.append(plugin(
            "librotors_gazebo_motor_model.so",
            f"<robotNamespace>mav</robotNamespace><jointName>rotor_{number}_joint</jointName>"
            f"<linkName>rotor_{number}</linkName><motorNumber>{number}</motorNumber>"
            f"<turningDirection>{'ccw' if way > 0.0 else 'cw'}</turningDirection>"
            "<commandSubTopic>gazebo/command/motor_speed</commandSubTopic>"
            f"<motorSpeedPubTopic>motor_speed/{number}</motorSpeedPubTopic>"))
    plugins.append(plugin("librotors_gazebo_odometry_plugin.so",
                          "<robotNamespace>mav</robotNamespace><linkName>base_link</linkName>"))
    return Model("mav", Pose((0.0, 0.0, 0.06)), links=links, joints=joints, plugins=plugins)


def rotor_speeds(told, velocity, position=None, heading=0.0):
    """Speeds that make a multirotor move at a velocity, or stay at a position, by its odometry.

    A geometric controller (Lee, Leok, McClamroch 2010): the thrust is the wanted force along the
    axis of the body, the torque turns that axis towards the force.
    """
    at, turn = told.pose.pose.position, told.pose.pose.orientation
    turn = (turn.x, turn.y, turn.z, turn.w)
    linear, angular = told.twist.twist.linear, told.twist.twist.angular
    moving = np.array(rotate(turn, (linear.x, linear.y, linear.z)))
    lack = 2.5 * (np.array(velocity) - moving)
    if position is not None:
        lack = lack + 2.0 * (np.array(position) - np.array((at.x, at.y, at.z)))
    force = TOTAL * (lack + np.array((0.0, 0.0, G)))
    body = np.array([rotate(turn, axis) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]).T
    up = force / np.linalg.norm(force)
    left = np.cross(up, (math.cos(heading), math.sin(heading), 0.0))
    left /= np.linalg.norm(left)
    wanted = np.array([np.cross(left, up), left, up]).T
    skew = wanted.T @ body - body.T @ wanted
    error = 0.5 * np.array((skew[2, 1], skew[0, 2], skew[1, 0]))
    rate = np.array((angular.x, angular.y, angular.z))
    torque = -np.array((0.03, 0.03, 0.06)) * (60.0 * error + 14.0 * rate)
    thrusts = np.linalg.solve(np.array([(1.0, y, -x, -way * MOMENT)
                                        for (x, y), way in zip(ARMS, WAYS)]).T,
                              (force @ body[:, 2], *torque))
    return [math.sqrt(max(0.0, value) / THRUST) for value in thrusts]


def steer(one, seconds, **wanted):
    """Have a controller fly at 100 Hz by what the odometry says."""
    for _ in range(round(seconds * 100)):
        told = one.last("mav/odometry", one.now())
        one.graph.sent.clear()
        one.deliver("mav/gazebo/command/motor_speed",
                 angular_velocities=rotor_speeds(told, **wanted))
        one.sim.clock.advance(10)
    return one.last("mav/odometry", one.now())


def test_a_multirotor_of_rotors_hovers_where_its_controller_says_and_follows_velocities(case):
    one = case(rotors_model())
    one.graph.ignored |= {"mav/pose", "mav/pose_with_covariance", "mav/position", "mav/transform"}
    one.sim.clock.advance(10)
    still = (0.0, 0.0, 0.0)
    steer(one, 6.0, velocity=still, position=(0.5, -0.5, 1.0))
    pose, twist = one.sim.states.model_state("mav")
    assert pose.position == pytest.approx((0.5, -0.5, 1.0), abs=0.01)
    assert twist.linear == pytest.approx(still, abs=0.01)
    # Each rotor carries a quarter of the weight.
    speeds = [one.graph.on(f"mav/motor_speed/{number}")[-1].data * 10.0 for number in range(4)]
    hover = math.sqrt(TOTAL * G / 4.0 / THRUST)
    assert [abs(speed) for speed in speeds] == pytest.approx([hover] * 4, rel=5e-3)
    assert [math.copysign(1.0, speed) for speed in speeds] == list(WAYS)
    steer(one, 3.0, velocity=(1.0, 0.5, 0.2))
    _, twist = one.sim.states.model_state("mav")
    # The drag of the rotors along the ground, 4 k w v, is what the controller's gain leaves.
    left = 2.5 * TOTAL / (2.5 * TOTAL + 4.0 * 1e-4 * hover)
    assert twist.linear == pytest.approx((1.0 * left, 0.5 * left, 0.2), abs=0.02)


@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005])
def test_the_torque_on_a_rotor_turns_the_body_the_other_way(case, step_size):
    model = rotors_model()
    model.plugins = [one for one in model.plugins if "motor_model" in one.filename]
    one = case(replace(model, pose=Pose((0.0, 0.0, 100.0))))
    physics = one.sim.physics
    physics.set(replace(physics.settings, max_step_size=step_size), physics.gravity)
    hover = math.sqrt(TOTAL * G / 4.0 / THRUST)
    fast, slow = hover * 1.05, math.sqrt(2.0 - 1.05 ** 2) * hover

    def command(*speeds):
        one.deliver("mav/gazebo/command/motor_speed", angular_velocities=speeds)
        one.sim.clock.advance(round(1.0 / step_size))

    command(hover, hover, hover, hover)
    before = one.sim.states.model_state("mav")[1]
    command(fast, slow, fast, slow)   # the weight is carried, the counter-clockwise ones are faster
    twist = one.sim.states.model_state("mav")[1]
    # The torque of the air, what the rotors took as they became faster, and the drag of the rotors
    # along their circle.
    torque = MOMENT * THRUST * 2.0 * (fast ** 2 - slow ** 2)
    gained = 2.0 * 4e-5 * (fast - slow) / 10.0
    lag = (1.0 / 80.0 + 1.0 / 40.0) / 2.0
    whole = 0.06 + 4.0 * (4e-5 + ROTOR_MASS * ARM ** 2)
    damping = 2.0 * (fast + slow) * 1e-4 * ARM ** 2
    left = math.exp(-damping * (1.0 - lag) / whole)
    assert twist.angular[2] == pytest.approx(
        -torque / damping * (1.0 - left) - gained / whole * left, rel=0.005)
    assert twist.linear[2] == pytest.approx(before.linear[2], abs=0.02)
