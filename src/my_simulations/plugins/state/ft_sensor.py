"""libgazebo_ros_ft_sensor.so: the wrench of a joint as geometry_msgs/WrenchStamped.

Parameters, defaults, topic and frame are those of gazebo_plugins: in the frame of the child link,
what it exerts on its parent. In a `<sensor type="force_torque">` of a joint it measures that joint,
by the sensor's `<frame>`, `<measure_direction>`, noise and rate.
"""
from __future__ import annotations

from typing import Optional

from ...description.model import WORLD, Joint
from ...description.sensor import ForceTorque
from ...sensing.sensor_models import measure_wrench
from ..context import PluginError
from ..frames import add_tf_prefix
from ..noise import WhiteNoise
from ..sensors.noisy_plugin import NoisyPlugin
from ..standard_messages import wrench_message


class FtSensor(NoisyPlugin):
    """Publishes while there are subscribers."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._name = context.sensor_joint if context.sensor_joint and not p.text("jointName") \
            else self.required_text("jointName")
        topic = self.required_text("topicName")
        sensor = context.sensor
        self._block: Optional[ForceTorque] = sensor.force_torque if sensor is not None else None
        self._joint = self._described()
        self._white = WhiteNoise(context.seed, f"{context.model}::{self._name}::ft",
                                 p.number("gaussianNoise", 0.0))
        self._noise = [self.add_noise(getattr(getattr(self._block, kind), axis), f"{kind}/{axis}")
                       for kind in ("force", "torque") for axis in "xyz"
                       ] if self._block is not None else []
        self._frame = add_tf_prefix(context, self._frame_name())
        self._topic = context.publish(topic, "geometry_msgs/WrenchStamped")
        context.joint_wrench(self._name)
        context.observe(p.number("updateRate", 0.0) or (
            sensor.update_rate if sensor is not None else 0.0), self.update, [self._topic],
            wrenches=[self._name])

    def _described(self) -> Joint:
        try:
            return self.context.joint_spec(self._name)
        except PluginError as fault:
            raise PluginError(
                f"{fault}; a fixed joint of a URDF is there with <preserveFixedJoint>true"
                "</preserveFixedJoint> in its <gazebo> element") from fault

    def _frame_name(self) -> str:
        joint, block = self._joint, self._block
        if block is not None and block.frame == "parent" and joint.parent != WORLD:
            return joint.parent
        if block is not None and block.frame == "sensor" and self.context.sensor is not None:
            return self.context.sensor.name
        return joint.child

    def update(self) -> None:
        """Publish what was transmitted in the last step."""
        context, block, sensor = self.context, self._block, self.context.sensor
        wrench = context.joint_wrench(self._name)
        if wrench is None:
            return
        sample = measure_wrench(wrench) if block is None or sensor is None else measure_wrench(
            wrench, block.frame, block.measure_direction, self._joint.pose, sensor.pose)
        values = [value + noise for value, noise in zip(
            (*sample.force, *sample.torque), self._white.draw(6, self.context.now_ns))]
        values = [float(noise.apply(value, context.now_ns))
                  for noise, value in zip(self._noise, values)] or values
        x, y, z, tx, ty, tz = values
        self._topic.publish(wrench_message(context, self._frame, ((x, y, z), (tx, ty, tz))))
