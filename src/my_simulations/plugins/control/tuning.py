"""PID gains that dynamic_reconfigure can change. Names and ranges: control_toolbox's Parameters."""
from __future__ import annotations

from typing import Callable, Dict

from ...engine.drive_commands import PidGains
from ..context import Context
from ..reconfigure import Option, Reconfigure, Value

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
