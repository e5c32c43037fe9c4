"""Suggestions for URIs that cannot be resolved."""
from __future__ import annotations

import difflib
import os
import re
from typing import Callable, List, Sequence

_SCHEME = re.compile(r"([A-Za-z]+):/*")
_SCHEMES = ("model", "package", "file")
_LIKE = 0.7
_NO_PACKAGE = "ROS package "
"""Prefix of `ResourceNotFoundError.tried` for an unknown package."""


def suggestion(uri: str, tried: Sequence[str], packages: Callable[[], List[str]]) -> str:
    """The URI with its misspelt part corrected, if such a file exists; else "".

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
    for place in tried:
        if place.startswith(_NO_PACKAGE):
            wrong = place[len(_NO_PACKAGE):]
            names = [os.path.basename(folder) for folder in packages()]
        else:
            folder, wrong = _first_missing(place)
            names = _listed(folder)
        near = difflib.get_close_matches(wrong, names, 1, _LIKE)
        if near and wrong and wrong in uri:
            at = uri.rindex(wrong)
            return uri[:at] + near[0] + uri[at + len(wrong):]
    return ""


def _first_missing(path: str) -> "tuple[str, str]":
    """The deepest existing folder of a path, and the missing name in it."""
    folder, name = os.path.split(path)
    while folder != os.path.dirname(folder) and not os.path.isdir(folder):
        folder, name = os.path.split(folder)
    return folder, name


def _listed(folder: str) -> List[str]:
    try:
        return os.listdir(folder)
    except OSError:
        return []
