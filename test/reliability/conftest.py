"""Proofs that are short in CI and long by `tools/test --long`; figures go to the table."""
from __future__ import annotations

import json
import os
import time
from typing import Any, Callable, Dict

import pytest

IS_LONG = os.environ.get("MY_SIMULATIONS_LONG") == "1"
RECORDS = "MY_SIMULATIONS_RELIABILITY"
"""Environment variable: file that gets a line of JSON for each proof."""


def scaled(short: int, long: int) -> int:
    """How much of a proof this run does."""
    return long if IS_LONG else short


@pytest.fixture
def record(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Keeps the figures of a proof that has passed, for doc/reliability.md."""
    began = time.monotonic()

    def keep(proof: str, **figures: Any) -> None:
        path = os.environ.get(RECORDS)
        line: Dict[str, Any] = {
            "proof": proof, "test": request.node.nodeid.split("[")[0], "long": IS_LONG,
            "seconds": round(time.monotonic() - began), "figures": figures}
        print(line)
        if path:
            with open(path, "a", encoding="utf-8") as stream:
                stream.write(json.dumps(line) + "\n")

    return keep
