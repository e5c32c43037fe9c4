"""When a plugin is called: at a rate of sim time, or once."""
from __future__ import annotations

from typing import Callable, List, Optional

from ..simulator.appointments import Moment, Rate
from ..simulator.wrenches import first_step


class Appointment:
    """Something that is called at a rate, or once.

    Attributes:
        call: what is called.
        next: the step at which that is due.
        single: whether it is over then.
    """

    def __init__(self, owner: "List[Appointment]", rate: Optional[Rate],
                 call: Callable[[], None], ns: int = 0) -> None:
        self._owner, self._rate, self._ns = owner, rate, ns
        self.call = call
        self.next = 0
        self.single = rate is None

    def set_next(self, moment: Moment) -> None:
        """The first time after a moment."""
        if self._rate is not None:
            self.next = self._rate.after(moment.step, moment.clock)
        else:
            self.next = max(moment.step + 1, first_step(moment.clock, self._ns))

    def end(self) -> None:
        """Never again."""
        if self in self._owner:
            self._owner.remove(self)
