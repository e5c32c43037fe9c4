"""Stop bodies that a wrong gain, inertia or overlap has thrown out of the world.

A body is stopped if, since it was last put somewhere, it went further than `RANGE` or became
faster than `SPEED`. It is then kept in place, at rest, until it is moved by a command, reset or
removed; the world goes on. Velocities that a command sets may be higher: then twice that speed is
the limit.
"""
from __future__ import annotations

from math import sqrt
from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Set

from ...geometry import Vec3, norm, scale, subtract
from ..run_state import RestPose
from .bodies import Axis, Body, axis_states
from .body_events import BodyEvent
from .link_states import motion
from .rest import put_at_rest, read_rest_pose
from .step_helper import FAR, StepHelper, next_multiple

RANGE = 1e4
"""Largest distance, m, from where a body was put."""
SPEED = 343.0
"""Largest speed, m/s: that of sound in air at 20 degrees Celsius."""

_PERIOD_S = 0.2        # of sim time between two checks of all bodies
_LEAST_GYRATION = 1e-3  # m, of a radius of gyration: smaller ones are mistakes of units
_MASS_RATIO = 1000.0    # of neighbouring links
_FALL = 0.02            # relative difference from a free fall that still counts as one
_FAST_JOINT = 100.0     # rad/s or m/s: faster than motors turn joints


class _Start(NamedTuple):
    """Where a body was last put.

    Attributes:
        place: its position, m.
        velocity: with which it was put there, m/s.
        step: the step count then.
        limit: the speed above which it is stopped, m/s.
    """

    place: Vec3
    velocity: Vec3
    step: int
    limit: float


class DivergenceStop(StepHelper):
    """Checks the first link of each moving body every 0.2 s of sim time.

    Args:
        report: is called once for each stop with the body and a clause that says what happened.
        loaded: returns PyBullet's numbers of the bodies on which forces act.
        moved: is called with a body that was just stopped.
    """

    events = frozenset({BodyEvent.STATE_SET})

    def __init__(self, report: Callable[[Body, str], None], loaded: Callable[[], Set[int]],
                 moved: Callable[[Body], None]) -> None:
        self._report, self._loaded, self._moved = report, loaded, moved
        self._bodies: Dict[int, Body] = {}
        self._starts: Dict[int, _Start] = {}
        self._new: Dict[int, Body] = {}
        self._stops: Dict[int, RestPose] = {}
        self._period = 1
        self.body_tables = (self._bodies, self._starts, self._new, self._stops)

    def configure(self, step_size: float) -> None:
        """Use another step size, s."""
        self._period = max(1, round(_PERIOD_S / step_size))

    def add(self, body: Body) -> None:
        if body.moves:
            self._bodies[body.uid] = body
            self._new[body.uid] = body

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Measure from the pose and velocity that a command has set; release a stopped body."""
        if body.uid in self._bodies:
            self._stops.pop(body.uid, None)
            self._new[body.uid] = body

    @property
    def stopped(self) -> List[Body]:
        return [self._bodies[uid] for uid in self._stops]

    def stop(self, bodies: Iterable[Body]) -> None:
        """Keep bodies in place, at rest."""
        for body in bodies:
            self._stops[body.uid] = read_rest_pose(body)

    def due(self, step: int) -> int:
        """Each step while a body is stopped or new, else each period."""
        if self._stops or self._new:
            return step
        return next_multiple(step, self._period) if self._bodies else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Record where new bodies begin, and check all bodies once in a period."""
        for body in self._new.values():
            now = motion(body.uid, body.parts[0].index)
            self._starts[body.uid] = _Start(now.position, now.linear, step,
                                            max(SPEED, 2.0 * norm(now.linear)))
        self._new.clear()
        if step % self._period == 0:
            for body in list(self._bodies.values()):
                self._check(body, step, dt, gravity)

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Put stopped bodies back, at rest."""
        for uid, place in self._stops.items():
            put_at_rest(self._bodies[uid], place)

    def _check(self, body: Body, step: int, dt: float, gravity: Vec3) -> None:
        start = self._starts.get(body.uid)
        if start is None or body.uid in self._stops:
            return
        now = motion(body.uid, body.parts[0].index)
        speed = norm(now.linear)
        if speed > start.limit:
            what = f"became faster than the speed of sound ({speed:.0f} m/s)"
        elif norm(subtract(now.position, start.place)) > RANGE:
            what = f"went further than {RANGE / 1000:g} km"
        else:
            return
        cause = self._cause(body, start, now.linear, (step - start.step) * dt, gravity)
        place = self._stops[body.uid] = read_rest_pose(body)
        put_at_rest(body, place)
        self._moved(body)
        self._report(body, f"{what} and was stopped; likely cause: {cause}")

    def _cause(self, body: Body, start: _Start, velocity: Vec3, elapsed: float,
               gravity: Vec3) -> str:
        """Return a clause that names the likely cause."""
        fall = subtract(subtract(velocity, start.velocity), scale(gravity, elapsed))
        if norm(fall) < _FALL * norm(velocity) and norm(gravity) > 0.0:
            return "nothing is below it, so it fell freely"
        implausible = _implausible_inertia(body)
        if implausible:
            return implausible
        axis = _fastest(body)
        if axis:
            return f"the gain or effort that drives joint '{axis.name}' is too high"
        if body.uid in self._loaded():
            return "a force that acts on it is too strong, as of a plugin with too high a gain"
        return "it overlapped another body, or what touches it is driven too fast"


def _implausible_inertia(body: Body) -> str:
    """Return a clause about a link with an implausible inertia; "" if there is none."""
    moving = [part for part in body.parts if part.mass > 0.0]
    for part in moving:
        if sqrt(max(part.moments) / part.mass) < _LEAST_GYRATION:
            return (f"the inertia of link '{part.link.name}' is far too small for its mass of "
                    f"{part.mass:g} kg")
    masses = sorted(moving, key=lambda part: part.mass)
    if masses and masses[-1].mass > _MASS_RATIO * masses[0].mass:
        return (f"link '{masses[-1].link.name}' has more than {_MASS_RATIO:g} times the mass of "
                f"link '{masses[0].link.name}'")
    return ""


def _fastest(body: Body) -> Optional[Axis]:
    """Return the joint axis with the highest rate if that is above `_FAST_JOINT`."""
    rates = [abs(state[1]) for state in axis_states(body)]
    return body.axes[rates.index(max(rates))] if rates and max(rates) > _FAST_JOINT else None
