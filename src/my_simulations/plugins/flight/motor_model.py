"""librotors_gazebo_motor_model.so: a rotor of a multirotor.

Parameters, defaults, topics and laws are those of rotors_gazebo_plugins; the drag of a rotor is
that of Martin and Salaun, The True Role of Accelerometer Feedback in Quadrotor Control, ICRA 2010.
Where it differs: the moments act on the rotor, whose motor passes them on to the body that carries
it, and acts back on that body when it accelerates; nothing acts before the first command.
"""
from __future__ import annotations

import math
from typing import Any, Callable, Sequence

from ...engine.drive_commands import JointServo, PidGains
from ...engine.wrench_laws import Rotor
from ...geometry import ZERO3, Vec3
from ..base import Plugin
from ..context import PluginError
from ..finite_messages import subscribe_finite
from ..frames import data_message

ACTUATORS = "mav_msgs/Actuators"
_MOTOR_EFFORT = 1e3   # N m: the motor follows its speed in one step
_TURNS = {"ccw": 1.0, "cw": -1.0}


class MotorModel(Plugin):
    """Turns `<jointName>`; thrust, drag and their moments act on `<linkName>`.

    The engine computes both, so that only commands cost a synchronization.
    """

    def load(self) -> None:
        context, p = self.enter_namespace()
        joint, link, _ = map(self.required_text, ("jointName", "linkName", "motorNumber"))
        self._joint, self._link = context.joint(joint), context.link(link)
        self._number = p.integer("motorNumber", 0)
        self._direction = p.choice("turningDirection", _TURNS, -1.0)
        self._kind = p.text("motorType", "velocity")
        if self._kind not in ("velocity", "position", "force"):
            raise PluginError(f"<motorType> must be velocity, position or force, it is"
                              f" '{self._kind}'")
        self._most_speed = p.number("maxRotVelocity", 838.0)
        self._thrust_constant = p.number("motorConstant", 8.54858e-06)
        self._moment_constant = p.number("momentConstant", 0.016)
        self._drag = p.number("rotorDragCoefficient", 1.0e-4)
        self._rolling = p.number("rollingMomentCoefficient", 1.0e-6)
        self._up_time = p.positive("timeConstantUp", 1.0 / 80.0)
        self._down_time = p.positive("timeConstantDown", 1.0 / 40.0)
        self._slowdown = p.positive("rotorVelocitySlowdownSim", 10.0)
        command = p.text("commandSubTopic", "command/motor_speed")
        subscribe_finite(context, command, ACTUATORS, self._receive)
        self._offer_wind(p.text("windSpeedSubTopic", "wind_speed"))
        self._offer_states()
        self._commanded = False

    def _offer_wind(self, topic: str) -> None:
        self._wind: Vec3 = ZERO3
        try:
            subscribe_finite(self.context, topic, "rotors_comm/WindSpeed", self._receive_wind)
        except PluginError as missing:
            self.context.info(f"no wind by a topic: {missing}")

    def _offer_states(self) -> None:
        """Speed, and with a topic also position and effort, in every step with a subscriber."""
        p, joint = self.context.parameters, self._joint
        self._publish_value(p.text("motorSpeedPubTopic", "motor_speed"), lambda: joint.velocity)
        if p.text("motorPositionPubTopic"):
            self._publish_value(p.text("motorPositionPubTopic"), lambda: joint.position)
        if p.text("motorForcePubTopic"):
            self._publish_value(p.text("motorForcePubTopic"),
                                lambda: self.context.efforts([joint.name])[0], [joint.name])

    def _publish_value(self, name: str, read: Callable[[], float],
                       efforts: Sequence[str] = ()) -> None:
        topic = self.context.publish(name, "std_msgs/Float32")

        def publish() -> None:
            topic.publish(data_message(self.context, "std_msgs/Float32", read()))

        self.context.observe(0.0, publish, [topic], efforts=efforts)

    def reset(self) -> None:
        if self._commanded:
            self._commanded = False
            self._joint.set_servo(JointServo(0, ""))
            self.context.set_wrench(self._link.name, ZERO3, ZERO3)

    def _receive_wind(self, message: Any) -> None:
        self._wind = (message.velocity.x, message.velocity.y, message.velocity.z)
        if self._commanded:
            self._apply_air()

    def _receive(self, message: Any) -> None:
        values = message.angular_velocities
        if self._number >= len(values):
            self.context.warn(f"a command for {len(values)} motors has none for motor"
                              f" {self._number}")
            return
        wanted = float(values[self._number])
        if self._kind == "velocity":
            self._turn(min(wanted, self._most_speed))
        elif self._kind == "force":
            self._joint.set_servo(JointServo(0, "effort", target=wanted))
        else:
            self._joint.set_servo(self._position_servo(wanted))

    def _turn(self, speed: float) -> None:
        """Have the rotor follow a speed, rad/s of the real one, and the air act on it."""
        # A clockwise rotor is slower when its rate rises.
        lags = (self._up_time, self._down_time)
        self._joint.set_servo(JointServo(
            0, "velocity", target=self._direction * speed / self._slowdown,
            lags=lags if self._direction > 0.0 else lags[::-1], most_effort=_MOTOR_EFFORT))
        if not self._commanded:
            self._commanded = True
            self._apply_air()

    def _apply_air(self) -> None:
        slow = self._slowdown
        self.context.set_wrench_law(self._link.name, Rotor(
            self._direction * self._thrust_constant * slow * slow, self._moment_constant,
            self._drag * slow, self._rolling * slow, self._wind), self._joint.name)

    def _position_servo(self, angle: float) -> JointServo:
        found = self.context.parameters.children("joint_control_pid")
        if not found:
            raise PluginError("it has no <joint_control_pid>")
        pid = found[0]
        most = pid.number("cmdMax", 0.0)
        return JointServo(
            0, "effort", target=angle, wraps=True, most_effort=most if most > 0.0 else math.inf,
            gains=PidGains(pid.number("p", 0.0), pid.number("i", 0.0), pid.number("d", 0.0),
                           -abs(pid.number("iMin", 0.0)), abs(pid.number("iMax", 0.0))))
