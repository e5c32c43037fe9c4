"""The noise that simulators of drones add to velocity commands."""
from __future__ import annotations

import random
from typing import Tuple

from ..context import Context


class CommandNoise:
    """Noise of each command, `<motionSmallNoise>`, and of periods, `<motionDriftNoise>`.

    Both are uniform. `<motionDriftNoiseTime>` is the length of a period, s. The parameters and the
    law are those of tum_simulator and sjtu_drone.

    Args:
        context: of the plugin.
    """

    def __init__(self, context: Context) -> None:
        p = context.parameters
        self._context = context
        self._small = p.number("motionSmallNoise", 0.0)
        self._most_drift = p.number("motionDriftNoise", 0.0)
        self._period_ns = round(p.number("motionDriftNoiseTime", 1.0) * 1e9)
        self.reset()

    def reset(self) -> None:
        """Begin the sequence of numbers again."""
        self._random = random.Random(f"{self._context.seed}::{self._context.model}::drone")
        self._drift: Tuple[float, ...] = (0.0,) * 4
        self._drift_until_ns = self._context.now_ns + self._period_ns

    def draw(self) -> Tuple[float, ...]:
        """Return the noise of the four values of a command."""
        if self._context.now_ns > self._drift_until_ns:
            self._drift = tuple(self._most_drift * self._random.uniform(-1.0, 1.0)
                                for _ in range(4))
            self._drift_until_ns = self._context.now_ns + self._period_ns
        return tuple(one + self._small * self._random.uniform(-1.0, 1.0) for one in self._drift)
