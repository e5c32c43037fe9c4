"""Events for the user about bodies that the physics engine cannot simulate as described."""
from __future__ import annotations

from typing import List, Mapping, Set, Union

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
        self._reported: Set[Union[int, str]] = set()   # ids of models, texts of misfits

    def take_events(self) -> List[Event]:
        """Return the events since the last call."""
        found, self._events = self._events, []
        return found

    def forget(self, model_id: int) -> None:
        """Allow another report about a model that was removed or moved by a command."""
        self._reported.discard(model_id)

    def forget_all(self) -> None:
        """Allow all reports again."""
        self._reported.clear()

    def misfit(self, uid: int, text: str, share: float) -> None:
        """Report, once, that no coefficient fits all pairs of a body; `share`: relative error."""
        self._report(text, "log", self._bodies[uid], "model '{}' " + text.format(100 * share))

    def diverged(self, body: Body) -> None:
        """Report that the state of a body became infinite."""
        self._report(body.model_id, "diverged", body, "the state of model '{}' became infinite; it"
                     " was put back where it was, at rest")

    def reached_fastest_rate(self, body: Body, step_size: float) -> None:
        """Report that a joint has reached the largest rate of the engine."""
        self._report(body.model_id, "diverged", body, "a joint of model '{}' turns or moves with "
                     f"{bodies.FASTEST_RATE:g} rad/s or m/s, the fastest that is computed: what"
                     f" drives it is too strong for steps of {step_size:g} s")

    def stopped(self, body: Body, text: str) -> None:
        """Report that a body was stopped; `text` is a clause with the manner and the reason."""
        self._report(body.model_id, "diverged", body, "model '{}' {}", text)

    def _report(self, key: Union[int, str], kind: str, body: Body, text: str,
                *values: str) -> None:
        """Report once per model, until a command moves it, or once per text."""
        if key not in self._reported:
            self._reported.add(key)
            name = self._models[body.model_id].model.name
            self._events.append(Event(kind, text.format(name, *values), body.model_id))
