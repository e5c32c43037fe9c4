"""Short rays of a base: for cliffs below it and walls beside it."""
from __future__ import annotations

from typing import Callable, Dict, List, Mapping, Tuple

from ...description.sensor import Sensor
from ...sensing.api import RayReturns
from ..context import Context, PluginError
from ..sensors.rays import fan_of

_PATIENCE_NS = 10 ** 9                          # of sim time, for rays


class FloorRays:
    """Casts the first ray of several sensors one after the other.

    Args:
        context: of the plugin.
        sensors: the link and the sensor, by a name.
        answered: receives the distance of each ray by name, m; infinite without a hit.
    """

    def __init__(self, context: Context, sensors: Mapping[str, Tuple[str, Sensor]],
                 answered: Callable[[Dict[str, float]], None]) -> None:
        self._context, self._sensors, self._answered = context, dict(sensors), answered
        self._next_cast_ns = 0
        for _, sensor in self._sensors.values():
            if sensor.ray is None:
                raise PluginError(f"sensor '{sensor.name}' has no <ray>")

    def clock_set(self) -> None:
        """Discard pending rays after sim time was set."""
        self._next_cast_ns = 0

    def cast(self) -> None:
        """Cast the rays, unless earlier ones are pending."""
        now = self._context.now_ns
        if now >= self._next_cast_ns:
            self._next_cast_ns = now + _PATIENCE_NS
            self._cast_next(list(self._sensors), {})

    def _cast_next(self, names: List[str], found: Dict[str, float]) -> None:
        if not names:
            self._next_cast_ns = 0
            self._answered(found)
            return
        link, sensor = self._sensors[names[0]]
        assert sensor.ray is not None

        def receive(returns: RayReturns, ns: int) -> None:
            found[names[0]] = float(returns.ranges.flat[0])
            self._cast_next(names[1:], found)

        self._context.scan(fan_of(sensor.ray), False, receive, (link, sensor.pose))


def sensor_named(context: Context, name: str) -> Tuple[str, Sensor]:
    """A sensor of the model, and its link. Raises PluginError."""
    for link, sensor in context.sensors():
        if sensor.name == name:
            return link, sensor
    raise PluginError(f"the model has no sensor '{name}'")
