"""Wake sleeping bodies before a command changes them or their supports.

PyBullet wakes a sleeping body only if an awake body hits it. A sleeping body stays in mid-air if
its support is deleted or moved, and ignores velocities and forces (measured). So the target of a
command and its contact island are woken first.
"""
from __future__ import annotations

from typing import Callable, Dict, Iterable, List, Set

import pybullet

from ..body_plan import BASE
from .bodies import Body

_REACH = 0.02  # m: Bullet makes contacts slightly before surfaces touch
_WORLD_SIZE = 1e9


class WakeUp:
    """Wakes bodies and their contact islands."""

    def __init__(self, bodies: Dict[int, Body], touch: Callable[[Body], None]) -> None:
        self._bodies = bodies
        self._touch = touch

    def everything(self) -> None:
        for body in self._bodies.values():
            self._rouse(body)

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
                self._rouse(body)
            for uid in self._overlapping(body):
                near = self._bodies.get(uid)
                if near is None or near.uid in seen or not near.moves:
                    continue
                seen.add(near.uid)
                queue.append(near)

    def _rouse(self, body: Body) -> None:
        if body.sleeps:
            pybullet.changeDynamics(body.uid, BASE,
                                    activationState=pybullet.ACTIVATION_STATE_WAKE_UP)
        self._touch(body)

    @staticmethod
    def _overlapping(body: Body) -> Set[int]:
        found: Set[int] = set()
        for uid in body.uids:
            for index in sorted({BASE, *(part.index for part in body.colliders)}):
                low, high = pybullet.getAABB(uid, index)
                if high[0] < low[0]:
                    continue
                reach = 0.0 if high[0] - low[0] > _WORLD_SIZE else _REACH
                found.update(pair[0] for pair in pybullet.getOverlappingObjects(
                    [c - reach for c in low], [c + reach for c in high]) or ())
        return found
