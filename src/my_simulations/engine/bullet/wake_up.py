"""Wake sleeping bodies before a command changes them or their supports.

PyBullet wakes a sleeping body only if an awake body hits it. A sleeping body stays in mid-air if
its support is deleted or moved, and ignores velocities and forces (measured). So the target of a
command and its contact island are woken first.
"""
from __future__ import annotations

from typing import Callable, Dict, Iterable, List, Sequence, Set, Tuple

import pybullet

from ...geometry import Vec3
from ..body_plan import BASE
from .approach import hull
from .bodies import Body

_REACH = 0.02  # m: Bullet makes contacts slightly before surfaces touch
_WORLD_SIZE = 1e9  # m: a larger box is that of an infinite shape, as a plane


class WakeUp:
    """Wakes bodies and their contact islands."""

    def __init__(self, bodies: Dict[int, Body], notify: Callable[[Body], None]) -> None:
        """`notify` is called with each body that is woken, also with those that cannot sleep."""
        self._bodies = bodies
        self._notify = notify

    def everything(self) -> None:
        for body in self._bodies.values():
            self._wake(body)

    def around(self, targets: Iterable[Body], awake: bool = False) -> None:
        """Wake the targets, the bodies that overlap them, and so on through moving bodies.

        `awake`: the targets were already woken, and have been moved since.
        """
        queue: List[Body] = list({body.uid: body for body in targets}.values())
        seen: Set[int] = {body.uid for body in queue}
        woken = seen.copy() if awake else set()
        while queue:
            body = queue.pop()
            if body.uid not in woken:
                self._wake(body)
            for near in self._moving_near(body, seen):
                seen.add(near.uid)
                queue.append(near)

    def _wake(self, body: Body) -> None:
        if body.sleeps:
            pybullet.changeDynamics(body.uid, BASE,
                                    activationState=pybullet.ACTIVATION_STATE_WAKE_UP)
        self._notify(body)

    def _moving_near(self, body: Body, seen: Set[int]) -> List[Body]:
        """Return the moving bodies, except those in `seen`, that overlap a link of a body."""
        bodies = self._bodies
        return [bodies[uid] for uid in find_overlapping(
            body, lambda uid: uid in bodies and bodies[uid].moves and uid not in seen)]


def find_overlapping(body: Body, is_wanted: Callable[[int], bool]) -> List[int]:
    """Return those of the wanted bodies, by PyBullet's number, that overlap a link of a body."""
    boxes = _link_boxes(body)
    # One query for all links is enough if only static bodies are near.
    if len(boxes) > 1 and not bodies_in(*hull(boxes), is_wanted):
        return []
    return list(dict.fromkeys(uid for box in boxes for uid in bodies_in(*box, is_wanted)))


def bodies_in(low: Sequence[float], high: Sequence[float],
              is_wanted: Callable[[int], bool]) -> List[int]:
    """Return those of the wanted bodies that overlap an axis-aligned box; m, world frame."""
    return [uid for uid, _ in pybullet.getOverlappingObjects(low, high) or () if is_wanted(uid)]


def _link_boxes(body: Body) -> List[Tuple[Vec3, Vec3]]:
    """Return the bounding boxes of the links of a body, enlarged by `_REACH`: low, high, m."""
    found: List[Tuple[Vec3, Vec3]] = []
    for uid in body.uids:
        for index in sorted({BASE, *(part.index for part in body.colliders)}):
            low, high = pybullet.getAABB(uid, index)
            if high[0] < low[0]:
                continue
            reach = 0.0 if high[0] - low[0] > _WORLD_SIZE else _REACH
            (x, y, z), (u, v, w) = low, high
            found.append(((x - reach, y - reach, z - reach), (u + reach, v + reach, w + reach)))
    return found
