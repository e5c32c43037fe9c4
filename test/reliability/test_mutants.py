"""Inputs changed by their structure, fast: all faults are told, none is raised, nothing grows."""
from __future__ import annotations

import os

import pytest
from mutant_doors import DOORS
from mutant_plugins import Plugins
from mutant_readers import READERS
from mutant_run import prove
from proofs import scaled

INPUTS = int(os.environ.get("MY_SIMULATIONS_MUTATIONS") or scaled(500, 1_000_000))
"""Of each proof: ten of them make 10 million in a long run."""


pytestmark = pytest.mark.usefixtures("silent")


@pytest.mark.parametrize("name", sorted(READERS))
def test_readers(record, tmp_path, name):
    prove(READERS[name](tmp_path), INPUTS, record, tmp_path / "found")


DOORS = {**DOORS, "plugins": Plugins}


@pytest.mark.parametrize("name", sorted(DOORS))
def test_doors(record, tmp_path, name):
    door = DOORS[name](tmp_path)
    try:
        prove(door.target, INPUTS, record, tmp_path / "found")
    finally:
        door.close()
