"""librotors_gazebo_wind_plugin.so: a constant force and a gust on a link, and the wind's speed.

Parameters, defaults and topics are those of rotors_gazebo_plugins. Where it differs: fields of wind
in files (`<useCustomStaticWindField>`) are not supported.
"""
from __future__ import annotations

from typing import List, Optional

from ...engine.wrench_laws import ForceAtPoint
from ...geometry import ZERO3, Vec3, add, scale, unit
from ...geometry_messages import fill_vector
from ..base import Plugin
from ..context import CallHandle, PluginError, Publication
from ..frames import stamp_message
from ..standard_messages import wrench_message


class RotorsWind(Plugin):
    """Acts on `<linkName>` at `<xyzOffset>`."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(p.text("linkName", "base_link"))
        self._offset, self._frame = p.vector("xyzOffset"), p.text("frameId", "world")
        if p.flag("useCustomStaticWindField", False):
            context.warn("<useCustomStaticWindField> is not supported; the wind has the speed"
                         " <windSpeedMean> everywhere")
        way = unit(p.vector("windDirection", (1.0, 0.0, 0.0)))
        self._steady = scale(way, p.number("windForceMean", 0.0))
        self._gust = scale(unit(p.vector("windGustDirection", (0.0, 1.0, 0.0))),
                           p.number("windGustForceMean", 0.0))
        self._velocity = scale(way, p.number("windSpeedMean", 0.0))
        start = p.number("windGustStart", 10.0)
        self._gust_ns = (round(start * 1e9),
                         round((start + p.number("windGustDuration", 0.0)) * 1e9))
        self._force = context.publish(p.text("windForcePubTopic", "external_force"),
                                      "geometry_msgs/WrenchStamped")
        context.observe(0.0, self._publish_force, [self._force])
        self._speed: Optional[Publication] = None
        try:
            self._speed = context.publish(p.text("windSpeedPubTopic", "wind_speed"),
                                          "rotors_comm/WindSpeed")
            context.observe(0.0, self._publish_speed, [self._speed])
        except PluginError as missing:
            context.info(f"the speed of the wind is not published: {missing}")
        self._changes: List[CallHandle] = []   # when the gust begins and ends
        self.reset()

    def reset(self) -> None:
        """Forces ended with the reset."""
        for one in self._changes:
            one.end()
        self._changes = []
        if any(self._steady) or any(self._gust):
            self._push()
            # A nanosecond more: steps may begin that much early.
            self._changes = [self.context.once(ns + 1, self._push) for ns in self._gust_ns
                             if ns > self.context.now_ns]

    clock_set = reset

    def force(self) -> Vec3:
        """On the link now, N, world axes."""
        start, end = self._gust_ns
        blows = start <= self.context.now_ns < end
        return add(self._steady, self._gust) if blows else self._steady

    def _push(self) -> None:
        """Push from now on, at a point that moves with the link."""
        self.context.set_wrench_law(self._link.name, ForceAtPoint(self.force(), self._offset))

    def _publish_force(self) -> None:
        self._force.publish(wrench_message(self.context, self._frame, (self.force(), ZERO3)))

    def _publish_speed(self) -> None:
        assert self._speed is not None
        message = stamp_message(self.context, "rotors_comm/WindSpeed", self._frame)
        fill_vector(message.velocity, self._velocity)
        self._speed.publish(message)
