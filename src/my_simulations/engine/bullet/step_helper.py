"""What the engine does around the steps of Bullet, one part a question."""
from __future__ import annotations

from collections import deque
from itertools import repeat, starmap
from typing import Callable, List, Protocol, Sequence, Set, TypeVar

from ...geometry import Vec3
from .bodies import Body

FAR = 1 << 30
"""More steps than are ever made in one go."""

Item = TypeVar("Item")
_Call = Callable[[int, float, Vec3], None]


class BodyKeeper(Protocol):
    """Remembers bodies one by one."""

    def forget(self, body: Body) -> None:
        """A body is gone."""

    def clear(self) -> None:
        """All bodies are gone."""


class StepHelper(BodyKeeper, Protocol):
    """Acts around steps.

    Everything it does follows from step counts, commands and the state of the world, never from how
    many steps are made in one go: so runs repeat bit for bit.
    """

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act before the step of `dt` s that begins at count `step`."""

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act after the step that began at count `step`."""

    def due(self, step: int) -> int:
        """The first step from count `step` on around which it acts, as far as is known now.

        `FAR` for none. It stays right until the helper has acted or a command reached a body.
        """


class StepLoop:
    """Makes steps and calls helpers around those where they are due, in their order."""

    def __init__(self, helpers: Sequence[StepHelper], one: Callable[[], object],
                 prepare: Callable[[], None] = lambda: None) -> None:
        """`one` makes a step; `prepare` is called before it, once all helpers have acted."""
        self._helpers = helpers
        self._prepare = prepare
        self._befores = [helper.before for helper in helpers]
        self._afters = [helper.after for helper in helpers]
        self._one = one
        self._touched = False
        self._dues: List[int] = []
        self._next = (0, 0)   # the step that follows the last one, and the first of `_dues`
        self._moving: Set[int] = set()

    def add(self, body: Body) -> None:
        """Know a new body."""
        self.changed()
        if body.moves:
            self._moving.add(body.uid)

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self.changed()
        self._moving.discard(body.uid)

    def clear(self) -> None:
        """All bodies are gone."""
        self.changed()
        self._moving.clear()

    def touched(self, body: Body) -> None:
        """A command, or a force that begins, reached a body: others may be due."""
        self._touched = True

    def changed(self) -> None:
        """Something was changed: ask all helpers anew."""
        self._dues = []

    def run(self, first: int, count: int, dt: float, gravity: Vec3) -> None:
        """Make `count` steps of `dt` s from count `first` on."""
        helpers, one = self._helpers, self._one
        step, end = first, first + count
        dues, (follows, due) = self._dues, self._next
        # A world that steps in real time asks for one step at a time: what was known still holds.
        if not dues or self._touched or follows != first:
            dues = [helper.due(step) for helper in helpers]
            due = min(dues)
        while step < end:
            free = min(due, end) - step
            if free > 0:
                # Bullet takes 13 us for a step of nothing, which a world at rest pays each time.
                self._prepare()
                if self._moving:
                    deque(starmap(one, repeat((), free)), maxlen=0)  # a loop without bytecode
                step += free
                continue
            acting = [n for n, at in enumerate(dues) if at <= step]
            others = min([end, *(at for at in dues if at > step)])
            # Mostly the same ones act in each step: nobody else is asked until something changes.
            while step < others:
                self._make_step(acting, step, dt, gravity)
                step += 1
                if self._touched:
                    dues = [helper.due(step) for helper in helpers]
                    break
                changed = False
                for n in acting:
                    at = dues[n] = helpers[n].due(step)
                    changed |= at > step
                if changed:
                    break
            due = min(dues)
        self._touched = False
        self._dues, self._next = dues, (end, due)

    def _make_step(self, acting: List[int], step: int, dt: float, gravity: Vec3) -> None:
        self._touched = False
        self._call(self._befores, acting, step, dt, gravity)
        self._prepare()
        self._one()
        self._call(self._afters, acting, step, dt, gravity)

    def _call(self, calls: Sequence[_Call], acting: List[int], step: int, dt: float, gravity: Vec3,
              ) -> None:
        """Call those who act and, once a body was touched, whoever else is due, in their order."""
        begin = 0
        if not self._touched:
            for n in acting:
                calls[n](step, dt, gravity)
                if self._touched:
                    begin = n + 1
                    break
            else:
                return
        for n in range(begin, len(calls)):
            if n in acting or self._helpers[n].due(step) <= step:
                calls[n](step, dt, gravity)


def next_multiple(step: int, every: int) -> int:
    """The first multiple of `every` from `step` on."""
    return step + -step % every


_FEWEST = 8  # items a turn: a look costs about as much as asking two of them


def turn_of(items: List[Item], look: int, rounds: int) -> List[Item]:
    """The items whose turn it is at count `look`, when each has its turn once in `rounds` looks."""
    share = max(_FEWEST, -(-len(items) // rounds))
    at = look % rounds * share
    return items[at:at + share]


def looks_until_turn(count: int, look: int, rounds: int) -> int:
    """How many looks after `look` the next of `count` items has its turn; 0 for at this one."""
    if not count:
        return FAR
    at = look % rounds
    return 0 if at * max(_FEWEST, -(-count // rounds)) < count else rounds - at
