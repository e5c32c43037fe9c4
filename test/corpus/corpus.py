#!/usr/bin/env python3
"""Reads every world, model and robot below some folders and says what became of each.

usage: corpus.py [--all] [--seconds N] [NAME=]FOLDER …

A file is read as `check_model` reads it, meshes included, in a process of its own kind that may
crash or hang without harm. Model and resource paths are taken from the folders themselves: what
holds model folders is a model path, what holds a `media` folder a resource path, what holds
packages a package path. Columns:

  files    worlds, SDF and URDF files, and xacro files that make a robot
  clean    no error (there may be warnings)
  absent   every error is about a file that is nowhere below the folders
  invalid  errors that Gazebo reports as well: see `INVALID`
  ours     errors that are left
  crash    the process ended; `hang`: it took longer than `--seconds`

The exit status is 0 where 99 % are clean, absent or invalid and none crashed or hung.
"""
from __future__ import annotations

import argparse
import os
import re
import sys
import time
from collections import Counter
from typing import Any, Dict, Iterator, List, Sequence, Set, Tuple

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from workers import Worker

EXTENSIONS = (".world", ".sdf", ".urdf", ".xacro")
COLUMNS = ("files", "clean", "absent", "invalid", "ours", "crash", "hang")

INVALID = {
    "include-uri-missing": "Gazebo: an include without a URI finds nothing",
    "root-unknown": "Gazebo reads no documents of before SDF",
    "joint-link-unknown": "Gazebo: the joint's link cannot be found",
}
_MISSING = ("model-not-found", "mesh-not-found", "image-not-found", "xacro-failed")
_URI = re.compile(r"'([^']+)' was not found|resource not found: (\w+)")  # the latter: a package


def files_below(folder: str) -> Iterator[str]:
    """Every file that may be read, sorted."""
    for at, folders, names in os.walk(folder):
        folders.sort()
        for name in sorted(names):
            if name.endswith(EXTENSIONS):
                yield os.path.join(at, name)


def environment(folders: Sequence[str]) -> Dict[str, str]:
    """Gazebo's and ROS's search paths, from what lies in the folders."""
    models: Dict[str, None] = {}
    media: Dict[str, None] = {}
    packages: Dict[str, None] = {}
    for folder in folders:
        media[folder] = None
        for at, inside, names in os.walk(folder):
            inside.sort()
            if "model.config" in names or "manifest.xml" in names:
                models[os.path.dirname(at)] = None
            if "media" in inside or "Media" in inside:
                media[at] = None
            if "package.xml" in names:
                packages[os.path.dirname(at)] = None
    ros = [*packages, *filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep))]
    return {**os.environ, "GAZEBO_MODEL_PATH": os.pathsep.join(models),
            "GAZEBO_RESOURCE_PATH": os.pathsep.join(media),
            "ROS_PACKAGE_PATH": os.pathsep.join(ros), "GAZEBO_MODEL_DATABASE_URI": ""}


class Shelf:
    """What there is below the folders."""

    def __init__(self, folders: Sequence[str]) -> None:
        self._tails: Set[str] = set()
        for folder in folders:
            for at, inside, names in os.walk(folder):
                parts = at.split(os.sep)
                for name in (*names, *inside):
                    for count in range(min(4, len(parts)) + 1):
                        self._tails.add("/".join([*parts[len(parts) - count:], name]))

    def has(self, uri: str) -> bool:
        """Whether some path ends as the URI does (its last three names, where it has so many).

        A single name with an extension is too common to be looked for anywhere but beside the
        file, which the resolver did.
        """
        scheme, _, rest = uri.rpartition("://")
        if scheme.startswith("http"):
            return False
        parts = [part for part in rest.split("/") if part not in ("", ".", "..")]
        if len(parts) == 1 and os.path.splitext(parts[0])[1]:
            return False
        return "/".join(parts[-3:]) in self._tails


def verdict(issues: Sequence[Dict[str, Any]], shelf: Shelf) -> str:
    """The column of a file that was read."""
    faults = [issue for issue in issues if issue["severity"] == "error"]
    if not faults:
        return "clean"
    kinds = {_kind(fault, shelf) for fault in faults}
    # A joint to a model that is absent fails for the same reason.
    if "absent" in kinds and all(_kind(fault, shelf) == "absent"
                                 or fault["code"] == "joint-link-unknown" for fault in faults):
        return "absent"
    return "ours" if "ours" in kinds else "invalid"


def _kind(fault: Dict[str, Any], shelf: Shelf) -> str:
    if fault["code"] in _MISSING:
        found = _URI.search(fault["message"])
        return "ours" if found is None or shelf.has(found[1] or found[2]) else "absent"
    return "invalid" if fault["code"] in INVALID else "ours"


def main(argv: Sequence[str]) -> int:
    """Prints the table; see the module's text."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folders", nargs="+", metavar="[NAME=]FOLDER")
    parser.add_argument("--seconds", type=float, default=60.0, help="more for a file is a hang")
    parser.add_argument("--all", action="store_true", help="show warnings, too")
    options = parser.parse_args(argv)
    named: List[Tuple[str, str]] = []
    for text in options.folders:
        name, _, folder = text.rpartition("=")
        folder = os.path.abspath(folder)
        named.append((name or os.path.basename(folder), folder))
    worker = Worker(environment([folder for _, folder in named]), options.seconds)
    shelf = Shelf([folder for _, folder in named])
    rows: List[Tuple[str, Counter[str]]] = []
    slowest: Tuple[float, str] = (0.0, "")
    codes: Counter[Tuple[str, str]] = Counter()
    for name, folder in named:
        row: Counter[str] = Counter()
        for path in files_below(folder):
            began = time.monotonic()
            answer = worker.read(path)
            slowest = max(slowest, (time.monotonic() - began, path))
            column = answer.get("end") or verdict(answer["issues"], shelf)
            if answer.get("fragment"):
                continue  # xacro that only defines macros
            row["files"] += 1
            row[column] += 1
            codes.update({(i["severity"], i["code"]) for i in answer.get("issues", ())})
            _show(column, path, answer.get("issues", ()), options.all)
        rows.append((name, row))
    worker.close()
    return _table(rows, codes, slowest)


def _show(column: str, path: str, issues: Sequence[Dict[str, Any]], everything: bool) -> None:
    if column in ("crash", "hang"):
        print(f"{column:8}{path}")
    for issue in issues:
        if everything or issue["severity"] == "error":
            hint = INVALID.get(issue["code"], "") if issue["severity"] == "error" else ""
            line = f":{issue['line']}" if issue["line"] else ""
            print(f"{column:8}{issue['file'] or path}{line}: {issue['severity']}"
                  f" [{issue['code']}] {issue['message']}" + (f" ({hint})" if hint else ""))


def _table(rows: Sequence[Tuple[str, Counter[str]]], codes: Counter[Tuple[str, str]],
           slowest: Tuple[float, str]) -> int:
    print("\nfiles with …")
    for (severity, code), count in sorted(codes.items()):
        print(f"  {count:5} {severity} {code}")
    print(f"\nslowest: {slowest[0]:.1f} s, {slowest[1]}\n")
    width = max(len(name) for name, _ in rows)
    print(" " * width + "".join(f"{column:>9}" for column in COLUMNS))
    good = True
    for name, row in rows:
        print(f"{name:{width}}" + "".join(f"{row[column]:9}" for column in COLUMNS))
        good = good and not (row["crash"] or row["hang"]) and row["ours"] <= 0.01 * row["files"]
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
