"""hector_gazebo_plugins' receivers: gps, magnetic field, height by pressure, sonar.

Parameters, defaults, topics, axes and formulas are those of hector: north, west and up if the
reference heading is 0. dynamic_reconfigure and services of hector's own types are not supported.
"""
from __future__ import annotations

import math
from typing import Any, Optional, Tuple

from ...description.surroundings import SphericalCoordinates
from ...geometry import Vec3, conjugate, rotate
from ..context import Link, PluginError, Publication
from ..frames import stamp_message
from ..standard_messages import (
    ULTRASOUND,
    fix_message,
    magnetic_message,
    point_message,
    range_message,
    vector_message,
)
from .hector_errors import SensorErrors, rate_of
from .noisy_plugin import NoisyPlugin
from .rays import RayPlugin

_EQUATOR = 6378137.0            # WGS 84, m
_FLATTENING = 1.0 / 298.257223563
_SONAR_HERTZ = 10.0             # where it has no rate of its own, whatever its sensor's is
_SCALE_HEIGHT, _EXPONENT = 44330.0, 5.263157  # of the standard atmosphere


class _LinkSensor(NoisyPlugin):
    """On the link `<bodyName>`, or the model's own."""

    _link: Link

    def _begin(self, frame: str = "") -> None:
        context, p = self.enter_namespace()
        self._link = context.link(p.text("bodyName"))
        self._frame = (p.text("frameId") or frame or self._link.name).lstrip("/")

    def _with_errors(self, prefix: str = "", width: int = 3) -> SensorErrors:
        """Return the errors of a quantity; `reset` resets them."""
        made = SensorErrors(self.context, prefix, width)
        self._noises.append(made)
        return made

    def _place(self) -> Optional[SphericalCoordinates]:
        """Return the world's coordinates, if they are used; the default is 0, 0 as in Gazebo."""
        if not self.context.parameters.flag("useWorldSphericalCoordinates", False):
            return None
        return self.context.spherical_coordinates or SphericalCoordinates()

    def _heading(self) -> float:
        """Of the world's x axis, rad clockwise from north."""
        place = self._place()
        usual = 90.0 - place.heading_deg if place else 0.0
        return math.radians(self.context.parameters.number("referenceHeading", usual))


class Gps(_LinkSensor):
    """sensor_msgs/NavSatFix, and the velocity as geometry_msgs/Vector3Stamped."""

    def load(self) -> None:
        self._begin("/world")
        context, p, place = self.context, self.context.parameters, self._place()
        self._latitude = p.number("referenceLatitude", place.latitude_deg if place else 49.9)
        self._longitude = p.number("referenceLongitude", place.longitude_deg if place else 8.9)
        self._altitude = p.number("referenceAltitude", place.elevation if place else 0.0)
        self._north, self._east = metres_per_radian(math.radians(self._latitude))
        self._turned = self._heading()
        self._status, self._service = p.integer("status", 0), p.integer("service", 0)
        self._place_errors = self._with_errors()
        self._velocity_errors = self._with_errors("velocity")
        self._last_ns = context.now_ns
        fix = p.text("topicName") or "fix"
        self._fix = context.publish(fix, "sensor_msgs/NavSatFix", 10)
        self._velocity = context.publish(p.text("velocityTopicName") or "fix_velocity",
                                         "geometry_msgs/Vector3Stamped", 10)
        # The error of the position contains the integral of that of the velocity.
        context.observe(rate_of(p, 4.0), self.update, [self._fix, self._velocity],
                        remembers=self._velocity_errors.has_drift)

    def reset(self) -> None:
        super().reset()
        self._last_ns = self.context.now_ns

    def _north_west(self, x: float, y: float) -> Tuple[float, float]:
        c, s = math.cos(self._turned), math.sin(self._turned)
        return c * x + s * y, -s * x + c * y

    def update(self) -> None:
        """Measure, and publish on the topics that have a subscriber."""
        ns = self.context.now_ns
        vx, vy, vz = self._velocity_errors.apply(self._link.twist.linear, ns)
        x, y, z = self._place_errors.apply(self._link.pose.position, ns)
        # From the next sample on, the position error contains this velocity error's integral.
        elapsed, self._last_ns = max(0.0, (ns - self._last_ns) * 1e-9), ns
        self._place_errors.shift([elapsed * drift for drift in self._velocity_errors.current])
        if self._fix.wanted:
            north, west = self._north_west(x, y)
            variances = [a * a + b * b for a, b in zip(self._place_errors.drift,
                                                       self._place_errors.noise)]
            self._fix.publish(fix_message(
                self.context, self._frame, self._latitude + math.degrees(north / self._north),
                self._longitude - math.degrees(west / self._east), self._altitude + z, variances,
                self._status, self._service))
        if self._velocity.wanted:
            self._velocity.publish(vector_message(self.context, self._frame,
                                                  (*self._north_west(vx, vy), vz)))


