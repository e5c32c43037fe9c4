#!/usr/bin/env python3
"""Reads every world, model and robot below some folders and says what became of each.

usage: corpus.py [--all] [--seconds N] [NAME=]FOLDER …

A file is read as `check_model` reads it, meshes included, in a process of its own kind that may
crash or hang without harm. Model and resource paths are taken from the folders themselves: what
holds model folders is a model path, what holds a `media` folder a resource path, what holds
packages a package path. Columns:

  files    worlds, SDF and URDF files, and xacro files that make a robot without being given more
  clean    no error and nothing tolerated (there may be warnings)
  odd      no error, but faults that Gazebo tolerates, and we do as it does
  missing  what is wrong is that files are nowhere below the folders
  faulty   errors that Gazebo reports as well, for which it refuses the document: see `FAULTY`
  ours     errors that are left
  crash    the process ended; `hang`: it took longer than `--seconds`

The exit status is 0 where 99 % of each row are not ours and none crashed or hung.
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
COLUMNS = ("files", "clean", "odd", "missing", "faulty", "ours", "crash", "hang")

FAULTY = {
    "include-uri-missing": "libsdformat: an include without a URI finds nothing",
    "root-unknown": "libsdformat reads no documents of before SDF",
    "bad-value": "libsdformat, urdfdom: not a value; the document is refused",
    "name-empty": "libsdformat, urdfdom: a required name is missing",
    "joint-type-missing": "libsdformat: a required attribute is missing",
    "joint-link-missing": "libsdformat, urdfdom: a joint must have a parent and a child",
    "geometry-missing": "libsdformat, urdfdom: a shape must have a geometry",
    "geometry-unknown": "Gazebo: unknown collision geometry type",
    "mass-not-positive": "Gazebo: setting the mass of a link to zero is an exception",
    "attribute-missing": "urdfdom: a shape must have its sizes",
    "mass-missing": "urdfdom: an inertial must have a mass",
    "inertia-missing": "urdfdom: an inertial must have an inertia",
    "joint-limit-missing": "urdfdom: a revolute or prismatic joint must have limits",
    "joint-link-unknown": "urdfdom: a joint must connect links that are defined",
    "joint-type-unknown": "urdfdom: a joint must have a known type",
    "joint-cycle": "urdfdom: the links of a robot form a tree",
    "name-repeated": "urdfdom: links and joints have names of their own",
    "root-many": "urdfdom: two root links",
    "root-missing": "urdfdom: no root link",
    "link-missing": "Gazebo: no link with a mass; the robot is not created",
    "xml-truncated": "TinyXML, expat: the document ends too early",
    "xml-empty": "TinyXML: the document is empty",
    "xml-no-root": "TinyXML: no element",
    "xacro-unexpanded": "urdfdom: the values are expressions",
    "include-cycle": "libsdformat: a model that includes itself is read without end",
}
"""Codes of errors with the voice of who refuses the document in Gazebo 11."""
_MISSING = ("model-not-found", "mesh-not-found", "image-not-found", "xacro-failed")
_URI = re.compile(r"'([^']+)' was not found|resource not found: (\w+)"  # the latter: a package
                  r"|No such file or directory: ([^\s;]+)")
_NEEDS_MORE = re.compile(r"Undefined substitution argument|name '\w+' is not defined|unknown macro")
"""What xacro says of a file that is given arguments by others, or is a part of another one."""


def files_below(folder: str, extensions: Sequence[str] = EXTENSIONS) -> Iterator[str]:
    """Every file that may be read, sorted."""
    for at, folders, names in os.walk(folder):
        folders.sort()
        for name in sorted(names):
            if name.endswith(tuple(extensions)):
                yield os.path.join(at, name)


def environment(folders: Sequence[str]) -> Dict[str, str]:
    """Return Gazebo's and ROS's search paths for the models, media and packages in the folders."""
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
        self._undescribed: Set[str] = set()
        self._packages: Dict[str, str] = {}
        for folder in folders:
            for at, inside, names in os.walk(folder):
                if "model.config" in names and not any(n.endswith((".sdf", ".urdf"))
                                                       for n in names):
                    self._undescribed.add(os.path.basename(at))  # made by a build
                if "package.xml" in names:
                    self._packages.setdefault(_package_name(at), at)
                parts = at.split(os.sep)
                for name in (*names, *inside):
                    for count in range(min(4, len(parts)) + 1):
                        self._tails.add("/".join([*parts[len(parts) - count:], name]))

    def has(self, uri: str) -> bool:
        """Whether some path ends as the URI does (its last three names, where it has so many).

        Paths, whole or relative, are found where they say or nowhere.
        """
        scheme, _, rest = uri.rpartition("://")
        if scheme not in ("model", "package", "file", ""):
            return False
        if not scheme and not rest.startswith("/"):
            return False  # beside the file, or in a resource path: the resolver has looked there
        if scheme == "file" or rest.startswith("/"):
            return os.path.exists(rest)
        parts = [part for part in rest.split("/") if part not in ("", ".", "..")]
        if scheme == "package" and parts and parts[0] in self._packages:
            return os.path.exists(os.path.join(self._packages[parts[0]], *parts[1:]))
        if scheme == "model" and parts and parts[0] in self._undescribed:
            return False
        return "/".join(parts[-3:]) in self._tails


def _package_name(folder: str) -> str:
    with open(os.path.join(folder, "package.xml"), errors="replace") as stream:
        found = re.search(r"<name>\s*([^<\s]+)\s*</name>", stream.read())
    return found[1] if found else os.path.basename(folder)


def verdict(issues: Sequence[Dict[str, Any]], shelf: Shelf) -> str:
    """The column of a file that was read."""
    kinds = {_kind(issue, shelf) for issue in issues}
    for kind in ("ours", "faulty", "missing", "odd"):
        if kind in kinds:
            return kind
    return "clean"


def is_part(path: str, issues: Sequence[Dict[str, Any]]) -> bool:
    """True for xacro that defines macros only, is a part of a world, or must be given arguments."""
    faults = [issue for issue in issues if issue["severity"] == "error"]
    return path.endswith(".xacro") and bool(faults) and all(
        fault["code"] in ("link-missing", "root-unknown")
        or (fault["code"] == "xacro-failed" and _NEEDS_MORE.search(fault["message"]))
        for fault in faults)


def _kind(issue: Dict[str, Any], shelf: Shelf) -> str:
    is_error = issue["severity"] == "error"
    if not (is_error or issue["tolerated"]):
        return "clean"
    if issue["code"] == "xacro-failed" and "XML parsing error" in issue["message"]:
        return "faulty"
    if issue["code"] in _MISSING:
        found = _URI.search(issue["message"])
        return "ours" if found is None or shelf.has(
            found[1] or found[2] or found[3]) else "missing"
    if is_error:
        return "faulty" if issue["code"] in FAULTY else "ours"
    return "odd"


def main(argv: Sequence[str]) -> int:
    """Prints the table; see the module's text."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folders", nargs="+", metavar="[NAME=]FOLDER")
    parser.add_argument("--seconds", type=float, default=60.0, help="more for a file is a hang")
    parser.add_argument("--show", default="ours,crash,hang", metavar="COLUMN,…",
                        help="files of which columns are told about (default: %(default)s)")
    parser.add_argument("--kinds", default=",".join(EXTENSIONS), metavar=".EXT,…",
                        help="which files are read (default: %(default)s)")
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
        for path in files_below(folder, options.kinds.split(",")):
            began = time.monotonic()
            answer = worker.read(path)
            slowest = max(slowest, (time.monotonic() - began, path))
            column = answer.get("end") or verdict(answer["issues"], shelf)
            if is_part(path, answer.get("issues", ())):
                continue
            row["files"] += 1
            row[column] += 1
            codes.update({(i["severity"], i["code"]) for i in answer.get("issues", ())})
            if column in options.show.split(",") or options.all:
                _show(column, path, answer.get("issues", ()), options.all)
        rows.append((name, row))
    worker.close()
    return _table(rows, codes, slowest)


def _show(column: str, path: str, issues: Sequence[Dict[str, Any]], everything: bool) -> None:
    if column in ("crash", "hang"):
        print(f"{column:8}{path}")
    told: Counter[str] = Counter()
    for issue in issues:
        if not (everything or issue["severity"] == "error" or issue["tolerated"]):
            continue
        told[issue["code"]] += 1
        if told[issue["code"]] > _MOST_OF_A_KIND:
            continue
        hint = FAULTY.get(issue["code"], "") if issue["severity"] == "error" else ""
        line = f":{issue['line']}" if issue["line"] else ""
        print(f"{column:8}{issue['file'] or path}{line}: {issue['severity']} [{issue['code']}]"
              f" {issue['message'][:300]}" + (f" ({hint})" if hint else ""), flush=True)


_MOST_OF_A_KIND = 3


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
