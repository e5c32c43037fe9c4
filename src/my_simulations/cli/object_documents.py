"""From an object of the list to the XML text that is spawned."""
from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Callable, Dict, Iterable, List, Optional, Tuple

from ..errors import InputError, error
from ..objects.object_document import read_document, root_tag
from ..objects.object_list import PlacedObject
from ..objects.selection import closest
from ..resources.package_files import PACKAGE, file_in_package, own_directory
from ..resources.ros_packages import PackageIndex

# An empty entry is the current folder, where a file xacro.py would hide the module.
_RUN_XACRO = ("import sys; sys.path[:] = [p for p in sys.path if p]; "
              "import xacro; xacro.main()")

FindPackage = Callable[[str], Optional[str]]


def package_finder() -> FindPackage:
    """From a package's name to its folder; this package is found without rospack too."""
    index = PackageIndex()

    def find(name: str) -> Optional[str]:
        return index.find(name) or (own_directory() or None if name == PACKAGE else None)

    return find


@dataclass(frozen=True)
class Document:
    """An object's XML text.

    Attributes:
        xml: the text, after xacro where its file needs that.
        sdf: whether it is SDF; URDF otherwise.
        path: its file.
        other: a file of that name in this package, which was not taken; "" for none.
        origin: what messages call the text.
    """

    xml: str
    sdf: bool
    path: str
    other: str
    origin: str


def package_names() -> List[str]:
    """The ROS packages there are, as their folders are called."""
    return sorted(os.path.basename(folder) for folder in PackageIndex().folders())


def locate(placed: PlacedObject, find: FindPackage) -> Tuple[str, str]:
    """The path of the object's file, and of another one that its entry could mean.

    An entry that names no package is looked for in that of its list, then in this one; "" where
    there is no second file.

    Raises:
        InputError: the package or the file does not exist.
    """
    found = [path for path in _candidates(placed, find) if os.path.isfile(path)]
    if found:
        return found[0], found[1] if len(found) > 1 else ""
    folder = find(placed.file.package)
    if folder is None:
        near = closest(placed.file.package, package_names(), 1)
        raise InputError([error(
            "unknown-package",
            f"object '{placed.name}': there is no ROS package '{placed.file.package}'",
            xpath=f"{placed.param}/model",
            hint=(f"did you mean {near[0]}? Else " if near else "")
            + "source the workspace that holds it, or correct the name")])
    raise InputError([error(
        "object-file-missing", f"object '{placed.name}': there is no file "
        + " and no ".join(_candidates(placed, find)), xpath=f"{placed.param}/model",
        hint="" if placed.file.named else "write the file, or name its package: "
             "model: PACKAGE/objects/FILE, or --package PACKAGE")])


def _candidates(placed: PlacedObject, find: FindPackage) -> List[str]:
    """Where its file may be, best first; each file once, though several links may lead to it."""
    packages = [placed.file.package] + ([] if placed.file.named else [PACKAGE])
    paths: Dict[str, str] = {}
    for package in packages:
        folder = find(package)
        if folder is not None:
            path = file_in_package(folder, package, os.path.join(*placed.file.path.split("/")))
            paths.setdefault(os.path.realpath(path), path)
    return list(paths.values())


class Documents:
    """The XML of objects. Use as a context manager.

    A file that several objects are made from is read once. What must go through xacro, does so
    ahead of its turn, several files at a time: xacro takes far longer than a spawn.
    """

    def __init__(self, objects: Iterable[PlacedObject], find: FindPackage,
                 timeout: float) -> None:
        """Begin with the files of `objects`.

        Args:
            objects: in the order in which they will be asked for.
            find: from a package's name to its folder.
            timeout: wall seconds that xacro may take for one file.
        """
        self._find, self._timeout = find, timeout
        self._pool = ThreadPoolExecutor(max(2, os.cpu_count() or 1), "xacro")
        self._texts: Dict[str, Future[str]] = {}
        for placed in objects:
            try:
                self._text(locate(placed, find)[0], placed.file.xacro)
            except InputError:
                continue  # raised when its turn comes

    def __enter__(self) -> Documents:
        return self

    def __exit__(self, *_: object) -> None:
        for text in self._texts.values():
            text.cancel()
        self._pool.shutdown()

    def of(self, placed: PlacedObject) -> Document:
        """The object's XML, through xacro where its file needs it.

        Raises:
            InputError: the file is missing, unreadable, empty, or xacro fails.
        """
        path, other = locate(placed, self._find)
        text = self._text(path, placed.file.xacro).result()
        root = root_tag(text)
        sdf = root == "sdf" if root in ("sdf", "robot") else placed.file.sdf
        origin = f"{path} (after xacro)" if placed.file.xacro else path
        return Document(text, sdf, path, other, origin)

    def _text(self, path: str, xacro: bool) -> Future[str]:
        if path not in self._texts:
            self._texts[path] = (self._pool.submit(run_xacro, path, self._timeout) if xacro
                                 else self._pool.submit(read_document, path))
        return self._texts[path]


def run_xacro(path: str, timeout: float) -> str:
    """What xacro makes of a file.

    Raises:
        InputError: xacro is not installed, fails, or takes longer than `timeout` wall seconds.
    """
    try:
        done = subprocess.run([*_xacro_command(path), path], capture_output=True, timeout=timeout,
                              check=False)
    except subprocess.TimeoutExpired as fault:
        raise InputError([error("xacro-timeout", f"xacro did not end within {timeout:g} s",
                                file=path)]) from fault
    except OSError as fault:
        raise InputError([error("xacro-failed", f"xacro does not start: {fault}",
                                file=path)]) from fault
    text = done.stdout.decode("utf-8", "replace")
    if done.returncode != 0 or not text.strip():
        raise InputError([error("xacro-failed", f"xacro failed: {_reason(done.stderr)}",
                                file=path)])
    return text


def _xacro_command(path: str) -> List[str]:
    if importlib.util.find_spec("xacro") is not None:
        return [sys.executable, "-c", _RUN_XACRO]
    command = shutil.which("xacro")
    if command is None:
        raise InputError([error("xacro-missing", "xacro is needed for this file and not installed",
                                file=path, hint="source the workspace's devel/setup.bash")])
    return [command]


def _reason(stderr: bytes) -> str:
    """What xacro says, without its deprecation notes and tracebacks' frames."""
    lines = [line.strip() for line in stderr.decode("utf-8", "replace").splitlines()]
    said = [line for line in lines if line and not line.lower().startswith("xacro: in-order")]
    if any(line.startswith("Traceback") for line in said):
        said = said[-1:]
    return "; ".join(said[:4]) or "no output"