def metres_per_radian(latitude: float) -> Tuple[float, float]:
    """Return metres per radian of latitude and of longitude on the WGS 84 ellipsoid.

    `latitude` is in rad.
    """
    square = 2.0 * _FLATTENING - _FLATTENING ** 2
    part = 1.0 / (1.0 - square * math.sin(latitude) ** 2)
    vertical = _EQUATOR * math.sqrt(part)
    return vertical * (1.0 - square) * part, vertical * math.cos(latitude)


class Magnetic(_LinkSensor):
    """The earth's field in the link's axes; of `magnitude` 1 where none is given."""

    def load(self) -> None:
        self._begin()
        context, p = self.context, self.context.parameters
        down = math.radians(p.number("inclination", 60.0))
        angle = self._heading() - math.radians(p.number("declination", 0.0))
        size = p.number("magnitude", 1.0)
        self._field: Vec3 = (size * math.cos(down) * math.cos(angle),
                             size * math.cos(down) * math.sin(angle), -size * math.sin(down))
        self._errors = self._with_errors()
        self._plain = not p.flag("useMagneticFieldMsgs", False)
        kind = "geometry_msgs/Vector3Stamped" if self._plain else "sensor_msgs/MagneticField"
        self._topic = context.publish(p.text("topicName") or "magnetic", kind)
        context.observe(rate_of(p), self.update, [self._topic])

    def update(self) -> None:
        context = self.context
        felt = rotate(conjugate(self._link.pose.orientation), self._field)
        x, y, z = self._errors.apply(felt, context.now_ns)
        make = vector_message if self._plain else magnetic_message
        self._topic.publish(make(context, self._frame, (x, y, z)))


class Baro(_LinkSensor):
    """The height as geometry_msgs/PointStamped, and hector_uav_msgs/Altimeter where it is there."""

    def load(self) -> None:
        self._begin()
        context, p = self.context, self.context.parameters
        self._elevation, self._qnh = p.number("elevation", 0.0), p.number("qnh", 1013.25)
        self._errors = self._with_errors(width=1)
        self._height = context.publish(p.text("topicName") or "pressure_height",
                                       "geometry_msgs/PointStamped", 10)
        self._altimeter: Optional[Publication] = None
        try:
            self._altimeter = context.publish(p.text("altimeterTopicName") or "altimeter",
                                              "hector_uav_msgs/Altimeter", 10)
        except PluginError as missing:
            context.info(f"only the height is published: {missing}")
        context.observe(rate_of(p), self.update, [self._height, *(
            [self._altimeter] if self._altimeter is not None else [])])

    def update(self) -> None:
        context = self.context
        (height,) = self._errors.apply(self._link.pose.position[2:], context.now_ns)
        if self._height.wanted:
            self._height.publish(point_message(context, self._frame, (0.0, 0.0, height)))
        if self._altimeter is not None and self._altimeter.wanted:
            message = stamp_message(context, "hector_uav_msgs/Altimeter", self._frame)
            message.qnh, message.altitude = self._qnh, height + self._elevation
            message.pressure = pressure_at(message.altitude, self._qnh)
            self._altimeter.publish(message)


def pressure_at(altitude: float, qnh: float) -> float:
    """hPa at a height (m) of the standard atmosphere, with `qnh` at sea level; 0 above it."""
    return float(max(0.0, 1.0 - altitude / _SCALE_HEIGHT) ** _EXPONENT * qnh)


class Sonar(RayPlugin):
    """sensor_msgs/Range of a ray sensor: the nearest of all rays."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self.read_ray_element()
        self._frame = (p.text("frameId") or "/sonar_link").lstrip("/")
        flat, high = self._ray.horizontal, self._ray.vertical
        wide = [abs(one.max_angle - one.min_angle) for one in (flat, high)]
        self._view = min((angle for angle in wide if angle > 0.0), default=0.0)
        self._errors = SensorErrors(context, width=1)
        self._noises = [self._errors]
        self._topic = context.publish(p.text("topicName") or "sonar", "sensor_msgs/Range")
        self.follow(rate_of(p, _SONAR_HERTZ))

    def _publish(self, returns: Any, ns: int) -> None:
        least, most = self._ray.min_range, self._ray.max_range
        nearest = min(float(returns.ranges.min()), most)
        if nearest < most:
            (noisy,) = self._errors.apply((nearest,), ns)
            nearest = min(max(noisy, least), most)
        self._topic.publish(range_message(self.context, self._frame, ns, ULTRASOUND, self._view,
                                          (least, most), nearest))
