"""Topics of SDF's `gps`, `magnetometer` and `altimeter` sensors, which Gazebo gives no ROS names.

`libmy_simulations_gps.so`, `libmy_simulations_magnetometer.so`, `libmy_simulations_altimeter.so`,
each inside of its `<sensor>`: values, signs and noise are those of Gazebo's sensors, at the
sensor's `<update_rate>`. Parameters: `robotNamespace` (missing: the model's name), `topicName`,
`frameName` (default: the link's name).
"""
from __future__ import annotations

from typing import Any

from ...description.sensor import Altimeter, Gps, Magnetometer
from ...description.surroundings import SphericalCoordinates
from ...geometry import transform
from ...sensing import gps
from ...sensing.sensor_models import measure_altitude, measure_magnetic_field, velocity_at
from ..context import Publication
from ..frames import add_tf_prefix
from ..standard_messages import fix_message, magnetic_message, point_message, vector_message
from .noisy_plugin import NoisyPlugin


class _SensorPlugin(NoisyPlugin):
    """Base class of the three sensors."""

    block: Any = None

    def _begin(self, kind: str) -> None:
        context, p = self.enter_namespace(self.context.model)
        self._sensor = self.required_sensor(kind)
        self._link, self._mount = context.link(context.sensor_link), self._sensor.pose
        self._frame = add_tf_prefix(context, p.text("frameName") or context.sensor_link)
        self.block = getattr(self._sensor, kind)

    def _follow(self, *topics: Publication) -> None:
        """Measure at the sensor's rate while there are subscribers."""
        self.context.observe(self._sensor.update_rate, self.update, topics)

    def update(self) -> None:
        raise NotImplementedError


class GpsSensor(_SensorPlugin):
    """sensor_msgs/NavSatFix on `fix`, velocity east, north, up on `fix_velocity`."""

    def load(self) -> None:
        self._begin("gps")
        block, context = self.block or Gps(), self.context
        self._place = [self.add_noise(one, f"position/{axis}") for one, axis in (
            (block.position_horizontal, "x"), (block.position_horizontal, "y"),
            (block.position_vertical, "z"))]
        self._speed = [self.add_noise(one, f"velocity/{axis}") for one, axis in (
            (block.velocity_horizontal, "east"), (block.velocity_horizontal, "north"),
            (block.velocity_vertical, "up"))]
        level, up = block.position_horizontal.stddev ** 2, block.position_vertical.stddev ** 2
        self._variances = (level, level, up)
        fix = context.parameters.text("topicName") or "fix"
        self._fix = context.publish(fix, "sensor_msgs/NavSatFix")
        self._velocity = context.publish(f"{fix}_velocity", "geometry_msgs/Vector3Stamped")
        self._follow(self._fix, self._velocity)

    def update(self) -> None:
        context, ns, link = self.context, self.context.now_ns, self._link
        x, y, z = (noise.apply(value, ns) for noise, value in zip(
            self._place, transform(link.pose, self._mount.position)))
        found = gps.measure((x, y, z), velocity_at(link.pose, link.twist, self._mount),
                            context.spherical_coordinates or SphericalCoordinates())
        east, north, up = (noise.apply(value, ns) for noise, value in zip(
            self._speed, found.velocity))
        if self._fix.wanted:
            self._fix.publish(fix_message(context, self._frame, found.latitude_deg,
                                          found.longitude_deg, found.altitude, self._variances))
        if self._velocity.wanted:
            self._velocity.publish(vector_message(context, self._frame, (east, north, up)))


class MagnetometerSensor(_SensorPlugin):
    """sensor_msgs/MagneticField on `magnetic_field`, T in the sensor's axes."""

    def load(self) -> None:
        self._begin("magnetometer")
        block, context = self.block or Magnetometer(), self.context
        self._axes = [self.add_noise(getattr(block, axis), axis) for axis in "xyz"]
        self._variances = [getattr(block, axis).stddev ** 2 for axis in "xyz"]
        self._topic = context.publish(context.parameters.text("topicName") or "magnetic_field",
                                      "sensor_msgs/MagneticField")
        self._follow(self._topic)

    def update(self) -> None:
        context = self.context
        felt = measure_magnetic_field(self._link.pose, self._mount, context.magnetic_field)
        noisy = [noise.apply(value, context.now_ns) for noise, value in zip(self._axes, felt)]
        self._topic.publish(magnetic_message(context, self._frame, noisy, self._variances))


class AltimeterSensor(_SensorPlugin):
    """geometry_msgs/PointStamped on `altitude` (m over where it began) and the speed upwards."""

    def load(self) -> None:
        self._begin("altimeter")
        block, context = self.block or Altimeter(), self.context
        self._up = self.add_noise(block.vertical_position, "vertical_position")
        self._upwards = self.add_noise(block.vertical_velocity, "vertical_velocity")
        self._reference = transform(self._link.pose, self._mount.position)[2]
        name = context.parameters.text("topicName") or "altitude"
        self._height = context.publish(name, "geometry_msgs/PointStamped")
        self._velocity = context.publish(f"{name}_velocity", "geometry_msgs/Vector3Stamped")
        self._follow(self._height, self._velocity)

    def update(self) -> None:
        context, ns = self.context, self.context.now_ns
        found = measure_altitude(self._link.pose, self._link.twist, self._mount, self._reference)
        height = self._up.apply(found.vertical_position, ns)
        speed = self._upwards.apply(found.vertical_velocity, ns)
        if self._height.wanted:
            self._height.publish(point_message(context, self._frame, (0.0, 0.0, height)))
        if self._velocity.wanted:
            self._velocity.publish(vector_message(context, self._frame, (0.0, 0.0, speed)))
