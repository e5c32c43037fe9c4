"""Chooses the program of a submission that contains several."""
from __future__ import annotations

import os
import re
from typing import NamedTuple, Sequence, Tuple

from .submission import files_by_pattern, summarize_names

_LARGEST = 1 << 20   # bytes of a file that are searched
_STARTS_NODE = re.compile(r"^[^#\n]*\binit_node\s*\(", re.MULTILINE)
_IS_MAIN = re.compile(r"^if\s+__name__\s*==\s*[\"']__main__[\"']", re.MULTILINE)


class Choice(NamedTuple):
    """A program of a submission.

    Attributes:
        name: path in the submission; "" if nothing fits.
        note: why it was chosen; "" if it is the only one.
    """

    name: str
    note: str


def choose_program(folder: str, patterns: Sequence[str]) -> Choice:
    """Choose the program that is run.

    The first pattern that fits decides. Of several Python files those come first that start a node
    of ROS and contain a main program, then those that do one of the two; else the order of paths
    decides, as of `submission.find_matching`.

    Args:
        folder: the submission.
        patterns: of the program's path.
    """
    for pattern, found in zip(patterns, files_by_pattern(folder, patterns)):
        if found:
            kinds = {name: _kind(os.path.join(folder, name)) for name in found}
            first, *others = sorted(found, key=lambda name: (-sum(kinds[name]), not kinds[name][0]))
            if not others:
                return Choice(first, "")
            is_best = all(kinds[first] != kinds[other] for other in others)
            return Choice(first, f"{first} was run, {_reason(kinds[first], is_best)}; the"
                                 f" submission contains more files that fit {pattern}:"
                                 f" {summarize_names(others)}")
    return Choice("", "")


def _reason(kind: Tuple[bool, bool], is_best: bool) -> str:
    starts_node, is_main = kind
    if not is_best or not (starts_node or is_main):
        return "which has the fewest folders and then the first name"
    parts = ["calls init_node"] * starts_node + ["has a main program"] * is_main
    return f"because it {' and '.join(parts)}"


def _kind(path: str) -> Tuple[bool, bool]:
    """Whether a Python file starts a node of ROS, and whether it has a main program."""
    if not path.lower().endswith(".py"):
        return False, False
    with open(path, encoding="utf-8", errors="replace") as stream:
        text = stream.read(_LARGEST)
    return _STARTS_NODE.search(text) is not None, _IS_MAIN.search(text) is not None
