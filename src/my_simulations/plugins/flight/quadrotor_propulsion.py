"""libhector_gazebo_quadrotor_propulsion.so: four motors with propellers, driven by voltages.

Parameters, defaults, topics and laws are those of hector_quadrotor_gazebo_plugins and
hector_quadrotor_model. Where it differs: the world does not wait for commands. A command acts
`<controlDelay>` after its stamp, or at once if that is past, and `<controlTolerance>` has no
effect. With a `<controlRate>` the motors stop 1 s of sim time after the last command. Wrench and
status are published from the first command on.
"""
from __future__ import annotations

import math
from collections import deque
from dataclasses import replace
from typing import Any, Deque, List, NamedTuple, Optional, Sequence, Tuple

from ...engine.wrench_laws import BodyDrag, Wrench, clamped_vector
from ...geometry import Vec3, is_number
from ..base import Plugin
from ..call_slot import CallSlot
from ..context import Context, PluginError
from ..finite_messages import subscribe_finite
from ..frames import stamp_message
from ..standard_messages import wrench_message
from ..time_out import Stopwatch
from .body_wrench import body_twist, push_at_origin

_PWM_STEPS = 255
_COMMAND_END_NS = 10 ** 9
_SUPPLY_HZ = 1.0
_TURNS = 1.0   # rad/s: a motor that turns faster counts as running


class MotorConstants(NamedTuple):
    """Parameters of a motor with its propeller, by their names in hector_quadrotor_model.

    Attributes:
        k_t: torque per thrust, m.
        k_m: friction, N m s.
        CT0s, CT1s, CT2s: of the thrust, for the speed of the rotor squared, for its product with
            the speed of the air, and for that squared.
        Psi: torque per current, N m / A.
        J_M: inertia of motor and propeller, kg m^2.
        R_A: ohm.
        alpha_m, beta_m: of the current, for the voltage.
        l_m: m from the middle of the body to a rotor.
    """

    k_t: float
    k_m: float
    CT0s: float
    CT1s: float
    CT2s: float
    Psi: float
    J_M: float
    R_A: float
    alpha_m: float
    beta_m: float
    l_m: float


class Rotor(NamedTuple):
    """State of a motor: its speed in rad/s, and the thrust, torque and current of the last step."""

    speed: float = 0.0
    thrust: float = 0.0
    torque: float = 0.0
    current: float = 0.0

    def advance(self, constants: MotorConstants, voltage: float, air: float, dt: float) -> "Rotor":
        """Return the state `dt` s later; `air` is the speed of the rotor along its axis, m/s.

        Source: hector_quadrotor_model, quadrotorPropulsion. Thrust F = CT0s w^2 + CT1s w v -+ CT2s
        v^2; current I from a quadratic characteristic; torque M = Psi I; J_M dw/dt = M - k_t F -
        k_m w.
        """
        thrust = (constants.CT0s * self.speed ** 2 + constants.CT1s * air * self.speed
                  - math.copysign(constants.CT2s * air ** 2, air))
        half = (voltage * constants.beta_m - constants.Psi * self.speed) / (2.0 * constants.R_A)
        current = half + math.sqrt(max(0.0, half ** 2 + voltage * constants.alpha_m
                                       / constants.R_A))
        torque = constants.Psi * current
        change = (torque - constants.k_t * thrust - constants.k_m * self.speed) / constants.J_M
        return Rotor(self.speed + dt * change, thrust, torque, current)


def rotor_speeds_along(velocity: Vec3, spin: Vec3, arm: float) -> Tuple[float, ...]:
    """Speeds along z of the rotors at the front, right, rear and left, m/s, in body axes."""
    return (velocity[2] - arm * spin[1], velocity[2] - arm * spin[0],
            velocity[2] + arm * spin[1], velocity[2] + arm * spin[0])


def wrench_of(rotors: Sequence[Rotor], arm: float) -> Wrench:
    """The wrench of rotors at the front, right, rear and left, in body axes."""
    front, right, rear, left = (rotor.thrust for rotor in rotors)
    yaw = rotors[0].torque - rotors[1].torque + rotors[2].torque - rotors[3].torque
    return ((0.0, 0.0, front + right + rear + left),
            ((left - right) * arm, (rear - front) * arm, yaw))


