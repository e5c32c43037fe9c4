"""Reads the XML document of an object: its file, through xacro if needed.

The text is not parsed here: the simulator checks the XML, can repair more, and reports line and
column.
"""
from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Callable, Dict, Iterable, List, Optional, Tuple

from ..errors import InputError, error
from ..resources.package_files import PACKAGE, file_in_package, own_directory
from ..resources.ros_packages import PackageIndex
from .object_list import PlacedObject
from .selection import closest

# An empty entry is the current folder, where a file xacro.py would hide the module.
_RUN_XACRO = ("import sys; sys.path[:] = [p for p in sys.path if p]; "
              "import xacro; xacro.main()")

FindPackage = Callable[[str], Optional[str]]


def package_finder() -> FindPackage:
    """A function from a package name to its folder; finds this package without rospack, too."""
    index = PackageIndex()

    def find(name: str) -> Optional[str]:
        return index.find(name) or (own_directory() or None if name == PACKAGE else None)

    return find


@dataclass(frozen=True)
class Document:
    """An object's XML text.

    Attributes:
        xml: the text, after xacro expansion.
        sdf: whether it is SDF, else URDF.
        path: its file.
        other: a file of the same name in this package that was not used; "" for none.
        origin: name of the document in messages.
    """

    xml: str
    sdf: bool
    path: str
    other: str
    origin: str


def package_names() -> List[str]:
    return sorted(os.path.basename(folder) for folder in PackageIndex().folders())


def locate(placed: PlacedObject, find: FindPackage) -> Tuple[str, str]:
    """The path of the object's file, and that of a second candidate, "" for none.

    An entry without a package is searched in the package of its list, then in this one. Raises
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
            f"object '{placed.name}': ROS package '{placed.file.package}' was not found",
            xpath=f"{placed.param}/model",
            hint=(f"did you mean {near[0]}? Otherwise " if near else "")
            + "source its workspace, or correct the name")])
    raise InputError([error(
        "object-file-missing", f"object '{placed.name}': file not found: "
        + ", ".join(_candidates(placed, find)), xpath=f"{placed.param}/model",
        hint="" if placed.file.named else "create the file, or give its package: "
             "model: PACKAGE/objects/FILE, or --package PACKAGE")])


def _candidates(placed: PlacedObject, find: FindPackage) -> List[str]:
    """Candidate paths of its file, best first, without duplicates through links."""
    packages = [placed.file.package] + ([] if placed.file.named else [PACKAGE])
    paths: Dict[str, str] = {}
    for package in packages:
        folder = find(package)
        if folder is not None:
            path = file_in_package(folder, package, os.path.join(*placed.file.path.split("/")))
            paths.setdefault(os.path.realpath(path), path)
    return list(paths.values())


class Documents:
    """The XML documents of objects. Use as a context manager.

    A file used by several objects is read once. xacro, which takes far longer than a spawn, runs
    in advance for several files in parallel.
    """

    def __init__(self, objects: Iterable[PlacedObject], find: FindPackage, timeout: float) -> None:
        """Start to read the files of `objects`.

        Args:
            objects: the objects, in the order in which they will be requested.
            find: returns the folder of a package name.
            timeout: wall seconds for one run of xacro.
        """
        self._find, self._timeout = find, timeout
        self._pool = ThreadPoolExecutor(max(2, os.cpu_count() or 1), "xacro")
        self._texts: Dict[str, Future[str]] = {}
        for placed in objects:
            try:
                self._text(locate(placed, find)[0], placed.file.xacro)
            except InputError:
                continue  # raised by `of`

    def __enter__(self) -> Documents:
        return self

    def __exit__(self, *_: object) -> None:
        for text in self._texts.values():
            text.cancel()
        self._pool.shutdown()

    def of(self, placed: PlacedObject) -> Document:
        """The document of an object.

        Raises InputError: the file is missing, unreadable or empty, or xacro fails.
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
    """The output of xacro for a file.

    Raises InputError: xacro is not installed, fails, or runs longer than `timeout` wall seconds.
    """
    try:
        done = subprocess.run([*_xacro_command(path), path], capture_output=True, timeout=timeout,
                              check=False)
    except subprocess.TimeoutExpired as fault:
        raise InputError([error("xacro-timeout", f"xacro did not finish within {timeout:g} s",
                                file=path)]) from fault
    except OSError as fault:
        raise InputError([error("xacro-failed", f"cannot start xacro: {fault}",
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
        raise InputError([error("xacro-missing", "xacro is required for this file, but not "
                                                 "installed",
                                file=path, hint="source the workspace's devel/setup.bash")])
    return [command]


def _reason(stderr: bytes) -> str:
    """The error output of xacro without deprecation notes and traceback frames."""
    lines = [line.strip() for line in stderr.decode("utf-8", "replace").splitlines()]
    said = [line for line in lines if line and not line.lower().startswith("xacro: in-order")]
    if any(line.startswith("Traceback") for line in said):
        said = said[-1:]
    return "; ".join(said[:4]) or "no output"


_DECLARATION = re.compile(rb"\A\s*<\?xml[^>]*?encoding\s*=\s*[\"']([A-Za-z0-9._-]+)[\"'][^>]*\?>")
_PROLOGUE = re.compile(r"\s+|<\?.*?\?>|<!--.*?-->|<!DOCTYPE(?:[^\[>]|\[[^\]]*\])*>", re.S)
_START_TAG = re.compile(r"<[A-Za-z_][\w.:-]*")


def read_document(file: str) -> str:
    """The text of an XML file, decoded as declared, else as UTF-8.

    Raises InputError: the file is missing, unreadable, empty, or not in the declared encoding.
    """
    try:
        with open(file, "rb") as stream:
            raw = stream.read()
    except OSError as fault:
        raise InputError([error("object-unreadable",
                                f"cannot read the file of the object: {fault.strerror}",
                                file=file)]) from fault
    if not raw.strip():
        raise InputError([error("object-empty", "the file of the object is empty", file=file)])
    return decoded(raw, file)


def decoded(raw: bytes, file: str) -> str:
    """The text of an XML document, decoded as declared, else as UTF-8.

    Args:
        raw: the document.
        file: its file, or where else it comes from, for messages.

    Raises:
        InputError: it is not in the declared encoding.
    """
    declared = _DECLARATION.match(raw)
    encoding = declared.group(1).decode("ascii") if declared else "utf-8"
    try:
        text = raw.decode("utf-8-sig" if encoding.lower() in ("utf-8", "utf8") else encoding)
    except (UnicodeError, LookupError) as fault:
        raise InputError([error("object-encoding", f"this is not {encoding} text: {fault}",
                                file=file, hint="save it as UTF-8")]) from fault
    if declared and encoding.lower() not in ("utf-8", "utf8"):
        # The service message is UTF-8, so the declared encoding would be wrong.
        text = re.sub(r"\A(\s*<\?xml[^>]*?)\s+encoding\s*=\s*[\"'][^\"']*[\"']", r"\1", text)
    return text


def root_tag(xml: str) -> str:
    """The name of the root element; "" if there is none."""
    start = _root_start(xml)
    found = _START_TAG.match(xml, start)
    return found.group(0)[1:] if found else ""


def _root_start(xml: str) -> int:
    at = 1 if xml.startswith("\ufeff") else 0
    while True:
        found = _PROLOGUE.match(xml, at)
        if not found or found.end() == at:
            return at
        at = found.end()
