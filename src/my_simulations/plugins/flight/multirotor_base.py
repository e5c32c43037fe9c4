"""librotors_gazebo_multirotor_base_plugin.so and librotors_gazebo_controller_interface.so.

Parameters, defaults and topics are those of rotors_gazebo_plugins. The first publishes the joints
and speeds of all rotors of a body, the second passes the commands of a controller to the rotors,
each one once.
"""
from __future__ import annotations

import re
from typing import Any, Dict

from ..base import Plugin
from ..context import Joint, PluginError
from ..frames import stamp_message
from ..standard_messages import joint_state_message
from .motor_model import ACTUATORS

_ROTOR = re.compile(r"rotor_(\d+)")


class MultirotorBase(Plugin):
    """Of the rotors whose joints are on `<linkName>` and whose links are called rotor_NUMBER."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._base = context.link(p.text("linkName", "base_link")).name
        self._slowdown = p.number("rotorVelocitySlowdownSim", 10.0)
        found: Dict[int, Joint] = {}
        for joint in context.description.joints:
            number = _ROTOR.search(joint.child)
            if joint.parent == self._base and number is not None and joint.type != "fixed":
                found[int(number.group(1))] = context.joint(joint.name)
        self._joints = [found[number] for number in sorted(found)]
        self._states = context.publish("joint_states", "sensor_msgs/JointState")
        context.observe(0.0, self._publish_states, [self._states])
        try:
            self._speeds = context.publish(p.text("motorPubTopic", "motor_speed"), ACTUATORS, 10)
        except PluginError as missing:
            context.warn(f"no speeds of rotors: {missing}")
            return
        context.observe(0.0, self._publish_speeds, [self._speeds])

    def _publish_states(self) -> None:
        self._states.publish(joint_state_message(self.context, self._joints, self._base,
                                                 velocities=False))

    def _publish_speeds(self) -> None:
        message = stamp_message(self.context, ACTUATORS, self._base)
        message.angular_velocities = [joint.velocity * self._slowdown for joint in self._joints]
        self._speeds.publish(message)


class ControllerInterface(Plugin):
    """From `<commandMotorSpeedSubTopic>` to `<motorSpeedCommandPubTopic>`."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._rotors = context.publish(
            p.text("motorSpeedCommandPubTopic", "gazebo/command/motor_speed"), ACTUATORS)
        context.subscribe(p.text("commandMotorSpeedSubTopic", "command/motor_speed"), ACTUATORS,
                          self._pass_on)

    def _pass_on(self, command: Any) -> None:
        message = stamp_message(self.context, ACTUATORS)
        message.angular_velocities = list(command.angular_velocities)
        self._rotors.publish(message)
