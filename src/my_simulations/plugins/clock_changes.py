"""Finds resets, and settings of the clock, between two turns of the plugins."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Tuple

from ..simulator.resets import Resets
from ..simulator.sync_points import SimTimeStep


@dataclass(frozen=True)
class ClockChange:
    """What changed since the last turn.

    Attributes:
        is_clock_set: the clock was set.
        is_set_back: it was set to an earlier sim time.
        notices: methods of plugins to call, in this order: `reset`, `clock_set`.
    """

    is_clock_set: bool
    is_set_back: bool
    notices: Tuple[str, ...]


class ClockChanges:
    """Compares the resets and the clock with those of the last turn.

    Args:
        resets: counts the resets of the world; those before now do not count.
    """

    def __init__(self, resets: Resets) -> None:
        self._resets = resets
        self._world_resets = resets.world_resets
        self._simulation_resets = resets.simulation_resets
        self._time_step: Optional[SimTimeStep] = None

    def since_last(self, time_step: SimTimeStep) -> ClockChange:
        before, self._time_step = self._time_step, time_step
        is_clock_set = before is not None and time_step.clock_sets != before.clock_sets
        is_set_back = before is not None and is_clock_set and time_step.sim_ns < before.sim_ns
        notices: Tuple[str, ...] = ()
        if is_clock_set:
            resets = self._resets.simulation_resets
            if resets != self._simulation_resets:
                notices = ("reset",)
            elif is_set_back:
                notices = ("clock_set",)
            self._simulation_resets = resets
        world_resets = self._resets.world_resets
        if world_resets != self._world_resets:
            self._world_resets = world_resets
            notices += ("reset",)
        return ClockChange(is_clock_set, is_set_back, notices)
