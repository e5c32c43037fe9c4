"""libgazebo_ros_bumper.so: gazebo_msgs/ContactsState of a contact sensor.

Parameters, defaults, topic and header are those of gazebo_plugins. Positions, normals and forces
are in world axes (in gazebo_plugins forces are in link axes); torques are about the link's
origin. As in gazebo_plugins a collision names each link: the sensor's, else the link's first.

libunitreeFootContactPlugin.so: the force on a foot, as geometry_msgs/WrenchStamped.

The topic is that of unitree_ros, `/visual/SENSOR/the_force`. As in unitree_ros the force is the
mean over the contacts of the link, in the link's axes.
"""
from __future__ import annotations

from typing import Any, Dict, List, Tuple

from ...description.model import Model
from ...geometry import ZERO3, Vec3, add, conjugate, cross, rotate, scale, subtract
from ...geometry_messages import fill_vector, fill_wrench
from ..base import Plugin
from ..frames import add_tf_prefix, stamp_message
from ..standard_messages import wrench_message


class Bumper(Plugin):
    """Publishes while there are subscribers; without a contact `states` is empty."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        sensor = self.required_sensor("contact")
        self._frame = add_tf_prefix(context, p.text("frameName", "world"))
        self._link = context.link(context.sensor_link)
        block = sensor.contact
        self._collision = block.collisions[0] if block is not None and block.collisions else ""
        self._topic = context.publish(p.text("bumperTopicName", "bumper_states"),
                                      "gazebo_msgs/ContactsState")
        context.observe(sensor.update_rate, self.update, [self._topic], contacts=True)

    def update(self) -> None:
        """Publish the contacts of the last step."""
        context = self.context
        mine = f"{context.model}::{context.sensor_link}"
        touching: Dict[str, List[Tuple[Any, float]]] = {}
        for one, other, contact in context.contacts():
            if mine in (one, other):
                touching.setdefault(other if one == mine else one, []).append(
                    (contact, 1.0 if one == mine else -1.0))
        message = stamp_message(context, "gazebo_msgs/ContactsState", self._frame)
        models = context.models() if touching else {}
        message.states = [self._state(mine, other, points, models)
                          for other, points in touching.items()]
        self._topic.publish(message)

    def _state(self, mine: str, other: str, points: List[Tuple[Any, float]],
               models: Dict[str, Model]) -> Any:
        context, at = self.context, self._link.pose.position
        state = context.message("gazebo_msgs/ContactState")
        state.collision1_name = (f"{mine}::{self._collision}" if self._collision
                                 else _first_collision(mine, models))
        state.collision2_name = _first_collision(other, models)
        state.info = f"{len(points)} points at {context.now_ns * 1e-9:.3f} s"
        state.wrenches, state.contact_positions = [], []
        state.contact_normals, state.depths = [], []
        total: Tuple[Vec3, Vec3] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for contact, sign in points:
            force = scale(add(scale(contact.normal, contact.force), contact.friction), sign)
            torque = cross(subtract(contact.position, at), force)
            total = (add(total[0], force), add(total[1], torque))
            state.wrenches.append(_wrench(context, force, torque))
            state.contact_positions.append(_vector(context, contact.position))
            state.contact_normals.append(_vector(context, scale(contact.normal, sign)))
            state.depths.append(contact.depth)
        state.total_wrench = _wrench(context, *total)
        return state


def _first_collision(scoped: str, models: Dict[str, Model]) -> str:
    """The scoped name of the first collision of a link; the link's where it has none."""
    model, _, name = scoped.partition("::")
    for link in models[model].links if model in models else ():
        if link.name == name and link.collisions:
            return f"{scoped}::{link.collisions[0].name}"
    return scoped


def _vector(context: Any, values: Vec3) -> Any:
    made = context.message("geometry_msgs/Vector3")
    fill_vector(made, values)
    return made


def _wrench(context: Any, force: Vec3, torque: Vec3) -> Any:
    made = context.message("geometry_msgs/Wrench")
    fill_wrench(made, (force, torque))
    return made


class FootContact(Plugin):
    """Publishes at the sensor's rate while there are subscribers."""

    def load(self) -> None:
        context = self.context
        sensor = self.required_sensor("contact")
        self._link = context.link(context.sensor_link)
        self._topic = context.publish(f"/visual/{sensor.name}/the_force",
                                      "geometry_msgs/WrenchStamped", 100)
        context.observe(sensor.update_rate, self.update, [self._topic], contacts=True)

    def update(self) -> None:
        """Publish the mean contact force of the last step."""
        context, total, count = self.context, (0.0, 0.0, 0.0), 0
        mine = f"{context.model}::{context.sensor_link}"
        for one, other, contact in context.contacts():
            if mine in (one, other):
                force: Vec3 = add(scale(contact.normal, contact.force), contact.friction)
                total = add(total, scale(force, 1.0 if one == mine else -1.0))
                count += 1
        force = rotate(conjugate(self._link.pose.orientation), scale(total, 1.0 / max(1, count)))
        self._topic.publish(wrench_message(context, self._link.name, (force, ZERO3)))
