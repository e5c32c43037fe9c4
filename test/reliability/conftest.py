"""Keeps the figures of proofs for doc/dev/reliability.md."""
from __future__ import annotations

import json
import logging
import os
import time
import warnings
from typing import Any, Callable, Dict, Iterator

import pytest
from proofs import IS_LONG

RECORDS = "MY_SIMULATIONS_RELIABILITY"
"""Environment variable: file that gets a line of JSON for each proof."""


@pytest.fixture
def silent() -> Iterator[None]:
    """No log lines and warnings: pytest keeps all of a test, which would count as its growth."""
    logging.disable()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
    logging.disable(logging.NOTSET)


@pytest.fixture
def record(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Keeps the figures of a proof that has passed, for doc/dev/reliability.md."""
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
