"""Parameters of a controller, by path: `constraints/goal_time`."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional

from ...engine.drive_commands import PidGains
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

    def number(self, path: str, default: float) -> float:
        value = self.get(path)
        if value is None:
            return default
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self._wrong(path, value, "a number")
        return float(value)

    def flag(self, path: str, default: bool) -> bool:
        value = self.get(path)
        if value is None:
            return default
        if not isinstance(value, (bool, int)):
            raise self._wrong(path, value, "true or false")
        return bool(value)

    def text(self, path: str, default: Optional[str] = None) -> str:
        """Return a text; the parameter is required if there is no default."""
        value = self.get(path)
        if value is None:
            if default is None:
                raise PluginError(f"parameter {self.name}/{path} is missing")
            return default
        if not isinstance(value, str):
            raise self._wrong(path, value, "a text")
        return value

    def texts(self, path: str, default: Optional[List[str]] = None) -> List[str]:
        """Return a list of texts, also for one text; required if there is no default."""
        value = self.get(path)
        if value is None:
            if default is None:
                raise PluginError(f"parameter {self.name}/{path} is missing")
            return default
        found = [value] if isinstance(value, str) else value
        if not isinstance(found, list) or not found or not all(
                isinstance(one, str) for one in found):
            raise self._wrong(path, value, "a list of names")
        return found

    def numbers(self, path: str, count: int, default: List[float]) -> List[float]:
        value = self.get(path)
        if value is None:
            return default
        if not isinstance(value, list) or len(value) != count or not all(
                isinstance(one, (int, float)) for one in value):
            raise self._wrong(path, value, f"a list of {count} numbers")
        return [float(one) for one in value]

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

    def _wrong(self, path: str, value: Any, wanted: str) -> PluginError:
        return PluginError(f"parameter {self.name}/{path} must be {wanted}, it is {value!r}")


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
    def take(values: Dict[str, Value]) -> None:
        changed(PidGains(float(values["p"]), float(values["i"]), float(values["d"]),
                         float(values["i_clamp_min"]), float(values["i_clamp_max"]),
                         bool(values["antiwindup"])))

    return Reconfigure(context, name, _OPTIONS, {
        "p": gains.p, "i": gains.i, "d": gains.d, "i_clamp_min": gains.i_min,
        "i_clamp_max": gains.i_max, "antiwindup": gains.antiwindup}, take)
