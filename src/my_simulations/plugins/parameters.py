"""Parameters of a `<plugin>` element: its children, by name and type."""
from __future__ import annotations

import math
from typing import Any, Callable, List, Mapping, Optional, Tuple, TypeVar

from ..description.model import INFINITE
from ..geometry import IDENTITY_QUAT, Pose, Quat, Vec3, quat_from_rpy

T = TypeVar("T")

Warn = Callable[[str], None]


class Parameters:
    """The children of a plugin's element. A text that cannot be read is warned of once.

    Args:
        xml: the whole element.
        warn: called with a message for each invalid value, which the default replaces.
    """

    def __init__(self, xml: str, warn: Warn = lambda text: None) -> None:
        from lxml import etree

        self._warn = warn
        # Prefixes may be declared outside of the element.
        self._root: Any = etree.fromstring(xml, etree.XMLParser(
            recover=True, resolve_entities=False)) if xml else etree.Element("plugin")

    def __contains__(self, name: str) -> bool:
        return self._root.find(name) is not None

    def text(self, name: str, default: str = "") -> str:
        """Return the stripped text of a child; the default if there is none."""
        found = self._root.find(name)
        return default if found is None else (found.text or "").strip()

    def texts(self, name: str) -> List[str]:
        """Return the texts of all children of a name."""
        return [(child.text or "").strip() for child in self._root.findall(name)]

    def children(self, name: str) -> "List[Parameters]":
        """Return the children of a name, as parameters with children."""
        found = []
        for child in self._root.findall(name):
            made = Parameters("", self._warn)
            made._root = child
            found.append(made)
        return found

    def attribute(self, name: str, default: str = "") -> str:
        """Return an attribute of the element."""
        return str(self._root.get(name, default))

    def number(self, name: str, default: float) -> float:
        """A number; one beyond SDF's "no limit", +-1e16, or infinite, is that."""
        return self._read(name, default, _number, "a number")

    def positive(self, name: str, default: float) -> float:
        """A number above 0, of what is divided by; at least a billionth."""
        return self._read(name, default, _positive, "a number above 0")

    def integer(self, name: str, default: int) -> int:
        """Return an integer."""
        return self._read(name, default, lambda text: int(_number(text)), "a whole number")

    def flag(self, name: str, default: bool) -> bool:
        """Return true or false, from true, false, 1 or 0 in any case."""
        words = {"true": True, "1": True, "false": False, "0": False}
        return self._read(name, default, lambda text: words[text.lower()], "true or false")

    def vector(self, name: str, default: Vec3 = (0.0, 0.0, 0.0)) -> Vec3:
        """Return three numbers."""
        return self._read(name, default, _three, "three numbers")

    def turn(self, name: str, default: Quat = IDENTITY_QUAT) -> Quat:
        """Return roll, pitch and yaw (rad) as a quaternion."""
        return self._read(name, default, lambda text: quat_from_rpy(*_three(text)),
                          "three numbers")

    def pose(self, name: str) -> Pose:
        """Return a pose from x y z (m) and roll pitch yaw (rad); the default is the identity."""
        return self._read(name, Pose(), _pose, "six numbers")

    def choice(self, name: str, options: Mapping[str, T], default: T) -> T:
        """Return one of some allowed words."""
        return self._read(name, default, lambda text: options[text], " or ".join(options))

    def _read(self, name: str, default: T, read: Callable[[str], T], wanted: str) -> T:
        text = self.text(name)
        if not text:
            return default
        try:
            return read(text)
        except (ValueError, KeyError):
            self._warn(f"<{name}> must be {wanted}, it is {text!r}; {default!r} is used")
            return default


def _number(text: str) -> float:
    value = float(text)
    if math.isnan(value):
        raise ValueError
    return max(-INFINITE, min(INFINITE, value))


def _positive(text: str) -> float:
    value = _number(text)
    if value < 1e-9:
        raise ValueError
    return value


def _three(text: str) -> Tuple[float, float, float]:
    x, y, z = map(_number, text.split())
    return (x, y, z)


def _pose(text: str) -> Pose:
    x, y, z, roll, pitch, yaw = map(_number, text.split())
    return Pose((x, y, z), quat_from_rpy(roll, pitch, yaw))


def lowest_rate(*rates: float, default: float = 0.0) -> float:
    """Hz, of a plugin that can be no faster than its sensor: the lowest of the rates above 0."""
    return min((rate for rate in rates if rate > 0.0), default=default)


def namespace_or(parameters: Parameters, default: Optional[str]) -> str:
    """Return `<robotNamespace>`; the default if it is missing or empty."""
    return parameters.text("robotNamespace") or (default or "")
