"""Noise of sensors, drawn by counting: no sample depends on whether the one before was taken.

Every draw comes from Philox (a generator that is a function of key and counter), keyed by the
world's seed, the sensor's scoped name and the quantity, counted by the sample. The models are those
of Gazebo Classic 11 (`GaussianNoiseModel`): a bias drawn once with a random sign, from which it may
wander towards 0, white noise, rounding to a precision.
"""
from __future__ import annotations

import hashlib
import math
from typing import Any

from ..description.sensor import Noise as NoiseSpec

GAUSSIAN, QUANTIZED = "gaussian", "gaussian_quantized"
_WHITE, _BIAS, _WANDERING = range(3)


class SampleGenerator:
    """Draws the samples of one quantity of one sensor. For one thread.

    A new generator for each sample took ten times as long as moving one to the sample.
    """

    def __init__(self, seed: int, sensor: str, quantity: str) -> None:
        import numpy as np

        name = f"{seed}\0{sensor}\0{quantity}".encode()
        key = np.frombuffer(hashlib.blake2b(name, digest_size=16).digest(), dtype=np.uint64)
        self._philox = np.random.Philox(key=key, counter=np.zeros(4, dtype=np.uint64))
        self._state: Any = self._philox.state   # its buffer is empty
        self._counter = self._state["state"]["counter"]
        self._generator = np.random.Generator(self._philox)

    def at(self, sample: int, purpose: int = _WHITE) -> Any:
        """Return the numpy.random.Generator at a sample; the next call moves it."""
        self._counter[2], self._counter[3] = sample % (1 << 64), purpose
        self._philox.state = self._state
        return self._generator


def sample_generator(seed: int, sensor: str, quantity: str, sample: int) -> Any:
    """Return the numpy.random.Generator of one sample of one quantity of a sensor."""
    return SampleGenerator(seed, sensor, quantity).at(sample)


class Noise:
    """The noise of one quantity of one sensor, e.g. `range` or `angular_velocity/x`.

    Only a bias that wanders remembers anything: where it was at the sample before. Over samples
    left out it wanders in one stride, which has the same distribution.

    Attributes:
        bias: where it begins.
    """

    def __init__(self, spec: NoiseSpec, seed: int, sensor: str, quantity: str = "") -> None:
        self.spec = spec
        self._active = spec.type in (GAUSSIAN, QUANTIZED)
        if self._active:
            self._draws = SampleGenerator(seed, sensor, quantity)
        self.bias = self._first_bias() if self._active else 0.0
        self._wandering = self.bias

    def _first_bias(self) -> float:
        spec = self.spec
        if spec.bias_mean == 0.0 and spec.bias_stddev == 0.0:
            return 0.0
        draws = self._draws.at(0, _BIAS)
        bias = draws.normal(spec.bias_mean, max(0.0, spec.bias_stddev))
        return float(-bias if draws.random() < 0.5 else bias)

    def reset(self) -> None:
        """Reset the bias to its initial value, for a reset of the world."""
        self._wandering = self.bias

    def apply(self, values: Any, sample: int, elapsed: float) -> Any:
        """Return the values of a sample with noise; values that are not finite stay.

        Args:
            values: a float or an array, in the quantity's unit.
            sample: its number; the same number gives the same draws.
            elapsed: sim time since the sample before, s.
        """
        if not self._active:
            return values
        import numpy as np

        spec = self.spec
        self._drift(sample, elapsed)
        plain = np.asarray(values, dtype=np.float64)
        noisy = plain + (self._wandering + spec.mean)
        if spec.stddev > 0.0:
            noisy = noisy + self._draws.at(sample).normal(0.0, spec.stddev, plain.shape)
        if spec.precision > 0.0:  # whichever of the two types, as in Gazebo
            steps = noisy / spec.precision
            noisy = np.copysign(np.floor(np.abs(steps) + 0.5), steps) * spec.precision
        noisy = np.where(np.isfinite(plain), noisy, plain)
        return noisy if plain.ndim else float(noisy)

    def _drift(self, sample: int, elapsed: float) -> None:
        """An Ornstein-Uhlenbeck step, exact for any length."""
        spec, tau = self.spec, self.spec.dynamic_bias_correlation_time
        if spec.dynamic_bias_stddev <= 0.0 or tau <= 0.0 or elapsed <= 0.0:
            return
        spread = spec.dynamic_bias_stddev * math.sqrt(-tau / 2.0 * math.expm1(-2.0 * elapsed / tau))
        draw = self._draws.at(sample, _WANDERING).normal(0.0, spread)
        self._wandering = math.exp(-elapsed / tau) * self._wandering + float(draw)


def noisy_picture(rgb: Any, spec: NoiseSpec, seed: int, sensor: str, sample: int) -> Any:
    """A picture (h, w, 3) uint8 with Gazebo's image noise: grey, in parts of full brightness."""
    import numpy as np

    if spec.type not in (GAUSSIAN, QUANTIZED):
        return rgb
    generator = sample_generator(seed, sensor, "image", sample)
    grey = generator.standard_normal(rgb.shape[:2], np.float32)
    shift = np.rint((grey * np.float32(spec.stddev) + np.float32(spec.mean)) * np.float32(255.0))
    # In whole numbers it takes a quarter of the time.
    whole = np.clip(shift, -255, 255).astype(np.int16)
    return np.clip(rgb + whole[..., None], 0, 255).astype(np.uint8)
