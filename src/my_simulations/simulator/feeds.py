"""States of the whole world as rows of numbers, for readers at high rates."""
from __future__ import annotations

from typing import Dict, Optional, Tuple

from ..engine.ring import DEMAND_NS, LINK_WIDTH, POSE_DEMAND_NS, WAKE_REQUESTED, Clock
from .row_layout import RowLayout, layout_of
from .session import Session

ROW_WIDTH = LINK_WIDTH
"""Doubles per row: position (m), orientation x, y, z, w, velocity (m/s), angular (rad/s)."""


class StateFeed:
    """Rows of link states in the world frame. Safe from any thread; takes the registry lock.

    The engine writes as often as the most demanding reader asked for with `request`.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._layout: Optional[RowLayout] = None
        self._requests: Dict[str, Tuple[float, float, bool]] = {}

    def request(self, who: str, *, states_hz: float = 0.0, poses_hz: float = 0.0,
                notify: bool = False) -> None:
        """Set the rate at which a reader needs states, or poses only; 0 for never.

        Args:
            who: the reader; a later request of the same reader replaces this one.
            states_hz: poses and twists, per second of wall time.
            poses_hz: poses alone, at half the cost.
            notify: wake `SimClock.wait_step` at each step.
        """
        with self._session.registry_lock:
            self._requests[who] = (states_hz, poses_hz, notify)
            words = self._session.ring.words
            for n, word in enumerate((DEMAND_NS, POSE_DEMAND_NS)):
                most = max(request[n] for request in self._requests.values())
                words[word] = int(1e9 / most) if most > 0.0 else 0
            words[WAKE_REQUESTED] = int(any(notified for _, _, notified in self._requests.values()))

    def states(self) -> Tuple[RowLayout, int, bytes]:
        """The layout, the snapshot's sequence number, and its rows of `ROW_WIDTH` doubles.

        The layout is the same object until models change. A state that was set just now may
        be in the next snapshot only; see `States.await_posted`.
        """
        with self._session.registry_lock:
            return (self._current_layout(), *self._session.ring.raw_links())

    def rows(self) -> bytes:
        """The rows of `states`; they show all states that were set. Raises CommandError."""
        self._session.await_posted()
        return self.states()[2]

    def earlier_states(self, sequence: int) -> Optional[Tuple[int, bytes]]:
        """Step and rows of an earlier snapshot; None if it was overwritten."""
        return self._session.ring.earlier_links(sequence)

    def poses(self) -> Tuple[RowLayout, int, Clock, bytes]:
        """The layout, and rows as in `states`, of which only the poses are current.

        Between them the step at which links were there, and the clock that belongs to it.
        """
        with self._session.registry_lock:
            return (self._current_layout(), *self._session.ring.raw_poses())

    @property
    def latest(self) -> int:
        """Sequence number of the newest snapshot."""
        return self._session.ring.latest

    @property
    def changes(self) -> int:
        """Increases whenever the result of `poses` may have changed."""
        return self._session.ring.changes

    def _current_layout(self) -> RowLayout:
        registry = self._session.registry
        if self._layout is None or self._layout.revision != registry.revision:
            self._layout = layout_of(registry.entities(), registry.revision)
        return self._layout
