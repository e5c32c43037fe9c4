"""The error model that hector_gazebo_plugins' sensors share.

value * scaleError + offset + drift + white noise. The drift is a first-order Markov process with
the standard deviation `drift` and the time constant 1 / `driftFrequency` (1 h). It is a function of
sim time, whatever the rate and whichever samples are taken (original: its size depends on the
rate): it is stepped exactly 50 times in a time constant, and is straight between two steps.
"""
from __future__ import annotations

import math
from typing import List, Optional, Sequence

from ...sensing.noise import SampleGenerator
from ..context import Context
from ..parameters import Parameters

_WHITE, _DRIFT, _FIRST_DRIFT = range(3)
_HOUR_S = 3600.0
_STRIDES = 50.0          # of the drift, in a time constant
_LEAST_STRIDE_NS = 10 ** 6


class SensorErrors:
    """Errors of a quantity of `width` numbers.

    Args:
        context: of the plugin.
        prefix: of the parameters: `accel` reads accelDrift, "" reads drift.
        width: 1 or 3.
    """

    def __init__(self, context: Context, prefix: str = "", width: int = 3) -> None:
        def read(name: str, default: float) -> List[float]:
            key = f"{prefix}{name}" if prefix else name[0].lower() + name[1:]
            return repeat_numbers(context.parameters, key, width, default)

        self.offset, self.drift = read("Offset", 0.0), read("Drift", 0.0)
        self._frequency = read("DriftFrequency", 1.0 / _HOUR_S)
        self.noise, self._scale = read("GaussianNoise", 0.0), read("ScaleError", 1.0)
        self._draws = SampleGenerator(
            context.seed, f"{context.model}::{context.parameters.text('bodyName')}",
            f"{prefix or 'value'} {context.parameters.text('topicName')}")
        self._width = width
        self._stride_ns = max(_LEAST_STRIDE_NS, round(1e9 / (
            _STRIDES * max(*self._frequency, 1e-9))))
        self.reset(context.now_ns)

    def reset(self, ns: int, drift: Optional[Sequence[float]] = None) -> None:
        """Restart the errors at `ns` with the given drift; without one it is random."""
        self._last_ns = ns
        begin = list(drift) if drift is not None else [
            size * draw for size, draw in zip(self.drift, self._draw(ns, _FIRST_DRIFT))]
        self._shifts = [0.0] * self._width
        number = ns // self._stride_ns
        self._ends = (number, begin, self._step_drift(number + 1, begin))
        self.current = begin

    @property
    def has_drift(self) -> bool:
        return any(self.drift)

    def _step_drift(self, number: int, before: Sequence[float]) -> List[float]:
        """The drift a stride after `before`, at the end of stride `number`."""
        if not self.has_drift:
            return list(before)
        elapsed = self._stride_ns * 1e-9
        return [math.exp(-f * elapsed) * now + size * math.sqrt(-math.expm1(-2 * f * elapsed)) * n
                for f, now, size, n in zip(self._frequency, before, self.drift,
                                           self._draw(number * self._stride_ns, _DRIFT))]

    def _drift_at(self, ns: int) -> List[float]:
        number, begin, end = self._ends
        while number < ns // self._stride_ns:
            number, begin = number + 1, end
            end = self._step_drift(number + 1, begin)
        self._ends = (number, begin, end)
        part = (ns - number * self._stride_ns) / self._stride_ns
        return [a + part * (b - a) for a, b in zip(begin, end)]

    def _draw(self, ns: int, purpose: int) -> List[float]:
        drawn: List[float] = self._draws.at(ns, purpose).standard_normal(self._width).tolist()
        return drawn

    @property
    def bias(self) -> List[float]:
        """Offset and drift at the last sample."""
        return [offset + drift for offset, drift in zip(self.offset, self.current)]

    def shift(self, by: Sequence[float]) -> None:
        """Add to the drift as of the next sample."""
        self._shifts = [now + more for now, more in zip(self._shifts, by)]

    def apply(self, values: Sequence[float], ns: int) -> List[float]:
        """Values of the sample at a sim time, with their errors."""
        elapsed, self._last_ns = max(0.0, (ns - self._last_ns) * 1e-9), ns
        if any(self._shifts):
            self._shifts = [math.exp(-f * elapsed) * now
                            for f, now in zip(self._frequency, self._shifts)]
        self.current = [drift + shift for drift, shift in zip(self._drift_at(ns), self._shifts)]
        white = self._draw(ns, _WHITE) if any(self.noise) else [0.0] * self._width
        return [value * scale + bias + size * n for value, scale, bias, size, n in zip(
            values, self._scale, self.bias, self.noise, white)]


def repeat_numbers(parameters: Parameters, name: str, width: int, default: float) -> List[float]:
    """Read `width` numbers of a parameter; repeat a single number, or use the default."""
    text = parameters.text(name)
    if not text:
        return [default] * width
    words = text.split()
    if width == 1 or len(words) == 1:
        return [parameters.number(name, default)] * width
    return list(parameters.vector(name, (default,) * 3))


def rate_of(parameters: Parameters, usual: float = 0.0) -> float:
    """Hz: `<updateRate>`, or one over `<updatePeriod>`."""
    period = parameters.number("updatePeriod", 0.0)
    return 1.0 / period if period > 0.0 else parameters.number("updateRate", usual)
