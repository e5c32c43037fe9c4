"""libunitreeFootContactPlugin.so: the force on a foot, as geometry_msgs/WrenchStamped.

The topic is that of unitree_ros, `/visual/SENSOR/the_force`. As in unitree_ros the force is the
mean over the contacts of the link, in the link's axes.
"""
from __future__ import annotations

from ...geometry import Vec3, add, conjugate, rotate, scale
from ..base import Plugin
from ..context import PluginError
from ..frames import stamped


class FootContact(Plugin):
    """Publishes at the sensor's rate while there are subscribers."""

    def load(self) -> None:
        context = self.context
        if context.sensor is None:
            raise PluginError("it must be in a <sensor> of type contact")
        self._link = context.link(context.sensor_link)
        self._topic = context.publish(f"/visual/{context.sensor.name}/the_force",
                                      "geometry_msgs/WrenchStamped", 100)
        context.observe(context.sensor.update_rate, self.update, [self._topic], contacts=True)

    def update(self) -> None:
        """Publish the mean contact force of the last step."""
        context, total, count = self.context, (0.0, 0.0, 0.0), 0
        mine = f"{context.model}::{context.sensor_link}"
        for one, other, contact in context.contacts():
            if mine in (one, other):
                force: Vec3 = add(scale(contact.normal, contact.force), contact.friction)
                total = add(total, scale(force, 1.0 if one == mine else -1.0))
                count += 1
        message = stamped(context, "geometry_msgs/WrenchStamped", self._link.name)
        force = rotate(conjugate(self._link.pose.orientation), scale(total, 1.0 / max(1, count)))
        at = message.wrench.force
        at.x, at.y, at.z = force
        self._topic.publish(message)
