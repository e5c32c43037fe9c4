#!/usr/bin/env python3
"""Files that mean harm, and what it takes to refuse them: time and peak memory of a whole process.

Started with the path of a file it reads that file as a world and prints seconds and MB.
"""
from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from typing import Callable, Dict, Iterator, List, Tuple

SECONDS, MEGABYTES = 1.0, 200.0
_HEAD, _FOOT = b"<sdf version='1.6'><world name='w'>", b"</world></sdf>"


def _bomb() -> Iterator[bytes]:
    entities = "".join(f"<!ENTITY e{n} '{f'&e{n - 1};' * 10 if n else 'ha'}'>" for n in range(10))
    yield f"<!DOCTYPE sdf [{entities}]>".encode() + _HEAD + b"&e9;" + _FOOT


def _external() -> Iterator[bytes]:
    yield (b"<!DOCTYPE sdf [<!ENTITY x SYSTEM 'file:///etc/passwd'>]>" + _HEAD + b"&x;" + _FOOT)


def _nested() -> Iterator[bytes]:
    yield _HEAD + b"<a>" * 200000 + b"</a>" * 200000 + _FOOT


def _text() -> Iterator[bytes]:
    yield _HEAD
    for _ in range(1024):
        yield b"abcdefgh" * (1 << 17)
    yield _FOOT


FILES: Dict[str, Callable[[], Iterator[bytes]]] = {
    "an entity bomb": _bomb, "an external entity": _external, "200 000 nested elements": _nested,
    "1 GB of text": _text}


def measured() -> List[Tuple[str, float, float]]:
    """(what, seconds, MB) of each file, in a process of its own that has read nothing else."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "hostile.world")
        for what, parts in FILES.items():
            with open(path, "wb") as stream:
                stream.writelines(parts())
            done = subprocess.run([sys.executable, os.path.abspath(__file__), path], check=True,
                                  capture_output=True, text=True, timeout=600)
            seconds, megabytes = map(float, done.stdout.split())
            found.append((what, seconds, megabytes))
    return found


def _read(path: str) -> None:
    from my_simulations.errors import InputError
    from my_simulations.formats.reading import read_world
    from my_simulations.resources.resolver import Resolver

    began = time.perf_counter()
    try:
        read_world(path, Resolver())
    except InputError:
        span = time.perf_counter() - began
        # Not getrusage: its figure begins with what the parent had when it started this process.
        with open("/proc/self/status") as status:
            peak = next(line for line in status if line.startswith("VmHWM:"))
        print(span, int(peak.split()[1]) / 1024)
        return
    raise SystemExit("it was not refused")


if __name__ == "__main__":
    _read(sys.argv[1])
