"""The flight states of the AR.Drone of tum_simulator, which two plugins of a model follow."""
from __future__ import annotations

from enum import IntEnum
from typing import Any, Callable, Mapping, Optional

from ..call_slot import CallSlot
from ..context import Context
from ..parameters import Parameters
from ..registry import library_name

_LIBRARY = "libhector_gazebo_quadrotor_state_controller.so"
_RISEN, _DESCENDED = 0.5, 0.2    # m by the sonar: where a take-off and a landing end
_TAKE_OFF_S = 0.5                # without a sonar
_LANDING_S, _LANDING_WITH_SONAR_S = 1.0, 5.0


class FlightState(IntEnum):
    """The numbers in `state` of ardrone_autonomy/Navdata."""

    LANDED = 2
    FLYING = 3
    TAKING_OFF = 6
    LANDING = 8


STRENGTHS: Mapping[FlightState, float] = {
    FlightState.LANDED: 0.0, FlightState.TAKING_OFF: 1.5, FlightState.FLYING: 1.0,
    FlightState.LANDING: 0.8}
"""Factor of thrust and torque in each state."""


def state_controller(context: Context) -> Optional[Parameters]:
    """Return the parameters of the model's state controller; None without one."""
    for spec in context.description.plugins:
        if library_name(spec.filename) == _LIBRARY:
            return Parameters(spec.xml)
    return None


class FlightStates:
    """Follows the topics that start and end a flight, and the sonar below the drone.

    A take-off ends 0.5 m above the ground, or after 0.5 s without a `<sonarTopic>`. A landing ends
    0.2 m above the ground or after 5 s, or after 1 s without a sonar. Source:
    GazeboQuadrotorStateController::Update.

    Args:
        context: of a plugin, in the namespace of the drone.
        parameters: of the state controller.
        changed: called after each change of the state.

    Attributes:
        state: the present state.
        has_sonar: whether a `<sonarTopic>` is given.
        altitude: of the sonar, m; None before its first message, and without a sonar.
    """

    def __init__(self, context: Context, parameters: Parameters,
                 changed: Callable[[], None]) -> None:
        self._context, self._changed = context, changed
        self.state = FlightState.LANDED
        self.altitude: Optional[float] = None
        self._timer = CallSlot()
        context.subscribe(parameters.text("takeoffTopic", "/ardrone/takeoff"), "std_msgs/Empty",
                          lambda message: self._take_off())
        context.subscribe(parameters.text("landTopic", "/ardrone/land"), "std_msgs/Empty",
                          lambda message: self._land())
        sonar = parameters.text("sonarTopic")
        self.has_sonar = bool(sonar)
        if sonar:
            context.subscribe(sonar, "sensor_msgs/Range", self._measure)

    def reset(self) -> None:
        """Put the drone on the ground, without a call of `changed`."""
        self._timer.end()
        self.state, self.altitude = FlightState.LANDED, None

    def clock_set(self) -> None:
        """Begin the time of a take-off or landing again."""
        self._start_timer()

    def _take_off(self) -> None:
        if self.state in (FlightState.LANDED, FlightState.LANDING):
            self._enter(FlightState.TAKING_OFF)

    def _land(self) -> None:
        if self.state in (FlightState.FLYING, FlightState.TAKING_OFF):
            self._enter(FlightState.LANDING)

    def _measure(self, message: Any) -> None:
        self.altitude = message.range
        self._apply_altitude()

    def _apply_altitude(self) -> None:
        if self.altitude is None:
            return
        if self.state is FlightState.TAKING_OFF and self.altitude > _RISEN:
            self._enter(FlightState.FLYING)
        elif self.state is FlightState.LANDING and self.altitude < _DESCENDED:
            self._enter(FlightState.LANDED)

    def _enter(self, state: FlightState) -> None:
        self.state = state
        self._changed()
        self._start_timer()
        self._apply_altitude()

    def _start_timer(self) -> None:
        self._timer.end()
        if self.state is FlightState.TAKING_OFF and not self.has_sonar:
            self._enter_after(_TAKE_OFF_S, FlightState.FLYING)
        elif self.state is FlightState.LANDING:
            self._enter_after(_LANDING_WITH_SONAR_S if self.has_sonar else _LANDING_S,
                              FlightState.LANDED)

    def _enter_after(self, seconds: float, state: FlightState) -> None:
        self._timer.set(self._context.once(self._context.now_ns + round(seconds * 1e9),
                                           lambda: self._enter(state)))
