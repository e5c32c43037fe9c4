"""Where an actor is at a time: the rules of the editor's page (web/js/actor_path.js).

Trajectories run one after the other, each from its first waypoint on, in world axes (Gazebo
behaviour). `delay_start` is waited for before each cycle (SDF spec 1.7, script/delay_start).
"""
from __future__ import annotations

from typing import List, Optional, Tuple

from ...description.actor import Actor, Waypoint
from ...geometry import Pose, add, scale, slerp, subtract

Key = Tuple[float, Pose]
"""Time since the script began, s, and the pose in the world."""


class ActorPath:
    """The path of an actor."""

    def __init__(self, actor: Actor) -> None:
        self._actor = actor
        self._keys: List[Key] = []
        self._length = 0.0
        for trajectory in actor.trajectories:
            ordered = _in_order(trajectory.waypoints)
            self._keys += [(self._length + (time if n else 0.0), pose)
                           for n, (time, pose) in enumerate(ordered)]
            self._length += max(ordered[-1][0] if ordered else 0.0, 0.0)

    @property
    def moves(self) -> bool:
        """Whether time makes any difference to where it is."""
        return self._actor.auto_start and bool(self._keys)

    def script_time(self, time: float) -> Optional[float]:
        """How long the script has been running, s; None before it begins for the first time.

        Without a trajectory nothing ends it. `time`: sim time, s.
        """
        delay = max(self._actor.delay_start, 0.0)
        since = time - delay
        if not self._actor.auto_start or since < 0.0:
            return None
        if not self._length:
            return since
        if not self._actor.loop:
            return min(since, self._length)
        return min(since % (self._length + delay), self._length)

    def pose_at(self, time: float) -> Pose:
        """In the world, at a sim time in s."""
        at = self.script_time(time)
        if at is None or not self._keys:
            return self._actor.pose
        after = next((n for n, (key, _) in enumerate(self._keys) if key > at), len(self._keys))
        if after in (0, len(self._keys)):
            return self._keys[max(after - 1, 0)][1]
        (begin, start), (end, goal) = self._keys[after - 1], self._keys[after]
        part = (at - begin) / (end - begin)
        way = subtract(goal.position, start.position)
        return Pose(add(start.position, scale(way, part)),
                    slerp(start.orientation, goal.orientation, part))


def _in_order(waypoints: List[Waypoint]) -> List[Key]:
    """In the order of their times; of those of one time the last counts."""
    return sorted({one.time: one.pose for one in waypoints}.items(), key=lambda key: key[0])
