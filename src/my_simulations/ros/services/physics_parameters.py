"""Physics parameters of services and dynamic_reconfigure: names, ranges, current values."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Dict, Mapping, Tuple

from ...errors import CommandError
from ...geometry import Vec3, is_finite
from ...plugins.reconfigure_options import Option, Value
from ...simulator.simulator import Simulator
from ..message_conversion import check_number

SHORTEST_STEP = 1e-6
"""s; smallest accepted step size."""

STRONGEST_GRAVITY = 1000.0
"""m/s^2; largest accepted gravity component."""

FASTEST = 1e6
"""Hz; largest accepted `max_update_rate`; 0 and less mean as fast as possible."""


@dataclass(frozen=True)
class Parameter(Option):
    """One of the 15 parameters (names, types, defaults and ranges: Gazebo behaviour).

    The names of those of `ode` are also in gazebo_msgs/ODEPhysics.

    Attributes:
        ode: field of `description.world.OdePhysics`; "" for other parameters.
    """

    ode: str = ""

    def checked(self, value: Value) -> Value:
        """The value. Raises CommandError if it is out of range."""
        if isinstance(value, bool):
            return value
        check_number(value, self.low, self.high, self.name)
        return value


PARAMETERS: Tuple[Parameter, ...] = (
    Parameter("time_step", 0.001, 0.0, 10.0, "step size (s)"),
    Parameter("max_update_rate", 60.0, 0.0, 1000.0, "steps per second of wall time (Hz), 0 for "
                                                    "as fast as possible"),
    Parameter("gravity_x", 0.0, -100.0, 100.0, "m/s^2"),
    Parameter("gravity_y", 0.0, -100.0, 100.0, "m/s^2"),
    Parameter("gravity_z", -9.8, -100.0, 100.0, "m/s^2"),
    Parameter("auto_disable_bodies", False, False, True, "kept", "auto_disable_bodies"),
    Parameter("sor_pgs_precon_iters", 0, 0, 10000, "kept", "precon_iters"),
    Parameter("sor_pgs_iters", 20, 0, 10000, "solver iterations", "iters"),
    Parameter("sor_pgs_w", 1.3, 0.0, 5.0, "kept", "sor"),
    Parameter("sor_pgs_rms_error_tol", -1.0, -1.0, 10000.0, "kept", "rms_error_tol"),
    Parameter("cfm", 0.0, 0.0, 10.0, "kept", "cfm"),
    Parameter("erp", 0.2, 0.0, 10.0, "kept", "erp"),
    Parameter("contact_surface_layer", 0.001, 0.0, 10.0, "kept, m", "contact_surface_layer"),
    Parameter("contact_max_correcting_vel", 100.0, 0.0, 1e7, "kept, m/s",
              "contact_max_correcting_vel"),
    Parameter("max_contacts", 100, 0, 10000000, "kept", "max_contacts"),
)

ODE = tuple(parameter for parameter in PARAMETERS if parameter.ode)


def current_parameters(simulator: Simulator) -> Dict[str, Value]:
    """Current values of all 15 parameters, each in its parameter's type."""
    physics, gravity = simulator.physics.settings, simulator.physics.gravity
    found: Dict[str, Value] = {
        "time_step": physics.max_step_size, "max_update_rate": physics.real_time_update_rate,
        "gravity_x": gravity[0], "gravity_y": gravity[1], "gravity_z": gravity[2],
        **{parameter.name: getattr(physics.ode, parameter.ode) for parameter in ODE}}
    return {parameter.name: type(parameter.default)(found[parameter.name])
            for parameter in PARAMETERS}


def change_parameters(simulator: Simulator, values: Mapping[str, Value]) -> None:
    """Set some of the 15 parameters; the others keep their values.

    Raises CommandError: a value is out of range; nothing has changed.
    """
    with simulator.change_lock:
        _change(simulator, values)


def _change(simulator: Simulator, values: Mapping[str, Value]) -> None:
    wanted = {**current_parameters(simulator), **values}
    step = wanted["time_step"]
    if not is_finite(step) or not SHORTEST_STEP <= step <= 10.0:
        raise CommandError(f"time_step must be between {SHORTEST_STEP:g} and 10 s, is {step:g}")
    rate = check_number(wanted["max_update_rate"], -FASTEST, FASTEST, "max_update_rate", "Hz")
    gravity: Vec3 = tuple(  # type: ignore[assignment]
        check_number(wanted[f"gravity_{axis}"], -STRONGEST_GRAVITY, STRONGEST_GRAVITY,
                f"gravity.{axis}", "m/s^2") for axis in "xyz")
    # Unchanged values are not checked: a world file may have values out of range.
    ode: Dict[str, Any] = {parameter.ode: parameter.checked(values[parameter.name])
                           for parameter in ODE if parameter.name in values}
    physics = simulator.physics.settings
    simulator.physics.set(
        replace(physics, max_step_size=step, real_time_update_rate=max(0.0, rate),
                ode=replace(physics.ode, **ode)), gravity)
