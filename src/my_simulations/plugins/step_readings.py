"""What plugins learn of a step from the engine by commands, read once for all of them."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Set, Tuple

from ..simulator.simulator import Simulator
from .schedule import Schedule


class StepReadings:
    """Efforts and contacts of the last step. For the thread of the host.

    A request makes the engine write its states and the node wait for a reply; ten robots that
    publish their joints at 50 Hz would make 500 of them a second.

    Args:
        simulator: the world.
        schedule: says where the world stands.
    """

    def __init__(self, simulator: Simulator, schedule: Schedule) -> None:
        self._simulator, self._schedule = simulator, schedule
        self._step: Optional[Tuple[int, int]] = None
        self._asked: Set[int] = set()            # rows, since efforts were read last
        self._efforts: Dict[int, float] = {}
        self._contacts: Optional[List[Any]] = None

    def efforts(self, rows: Sequence[int]) -> List[float]:
        """What servos and motors spent on joint axes in the last step, N m or N.

        Those that others asked for at earlier steps are read along. Raises CommandError.
        """
        self._look()
        if not self._efforts.keys() >= set(rows):
            wanted = sorted(self._asked.union(rows))
            self._efforts.update(zip(wanted, self._simulator.drives.efforts(wanted)))
            self._asked = set()
        self._asked.update(rows)
        return [self._efforts[row] for row in rows]

    def contacts(self) -> List[Any]:
        """The contacts of the last step, with the scoped names of both links."""
        self._look()
        if self._contacts is None:
            self._contacts = self._simulator.states.contacts()
        return self._contacts

    def _look(self) -> None:
        moment = self._schedule.moment
        step = None if moment is None else (moment.clock_sets, moment.step)
        if step is None or step != self._step:
            self._step, self._efforts, self._contacts = step, {}, None
