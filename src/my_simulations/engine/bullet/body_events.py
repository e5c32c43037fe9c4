"""Events of bodies: changes by commands and helpers, between steps or in them."""
from __future__ import annotations

from enum import Enum
from typing import Any, ClassVar, Dict, FrozenSet, Sequence, Set, Union

from .agenda import Agenda
from .bodies import Body


class BodyEvent(Enum):
    """What happened to one body."""

    ACTIVATED = "activated"
    """A command changed the body or one near it: it is awake, its pose and velocity may differ."""
    STATE_SET = "state set"
    """A command set its pose, its velocity or its joints."""
    STATE_REPAIRED = "state repaired"
    """Its state was not finite: it is back in its last finite pose, at rest."""
    FORCE_APPLIED = "force applied"
    """A force, or the effort of a servo, acts on it from the next step on."""
    MOTOR_TARGET_CHANGED = "motor target changed"
    """A joint motor has another target from the next step on."""
    PLANAR_VELOCITY_CHANGED = "planar velocity changed"
    """It moves with another planar velocity from the next step on."""
    FIXED_AT_REST = "fixed at rest"
    """An articulated body that stood still is set back to its pose periodically from now on."""
    RELEASED = "released"
    """It is no longer fixed at rest."""


ACTUATED = frozenset((BodyEvent.FORCE_APPLIED, BodyEvent.MOTOR_TARGET_CHANGED,
                      BodyEvent.PLANAR_VELOCITY_CHANGED))
"""The body has the same pose and velocity as before, and may move from the next step on."""

COMMANDED = ACTUATED | {BodyEvent.ACTIVATED}

BodyTable = Union[Dict[Any, Any], Set[Any], Agenda[Any]]


class BodyObserver:
    """Stores data of single bodies.

    Attributes:
        events: the events for which `handle_event` is called.
        body_tables: tables of the data, by PyBullet's numbers of bodies, or of bodies and links.
    """

    events: ClassVar[FrozenSet[BodyEvent]] = frozenset()
    body_tables: Sequence[BodyTable] = ()

    def add(self, body: Body) -> None:
        """Store what is needed of a new body."""

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Update what is stored about a body after one of `events`."""

    def forget(self, body: Body) -> None:
        """Drop what is stored about a removed body."""
        keys = body.keys if self.body_tables else ()
        for table in self.body_tables:
            for key in keys:
                if isinstance(table, set):
                    table.discard(key)
                else:
                    table.pop(key, None)
