"""Measures what an inertial measurement unit on a link would, without errors."""
from __future__ import annotations

from ..geometry import IDENTITY, IDENTITY_QUAT, Pose, Quat, Vec3
from ..sensing.sensor_models import ImuSample, acceleration_between, measure_motion, velocity_at
from .context import Context, Link
from .time_out import Stopwatch


class ImuMeter:
    """Accelerations are those since the measurement before.

    Args:
        context: of the plugin.
        link: carries the sensor.
        mount: link from sensor.
        reference: the frame of orientations in the world.
    """

    def __init__(self, context: Context, link: Link, mount: Pose = IDENTITY,
                 reference: Quat = IDENTITY_QUAT) -> None:
        self._context, self._link, self._mount, self._reference = context, link, mount, reference
        self._stopwatch = Stopwatch(context)
        self.restart()

    def restart(self) -> None:
        """Measure accelerations from the present time and velocity on."""
        self._stopwatch.restart()
        self._before = self._velocity()

    def measure(self) -> ImuSample:
        """Return the measurement of this step."""
        link, before, self._before = self._link, self._before, self._velocity()
        acceleration = acceleration_between(before, self._before, self._stopwatch.lap())
        return measure_motion(link.pose, link.twist, acceleration, self._context.gravity,
                              self._mount, self._reference)

    def _velocity(self) -> Vec3:
        return velocity_at(self._link.pose, self._link.twist, self._mount)
