"""Steps that belong to a rate of sim time, exact to the step.

The k-th step of a rate is the first one that begins at or after sim time k / rate. The steps do not
drift, and repeated runs have the same ones. The engine and the plugin host use the same rule.
"""
from __future__ import annotations

from .ring import Clock, picoseconds

_PS = 10 ** 12


class Rate:
    """A rate in Hz of sim time; 0 or less means every step.

    Args:
        hertz: the rate.
        lead: s by which every step of the rate is earlier.
    """

    def __init__(self, hertz: float, lead: float = 0.0) -> None:
        self.hertz, self.lead = hertz, lead
        self._lead_ps = picoseconds(lead)
        self._periods, self._per_ps = 0, 1   # periods in a number of picoseconds
        if hertz > 1e-6:
            from fractions import Fraction  # a world without plugins starts without it

            exact = Fraction(hertz).limit_denominator(10 ** 6)
            self._periods, self._per_ps = exact.numerator, exact.denominator * _PS

    def after(self, step: int, clock: Clock) -> int:
        """Step count of the first step of the rate after `step`."""
        periods, per_ps = self._periods, self._per_ps
        if not periods or per_ps <= periods * clock.step_ps:
            return step + 1
        epoch_ps = clock.epoch_ns * 1000 + self._lead_ps
        number = (epoch_ps + (step - clock.epoch_step) * clock.step_ps) * periods // per_ps
        while True:
            number += 1
            ahead = number * per_ps - epoch_ps * periods
            found = clock.epoch_step - (-ahead // (clock.step_ps * periods))
            if found > step:
                return found

    def is_at(self, step: int, clock: Clock) -> bool:
        return self.after(step - 1, clock) == step

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rate) and (self.hertz, self.lead) == (other.hertz, other.lead)

    def __hash__(self) -> int:
        return hash((self.hertz, self.lead))
