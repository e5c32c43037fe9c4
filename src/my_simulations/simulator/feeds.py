"""States of the whole world as rows of numbers, for whoever reads them many times a second."""
from __future__ import annotations

from typing import Dict, Optional, Tuple

from ..engine.ring import BELL, DEMAND_NS, LINK_WIDTH, POSE_DEMAND_NS
from .row_layout import Layout, lay_out
from .session import Session

ROW_WIDTH = LINK_WIDTH
"""Doubles in a row: position, orientation x, y, z, w, linear and angular velocity."""


class StateFeed:
    """Rows of link states in the world frame. Safe from any thread; takes the registry lock.

    The engine writes as often as the most demanding reader asked for with `request`.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._layout: Optional[Layout] = None
        self._requests: Dict[str, Tuple[float, float, bool]] = {}

    def request(self, who: str, *, states_hz: float = 0.0, poses_hz: float = 0.0,
                notify: bool = False) -> None:
        """Say how often a reader wants states, or poses only; 0 for not at all.

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
            words[BELL] = int(any(notified for _, _, notified in self._requests.values()))

    def states(self) -> Tuple[Layout, int, bytes]:
        """Who is in which row, the snapshot's sequence number, and its rows of `ROW_WIDTH` doubles.

        The layout is the same object until a name changes.
        """
        with self._session.registry_lock:
            return (self._current_layout(), *self._session.ring.raw_links())

    def earlier_states(self, sequence: int) -> Optional[Tuple[int, bytes]]:
        """Step and rows of an earlier snapshot; None once it has been overwritten."""
        return self._session.ring.earlier_links(sequence)

    def poses(self) -> Tuple[Layout, bytes]:
        """Who is in which row, and rows as in `states` of which only the poses are the newest."""
        with self._session.registry_lock:
            return self._current_layout(), self._session.ring.raw_poses()

    @property
    def latest(self) -> int:
        """Sequence number of the newest snapshot."""
        return self._session.ring.latest

    @property
    def changes(self) -> int:
        """Grows whenever `poses` may return others."""
        return self._session.ring.changes

    def _current_layout(self) -> Layout:
        registry = self._session.registry
        if self._layout is None or self._layout.revision != registry.revision:
            self._layout = lay_out(registry.entities(), registry.revision)
        return self._layout
