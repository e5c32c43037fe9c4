"""libgazebo_ros_power_monitor.so: the charge of PR2's batteries.

Source: pr2_gazebo_plugins, gazebo_ros_power_monitor.cpp; parameters, topics and law are its own.
Where it differs: `<powerStateRate>` is used as there, as a period in s; the charge also changes
while the topic has no subscriber; a charger changes the power by its `charge_rate` once, not with
each message. The messages come from the packages pr2_msgs and pr2_gazebo_plugins.
"""
from __future__ import annotations

import math
from typing import Any, Tuple

from ..base import Plugin
from ..context import PluginError
from ..frames import stamp_message

_AC_PRESENT = 4                                 # chargers
_UNKNOWN_S = 65535                              # time remaining without a current


class PowerMonitor(Plugin):
    """Publishes pr2_msgs/PowerState."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._capacity = p.positive("fullChargeCapacity", 80.0)        # A h
        self._discharge = p.number("dischargeRate", -500.0)            # W
        self._charging = p.number("chargeRate", 1000.0)                # W
        self._voltage = p.number("dischargeVoltage", 16.0)             # V
        self._period = p.positive("powerStateRate", 1.0)               # s
        self._topic = context.publish(p.text("powerStateTopic", "power_state"),
                                      "pr2_msgs/PowerState", 10)
        try:
            context.subscribe("plugged_in", "pr2_gazebo_plugins/PlugCommand", self._plug, 10)
        except PluginError as missing:
            context.warn(f"the topic plugged_in is not available: {missing}")
        self.reset()
        context.observe(1.0 / self._period, self._publish, [self._topic], remembers=True)

    def reset(self) -> None:
        self._charge, self._power, self._is_plugged = self._capacity, self._discharge, False

    def _plug(self, message: Any) -> None:
        if message.charge_rate > 0.0:
            self._charging = float(message.charge_rate)
        if message.discharge_rate < 0.0:
            self._discharge = float(message.discharge_rate)
        self._charge = float(message.charge)
        self._is_plugged = bool(message.ac_present)
        self._power = self._discharge + (self._charging if self._is_plugged else 0.0)

    def _publish(self) -> None:
        current = self._power / self._voltage if self._voltage > 0.0 else 0.0
        self._charge = max(0.0, min(self._capacity, self._charge + self._period / 3600.0 * current))
        message = stamp_message(self.context, "pr2_msgs/PowerState")
        message.power_consumption = self._power
        message.time_remaining.secs, message.time_remaining.nsecs = self._remaining(current)
        message.prediction_method = "fuel gauge"
        message.relative_capacity = int(100.0 * self._charge / self._capacity)
        message.AC_present = _AC_PRESENT if self._is_plugged else 0
        self._topic.publish(message)

    def _remaining(self, current: float) -> Tuple[int, int]:
        """s and ns until the batteries are empty, or full; as the original in minutes per hour."""
        missing = self._capacity - self._charge
        if current < 0.0:
            seconds = self._charge / -current * 60.0
        elif missing == 0.0:
            return 0, 0
        elif current == 0.0:
            return _UNKNOWN_S, _UNKNOWN_S
        else:
            seconds = missing / current * 60.0
        part, whole = math.modf(seconds)
        return int(whole), int(part * 1e9)
