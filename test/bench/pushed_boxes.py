#!/usr/bin/env python3
"""Prints how far 534 boxes slide that a constant force pushes, against Coulomb's law.

usage: pushed_boxes.py [BAR]     BAR: of the way; 0.02 by default

Cubes of 2 cm to 1 m with mu 0.1 to 0.9, and boxes of half the height with mu 1, lie on a level
floor and are pushed by 0.5 to 2 mu N at the centre of mass for one second. Those off by more than
BAR are printed, then how many there are. The exit code is 1 if there are any.
"""
from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import List, Tuple

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "engine")]
from pushing import PushedBox, ways

SIZES = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
MUS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.69, 0.7, 0.75, 0.8, 0.9)
PUSHES = (0.5, 0.9, 0.95, 1.05, 1.1, 1.15, 1.3, 2.0)


def cases() -> List[PushedBox]:
    """All cases; the direction of the push differs from one to the next."""
    found: List[Tuple[float, float, float, float]] = [
        (size, size, mu, push) for size in SIZES for mu in MUS for push in PUSHES]
    found += [(size, size / 2, 1.0, 1.1) for size in SIZES]
    return [PushedBox(size, height, mu, push, math.pi / 4 * ((n + n // 8) % 8))
            for n, (size, height, mu, push) in enumerate(found)]


def main() -> int:
    """Run all cases, one world each."""
    bar = float(sys.argv[1]) if len(sys.argv) > 1 else 0.02
    off = 0
    every = cases()
    for case in every:
        way = ways([case])[0]
        if abs(way - case.way()) > max(bar * case.way(), 1e-4):
            off += 1
            print(f"{case}: {way:.4f} m instead of {case.way():.4f}")
    print(f"{off} of {len(every)} are off by more than {100 * bar:g} %")
    return min(1, off)


if __name__ == "__main__":
    sys.exit(main())
