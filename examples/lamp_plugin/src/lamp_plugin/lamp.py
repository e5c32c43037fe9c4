"""liblamp.so: turns a joint back and forth and publishes its position.

Parameters: `<joint>` its name, `<rate>` rad/s, `<limit>` rad, `<updateRate>` Hz.
Topics: `lamp` (std_msgs/Float64, rad) and `lamp_rate` (std_msgs/Float64, rad/s, 0 to stop).
"""
from __future__ import annotations

from typing import Any

from my_simulations.plugins.base import Plugin
from my_simulations.plugins.context import PluginError

_EFFORT = 2.0   # N m at most


class Lamp(Plugin):
    """A lamp that warns."""

    def load(self) -> None:
        """Read the parameters, find the joint, and advertise the topics."""
        context, p = self.context, self.context.parameters
        self._joint = context.joint(p.text("joint", "lamp_joint"))
        self._rate, self._limit = p.number("rate", 1.0), p.number("limit", 0.5)
        if self._limit <= 0.0:
            raise PluginError("<limit> must be above 0")
        self._topic = context.publish("lamp", "std_msgs/Float64")
        context.subscribe("lamp_rate", "std_msgs/Float64", self._receive)
        hertz = p.number("updateRate", 50.0)
        context.every(hertz, self._turn)                    # acts: the world waits for it
        context.observe(hertz, self._publish, [self._topic])   # reads only

    def _receive(self, message: Any) -> None:
        self._rate = message.data

    def _turn(self) -> None:
        beyond = abs(self._joint.position) > self._limit
        if beyond and self._joint.position * self._rate > 0.0:
            self._rate = -self._rate
        self._joint.drive(self._rate, _EFFORT)

    def _publish(self) -> None:
        message = self.context.message("std_msgs/Float64")
        message.data = self._joint.position
        self._topic.publish(message)
