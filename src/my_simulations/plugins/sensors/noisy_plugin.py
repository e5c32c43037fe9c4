"""Plugins whose measurements have noise that restarts after a reset."""
from __future__ import annotations

from typing import Any, List, Protocol

from ...description.sensor import Noise
from ...sensing.noise import Noise as SensorNoise
from ..base import Plugin
from ..context import Context


class ResettableNoise(Protocol):
    """Noise that restarts at a sim time."""

    def reset(self, ns: int) -> None:
        """Restart the noise at a sim time."""


class NoisyPlugin(Plugin):
    """Restarts its noises after a reset, and after sim time was set back."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._noises: List[ResettableNoise] = []

    def add_noise(self, noise: Noise, quantity: str) -> "SampledNoise":
        """Return the noise of a quantity, which a reset restarts."""
        made = SampledNoise(self.context, noise, quantity)
        self._noises.append(made)
        return made

    def reset(self) -> None:
        for noise in self._noises:
            noise.reset(self.context.now_ns)

    def clock_set(self) -> None:
        self.reset()


class SampledNoise:
    """SDF's noise, sample by sample."""

    def __init__(self, context: Context, noise: Noise, quantity: str) -> None:
        name = f"{context.model}::{context.sensor_link}::" + (
            context.sensor.name if context.sensor is not None else "")
        self._noise = SensorNoise(noise, context.seed, name, quantity)
        self._last_ns = context.now_ns

    def apply(self, values: Any, ns: int) -> Any:
        """Values of the sample taken at a sim time, with their noise.

        Random draws depend on the sim time: skipped samples do not change those of others.
        """
        elapsed, self._last_ns = (ns - self._last_ns) * 1e-9, ns
        return self._noise.apply(values, ns, max(0.0, elapsed))

    def reset(self, ns: int) -> None:
        """Restart the noise at a sim time."""
        self._noise.reset()
        self._last_ns = ns
