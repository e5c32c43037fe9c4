"""Run the helpers that act before and after the steps of Bullet.

A step in which helpers are due is made as follows:

1. `before` of each helper that is due, in the order of the helpers. They read the state and the
   contacts of the last step, and change bodies, coefficients and parameters of the world.
2. `prepare`, which sets the parameters of the world that were requested (`WorldParameters`).
3. The step of Bullet: collision detection, then the solver, then new positions.
4. `after` of each helper that is due, in the same order. They correct velocities and poses.

Steps in which no helper is due are made in one loop.
"""
from __future__ import annotations

from collections import deque
from itertools import repeat, starmap
from typing import Callable, List, Optional, Sequence, Set

from ...geometry import Vec3
from .agenda import FAR as FAR
from .bodies import Body
from .body_events import COMMANDED, BodyEvent, BodyObserver

_Call = Callable[[int, float, Vec3], None]   # `StepHelper.before` or `after`


class StepHelper(BodyObserver):
    """Acts before and after steps.

    Its actions depend on step counts, commands and the state of the world only. The number of steps
    per call must not matter: so runs repeat bit for bit.
    """

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act before the step of `dt` s that begins at count `step`."""

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act after the step that began at count `step`."""

    def due(self, step: int) -> int:
        """Return the first step, `step` or later, before or after which the helper must act.

        `FAR` for none. The result is valid until the helper acts or a command changes a body.
        """
        return FAR


class StepLoop(BodyObserver):
    """Makes steps, and calls the helpers that are due before and after them, in their order."""

    events = COMMANDED | {BodyEvent.FIXED_AT_REST, BodyEvent.RELEASED}

    def __init__(self, helpers: Sequence[StepHelper], make_step: Callable[[], object],
                 prepare: Callable[[], None] = lambda: None) -> None:
        """`make_step` makes a step; `prepare` is called before it, after all helpers."""
        self._helpers = helpers
        self._prepare = prepare
        self._befores: List[Optional[_Call]] = [
            None if type(helper).before is StepHelper.before else helper.before
            for helper in helpers]
        self._afters: List[Optional[_Call]] = [
            None if type(helper).after is StepHelper.after else helper.after for helper in helpers]
        self._make_step = make_step
        self._notified = False         # an event was received: `_dues` may have changed
        self._dues: List[int] = []     # of the helpers; empty if they must be computed again
        self._next = (0, 0)   # the step that follows the last one, and the first of `_dues`
        self._moving: Set[int] = set()  # bodies that can move

    def add(self, body: Body) -> None:
        self.invalidate_due_steps()
        if body.moves:
            self._moving.add(body.uid)

    def forget(self, body: Body) -> None:
        self.invalidate_due_steps()
        self._moving.discard(body.uid)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Compute again, before the next step, when each helper is due."""
        self._notified = True

    def invalidate_due_steps(self) -> None:
        """Compute again, before the next step, when each helper is due."""
        self._dues = []

    def run(self, first: int, count: int, dt: float, gravity: Vec3) -> None:
        """Make `count` steps of `dt` s from count `first` on."""
        helpers, make_step = self._helpers, self._make_step
        step, end = first, first + count
        dues, (follows, due) = self._dues, self._next
        # A world in real time makes one step per call: the due steps of the last call still hold.
        if not dues or self._notified or follows != first:
            dues = [helper.due(step) for helper in helpers]
            due = min(dues)
        while step < end:
            undisturbed = min(due, end) - step   # steps in which no helper acts
            if undisturbed > 0:
                # A step of Bullet takes 13 us even without bodies. If none can move, it is omitted.
                self._prepare()
                if self._moving:
                    deque(starmap(make_step, repeat((), undisturbed)), maxlen=0)  # a loop in C
                step += undisturbed
                continue
            acting, next_other = [], end
            for n, at in enumerate(dues):
                if at <= step:
                    acting.append(n)
                elif at < next_other:
                    next_other = at
            # The same helpers usually act in many steps in a row. The due steps of the others are
            # computed again only after an event.
            while step < next_other:
                self._notified = False
                self._call(self._befores, acting, step, dt, gravity)
                self._prepare()
                make_step()
                self._call(self._afters, acting, step, dt, gravity)
                step += 1
                if self._notified:
                    dues = [helper.due(step) for helper in helpers]
                    break
                changed = False
                for n in acting:
                    at = dues[n] = helpers[n].due(step)
                    changed |= at > step
                if changed:
                    break
            due = min(dues)
        self._notified = False
        self._dues, self._next = dues, (end, due)

    def _call(self, calls: Sequence[Optional[_Call]], acting: List[int], step: int, dt: float,
              gravity: Vec3) -> None:
        """Call the acting helpers and, after an event, all others that are due, in their order."""
        begin = 0
        if not self._notified:
            for n in acting:
                call = calls[n]
                if call is not None:
                    call(step, dt, gravity)
                if self._notified:
                    begin = n + 1
                    break
            else:
                return
        for n in range(begin, len(calls)):
            call = calls[n]
            if call is not None and (n in acting or self._helpers[n].due(step) <= step):
                call(step, dt, gravity)


def next_multiple(step: int, every: int) -> int:
    """Return the first multiple of `every` that is not below `step`."""
    return step + -step % every
