"""Parameters of a `<plugin>` element: its children, by name and type."""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, Iterable, List, Mapping, Tuple, TypeVar

from ..description.model import INFINITE
from ..geometry import IDENTITY_QUAT, Pose, Quat, Vec3, quat_from_rpy, rpy_from_quat
from .plugin_state import PluginParameter

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
        self._declared: Dict[str, PluginParameter] = {}
        # Prefixes may be declared outside of the element.
        self._root: Any = etree.fromstring(xml, etree.XMLParser(
            recover=True, resolve_entities=False)) if xml else etree.Element("plugin")

    def __contains__(self, name: str) -> bool:
        return self._root.find(name) is not None

    def declared(self) -> Tuple[PluginParameter, ...]:
        """Return what was read, with the first defaults that are not ""; from any thread."""
        return tuple(self._declared.values())

    def declare(self, parameters: Iterable[PluginParameter]) -> None:
        """Add parameters that were read in another process."""
        for one in parameters:
            known = self._declared.get(one.name)
            if known is None or not known.default:   # some are read as text, then as a number
                self._declared[one.name] = one

    def text(self, name: str, default: str = "") -> str:
        """Return the stripped text of a child; the default if there is none."""
        self.declare([PluginParameter(name, "text", default)])
        return self._text(name, default)

    def _text(self, name: str, default: str = "") -> str:
        found = self._root.find(name)
        return default if found is None else (found.text or "").strip()

    def texts(self, name: str) -> List[str]:
        return [(child.text or "").strip() for child in self._root.findall(name)]

    def children(self, name: str) -> "List[Parameters]":
        found = []
        for child in self._root.findall(name):
            made = Parameters("", self._warn)
            made._root = child
            found.append(made)
        return found

    def attribute(self, name: str, default: str = "") -> str:
        return str(self._root.get(name, default))

    def number(self, name: str, default: float) -> float:
        """A number; one beyond SDF's "no limit", +-1e16, or infinite, is that."""
        return self._read(name, default, _number, "a number", PluginParameter(
            name, "number", _format_numbers(default)))

    def positive(self, name: str, default: float) -> float:
        """A number above 0, of what is divided by; at least a billionth."""
        return self._read(name, default, _positive, "a number above 0", PluginParameter(
            name, "number", _format_numbers(default)))

    def integer(self, name: str, default: int) -> int:
        return self._read(name, default, lambda text: int(_number(text)), "a whole number",
                          PluginParameter(name, "integer", str(default)))

    def flag(self, name: str, default: bool) -> bool:
        """Return true or false, from true, false, 1 or 0 in any case."""
        words = {"true": True, "1": True, "false": False, "0": False}
        return self._read(name, default, lambda text: words[text.lower()], "true or false",
                          PluginParameter(name, "flag", str(default).lower()))

    def vector(self, name: str, default: Vec3 = (0.0, 0.0, 0.0)) -> Vec3:
        return self._read(name, default, _three, "three numbers", PluginParameter(
            name, "text", _format_numbers(*default)))

    def turn(self, name: str, default: Quat = IDENTITY_QUAT) -> Quat:
        """Return roll, pitch and yaw (rad) as a quaternion."""
        return self._read(name, default, lambda text: quat_from_rpy(*_three(text)),
                          "three numbers", PluginParameter(
                              name, "text", _format_numbers(*rpy_from_quat(default))))

    def pose(self, name: str) -> Pose:
        """Return a pose from x y z (m) and roll pitch yaw (rad); the default is the identity."""
        return self._read(name, Pose(), _pose, "six numbers", PluginParameter(
            name, "text", _format_numbers(*[0.0] * 6)))

    def choice(self, name: str, options: Mapping[str, T], default: T) -> T:
        """Return one of some allowed words."""
        return self._read(name, default, lambda text: options[text], " or ".join(options),
                          PluginParameter(name, "choice", next(
                              (word for word, value in options.items() if value == default), ""),
                              tuple(options)))

    def _read(self, name: str, default: T, read: Callable[[str], T], wanted: str,
              parameter: PluginParameter) -> T:
        self.declare([parameter])
        text = self._text(name)
        if not text:
            return default
        try:
            return read(text)
        except (ValueError, KeyError):
            self._warn(f"<{name}> must be {wanted}, it is {text!r};"
                       f" {parameter.default or repr(default)} is used")
            return default


def _format_numbers(*numbers: float) -> str:
    """Numbers as an SDF file has them."""
    return " ".join(f"{value:.12g}" for value in numbers)


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
