"""Values that dynamic_reconfigure shows and changes, and its messages of them.

Nothing else is imported here: the physics settings, which every world has, are offered by it too.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Sequence, Union

from ..errors import SimulationError

Value = Union[bool, int, float]

_PACKAGE = "dynamic_reconfigure"
_GROUP = "Default"
_LEVEL = 1
_KINDS = {bool: ("bool", "bools", "BoolParameter"), int: ("int", "ints", "IntParameter"),
          float: ("double", "doubles", "DoubleParameter")}


class OptionError(SimulationError):
    """A request names a value that there is not, or one that is not finite."""


@dataclass(frozen=True)
class Option:
    """A value that can be changed; the type of the default is its type.

    Attributes:
        name: of the parameter.
        default: the value in the description; the present value is published separately.
        low, high: requested values are clamped to this range.
        meaning: the description for the user, with the unit.
    """

    name: str
    default: Value
    low: Value
    high: Value
    meaning: str

    def clamp(self, value: Value) -> Value:
        """Return the value within the range. Raises OptionError."""
        if isinstance(value, bool):
            return value
        if not math.isfinite(value):
            raise OptionError(f"{self.name} must be finite, it is {value}")
        return max(self.low, min(self.high, value))


class OptionMessages:
    """Makes and reads dynamic_reconfigure's messages of some options.

    Args:
        options: in the order in which they are shown.
        message: makes a message of a type such as `dynamic_reconfigure/Config`.
    """

    def __init__(self, options: Sequence[Option], message: Callable[[str], Any]) -> None:
        self._message = message
        self._options = {option.name: option for option in options}

    def config(self, values: Mapping[str, Value]) -> Any:
        config = self._message(f"{_PACKAGE}/Config")
        found: Dict[str, List[Any]] = {"bools": [], "ints": [], "strs": [], "doubles": []}
        for name, value in values.items():
            _, field, kind = _KINDS[type(self._options[name].default)]
            element = self._message(f"{_PACKAGE}/{kind}")
            element.name, element.value = name, value
            found[field].append(element)
        for field, elements in found.items():
            setattr(config, field, elements)
        group = self._message(f"{_PACKAGE}/GroupState")
        group.name, group.state, group.id, group.parent = _GROUP, True, 0, 0
        config.groups = [group]
        return config

    def description(self) -> Any:
        """A ConfigDescription: names, types, ranges and defaults, in one group."""
        group = self._message(f"{_PACKAGE}/Group")
        group.name, group.type, group.parent, group.id = _GROUP, "", 0, 0
        group.parameters = [self._parameter(option) for option in self._options.values()]
        message = self._message(f"{_PACKAGE}/ConfigDescription")
        message.groups = [group]
        for field, which in (("max", "high"), ("min", "low"), ("dflt", "default")):
            setattr(message, field, self.config({
                name: getattr(option, which) for name, option in self._options.items()}))
        return message

    def read(self, config: Any) -> Dict[str, Value]:
        """The values that a Config names, each within its range. Raises OptionError."""
        wanted: Dict[str, Value] = {}
        for kind, (word, field, _) in _KINDS.items():
            for element in getattr(config, field):
                option = self._options.get(element.name)
                if option is None or type(option.default) is not kind:
                    raise self._unknown(word, element.name)
                wanted[element.name] = option.clamp(element.value)
        for element in config.strs:
            raise self._unknown("str", element.name)
        return wanted

    def _unknown(self, word: str, name: str) -> OptionError:
        return OptionError(f"there is no {word} parameter {name!r}; there are"
                           f" {', '.join(self._options)}")

    def _parameter(self, option: Option) -> Any:
        made = self._message(f"{_PACKAGE}/ParamDescription")
        made.name, made.type = option.name, _KINDS[type(option.default)][0]
        made.level, made.description, made.edit_method = _LEVEL, option.meaning, ""
        return made
