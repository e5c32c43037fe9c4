"""How much of a proof is done: little in CI, all by `tools/test --long`."""
from __future__ import annotations

import os

IS_LONG = os.environ.get("MY_SIMULATIONS_LONG") == "1"


def scaled(short: int, long: int) -> int:
    """What this run does."""
    return long if IS_LONG else short
