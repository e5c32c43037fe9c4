#!/usr/bin/env python3
"""Runs every world below some folders for ten seconds of sim time and says what became of each.

usage: run_worlds.py [--cold] [--with FOLDER] [--seconds N] [--only WORD] [NAME=]FOLDER …

Each world runs without ROS, in a process of its own that may crash or hang without harm, with the
search paths of its own folder first and those of `--with` after it. Columns:

  worlds   files that end in .world
  runs     that came to ten seconds of sim time in `--seconds` of wall time
  refused  that could not be loaded
  late     that did not come to ten seconds in time
  crashes  engines that died
  first    seconds from the start of the process to the first step, median and worst
  silent   longest time without a word before the first step, s
  rtf      real-time factor from the first step on, median and worst
  moved    models that moved more than 1 mm between 5 and 10 s
  fell     models that are more than 1 m below where they began, and below -1 m

The exit status is 0 where nothing was refused, late, crashed or fell.
"""
from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from statistics import median
from typing import Any, Dict, List, Sequence, Tuple

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from corpus import environment, files_below

_SOURCES = os.path.join(HERE, "..", "..", "src")
_SLACK_S = 20.0  # for a process that has to come to its end
COLUMNS = ("worlds", "runs", "refused", "late", "crashes", "first", "silent", "rtf", "moved",
           "fell")


def run(path: str, folders: Sequence[str], seconds: float, cache: str = "") -> Dict[str, Any]:
    """What one world did; see `world_run`. `end` is "crash" or "hang" where it did not say.

    Args:
        path: of the world.
        folders: its search paths, the first one first.
        seconds: of wall time that it may take.
        cache: folder of the caches; "" for the user's.
    """
    surroundings = environment(folders)
    surroundings["PYTHONPATH"] = os.pathsep.join(
        filter(None, [_SOURCES, surroundings.get("PYTHONPATH")]))
    if cache:
        surroundings["XDG_CACHE_HOME"] = cache
    began = time.monotonic()
    with tempfile.TemporaryFile() as output:
        child = subprocess.Popen(
            [sys.executable, os.path.join(HERE, "world_run.py"), path, repr(began), repr(seconds)],
            env=surroundings, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.DEVNULL)
        try:
            child.wait(seconds + _SLACK_S)
            end = "crash"
        except subprocess.TimeoutExpired:
            end = "hang"
            child.kill()
            child.wait()
        output.seek(0)
        lines = output.read().splitlines()
    if child.returncode or not lines:
        return {"end": end}
    found: Dict[str, Any] = json.loads(lines[-1])
    return found


def tell(path: str, found: Dict[str, Any]) -> None:
    """A few lines about one world."""
    print(path)
    if "end" in found:
        print(f"    {found['end']}: {found.get('why', 'no word')}")
    if "first" in found:
        print(f"    first step after {found['first']:.1f} s, silent for {found['silent']:.1f} s; "
              f"real-time factor {found['rtf']:.2f} up to {found['sim']:.1f} s; "
              f"{found['models']} models, {found['errors']} errors")
    for name, way in sorted(found.get("moved", {}).items(), key=lambda item: -item[1])[:12]:
        print(f"    moved {1000 * way:9.1f} mm  {name}")
    for name, height in sorted(found.get("fell", {}).items()):
        print(f"    fell to {height:8.1f} m   {name}")
    for line in found.get("crashes", ()):
        print(f"    {line}")
    sys.stdout.flush()


def row_of(results: Sequence[Dict[str, Any]]) -> List[str]:
    """The columns of one folder."""
    ran = [one for one in results if "first" in one]

    def pair(key: str, worst: Any) -> str:
        values = [one[key] for one in ran]
        return f"{median(values):.1f}/{worst(values):.1f}" if values else "-"

    return [str(len(results)), str(sum("end" not in one for one in results)),
            str(sum(one.get("end") in ("refused", "crash") for one in results)),
            str(sum(one.get("end") in ("late", "hang") for one in results)),
            str(sum(len(one.get("crashes", ())) for one in results)),
            pair("first", max), f"{max((one['silent'] for one in ran), default=0.0):.1f}",
            pair("rtf", min), str(sum(len(one["moved"]) for one in ran)),
            str(sum(len(one["fell"]) for one in ran))]


def table(rows: Sequence[Tuple[str, List[str]]]) -> str:
    """The rows under their heads."""
    width = max(len(name) for name, _ in rows)
    lines = [" " * width + "".join(f" {head:>10}" for head in COLUMNS)]
    lines += [f"{name:{width}}" + "".join(f" {value:>10}" for value in row) for name, row in rows]
    return "\n".join(lines)


def main(argv: Sequence[str]) -> int:
    """Prints the table; see the module's text."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folders", nargs="+", metavar="[NAME=]FOLDER")
    parser.add_argument("--with", dest="shared", action="append", default=[], metavar="FOLDER",
                        help="models that every world may use")
    parser.add_argument("--seconds", type=float, default=120.0, help="of wall time for a world")
    parser.add_argument("--only", default="", metavar="WORD", help="in the world's path")
    parser.add_argument("--cold", action="store_true",
                        help="give each world a cache of its own that is empty")
    options = parser.parse_args(argv)
    shared = [os.path.abspath(folder) for folder in options.shared]
    rows: List[Tuple[str, List[str]]] = []
    good = True
    for text in options.folders:
        name, _, folder = text.rpartition("=")
        folder = os.path.abspath(folder)
        results = []
        for path in files_below(folder):
            if not path.endswith(".world") or options.only not in path:
                continue
            with tempfile.TemporaryDirectory() as cache:
                found = run(path, [folder, *shared], options.seconds, cache if options.cold else "")
            tell(path, found)
            results.append(found)
            good = good and "end" not in found and not found["fell"] and not found["crashes"]
        rows.append((name or os.path.basename(folder), row_of(results)))
    print("\n" + table(rows))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
