#!/usr/bin/env python3
"""Writes test/costly_tests.txt from what `tools/test --complete --processor-time` has written.

    tools/generate/costly_tests.py OUTPUT LOG... [--seconds S]

OUTPUT is its standard output, the LOGs are those of its runs of pytest. A test is costly if it
takes S seconds of processor time or more, a rostest if its tests do so on average.
"""
from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Iterable, Iterator, Tuple

REPOSITORY = Path(__file__).resolve().parents[2]
_TEST = re.compile(r" *([0-9.]+) (test/\S+\.py::.*)")
_ROSTEST = re.compile(r"\[\d+/\d+\] (rostest \S+) \.\.\. (\d+) ok \(.*processor ([0-9.]+) s\)")
_HEAD = ("# Processor time, s, and names of the tests that only `tools/test --complete` runs.\n"
         "# Written by tools/generate/costly_tests.py.\n")


def costly(lines: Iterable[str], least: float) -> Iterator[Tuple[str, float]]:
    """The names of tests with the processor time of each, s."""
    for line in lines:
        test, rostest = _TEST.fullmatch(line), _ROSTEST.match(line)
        if test and float(test.group(1)) >= least:
            yield test.group(2), float(test.group(1))
        if rostest and float(rostest.group(3)) >= least * int(rostest.group(2)):
            yield rostest.group(1), float(rostest.group(3))


def main() -> None:
    """Write the list."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--seconds", type=float, default=2.0)
    words = parser.parse_args()
    lines = [line for file in words.files
             for line in file.read_text(encoding="utf-8", errors="replace").splitlines()]
    found = dict(costly(lines, words.seconds))
    text = "".join(f"{seconds:.1f} {name}\n" for name, seconds in sorted(found.items()))
    (REPOSITORY / "test" / "costly_tests.txt").write_text(_HEAD + text, encoding="utf-8")
    print(f"{len(found)} tests, {sum(found.values()):.0f} s")


if __name__ == "__main__":
    main()
