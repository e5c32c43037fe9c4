"""Folders of ROS packages, and the Gazebo folders that they export.

rospkg is imported and the package path crawled on first use only, to keep start-up fast.
"""
from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from typing import Any, Callable, List, Optional, Tuple, Type

FindPackage = Callable[[str], Optional[str]]
"""Returns the folder of a package; None if it is unknown."""

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_EXPORT = re.compile(r"<gazebo_ros\b([^>]*)>")
_NAME = re.compile(r"<name>([^<]*)</name>")
_ATTRIBUTE = re.compile(r"""(gazebo_model_path|gazebo_media_path)\s*=\s*["']([^"']*)["']""")


@dataclass
class ExportedPaths:
    """Folders named by `<gazebo_ros gazebo_model_path= gazebo_media_path=>` in package.xml."""

    models: List[str] = field(default_factory=list)
    media: List[str] = field(default_factory=list)


class PackageIndex:
    """The packages of ROS_PACKAGE_PATH (tests pass in `rospack`)."""

    def __init__(self, rospack: Optional[Any] = None) -> None:
        self._rospack = rospack
        self._unknown: Tuple[Type[Exception], ...] = (KeyError,)

    def find(self, name: str) -> Optional[str]:
        """The folder of a package; None if it is unknown or ROS is not installed."""
        rospack = self._get()
        if rospack is None:
            return None
        try:
            return str(rospack.get_path(name))
        except self._unknown:
            return None

    def folders(self) -> List[str]:
        rospack = self._get()
        found = [self.find(name) for name in (rospack.list() if rospack is not None else ())]
        return [folder for folder in found if folder]

    def exported(self) -> ExportedPaths:
        """Exported folders of all packages, in the order of rospkg."""
        paths = ExportedPaths()
        for folder in self.folders():
            _add_exports(os.path.join(folder, "package.xml"), folder, paths)
        return paths

    def _get(self) -> Optional[Any]:
        if self._rospack is None:
            try:
                import rospkg
            except ImportError:
                return None
            self._rospack = rospkg.RosPack()
            self._unknown = (KeyError, rospkg.ResourceNotFound)
        return self._rospack


def is_in_workspace(path: str) -> bool:
    """Whether a file lies, links followed, below an entry of ROS_PACKAGE_PATH: among what the user
    has chosen to work with.
    """
    real = os.path.realpath(path)
    entries = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    return any(real.startswith(os.path.realpath(entry).rstrip(os.sep) + os.sep)
               for entry in entries if entry)


def package_above(path: str) -> str:
    """The nearest folder above a path that has a package.xml; "" if there is none."""
    folder = os.path.dirname(path)
    while os.path.dirname(folder) != folder:
        if os.path.isfile(os.path.join(folder, "package.xml")):
            return folder
        folder = os.path.dirname(folder)
    return ""


def package_of(path: str) -> str:
    """Name of the ROS package that contains a file; "" for none."""
    folder = package_above(path)
    return package_name(folder) if folder else ""


def package_name(folder: str) -> str:
    """The `<name>` in a folder's package.xml; "" if there is none."""
    try:
        with open(os.path.join(folder, "package.xml"), encoding="utf-8",
                  errors="replace") as stream:
            found = _NAME.search(_COMMENT.sub("", stream.read()))
    except OSError:
        return ""
    return found.group(1).strip() if found else ""


def _add_exports(manifest: str, prefix: str, paths: ExportedPaths) -> None:
    try:
        with open(manifest, encoding="utf-8", errors="replace") as stream:
            text = _COMMENT.sub("", stream.read())
    except OSError:
        return
    for tag in _EXPORT.findall(text):
        for attribute, value in _ATTRIBUTE.findall(tag):
            into = paths.models if attribute == "gazebo_model_path" else paths.media
            for entry in value.replace("${prefix}", prefix).split(os.pathsep):
                if entry and entry not in into:
                    into.append(entry)
