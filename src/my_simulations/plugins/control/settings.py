"""Parameters of a controller, by path: `constraints/goal_time`."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional, Tuple, Union

from ...engine.drive_commands import PidGains
from ...geometry import is_number
from ..context import Context, PluginError
from ..reconfigure import Option, Reconfigure, Value


class Settings:
    """The parameters of a controller. Values of a wrong type raise PluginError.

    Args:
        context: context of the plugin.
        name: name of the controller, below which the parameters are.
        found: the parameters as a tree of dictionaries; default: read from the parameter server.
    """

    def __init__(self, context: Context, name: str, found: Optional[Dict[str, Any]] = None) -> None:
        self.name = name
        if found is None:
            found = context.parameter(name, {})
        self._tree: Any = found if isinstance(found, dict) else {}

    def get(self, path: str) -> Any:
        """Return the value at a path; None if there is none."""
        found = self._tree
        for part in path.split("/"):
            if not isinstance(found, dict) or part not in found:
                return None
            found = found[part]
        return found

    def _read(self, path: str, default: Any, is_valid: Callable[[Any], bool], wanted: str) -> Any:
        value = self.get(path)
        if value is None:
            if default is None:
                raise PluginError(f"parameter {self.name}/{path} is missing")
            return default
        if not is_valid(value):
            raise PluginError(f"parameter {self.name}/{path} must be {wanted}, it is {value!r}")
        return value

    def number(self, path: str, default: Optional[float] = None) -> float:
        """Return a number; the parameter is required if there is no default."""
        return float(self._read(path, default, is_number, "a number"))

    def flag(self, path: str, default: bool) -> bool:
        return bool(self._read(path, default, lambda value: isinstance(value, int),
                               "true or false"))

    def text(self, path: str, default: Optional[str] = None) -> str:
        """Return a text; the parameter is required if there is no default."""
        return str(self._read(path, default, lambda value: isinstance(value, str), "a text"))

    def texts(self, path: str, default: Optional[List[str]] = None) -> List[str]:
        """Return a list of texts, also for one text; required if there is no default."""
        found = self._read(path, default, lambda value: isinstance(value, str) or (
            bool(value) and _is_list_of(value, str)), "a list of names")
        return [found] if isinstance(found, str) else list(found)

    def numbers(self, path: str, count: int, default: List[float]) -> List[float]:
        return list(map(float, self._read(
            path, default, lambda value: _is_list_of(value, (int, float)) and len(value) == count,
            f"a list of {count} numbers")))

    def gains(self, path: str) -> Optional[PidGains]:
        """Return PID gains; None if there is no p. Source: control_toolbox::Pid::init."""
        if self.get(f"{path}/p") is None:
            return None
        clamp = abs(self.number(f"{path}/i_clamp", 0.0))
        return PidGains(
            self.number(f"{path}/p", 0.0), self.number(f"{path}/i", 0.0),
            self.number(f"{path}/d", 0.0), -abs(self.number(f"{path}/i_clamp_min", clamp)),
            abs(self.number(f"{path}/i_clamp_max", clamp)),
            self.flag(f"{path}/antiwindup", False))

    def needed_gains(self, path: str) -> PidGains:
        """Return PID gains. Raises PluginError: there is no p."""
        found = self.gains(path)
        if found is None:
            raise PluginError(f"no p gain is specified: parameter {self.name}/{path}/p is missing")
        return found


def _is_list_of(value: Any, kind: Union[type, Tuple[type, ...]]) -> bool:
    return isinstance(value, list) and all(isinstance(one, kind) for one in value)


_OPTIONS = (
    Option("p", 10.0, -100000.0, 100000.0, "proportional gain"),
    Option("i", 0.1, -100000.0, 100000.0, "integral gain"),
    Option("d", 1.0, -1000.0, 1000.0, "derivative gain"),
    Option("i_clamp_min", -10.0, -100000.0, 0.0, "least integral term"),
    Option("i_clamp_max", 10.0, 0.0, 100000.0, "greatest integral term"),
    Option("antiwindup", False, False, True, "the integral itself stays within the limits"),
)


def offer_gains(context: Context, name: str, gains: PidGains,
            changed: Callable[[PidGains], None]) -> Reconfigure:
    """Let dynamic_reconfigure change gains below a name; `changed` receives the new gains."""
    def apply(values: Dict[str, Value]) -> None:
        changed(PidGains(float(values["p"]), float(values["i"]), float(values["d"]),
                         float(values["i_clamp_min"]), float(values["i_clamp_max"]),
                         bool(values["antiwindup"])))

    return Reconfigure(context, name, _OPTIONS, {
        "p": gains.p, "i": gains.i, "d": gains.d, "i_clamp_min": gains.i_min,
        "i_clamp_max": gains.i_max, "antiwindup": gains.antiwindup}, apply)
