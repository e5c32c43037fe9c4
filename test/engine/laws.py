"""What was measured against which law, printed at the end of a run."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Dict, List, Sequence, Union

Value = Union[float, Sequence[float]]


@dataclass
class Finding:
    """The worst of all measurements of one law; `deviation` and `bar` in the unit of the bar."""

    law: str
    measured: float
    expected: float
    deviation: float
    bar: float
    relative: bool
    count: int = 1

    def line(self) -> str:
        """One row of the report."""
        def shown(value: float) -> str:
            return f"{100 * value:.3g} %" if self.relative else f"{value:.3g}"
        return (f"{self.law:<62} {self.measured:>12.6g} {self.expected:>12.6g} "
                f"{shown(self.deviation):>10} {shown(self.bar):>9} {self.count:>5}")


class Laws:
    """Compares with laws and remembers the worst of each."""

    def __init__(self) -> None:
        self._found: Dict[str, Finding] = {}

    def near(self, law: str, measured: Value, expected: Value, *, rel: float = 0.0,
             abs: float = 0.0) -> None:
        """`measured` must be within `rel` times `expected`, or within `abs`, of `expected`."""
        if not isinstance(measured, (int, float)) or not isinstance(expected, (int, float)):
            assert len(measured) == len(expected)
            for one, other in zip(measured, expected):
                self.near(law, one, other, rel=rel, abs=abs)
            return
        deviation = math.fabs(measured - expected) / (math.fabs(expected) if rel else 1.0)
        finding = Finding(law, measured, expected, deviation, rel or abs, rel > 0.0)
        before = self._found.get(law)
        if before is not None:
            finding.count = before.count + 1
            if deviation <= before.deviation:
                before.count += 1
                finding = before
        self._found[law] = finding
        assert deviation <= (rel or abs), (
            f"{law}: {measured} is not within {rel or abs} of {expected}")

    def at_most(self, law: str, measured: float, bar: float) -> None:
        """`measured` must not be above `bar`."""
        self.near(law, max(0.0, measured), 0.0, abs=bar)

    def report(self) -> List[str]:
        """The table, a row a law."""
        if not self._found:
            return []
        head = (f"{'law':<62} {'measured':>12} {'expected':>12} {'off by':>10} {'bar':>9} "
                f"{'cases':>5}")
        return [head] + [self._found[law].line() for law in sorted(self._found)]
