"""The size of proofs: small in CI, full by `tools/test --long`."""
from __future__ import annotations

import os
from typing import Callable

IS_LONG = os.environ.get("MY_SIMULATIONS_LONG") == "1"


def scaled(short: int, long: int) -> int:
    """Return the count for this run, which is short or long."""
    return long if IS_LONG else short


ALLOWED = "MY_SIMULATIONS_PROOF_SECONDS"
"""Environment variable: processor time after which a proof stops reading inputs, in seconds."""


def allowance() -> Callable[[], float]:
    """Return a function for the used share of the allowed processor time; 0 without a limit."""
    most = float(os.environ.get(ALLOWED) or "inf")
    began = spent()
    return lambda: (spent() - began) / most


def spent() -> float:
    """Processor time of this process and of the children that it has waited for, in seconds."""
    return sum(os.times()[:4])


def per_second(count: int, began: float) -> int:
    """Inputs in a second of processor time since `spent()` was `began`, to two digits."""
    return round(float(f"{count / max(spent() - began, 0.01):.2g}"))
