"""What the engine does around the steps of Bullet, one part a question."""
from __future__ import annotations

from typing import Callable, List, Protocol, Sequence, TypeVar

from ...geometry import Vec3
from .bodies import Body

FAR = 1 << 30
"""More steps than are ever made in one go."""

Item = TypeVar("Item")


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

    @property
    def idle(self) -> bool:
        """True when it has nothing to do before the next command."""

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act before the step of `dt` s that begins at count `step`."""

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act after the step that began at count `step`."""

    def ahead(self, step: int) -> int:
        """How many steps may be made in one go after `before` was called for `step`.

        `after` is then called for the last of them. At least 1; for a step in between both would
        have done nothing.
        """


def make_steps(helpers: Sequence[StepHelper], first: int, count: int, dt: float, gravity: Vec3,
               one: Callable[[], object]) -> None:
    """Make `count` steps from count `first` on with `one`; between two acts of helpers no calls."""
    active = [helper for helper in helpers if not helper.idle]
    step, end = first, first + count
    while step < end:
        ahead = end - step
        for helper in active:
            helper.before(step, dt, gravity)
        for helper in active:
            if ahead > 1:
                ahead = min(ahead, helper.ahead(step))
        for _ in range(ahead):
            one()
        step += ahead
        for helper in active:
            helper.after(step - 1, dt, gravity)


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
