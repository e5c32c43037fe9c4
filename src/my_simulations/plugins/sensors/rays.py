"""What range sensors share: the rays of a `<ray>`."""
from __future__ import annotations

from typing import Tuple

from ...description.sensor import Ray, ScanAngles
from ...sensing.api import RayFan, RayReturns
from ..context import PluginError, Publication
from .noisy_plugin import NoisyPlugin

_NO_END = 1e6  # m: a sensor without a maximum range


def fan_of(ray: Ray, visuals: bool = False) -> RayFan:
    """The rays of a sensor: samples times resolution points, rows likewise.

    A single one of a `ray` sensor looks along the angle 0, whatever the file says; one of a
    `gpu_ray` sensor, which sees `visuals`, along the minimum (Gazebo behaviour: MultiRayShape,
    GpuRaySensor).
    """
    def spread(scan: ScanAngles) -> Tuple[int, float, float]:
        count = max(1, int(scan.samples * scan.resolution))
        return (1, 0.0, 0.0) if count == 1 and not visuals else (
            count, scan.min_angle, scan.max_angle)

    far = ray.max_range if 0.0 < ray.max_range < _NO_END else _NO_END
    return RayFan(*spread(ray.horizontal), *spread(ray.vertical), max(0.0, ray.min_range), far)


class RayPlugin(NoisyPlugin):
    """Base class of plugins in a `<ray>` sensor: they cast rays while there are subscribers."""

    _topic: Publication

    def read_ray_element(self) -> None:
        """Read the `<ray>` of the sensor. Raises PluginError."""
        kind = "ray or gpu_ray with a <ray>"
        self._sensor = self.required_sensor(kind)
        if self._sensor.ray is None:
            raise PluginError(f"it must be in a <sensor> of type {kind}")
        self._ray, self._visuals = self._sensor.ray, self._sensor.type in ("gpu_ray", "gpu_lidar")
        self._fan = fan_of(self._ray, self._visuals)

    def follow(self, hertz: float) -> None:
        """Cast the rays at a rate while there are subscribers."""
        self.context.observe(hertz, self.update, [self._topic], world=True)

    def update(self) -> None:
        self.context.scan(self._fan, self._visuals, self._publish)

    def _publish(self, returns: RayReturns, ns: int) -> None:
        raise NotImplementedError
