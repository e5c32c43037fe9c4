"""The angle forms of rosparam in YAML: `deg(90)`, `rad(pi/2)`, `!degrees 90`, `!radians pi/2`.

rosparam hands radians to `eval`; here they are sums of products and quotients of numbers and pi.
"""
from __future__ import annotations

import math
import re
from typing import Any

from .guarded_yaml import GuardedLoader

_VALUE = r"[-+]?\s*(?:pi|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_PRODUCT = re.compile(rf"\s*({_VALUE})((?:\s*[*/]\s*{_VALUE})*)\s*")
_FACTOR = re.compile(rf"([*/])\s*({_VALUE})")


class AngleLoader(GuardedLoader):
    """Reads the angle forms as numbers in rad."""


def _degrees(loader: AngleLoader, node: Any) -> float:
    text = _inside(loader.construct_scalar(node), "deg")
    try:
        return math.radians(float(text))
    except ValueError:
        raise ValueError(f"{text!r} is not a number of degrees") from None


def _radians(loader: AngleLoader, node: Any) -> float:
    text = _inside(loader.construct_scalar(node), "rad")
    total, at = 0.0, 0
    while at < len(text) or not at:
        found = _PRODUCT.match(text, at)
        if found is None or (at and found.group(1)[0] not in "+-"):
            raise ValueError(f"{text!r} is not an angle in radians; write, for example, 3*pi/4")
        total += _product(found)
        at = found.end()
    return total


def _inside(text: str, name: str) -> str:
    """What is between the brackets of `name(...)`, or the whole text."""
    text = text.strip()
    return text[len(name) + 1:-1].strip() if text.startswith(f"{name}(") else text


def _product(found: "re.Match[str]") -> float:
    value = _parse_factor(found.group(1))
    for sign, factor in _FACTOR.findall(found.group(2)):
        value = value * _parse_factor(factor) if sign == "*" else value / _parse_factor(factor)
    return value


def _parse_factor(text: str) -> float:
    """Parse `pi` or a number, with a sign."""
    plain = text.lstrip("+- ")
    value = math.pi if plain == "pi" else float(plain)
    return -value if text.startswith("-") else value


for _tag, _read, _name in (("!degrees", _degrees, "deg"), ("!radians", _radians, "rad")):
    AngleLoader.add_constructor(_tag, _read)
    AngleLoader.add_implicit_resolver(_tag, re.compile(rf"^{_name}\([^)]*\)$"), [_name[0]])
