"""libWindPlugin.so: wind that pushes the links of models with `<enable_wind>`.

Parameters and laws are those of Gazebo: the wind follows the world's `<wind>` with a first-order
lag, swings about it, has noise, and pushes each link by mass x `force_approximation_scaling_factor`
x (wind - velocity) at its centre of mass. Where it differs: lags pass once a step, not once a link
and step; and the wind can be changed on the topic `/gazebo/wind` (geometry_msgs/Vector3, m/s).
"""
from __future__ import annotations

import math
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from ...description.model import Link, Model
from ...geometry import Vec3, scale, subtract
from ..base import Plugin
from ..context import PluginError
from ..finite_messages import subscribe_finite
from ..noise import WhiteNoise
from ..parameters import Parameters
from ..time_out import Stopwatch

_LEAST_FACTOR = 1e-6   # 1/s, as in Gazebo
_HERTZ = 100.0
_LOOKS_A_LAG = 50.0    # per 1/factor, the time in which a link takes the wind's velocity


class _Lag(NamedTuple):
    time: float     # s
    share: float    # of the swing
    period: float   # s
    noise: WhiteNoise
    mean: float


class Wind(Plugin):
    """A plugin of the world."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        self._factor = p.number("force_approximation_scaling_factor", 0.0)
        if abs(self._factor) < _LEAST_FACTOR:
            raise PluginError("<force_approximation_scaling_factor> must be above 0")
        across = p.children("horizontal")[:1]
        self._magnitude = self._lag(_child(across, "magnitude"), "amplitude_percent", "magnitude")
        self._direction = self._lag(_child(across, "direction"), "amplitude", "direction")
        self._vertical = self._lag(p.children("vertical")[:1], "", "vertical")
        subscribe_finite(context, "/gazebo/wind", "geometry_msgs/Vector3", self._receive)
        self._given: Optional[Vec3] = None
        self._pushed: List[str] = []
        self.reset()
        context.every(max(_HERTZ, _LOOKS_A_LAG * self._factor), self.update)

    def _lag(self, found: Sequence[Parameters], swing: str, who: str) -> _Lag:
        p = found[0] if found else Parameters("")
        sines, noises = p.children("sin")[:1], p.children("noise")[:1]
        noise = noises[0] if noises else Parameters("")
        return _Lag(max(0.0, p.number("time_for_rise", 1.0)),
                    sines[0].number(swing, 0.0) if sines and swing else 0.0,
                    sines[0].number("period", 1.0) if sines else 1.0,
                    WhiteNoise(self.context.seed, f"wind::{who}", noise.number("stddev", 0.0)),
                    noise.number("mean", 0.0))

    def reset(self) -> None:
        self._means = [0.0, 0.0, 0.0]
        self._pushed = []
        self.clock_set()

    def clock_set(self) -> None:
        """Keep the wind, as in Gazebo; measure the lag from now."""
        self._stopwatch = Stopwatch(self.context)

    def _receive(self, message: Any) -> None:
        self._given = (float(message.x), float(message.y), float(message.z))

    def update(self) -> None:
        """Apply the force of the wind to all links in it."""
        context, wind = self.context, self.velocity()
        present = context.models()
        seen: Dict[str, Vec3] = {}
        for name, model in present.items():
            if model.static:
                continue
            for link in model.links:
                if catches_wind(model, link):
                    scoped = f"{name}::{link.name}"
                    lack = subtract(wind, context.model_link(scoped).twist.linear)
                    seen[scoped] = scale(lack, link.inertial.mass * self._factor)
        for scoped in self._pushed:   # these are out of the wind now
            if scoped not in seen and scoped.partition("::")[0] in present:
                seen[scoped] = (0.0, 0.0, 0.0)
        for scoped, force in seen.items():
            context.set_wrench(scoped, force, (0.0, 0.0, 0.0))
        self._pushed = [scoped for scoped, force in seen.items() if any(force)]

    def velocity(self) -> Vec3:
        """Of the wind now, m/s, world axes."""
        elapsed = self._stopwatch.lap()
        x, y, z = self._given or self.context.wind
        wanted = (math.hypot(x, y), math.degrees(math.atan2(y, x)), z)
        lags = (self._magnitude, self._direction, self._vertical)
        self._means = [value + (mean - value) * math.exp(-elapsed / lag.time) if lag.time else value
                       for lag, mean, value in zip(lags, self._means, wanted)]
        speed, way, up = self._means
        speed += speed * self._swing(self._magnitude) + self._noise(self._magnitude)
        way += self._swing(self._direction) + self._noise(self._direction)
        way = math.radians(way)
        return speed * math.cos(way), speed * math.sin(way), up + self._noise(self._vertical)

    def _swing(self, lag: _Lag) -> float:
        if not lag.share or lag.period <= 0.0:
            return 0.0
        return lag.share * math.sin(2.0 * math.pi * self.context.now_ns * 1e-9 / lag.period)

    def _noise(self, lag: _Lag) -> float:
        return lag.mean + lag.noise.draw(1, self.context.now_ns)[0]


def catches_wind(model: Model, link: Link) -> bool:
    """`<enable_wind>` of the link, else of its model."""
    for xml in link.extra:
        if "enable_wind" in xml:
            return "true" in xml.lower() or ">1<" in xml
    return model.enable_wind


def _child(found: Sequence[Parameters], name: str) -> List[Parameters]:
    return found[0].children(name)[:1] if found else []
