"""Efforts, contacts and joint wrenches of a step: of the engine's last one, or of a record."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Set, Tuple

from ..engine.commands import JointWrench, ReadContacts, ReadJointWrenches
from ..engine.drive_commands import ReadEfforts
from ..simulator.entity import Entity
from ..simulator.simulator import Simulator
from .context import PluginError
from .observations import StepView
from .schedule import Schedule


class StepReadings:
    """For the thread of the host.

    While a record is handed over, they are in it. For the last step the engine is asked, once for
    all plugins: a request makes it write its states and the node wait for a reply.

    Args:
        simulator: the world.
        schedule: says where the world stands.
        view: shows records.
    """

    def __init__(self, simulator: Simulator, schedule: Schedule, view: StepView) -> None:
        self._simulator, self._schedule, self._view = simulator, schedule, view
        self._step: Optional[Tuple[int, int]] = None
        self._asked: Set[int] = set()            # rows, since efforts were read last
        self._efforts: Dict[int, float] = {}
        self._contacts: Optional[List[Any]] = None

    def efforts(self, rows: Sequence[int]) -> List[float]:
        """What servos and motors spent on joint axes, N m or N.

        Those that others asked for at earlier steps are read along. Raises CommandError,
        PluginError.
        """
        if not rows:
            return []   # an observation of no efforts records no query
        if self._view.is_record:
            query, values = self._view.answer(ReadEfforts)
            return [_value(query.rows, values, row) for row in rows]
        self._discard_old()
        if not self._efforts.keys() >= set(rows):
            wanted = sorted(self._asked.union(rows))
            self._efforts.update(zip(wanted, self._simulator.drives.efforts(wanted)))
            self._asked = set()
        self._asked.update(rows)
        return [self._efforts[row] for row in rows]

    def contacts(self) -> List[Any]:
        """The contacts, with the scoped names of both links. Raises CommandError, PluginError."""
        if self._view.is_record:
            return self._simulator.states.named_contacts(self._view.answer(ReadContacts)[1])
        self._discard_old()
        if self._contacts is None:
            self._contacts = self._simulator.states.contacts()
        return self._contacts

    def wrench(self, entity: Entity, joint: str) -> Optional[JointWrench]:
        """What a joint transmitted. Raises CommandError, PluginError."""
        found: Optional[JointWrench]
        if self._view.is_record:
            query, values = self._view.answer(ReadJointWrenches)
            found = _value(query.joints, values, (entity.model_id, joint))
        else:
            found = self._simulator.joints.wrenches([f"{entity.model.name}::{joint}"])[0]
        return found

    def _discard_old(self) -> None:
        time_step = self._schedule.time_step
        step = None if time_step is None else (time_step.clock_sets, time_step.step)
        if step is None or step != self._step:
            self._step, self._efforts, self._contacts = step, {}, None


def _value(keys: Sequence[Any], values: Sequence[Any], key: Any) -> Any:
    """The value of one of the things that an observation has named."""
    if key not in keys:
        raise PluginError(f"an observation must name what it reads ({key})")
    return values[keys.index(key)]
