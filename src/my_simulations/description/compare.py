"""Compares two descriptions by meaning."""
from __future__ import annotations

import math
import re
from dataclasses import fields, is_dataclass
from typing import Any, Iterator, List, Tuple

from ..geometry import Pose, is_number

BUILT_IN = "file://media/materials/scripts/gazebo.material"
"""URI of the script of Gazebo's own materials, which are built in."""


def differences(a: Any, b: Any, tolerance: float = 0.0) -> List[str]:
    """Differences between two objects of the description, as `path: this, that`.

    Lists are compared in order, numbers with `tolerance`, orientations as rotations (q equals -q),
    XML without white space, and kept XML in any order. File names and `Model.uri` are ignored.
    Meshes are compared by the file they resolved to, else by URI.

    Args:
        a: an object of the description, e.g. a `World`.
        b: another one.
        tolerance: largest difference of two equal numbers, in their unit.
    """
    return list(_compare(a, b, tolerance, ""))


def _compare(a: Any, b: Any, tolerance: float, path: str) -> Iterator[str]:
    if isinstance(a, Pose) and isinstance(b, Pose):
        yield from _poses(a, b, tolerance, path)
    elif is_dataclass(a) and type(a) is type(b):
        for item in fields(a):
            if not _counts(a, item.name):
                continue
            yield from _field(item.name, getattr(a, item.name), getattr(b, item.name), tolerance,
                              f"{path}.{item.name}" if path else item.name)
    elif isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        if len(a) != len(b):
            yield f"{path}: {len(a)} entries, {len(b)} entries"
        for n, (one, other) in enumerate(zip(a, b)):
            yield from _compare(one, other, tolerance, f"{path}[{getattr(one, 'name', n)}]")
    elif is_number(a) and is_number(b):
        if not (a == b or math.isclose(a, b, rel_tol=tolerance, abs_tol=tolerance)):
            yield f"{path}: {a!r}, {b!r}"
    elif a != b:
        yield f"{path}: {a!r}, {b!r}"


def _counts(owner: Any, name: str) -> bool:
    if name in ("file", "line", "base_dir", "guide"):
        return False
    if name == "uri":
        return hasattr(owner, "path") and not owner.path
    return True


def _field(name: str, a: Any, b: Any, tolerance: float, path: str) -> Iterator[str]:
    if name == "extra":
        a, b = sorted(map(_canonical, a)), sorted(map(_canonical, b))
    elif name == "xml":
        a, b = _canonical(a), _canonical(b)
    elif name == "script_uris":
        a, b = ([uri for uri in uris if uri != BUILT_IN] for uris in (a, b))
    yield from _compare(a, b, tolerance, path)


def _poses(a: Pose, b: Pose, tolerance: float, path: str) -> Iterator[str]:
    yield from _compare(a.position, b.position, tolerance, f"{path}.position")
    same = _furthest(a.orientation, b.orientation, 1.0)
    opposite = _furthest(a.orientation, b.orientation, -1.0)
    if not min(same, opposite) <= tolerance:
        yield f"{path}.orientation: {a.orientation!r}, {b.orientation!r}"


def _furthest(a: Tuple[float, ...], b: Tuple[float, ...], sign: float) -> float:
    return max(abs(one - sign * other) for one, other in zip(a, b))


def _canonical(xml: str) -> str:
    """XML without white space between tags, with sorted attributes and plain prefixes."""
    from xml.etree import ElementTree

    if not xml:
        return ""
    xml = re.sub(r"""\sxmlns:[A-Za-z_][\w.-]*\s*=\s*("[^"]*"|'[^']*')""", "", xml)
    prefixes = sorted(set(re.findall(r"[<\s/]([A-Za-z_][\w.-]*):", xml)))
    declared = "".join(f' xmlns:{prefix}="urn:{prefix}"' for prefix in prefixes)
    try:
        return ElementTree.canonicalize(f"<all{declared}>{xml}</all>", strip_text=True)
    except ElementTree.ParseError:
        return xml
