"""One hierarchy of errors: every exception of the package has a place in it."""
from __future__ import annotations

import ast
import builtins
import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(REPOSITORY / "tools" / "generate"))

from source_codes import modules

ROOT = "SimulationError"
STANDALONE = {"resources/database/archive_worker.py"}
"""Runs in an isolated interpreter, without the package."""

SIGNALS = {"_StopParsing", "CallOverdue", "ThreadAbandoned"}
"""Control flow, no error (PEP 8 asks for the suffix where the exception is an error)."""


def exceptions():
    """Name, bases and module of every exception class of the package."""
    classes = [(node.name, [getattr(base, "id", getattr(base, "attr", "")) for base in node.bases],
                module.path) for module in modules() for node in module.nodes
               if isinstance(node, ast.ClassDef)]
    known = {name for name, kind in vars(builtins).items()
             if isinstance(kind, type) and issubclass(kind, BaseException)}
    found = []
    while True:
        more = [row for row in classes if row not in found and known & set(row[1])]
        if not more:
            return found
        found += more
        known |= {name for name, _, _ in more}


EXCEPTIONS = exceptions()


def test_the_scan_finds_the_hierarchy():
    assert {"SimulationError", "InputError", "CommandError", "UnknownEntityError",
            "ResourceNotFoundError"} <= {name for name, _, _ in EXCEPTIONS}


def test_every_exception_is_named_error():
    assert [row for row in EXCEPTIONS
            if not row[0].endswith("Error") and row[0] not in SIGNALS] == []


def test_every_public_exception_derives_from_the_common_root():
    bases = {name: found for name, found, _ in EXCEPTIONS}

    def is_rooted(name):
        return name == ROOT or any(is_rooted(base) for base in bases.get(name, ()))

    assert [row for row in EXCEPTIONS if not row[0].startswith("_") and row[0] not in SIGNALS
            and row[2] not in STANDALONE and not is_rooted(row[0])] == []


def test_no_two_exceptions_share_a_name():
    names = [name for name, _, _ in EXCEPTIONS]
    assert sorted(names) == sorted(set(names))
