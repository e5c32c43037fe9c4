"""One row of a study's table: the result of a case."""
from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from typing import Any, Dict, Union

OK, FAILED, REFUSED, DIVERGED, CRASHED, TIMED_OUT, TOO_LARGE, NODE_LOST = (
    "ok", "failed", "refused", "diverged", "crashed", "timed out", "too large", "node lost")
STATUSES = (OK, FAILED, REFUSED, DIVERGED, CRASHED, TIMED_OUT, TOO_LARGE, NODE_LOST)

Measured = Union[float, bool]


@dataclass
class Row:
    """The result of a case.

    Attributes:
        status: one of STATUSES.
        case: its id.
        index: its number in the plan.
        seed: its seed.
        settings: values of what was varied.
        values: measured and required values; empty unless the run was completed.
        attempt: in which attempt this came out, from 1.
        flaky: whether an attempt before this one crashed, and this one did not.
        signal: name of the signal that ended the engine; "" for none.
        step: the last step that was shown.
        issue: the first error, else "".
        hash: of the final poses, twists and joints, 32 hexadecimal digits.
        processor: model of the processor.
        seconds: processor time of the engine, s; of a scenario wall time.
        trajectory: file with its trajectory, beside the table; "" for none.
    """

    status: str
    case: str
    index: int
    seed: int
    settings: Dict[str, Any] = field(default_factory=dict)
    values: Dict[str, Measured] = field(default_factory=dict)
    attempt: int = 1
    flaky: bool = False
    signal: str = ""
    step: int = 0
    issue: str = ""
    hash: str = ""
    processor: str = ""
    seconds: float = 0.0
    trajectory: str = ""

    def line(self) -> str:
        """One line of the journal; the status stands first. NaN and infinity are texts."""
        plain = dict(vars(self))  # asdict copies all, which took more time than all else here
        plain["values"] = {name: value if math.isfinite(value) else str(value)
                           for name, value in self.values.items()}
        return json.dumps(plain, separators=(",", ":"), allow_nan=False) + "\n"


def row_of(line: "str | bytes") -> Row:
    """The row of a line of the journal. Raises ValueError, TypeError or KeyError."""
    plain = json.loads(line)
    plain["values"] = {name: float(value) if isinstance(value, str) else value
                       for name, value in plain["values"].items()}
    return Row(**plain)
