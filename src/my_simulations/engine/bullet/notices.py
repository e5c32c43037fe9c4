"""Events for the user about bodies that the physics engine cannot simulate as described."""
from __future__ import annotations

from typing import List, Mapping, Set

from ..api import Event
from . import bodies
from .bodies import Body
from .state_restore import Entry


class Notices:
    """Collects events until they are read.

    Args:
        models: by id.
        bodies_by_uid: of all models.
    """

    def __init__(self, models: Mapping[int, Entry], bodies_by_uid: Mapping[int, Body]) -> None:
        self._models = models
        self._bodies = bodies_by_uid
        self._events: List[Event] = []
        self._lost: Set[int] = set()   # models with a reported divergence

    def taken(self) -> List[Event]:
        """Return the events since the last call."""
        found, self._events = self._events, []
        return found

    def forget(self, model_id: int) -> None:
        """Allow another report about a model that was removed or moved by a command."""
        self._lost.discard(model_id)

    def forget_all(self) -> None:
        """Allow another report about each model."""
        self._lost.clear()

    def report_friction_misfit(self, uid: int, share: float) -> None:
        """Report that no coefficient fits all contacts of a body; `share`: relative error."""
        body = self._bodies[uid]
        self._events.append(Event(
            "log", f"model '{self._models[body.model_id].model.name}' touches others in a ring, "
            f"for which no friction fits all pairs: it is {100 * share:.0f} % off", body.model_id))

    def report_restitution_misfit(self, uid: int, share: float) -> None:
        """Report that no restitution fits all contacts of a body; `share`: relative error."""
        body = self._bodies[uid]
        self._events.append(Event(
            "log", f"model '{self._models[body.model_id].model.name}' may bounce off another moving"
            f" model {100 * share:.0f} % off the smaller restitution: no values fit all pairs",
            body.model_id))

    def diverged(self, body: Body) -> None:
        """Report that the state of a body became infinite."""
        self._report_divergence(
            body, "the state of model '{}' became infinite; it was put back where it was, at rest")

    def raced(self, body: Body, step_size: float) -> None:
        """Report that a joint has reached the largest rate of the engine."""
        self._report_divergence(
            body, f"a joint of model '{{}}' turns or moves with {bodies.FASTEST_RATE:g} rad/s or"
            " m/s, the fastest that is computed: what drives it is too strong for steps of"
            f" {step_size:g} s")

    def stopped(self, body: Body, text: str) -> None:
        """Report that a body was stopped; `text` is a clause with the manner and the reason."""
        self._report_divergence(body, "model '{}' {}", text)

    def _report_divergence(self, body: Body, text: str, *values: str) -> None:
        """Report a divergence once per model, until a command moves the model."""
        if body.model_id not in self._lost:
            self._lost.add(body.model_id)
            name = self._models[body.model_id].model.name
            self._events.append(Event("diverged", text.format(name, *values), body.model_id))
