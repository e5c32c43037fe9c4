"""dynamic_reconfigure for plugins: some values that can be seen and changed while they run.

Names of topics and of the service are those of dynamic_reconfigure's server; its tools (`dynparam`,
rqt_reconfigure) find and set what is offered here.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Sequence, Union

from .context import Context, Handle, PluginError

Value = Union[bool, int, float]

_GROUP = "Default"
_KINDS = {bool: ("bool", "bools", "BoolParameter"), int: ("int", "ints", "IntParameter"),
          float: ("double", "doubles", "DoubleParameter")}
_MESSAGES = "dynamic_reconfigure"


@dataclass(frozen=True)
class Option:
    """A value that can be changed; the type of the default is its type.

    Attributes:
        name: of the parameter.
        default: in the description; the present value is told beside it.
        low, high: what is asked for is brought into this range.
        meaning: for people, with the unit.
    """

    name: str
    default: Value
    low: Value
    high: Value
    meaning: str


class Reconfigure:
    """A server of dynamic_reconfigure.

    Args:
        context: of the plugin.
        name: what `dynparam` lists, below the plugin's namespace.
        options: what can be changed.
        values: what holds now, by name.
        changed: gets all values once some were set; what it raises goes to who has asked.
    """

    def __init__(self, context: Context, name: str, options: Sequence[Option],
                 values: Mapping[str, Value], changed: Callable[[Dict[str, Value]], None]) -> None:
        self._context, self._changed = context, changed
        self._options = {option.name: option for option in options}
        self._values = {option.name: values[option.name] for option in options}
        below = f"{name}/" if name else ""
        descriptions = context.publish(f"{below}parameter_descriptions",
                                       f"{_MESSAGES}/ConfigDescription", 10, latch=True)
        self._updates = context.publish(f"{below}parameter_updates", f"{_MESSAGES}/Config", 10,
                                        latch=True)
        descriptions.publish(self._description())
        self._updates.publish(self._config(self._values))
        self._handles: List[Handle] = [
            descriptions, self._updates,
            context.serve(f"{below}set_parameters", f"{_MESSAGES}/Reconfigure", self._set)]

    def tell(self, values: Mapping[str, Value]) -> None:
        """Values were changed in another way."""
        self._values = {name: values[name] for name in self._values}
        self._updates.publish(self._config(self._values))

    def close(self) -> None:
        """Offer it no more."""
        for handle in self._handles:
            handle.close()

    def _set(self, request: Any, response: Any) -> None:
        wanted = dict(self._values)
        for kind, (word, field, _) in _KINDS.items():
            for element in getattr(request.config, field):
                option = self._options.get(element.name)
                if option is None or type(option.default) is not kind:
                    raise PluginError(f"there is no {word} parameter {element.name!r}; there are"
                                      f" {', '.join(self._options)}")
                wanted[element.name] = _within(option, element.value)
        self._changed(wanted)
        self.tell(wanted)
        response.config = self._config(wanted)

    def _config(self, values: Mapping[str, Value]) -> Any:
        config = self._context.message(f"{_MESSAGES}/Config")
        found: Dict[str, List[Any]] = {"bools": [], "ints": [], "strs": [], "doubles": []}
        for name, value in values.items():
            _, field, kind = _KINDS[type(self._options[name].default)]
            element = self._context.message(f"{_MESSAGES}/{kind}")
            element.name, element.value = name, value
            found[field].append(element)
        for field, elements in found.items():
            setattr(config, field, elements)
        group = self._context.message(f"{_MESSAGES}/GroupState")
        group.name, group.state, group.id, group.parent = _GROUP, True, 0, 0
        config.groups = [group]
        return config

    def _description(self) -> Any:
        group = self._context.message(f"{_MESSAGES}/Group")
        group.name, group.type, group.parent, group.id = _GROUP, "", 0, 0
        group.parameters = [self._parameter(option) for option in self._options.values()]
        message = self._context.message(f"{_MESSAGES}/ConfigDescription")
        message.groups = [group]
        for field, which in (("max", "high"), ("min", "low"), ("dflt", "default")):
            setattr(message, field, self._config({
                name: getattr(option, which) for name, option in self._options.items()}))
        return message

    def _parameter(self, option: Option) -> Any:
        made = self._context.message(f"{_MESSAGES}/ParamDescription")
        made.name, made.type = option.name, _KINDS[type(option.default)][0]
        made.level, made.description, made.edit_method = 1, option.meaning, ""
        return made


def _within(option: Option, value: Value) -> Value:
    if isinstance(value, bool):
        return value
    if not math.isfinite(value):
        raise PluginError(f"{option.name} must be finite, it is {value}")
    return max(option.low, min(option.high, value))
