"""Inputs with changed structure: all faults are reported, none is raised, memory stays."""
from __future__ import annotations

import os

import pytest
from heap import memory
from mutant_doors import DOORS
from mutant_plugins import Plugins
from mutant_readers import READERS, read_document
from mutant_run import GROWTH, prove
from proofs import scaled

INPUTS = int(os.environ.get("MY_SIMULATIONS_MUTATIONS") or scaled(500, 1_000_000))
"""Inputs of each proof: ten proofs make 10 million in a long run."""


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


def test_memory_does_not_grow(record):
    def read_documents(count: int) -> None:
        for n in range(count):
            read_document(f"<sdf version='1.6'><model name='m{n}'><link name='l'><a{n}/></link>"
                          "</model></sdf>")
            read_document(f"<robot name='r{n}'><link name='l'/>")

    read_documents(scaled(300, 5000))
    before = memory()
    read_documents(scaled(1000, 100000))
    after = memory()
    assert after < GROWTH * before
    record("memory while reading", growth_percent=round(100 * (after / before - 1), 2))
