"""libRandomVelocityPlugin.so: a model that moves in random directions.

Parameters and defaults are those of Gazebo: `<link>`, `<initial_velocity>` and `<velocity_factor>`
(m/s), `<update_period>` (s), and the limits `<min_x>`, `<max_x>` and so on of each world axis, in
either order. Where it differs: all links of the model get the velocity, not only the one named;
the directions depend on the seed of the world and on sim time, so a run can be repeated.

libInitialVelocityPlugin.so: a model that begins with a velocity.

Parameters are those of Gazebo: `<linear>` m/s and `<angular>` rad/s, world axes.
"""
from __future__ import annotations

import math
from typing import List, Tuple

from ...geometry import Twist, Vec3
from ..base import Plugin
from ..noise import WhiteNoise


class RandomVelocity(Plugin):
    """Sets the linear velocity of the model before each step; it turns freely."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        context.link(self.required_text("link"))
        self._initial = p.vector("initial_velocity")
        self._speed = p.number("velocity_factor", 1.0)
        self._period_ns = round(p.number("update_period", 10.0) * 1e9)
        self._limits: List[Tuple[float, float]] = []
        for axis in "xyz":
            one, other = (p.number(f"min_{axis}", -math.inf), p.number(f"max_{axis}", math.inf))
            self._limits.append((min(one, other), max(one, other)))
        self._noise = WhiteNoise(context.seed, f"{context.model}\0RandomVelocity", 1.0)
        self.reset()
        context.every(0.0, self._update)

    def reset(self) -> None:
        """Begin again with the initial velocity."""
        self._velocity, self._changed_ns = self._initial, 0

    clock_set = reset

    def _update(self) -> None:
        now = self.context.now_ns
        if now - self._changed_ns > self._period_ns:
            self._velocity, self._changed_ns = self._draw(now), now
        self.context.move(self.context.pose, Twist(self._velocity, self.context.twist.angular))

    def _draw(self, ns: int) -> Vec3:
        """A velocity of the speed in a random direction, within the limits; m/s, world axes."""
        drawn = self._noise.draw(3, ns)
        length = math.sqrt(sum(value * value for value in drawn)) or 1.0
        x, y, z = (max(low, min(high, self._speed * value / length))
                   for value, (low, high) in zip(drawn, self._limits))
        return (x, y, z)


class InitialVelocity(Plugin):
    """Sets the velocity of all links when the model is spawned, and after a reset."""

    def load(self) -> None:
        p = self.context.parameters
        self._twist = Twist(p.vector("linear"), p.vector("angular"))
        self.reset()

    def reset(self) -> None:
        self.context.move(self.context.pose, self._twist)
