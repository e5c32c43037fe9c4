"""When plugins are called: at rates of sim time, or once."""
from __future__ import annotations

import heapq
from typing import Any, Callable, List, Optional, Tuple

from ..engine.rates import Rate
from ..simulator.sync_points import SimTimeStep
from ..simulator.wrenches import first_step


class ScheduledCall:
    """A function that is called at a rate, or once.

    Attributes:
        owner: the object that requested the call.
        call: the function.
        ended: it is not called any longer.
        single: it is called once.
    """

    def __init__(self, owner: Any, rate: Optional[Rate], call: Callable[[], None],
                 ns: int = 0) -> None:
        self.owner, self._rate, self._ns = owner, rate, ns
        self.call = call
        self.ended = False
        self.single = rate is None

    def next(self, time_step: SimTimeStep) -> int:
        """Return the first step after a moment at which the call is due."""
        if self._rate is not None:
            return self._rate.after(time_step.step, time_step.clock)
        return max(time_step.step + 1, first_step(time_step.clock, self._ns))

    def end(self) -> None:
        self.ended = True


class Schedule:
    """Future calls, ordered by step, then by the order in which they were requested.

    Attributes:
        time_step: the present step and sim time; None before the first `set_time_step`.
        sim_ns: sim time at `time_step`, ns.
    """

    def __init__(self) -> None:
        self.time_step: Optional[SimTimeStep] = None
        self.sim_ns = 0
        self._heap: List[Tuple[int, int, ScheduledCall]] = []
        self._made = 0

    def set_time_step(self, time_step: SimTimeStep) -> None:
        self.time_step, self.sim_ns = time_step, time_step.sim_ns

    def every(self, owner: Any, hertz: float, call: Callable[[], None]) -> ScheduledCall:
        """Schedule calls at a rate in Hz; 0 or less is every step."""
        return self._add(ScheduledCall(owner, Rate(hertz), call))

    def once(self, owner: Any, ns: int, call: Callable[[], None]) -> ScheduledCall:
        """Schedule one call in the first step that does not begin before a sim time."""
        return self._add(ScheduledCall(owner, None, call, ns))

    def _add(self, made: ScheduledCall) -> ScheduledCall:
        self._made += 1
        self._put(self._made, made)
        return made

    def _put(self, number: int, scheduled: ScheduledCall) -> None:
        due = scheduled.next(self.time_step) if self.time_step is not None else 0
        heapq.heappush(self._heap, (due, number, scheduled))

    def take_due(self) -> List[ScheduledCall]:
        """Those that are due now; those of a rate are due again when that says so."""
        assert self.time_step is not None
        found: List[Tuple[int, ScheduledCall]] = []
        while self._heap and self._heap[0][0] <= self.time_step.step:
            _, number, scheduled = heapq.heappop(self._heap)
            if not scheduled.ended:
                found.append((number, scheduled))
        for number, scheduled in found:
            if not scheduled.single:
                self._put(number, scheduled)
        return [scheduled for _, scheduled in sorted(found, key=lambda one: one[0])]

    @property
    def next_step(self) -> Optional[int]:
        """The step of the next call; None without one."""
        while self._heap and self._heap[0][2].ended:
            heapq.heappop(self._heap)
        return self._heap[0][0] if self._heap else None

    def reschedule(self, was_set_back: bool) -> None:
        """Schedule all calls again from `time_step`; drop single calls if sim time was set back."""
        before, self._heap = self._heap, []
        for _, number, scheduled in before:
            if scheduled.single and was_set_back:
                scheduled.end()
            if not scheduled.ended:
                self._put(number, scheduled)

    def end_all(self, owner: Any) -> None:
        for _, _, scheduled in self._heap:
            if scheduled.owner is owner:
                scheduled.end()
