"""Where an actor is at a time: the rules of the editor's page (web/js/actor_path.js).

Trajectories run one after the other, each from its first waypoint on, in world axes; a spline of
the trajectory's `tension` joins their positions (Gazebo behaviour), the shorter way of turning
their orientations; Gazebo joins these by a spline, too, whose turns swing by a few degrees about
straight parts of a path. Unlike in Gazebo, trajectories without waypoints take no time, and limbs
move by time where an animation says `interpolate_x`. `delay_start` is waited for before each cycle
(SDF spec 1.7, script/delay_start).
"""
from __future__ import annotations

from typing import List, NamedTuple, Optional, Tuple

from ...description.actor import Actor, Waypoint
from ...geometry import Pose, Vec3, add, scale, slerp, subtract

_CLOSED = 1e-3
"""m; ends of a path that are no further apart are one point (ignition::math::Vector3)."""


class Key(NamedTuple):
    """A waypoint of the script.

    Attributes:
        time: since the script began, s.
        pose: in the world.
        slope: of the spline, m for a whole segment.
    """

    time: float
    pose: Pose
    slope: Vec3


class Stride(NamedTuple):
    """What the limbs do: the name of an animation, and s since it began."""

    type: str
    time: float


class ActorPath:
    """The path of an actor."""

    def __init__(self, actor: Actor) -> None:
        self._actor = actor
        self._keys: List[Key] = []
        self._begins: List[Tuple[float, str]] = []   # of trajectories, with their animations
        self._length = 0.0
        for trajectory in actor.trajectories:
            if trajectory.waypoints:
                self._begins.append((self._length, trajectory.type))
            ordered = _in_order(trajectory.waypoints)
            slopes = _slopes([pose.position for _, pose in ordered], trajectory.tension)
            self._keys += [Key(self._length + (time if n else 0.0), pose, slopes[n])
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

    def stride_at(self, time: float) -> Optional[Stride]:
        """The animation that the trajectory of a sim time (s) names, from the trajectory's begin.

        Gazebo's rule. None before the script begins.
        """
        at = self.script_time(time)
        if at is None:
            return None
        begin, name = ([(0.0, "")] + [one for one in self._begins if one[0] <= at])[-1]
        return Stride(name, at - begin)

    def pose_at(self, time: float) -> Pose:
        """In the world, at a sim time in s."""
        at = self.script_time(time)
        if at is None or not self._keys:
            return self._actor.pose
        after = next((n for n, key in enumerate(self._keys) if key.time > at), len(self._keys))
        if after in (0, len(self._keys)):
            return self._keys[max(after - 1, 0)].pose
        start, goal = self._keys[after - 1], self._keys[after]
        part = (at - start.time) / (goal.time - start.time)
        return Pose(_on_spline(start, goal, part),
                    slerp(start.pose.orientation, goal.pose.orientation, part))


def _slopes(points: List[Vec3], tension: float) -> List[Vec3]:
    """Of a cardinal spline, which does not heed how long segments take (ignition::math::Spline).

    `tension` 0: Catmull-Rom; 1: straight, with a halt at each point.
    """
    if len(points) < 2:
        return [(0.0, 0.0, 0.0)] * len(points)
    closed = all(abs(a - b) <= _CLOSED for a, b in zip(points[0], points[-1]))
    before, after = (points[-2], points[1]) if closed else (points[0], points[-1])
    around = [before, *points, after]
    return [scale(subtract(around[n + 2], around[n]), 0.5 * (1.0 - tension))
            for n in range(len(points))]


def _on_spline(start: Key, goal: Key, part: float) -> Vec3:
    """Position at a part, 0 to 1, of a segment."""
    rest = 1.0 - part
    way = subtract(goal.pose.position, start.pose.position)
    bend = subtract(scale(start.slope, rest), scale(goal.slope, part))
    straight = add(start.pose.position, scale(way, part * part * (3.0 - 2.0 * part)))
    return add(straight, scale(bend, part * rest))


def _in_order(waypoints: List[Waypoint]) -> List[Tuple[float, Pose]]:
    """In the order of their times; of those of one time the last counts."""
    return sorted({one.time: one.pose for one in waypoints}.items(), key=lambda key: key[0])
