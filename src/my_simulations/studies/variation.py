"""The parameters of a study, and their values in each case."""
from __future__ import annotations

import hashlib
import statistics
from dataclasses import dataclass
from typing import Callable, Dict, Mapping, Optional, Sequence, Tuple, Union

Setting = Union[float, int, str, Tuple[float, ...], Tuple[str, ...]]
"""A value of a parameter: a number, a name, a pose or names of objects."""

_COMPONENTS = ("x", "y", "z", "roll", "pitch", "yaw")
NUMBER, POSE, NAME, NAMES = "a number", "3 or 6 numbers", "a name", "a name or a list of names"
TEXT = "a number, a text, true or false"


@dataclass(frozen=True)
class Target:
    """What a parameter sets.

    Attributes:
        kind: world, objects, pose, mass, friction, restitution, physics, gravity or none; for
            scenarios scenario, arg or none.
        name: model or `model::link`, or launch argument; "" where there is none.
        part: component, such as "z"; "" for the whole.
    """

    kind: str
    name: str = ""
    part: str = ""

    @property
    def value_kind(self) -> str:
        """What its values are: NUMBER, POSE, NAME, NAMES or TEXT."""
        if self.kind == "pose" and not self.part:
            return POSE
        return {"world": NAME, "objects": NAMES, "arg": TEXT, "scenario": NAME}.get(
            self.kind, NUMBER)


PHYSICS = ("step_size", "iterations")
FORMS = ("world", "objects", "pose.MODEL", "pose.MODEL.z", "mass.MODEL", "friction.MODEL",
         "restitution.MODEL", "physics.step_size", "physics.iterations", "gravity.z", "none")
SCENARIO_FORMS = ("arg.NAME", "none")


def target_of(text: str) -> Optional[Target]:
    """The target that a file names; None if there is no such thing."""
    kind, dot, rest = text.partition(".")
    if kind in ("world", "objects", "none"):
        return None if dot else Target(kind)
    if not rest:
        return None
    if kind == "pose":
        name, _, part = rest.rpartition(".")
        return Target(kind, name, part) if name and part in _COMPONENTS else Target(kind, rest)
    if kind in ("mass", "friction", "restitution", "arg"):
        return Target(kind, rest)
    if kind == "physics" and rest in PHYSICS:
        return Target(kind, part=rest)
    return Target(kind, part=rest) if kind == "gravity" and rest in "xyz" else None


def value_requirement(target: Target, value: Setting) -> str:
    """Return what a value of a target must be, such as "above 0"; "" if the value is allowed.

    As in a file: Gazebo refuses a link whose mass is not above 0.
    """
    if not isinstance(value, (int, float)):
        return ""
    if target.kind == "mass" or (target.kind, target.part) == ("physics", "step_size"):
        return "" if value > 0.0 else "above 0"
    if target.kind in ("friction", "restitution"):
        return "" if value >= 0.0 else "at least 0"
    if (target.kind, target.part) == ("physics", "iterations"):
        return "" if value >= 1.0 else "at least 1"
    return ""


def uniform_number(*words: object) -> float:
    """A number in [0, 1) that depends on the words alone, the same on every machine."""
    digest = hashlib.sha256("\0".join(map(str, words)).encode()).digest()
    return int.from_bytes(digest[:8], "big") / 2.0 ** 64


def _uniform(numbers: Sequence[float], u: float) -> float:
    return numbers[0] + (numbers[1] - numbers[0]) * u


def _normal(numbers: Sequence[float], u: float) -> float:
    inside = min(max(u, 2.0 ** -53), 1.0 - 2.0 ** -53)
    return statistics.NormalDist(numbers[0], numbers[1]).inv_cdf(inside)


def _log_uniform(numbers: Sequence[float], u: float) -> float:
    return float(numbers[0] * (numbers[1] / numbers[0]) ** u)


DISTRIBUTIONS: Mapping[str, Callable[[Sequence[float], float], float]] = {
    "uniform": _uniform, "normal": _normal, "log_uniform": _log_uniform}
"""By name; each takes its two numbers and a number in [0, 1)."""


@dataclass(frozen=True)
class Parameter:
    """One thing that is varied.

    Attributes:
        name: column of the table.
        target: what it sets.
        values: those it takes; empty for a distribution.
        distribution: key of DISTRIBUTIONS; "" for a list of values.
        numbers: of the distribution.
        samples: how many values are drawn for a grid.
    """

    name: str
    target: Target
    values: Tuple[Setting, ...] = ()
    distribution: str = ""
    numbers: Tuple[float, ...] = ()
    samples: int = 0

    @property
    def count(self) -> int:
        """How many values a grid has of it."""
        return len(self.values) or self.samples

    def on_grid(self, index: int, seed: int) -> Setting:
        """Its value number `index` of a grid."""
        return self.values[index] if self.values else self._drawn(index, seed)

    def at_random(self, case: int, seed: int) -> Setting:
        """Its value in a case of a random plan."""
        if self.values:
            return self.values[int(uniform_number(seed, self.name, case) * len(self.values))]
        return self._drawn(case, seed)

    def _drawn(self, index: int, seed: int) -> float:
        return DISTRIBUTIONS[self.distribution](self.numbers,
                                                uniform_number(seed, self.name, index))


def settings_on_grid(parameters: Sequence[Parameter], index: int, seed: int) -> Dict[str, Setting]:
    """The values in case `index` of a grid; the last parameter changes fastest."""
    found: Dict[str, Setting] = {}
    for parameter in reversed(parameters):
        index, place = divmod(index, parameter.count)
        found[parameter.name] = parameter.on_grid(place, seed)
    return {parameter.name: found[parameter.name] for parameter in parameters}
