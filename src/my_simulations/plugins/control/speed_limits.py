"""Limits of a base's velocity, acceleration and jerk. Source: ros_controllers."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, Optional, Tuple

from .settings import Settings


@dataclass(frozen=True)
class SpeedLimits:
    """Limits of one component of a velocity.

    Attributes:
        velocity: least and greatest velocity, m/s or rad/s; None for no limits.
        acceleration: likewise, m/s^2 or rad/s^2.
        jerk: likewise, m/s^3 or rad/s^3.
    """

    velocity: Optional[Tuple[float, float]] = None
    acceleration: Optional[Tuple[float, float]] = None
    jerk: Optional[Tuple[float, float]] = None

    def limit(self, wanted: float, last: float, before: float, dt: float) -> float:
        """Return the velocity within the limits that is nearest to `wanted`.

        Args:
            wanted: commanded velocity.
            last: velocity at the last update.
            before: velocity at the update before the last.
            dt: time between updates, s.
        """
        if self.jerk is not None:
            change = 2.0 * dt * dt
            wanted = last + (last - before) + clamp(
                wanted - last - (last - before), self.jerk[0] * change, self.jerk[1] * change)
        if self.acceleration is not None:
            wanted = last + clamp(wanted - last, self.acceleration[0] * dt,
                                  self.acceleration[1] * dt)
        if self.velocity is not None:
            wanted = clamp(wanted, *self.velocity)
        return wanted


def read_speed_limits(settings: Settings, path: str) -> SpeedLimits:
    """Read the limits below a path such as `linear/x` or `angular/z`."""
    found: List[Optional[Tuple[float, float]]] = []
    for kind in ("velocity", "acceleration", "jerk"):
        most = settings.number(f"{path}/max_{kind}", 0.0)
        pair = (settings.number(f"{path}/min_{kind}", -most), most)
        found.append(pair if settings.flag(f"{path}/has_{kind}_limits", False) else None)
    return SpeedLimits(*found)


def clamp(value: float, least: float, most: float) -> float:
    return max(least, min(most, value))
