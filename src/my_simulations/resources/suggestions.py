"""Suggestions for URIs that cannot be resolved."""
from __future__ import annotations

import difflib
import os
import re
from typing import Callable, List, Sequence

from .package_files import PACKAGE

_SCHEME = re.compile(r"([A-Za-z]+):/*")
_SCHEMES = ("model", "package", "file")
_LIKE = 0.7
_MOST_ABOVE = 6
"""Most folders from that of a file up to that of its package."""
_MOST_CORRECTIONS = 3   # of one URI
NO_PACKAGE = "ROS package "
"""Prefix of `ResourceNotFoundError.tried` for an unknown package."""


def suggestion(uri: str, tried: Sequence[str], packages: Callable[[], List[str]]) -> str:
    """The URI with its misspelt parts corrected; "" if no existing name is similar.

    An existing correction that differs in upper and lower case only comes first, then other
    existing ones; else it is that of the first part alone.

    Args:
        uri: the URI.
        tried: the paths that do not exist.
        packages: returns the folders of all ROS packages; called for an unknown package only.
    """
    scheme = _SCHEME.match(uri)
    if scheme and scheme.group(1).lower() in _SCHEMES:
        right = f"{scheme.group(1).lower()}://{uri[scheme.end():]}"
        if scheme.group(1) != scheme.group(1).lower() or scheme.group().count("/") < 2:
            return right
    found, first = "", ""
    for place in tried:
        if place.startswith(NO_PACKAGE):
            meant = _in_similar_package(uri, place[len(NO_PACKAGE):], packages())
            exists = bool(meant)
        else:
            meant, exists = _correct_uri(uri, place)
        if exists and meant.lower() == uri.lower():
            return meant
        found = found or (meant if exists else "")
        first = first or meant
    return found or first


def _in_similar_package(uri: str, package: str, folders: Sequence[str]) -> str:
    """The URI with a similar package that has the file; "" if no such package has it."""
    inside = uri.partition(package)[2].strip("/")
    having = [os.path.basename(folder) for folder in folders
              if os.path.exists(os.path.join(folder, inside))]
    return _with(uri, package, having)


def _correct_uri(uri: str, path: str) -> "tuple[str, bool]":
    """A URI with the parts corrected that a path does not have, and whether such a file exists."""
    meant = ""
    for _ in range(_MOST_CORRECTIONS):
        folder, wrong = _first_missing(path)
        near = _with(wrong, wrong, _list_folder(folder))
        if not near or wrong not in uri:
            break
        corrected = _with(uri, wrong, [near])
        path = os.path.join(folder, near) + path[len(os.path.join(folder, wrong)):]
        if os.path.exists(path):
            return corrected, True
        meant, uri = meant or corrected, corrected
    return meant, False


def _with(uri: str, wrong: str, names: Sequence[str]) -> str:
    """A URI with the name nearest to the last `wrong` in its place; "" for none."""
    near = ([name for name in names if name.lower() == wrong.lower()]
            or difflib.get_close_matches(wrong, names, 1, _LIKE))
    if not (near and wrong and wrong in uri):
        return ""
    at = uri.rindex(wrong)
    return uri[:at] + near[0] + uri[at + len(wrong):]


def same_file_elsewhere(uri: str, model_folders: Sequence[str], own_folders: Sequence[str],
                        packages: Callable[[], List[str]]) -> str:
    """A URI of an existing file with the same path in another package or model; "" for none.

    A tutorial's `package://cob_gazebo_objects/Media/models/X` exists in my_simulations; an absolute
    path of another machine may lead into a model or package that is here, too.

    Args:
        uri: the missing URI.
        model_folders: folders whose children are models.
        own_folders: folders of the package my_simulations.
        packages: returns the folders of all ROS packages.
    """
    scheme, separator, rest = uri.partition("://")
    if separator and scheme == "package":
        inside = rest.lstrip("/").partition("/")[2]
        own = (os.path.join(folder, inside) for folder in own_folders)
        return f"package://{PACKAGE}/{inside}" if inside and any(map(os.path.isfile, own)) else ""
    path = rest if scheme == "file" and separator else uri
    if not os.path.isabs(path):
        return ""
    names = path.strip("/").split("/")
    tails = [(names[at], "/".join(names[at:])) for at in range(len(names) - 1)]
    for _, tail in tails:
        if any(os.path.exists(os.path.join(folder, tail)) for folder in model_folders):
            return f"model://{tail}"
    known = {os.path.basename(folder): os.path.dirname(folder) for folder in packages()}
    for name, tail in tails:
        if name in known and os.path.exists(os.path.join(known[name], tail)):
            return f"package://{tail}"
    return ""


def unlisted_model_folder(uri: str, base_dir: str, packages: Callable[[], List[str]]) -> str:
    """The folder whose child a `model://` URI names, near the file or in a package; "" for none.

    Folders of models are often listed in GAZEBO_MODEL_PATH on the machine of their authors only.
    Searched are the folders from that of the file up to its package (two for a file in no package),
    then all packages, each with its `models` folder.

    Args:
        uri: the missing URI.
        base_dir: folder of the file that contains it; "" for none.
        packages: returns the folders of all ROS packages.
    """
    scheme, separator, rest = uri.strip().partition("://")
    name = rest.strip("/").partition("/")[0]
    if scheme != "model" or not separator or name in ("", ".", ".."):
        return ""
    for above in (*_above(base_dir), *packages()):
        for folder in (above, os.path.join(above, "models")):
            if os.path.isdir(os.path.join(folder, name)) and os.path.exists(
                    os.path.join(folder, rest.strip("/"))):
                return folder
    return ""


def _above(folder: str) -> List[str]:
    """A folder and those above it, up to its package; two for one that is in no package."""
    found: List[str] = []
    while folder and folder != os.path.dirname(folder) and len(found) < _MOST_ABOVE:
        found.append(folder)
        if os.path.exists(os.path.join(folder, "package.xml")):
            return found
        folder = os.path.dirname(folder)
    return found[:2]


def _first_missing(path: str) -> "tuple[str, str]":
    """The deepest existing folder of a path, and the missing name in it."""
    folder, name = os.path.split(path)
    while folder != os.path.dirname(folder) and not os.path.isdir(folder):
        folder, name = os.path.split(folder)
    return folder, name


def _list_folder(folder: str) -> List[str]:
    try:
        return os.listdir(folder)
    except OSError:
        return []
