"""What the user is told of bodies that physics could not treat as described."""
from __future__ import annotations

from typing import List, Mapping, Set

from ..api import Event
from . import bodies
from .bodies import Body
from .state_restore import Entry


class Notices:
    """Events that wait to be read.

    Args:
        models: by id.
        bodies_by_uid: of all models.
    """

    def __init__(self, models: Mapping[int, Entry], bodies_by_uid: Mapping[int, Body]) -> None:
        self._models = models
        self._bodies = bodies_by_uid
        self._events: List[Event] = []
        self._lost: Set[int] = set()   # models that were thrown away by what acts on them

    def taken(self) -> List[Event]:
        """What has happened since the last call."""
        found, self._events = self._events, []
        return found

    def forget(self, model_id: int) -> None:
        """A model is gone, or put elsewhere: what is told once may be told again."""
        self._lost.discard(model_id)

    def forget_all(self) -> None:
        """As `forget`, of all models."""
        self._lost.clear()

    def misfit(self, uid: int, share: float) -> None:
        """No friction fits all contacts of a body; by what share it is off."""
        body = self._bodies[uid]
        self._events.append(Event(
            "log", f"model '{self._models[body.model_id].model.name}' touches others in a ring, "
            f"for which no friction fits all pairs: it is {100 * share:.0f} % off", body.model_id))

    def odd_bounce(self, uid: int, share: float) -> None:
        """No restitution fits all contacts of a body; by what share it is off."""
        body = self._bodies[uid]
        self._events.append(Event(
            "log", f"model '{self._models[body.model_id].model.name}' may bounce off another moving"
            f" model {100 * share:.0f} % off the smaller restitution: no values fit all pairs",
            body.model_id))

    def diverged(self, body: Body) -> None:
        """The state of a body became infinite."""
        self._tell_lost(body, "the state of model '{}' became infinite; it was put back where it "
                              "was, at rest")

    def raced(self, body: Body, step_size: float) -> None:
        """A joint is as fast as is computed."""
        self._tell_lost(body, f"a joint of model '{{}}' turns or moves with {bodies.FASTEST_RATE:g}"
                              " rad/s or m/s, the fastest that is computed: what drives it is too "
                              f"strong for steps of {step_size:g} s")

    def stopped(self, body: Body, text: str) -> None:
        """A body was stopped; `text` is a clause about how and why."""
        self._tell_lost(body, "model '{}' {}", text)

    def _tell_lost(self, body: Body, text: str, *values: str) -> None:
        """Say it once, as it may come in each step, until the model is put elsewhere."""
        if body.model_id not in self._lost:
            self._lost.add(body.model_id)
            name = self._models[body.model_id].model.name
            self._events.append(Event("diverged", text.format(name, *values), body.model_id))