class QuadrotorPropulsion(Plugin):
    """Acts on the first link of the model."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link("")
        namespace = p.text("paramNamespace", "quadrotor_propulsion")
        self._constants = MotorConstants(*model_parameters(
            context, namespace, list(MotorConstants._fields)))
        self._voltage = float(context.parameter(f"{namespace}/supply_voltage",
                                                p.number("supplyVoltage", 14.8)))
        self._delay_ns = round(p.number("controlDelay", 0.0) * 1e9)
        self._control_hz = p.number("controlRate", 0.0)
        self._status_ns = round(1e9 / p.positive("motorStatusRate", 1e9)) \
            if p.number("motorStatusRate", 0.0) > 0.0 else 0
        for name, kind, read in (
                (p.text("topicName", "command/motor"), "MotorCommand", self._receive_voltages),
                (p.text("voltageTopicName") or p.text("pwmTopicName", "motor_pwm"), "MotorPWM",
                 self._receive_pwm)):
            if name:
                subscribe_finite(context, name, f"hector_uav_msgs/{kind}", read)
        self._frame = p.text("frameId", self._link.name)
        self._trigger = context.publish(p.text("triggerTopic", "quadro/trigger"),
                                        "rosgraph_msgs/Clock", 10)
        self._wrenches = context.publish(p.text("wrenchTopic", "propulsion/wrench"),
                                         "geometry_msgs/WrenchStamped", 10)
        self._supply = context.publish(p.text("supplyTopic", "supply"), "hector_uav_msgs/Supply",
                                       10, latch=True)
        self._status = context.publish(p.text("statusTopic", "motor_status"),
                                       "hector_uav_msgs/MotorStatus", 10)
        if self._control_hz > 0.0:
            context.observe(self._control_hz, self._publish_trigger, [self._trigger])
        if p.text("supplyTopic", "supply"):
            self._publish_supply()
            context.observe(_SUPPLY_HZ, self._publish_supply, [self._supply])
        self._timer = CallSlot()
        self.reset()

    def reset(self) -> None:
        self._timer.end()
        self._rotors = [Rotor()] * 4
        self._voltages = [0.0] * 4
        self._on = False
        self.clock_set()

    def clock_set(self) -> None:
        """Commands of another time are lost."""
        self._queue: Deque[Tuple[int, List[float]]] = deque()
        self._last_command_ns = self.context.now_ns
        self._stopwatch = Stopwatch(self.context)
        self._next_status_ns = 0

    # -- commands --------------------------------------------------------------------------------

    def _receive_voltages(self, message: Any) -> None:
        steps = [min(_PWM_STEPS, max(0, round(value / self._voltage * _PWM_STEPS)))
                 for value in message.voltage]
        self._add(message.header.stamp, steps)

    def _receive_pwm(self, message: Any) -> None:
        self._add(message.header.stamp, list(message.pwm))

    def _add(self, stamp: Any, steps: Sequence[int]) -> None:
        """Queue a command: for each motor a part of the voltage in 255 steps."""
        volts = [step * self._voltage / _PWM_STEPS for step in steps[:4]]
        ns = int(stamp.to_nsec())
        due = ns + self._delay_ns if ns else self.context.now_ns
        self._queue.append((due, volts if len(volts) == 4 else [0.0] * 4))
        self._on = True
        self._last_command_ns = self.context.now_ns
        if not self._timer.is_active:
            self._stopwatch.restart()
            self._timer.set(self.context.every(0.0, self.update))

    def _apply_commands(self) -> None:
        now = self.context.now_ns
        while self._queue and self._queue[0][0] <= now:
            self._voltages = self._queue.popleft()[1]
        if self._control_hz > 0.0 and now - self._last_command_ns > _COMMAND_END_NS and self._on:
            self._on, self._voltages = False, [0.0] * 4
            self.context.warn("no motor command for 1 s; the motors stop")

    # -- motors ----------------------------------------------------------------------------------

    def update(self) -> None:
        dt = self._stopwatch.lap()
        self._apply_commands()
        velocity, spin = (clamped_vector(one, MOST_VELOCITY) for one in body_twist(self._link))
        arm = self._constants.l_m
        self._rotors = [rotor.advance(self._constants, voltage, air, dt)
                        for rotor, voltage, air in zip(self._rotors, self._voltages,
                                                       rotor_speeds_along(velocity, spin, arm))]
        wrench = wrench_of(self._rotors, arm)
        push_at_origin(self.context, self._link, wrench)
        if self._wrenches.wanted:
            self._wrenches.publish(wrench_message(self.context, self._frame, wrench))
        if self._status.wanted and self.context.now_ns >= self._next_status_ns:
            self._next_status_ns = self.context.now_ns + self._status_ns
            self._publish_status()

    def _publish_status(self) -> None:
        message = stamp_message(self.context, "hector_uav_msgs/MotorStatus")
        message.on = self._on
        message.running = all(rotor.speed > _TURNS for rotor in self._rotors)
        message.voltage = list(self._voltages)
        message.frequency = [rotor.speed for rotor in self._rotors]
        message.current = [rotor.current for rotor in self._rotors]
        self._status.publish(message)

    def _publish_trigger(self) -> None:
        message = self.context.message("rosgraph_msgs/Clock")
        message.clock = self.context.stamp()
        self._trigger.publish(message)

    def _publish_supply(self) -> None:
        message = stamp_message(self.context, "hector_uav_msgs/Supply")
        message.voltage = [self._voltage]
        message.current = []
        self._supply.publish(message)


MOST_VELOCITY = 100.0   # m/s and rad/s: faster motion counts as this (hector_quadrotor_model)


class QuadrotorAerodynamics(Plugin):
    """libhector_gazebo_quadrotor_aerodynamics.so: drag of the first link in the wind.

    Parameters, topics and law are those of hector_quadrotor_gazebo_plugins and
    hector_quadrotor_model: with the velocity v of the body relative to the wind and its angular
    velocity w, both in its axes, the drag is (C_wxy v_x, C_wxy v_y, C_wz v_z) |v| and the moment
    (C_mxy w_x, C_mxy w_y, C_mz w_z) |w|, against the motion. Where it differs: the axes are those
    of the body at any roll angle (the original turns them the wrong way about x); the wind of the
    world counts until one comes on `<windTopicName>`.
    """

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link("")
        across, along, turn_across, turn_along = model_parameters(
            context, p.text("paramNamespace", "quadrotor_aerodynamics"),
            ["C_wxy", "C_wz", "C_mxy", "C_mz"])
        self._drag = BodyDrag((across, across, along), (turn_across, turn_across, turn_along),
                              context.wind, MOST_VELOCITY)
        context.set_wrench_law(self._link.name, self._drag)
        self._wind: Optional[Vec3] = None
        topic = p.text("windTopicName", "/wind")
        if topic:
            subscribe_finite(context, topic, "geometry_msgs/Vector3", self._receive)
        self._frame = p.text("frameId", self._link.name)
        self._wrenches = context.publish(p.text("wrenchTopic", "aerodynamics/wrench"),
                                         "geometry_msgs/WrenchStamped", 10)
        context.observe(0.0, self._publish, [self._wrenches])
        context.on_world_change(self.update)

    def reset(self) -> None:
        """Drag ended with the reset. The wind is that of the world."""
        self._wind = None
        self._drag = replace(self._drag, wind=self.context.wind)
        self.context.set_wrench_law(self._link.name, self._drag)

    def _receive(self, message: Any) -> None:
        self._wind = (message.x, message.y, message.z)
        self.update()

    def update(self) -> None:
        wind = self.context.wind if self._wind is None else self._wind
        if wind != self._drag.wind:
            self._drag = replace(self._drag, wind=wind)
            self.context.set_wrench_law(self._link.name, self._drag)

    def _publish(self) -> None:
        self._wrenches.publish(wrench_message(self.context, self._frame, self._drag.in_body_axes(
            self._link.pose, self._link.twist)))


def model_parameters(context: Context, namespace: str, names: List[str]) -> List[float]:
    """Numbers of the parameter server below a namespace.

    Raises PluginError if one is missing or not a number.
    """
    found = []
    for name in names:
        value = context.parameter(f"{namespace}/{name}", None)
        if not is_number(value):
            raise PluginError(f"parameter {namespace}/{name} must be a number, it is {value!r}: is"
                              " the parameter file of the model loaded?")
        found.append(float(value))
    return found
