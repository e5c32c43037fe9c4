"""Finds the files on which a scenario depends: those that its launch file names, and theirs."""
from __future__ import annotations

import contextlib
import glob
import os
import re
from typing import Dict, Iterator, List, Tuple

from lxml import etree

from ..errors import SimulationError
from ..objects.object_documents import package_finder
from ..resources.package_files import PACKAGE
from ..resources.resolver import Resolver
from ..resources.world_lookup import ENDINGS, find_world
from .provenance import digest_of, digest_of_file, digest_of_world

_SCANNED = (".launch", ".test", ".xml", ".urdf", ".xacro", ".gazebo", ".srdf", ".yaml")
_LARGEST = 1 << 20  # bytes of a file that is searched for names
_OPEN = re.compile(r"\$\((?:arg|env|optenv|eval|anon)\s[^()]*\)|\$\{[^{}]*\}")
_END = r"[^\s\"'<>;,]"
_IN_PACKAGE = re.compile(rf"(?:\$\(find\s+([\w-]+)\)|package://([\w-]+))/({_END}+)")
_BESIDE = re.compile(rf"\$\(dirname\)/({_END}+)|\bfilename\s*=\s*[\"']([^\"'$:]+)[\"']")
_WORLD = re.compile(rf"[\"']({_END}+(?:{'|'.join(map(re.escape, ENDINGS))}))[\"']")
_SYSTEM = ("/usr/", "/opt/ros/")


class LaunchedFiles:
    """Computes digests of scenarios with the files that they depend on.

    These are the files and folders that a launch file names by `$(find PACKAGE)/`, `package://`,
    `$(dirname)/`, or as a world; the files that these name; and the programs of nodes and tests,
    with the Python modules of their packages. A part of a name that an argument gives matches
    everything. The programs of installed packages and of this one are left out, as are libraries
    of compiled nodes, names that `$(eval)` computes, and what a node opens.
    """

    def __init__(self) -> None:
        self._find = package_finder()
        self._resolver = Resolver.from_environment()
        self._known: Dict[str, Tuple[str, List[str]]] = {}   # digest and named files, by path

    def digest(self, scenario: str) -> str:
        digests: Dict[str, str] = {}
        waiting = [scenario]
        while waiting:
            path = waiting.pop()
            if path not in digests:
                digests[path], named = self._read(path)
                waiting += named
        return digest_of(sorted((os.path.basename(path), one) for path, one in digests.items()))

    def _read(self, path: str) -> Tuple[str, List[str]]:
        """The digest of a file and the files that it names; each file is read once."""
        if path not in self._known:
            digest = digest_of_file(path) if not path.endswith(ENDINGS) else (
                digest_of_world(path, "", (), "", ()))
            self._known[path] = digest, self._named_in(path)
        return self._known[path]

    def _named_in(self, path: str) -> List[str]:
        if (not path.endswith(_SCANNED) or not os.path.isfile(path)
                or os.path.getsize(path) > _LARGEST):
            return []
        with open(path, encoding="utf-8", errors="replace") as stream:
            text = _OPEN.sub("*", stream.read())
        folder = os.path.dirname(path)
        patterns = [os.path.join(folder, one or other) for one, other in _BESIDE.findall(text)]
        for by_find, by_uri, inside in _IN_PACKAGE.findall(text):
            package = self._find(by_find or by_uri)
            if package is not None:
                patterns.append(os.path.join(package, inside))
        for name in _WORLD.findall(text):
            with contextlib.suppress(SimulationError):  # named in another way, or not there
                patterns.append(find_world(name, self._resolver))
        found = [file for pattern in patterns for file in _matching(pattern)]
        return found + [file for package, name in _programs(text)
                        for file in self._program(package, name)]

    def _program(self, package: str, name: str) -> Iterator[str]:
        """The files of a program of a package, and the Python modules of the package."""
        folder = self._find(package)
        if folder is None or package == PACKAGE or folder.startswith(_SYSTEM):
            return
        for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep):
            built = os.path.join(prefix, "lib", package, name)
            if prefix and os.path.isfile(built):
                yield built
        modules = os.path.join(folder, "src") + os.sep
        for path in _files_below(folder):
            if os.path.basename(path) == name or (path.startswith(modules)
                                                  and path.endswith(".py")):
                yield path


def _programs(text: str) -> Iterator[Tuple[str, str]]:
    """Package and name of the programs that the text of a launch file starts."""
    try:
        root = etree.fromstring(text.encode(), etree.XMLParser(resolve_entities=False))
    except etree.XMLSyntaxError:  # roslaunch reports it when the scenario runs
        return
    for element in root.iter("node", "test"):
        yield element.get("pkg", ""), element.get("type", "")


def _matching(pattern: str) -> Iterator[str]:
    """The files whose path matches a pattern, and those below the folders that do."""
    for path in glob.glob(pattern):
        if os.path.isdir(path):
            yield from _files_below(path)
        else:
            yield os.path.normpath(path)


def _files_below(folder: str) -> Iterator[str]:
    for place, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith((".", "__pycache__"))]
        for name in files:
            yield os.path.normpath(os.path.join(place, name))
