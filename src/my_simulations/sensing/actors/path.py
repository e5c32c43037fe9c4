"""Where an actor is at a time: the rules of the editor's page (web/js/actor_path.ts).

Trajectories run one after the other, each from its first waypoint on, in world axes; a spline of
the trajectory's `tension` joins their positions, another one their orientations (`squad`).
One without waypoints lasts as long as the animation that it names. All this is as in Gazebo; but
an actor is at its `<pose>` in trajectories without waypoints, in Gazebo at the world's origin, and
the distance along a path begins at 0 with each cycle, in Gazebo not in a loop of one trajectory.
`delay_start` is waited for before each cycle (SDF spec 1.7, script/delay_start).
"""
from __future__ import annotations

import math
from typing import List, Mapping, NamedTuple, Optional, Sequence, Tuple, TypeVar

from ...description.actor import Actor, Trajectory, Waypoint
from ...geometry import (
    Pose,
    Quat,
    Vec3,
    add,
    conjugate,
    multiply,
    norm,
    normalised,
    scale,
    slerp,
    subtract,
)

_CHORDS = 32
"""Into which a segment is divided to measure it."""


class Key(NamedTuple):
    """A waypoint of a trajectory.

    Attributes:
        time: since the trajectory began, s.
        pose: in the world.
        slope: of the spline, m for a whole segment.
        control: of the spline of turns.
    """

    time: float
    pose: Pose
    slope: Vec3
    control: Quat


class Stride(NamedTuple):
    """What the limbs do.

    Attributes:
        type: name of an animation.
        time: since it began, s.
        distance: m along the path since then, where the animation advances by it.
        on_path: whether a path says how far the actor has come.
    """

    type: str
    time: float
    distance: Optional[float] = None
    on_path: bool = False


class _Leg:
    """A trajectory within the script, from `begin` on for `length`, s."""

    def __init__(self, trajectory: Trajectory, begin: float, duration: float,
                 measured: bool) -> None:
        ordered = _in_order(trajectory.waypoints)
        slopes = _slopes([pose.position for _, pose in ordered], trajectory.tension)
        controls = controls_of([pose.orientation for _, pose in ordered])
        self.type, self.begin = trajectory.type, begin
        self.keys = [Key(time if n else 0.0, pose, slopes[n], controls[n])
                     for n, (time, pose) in enumerate(ordered)]
        self.length = max(ordered[-1][0], 0.0) if ordered else duration
        self._distances = _distances(self.keys) if measured and self.keys else []

    def place(self, time: float) -> Tuple[int, float]:
        """The segment at a time since `begin`, and the part of it that is behind."""
        last = len(self.keys) - 1
        after = next((n for n, key in enumerate(self.keys) if key.time > time), last + 1)
        if after in (0, last + 1):
            return max(after - 1, 0), 0.0
        start, goal = self.keys[after - 1].time, self.keys[after].time
        return after - 1, (time - start) / (goal - start)

    def pose(self, time: float) -> Pose:
        """In the world, at a time since `begin`."""
        n, part = self.place(time)
        start = self.keys[n]
        if not part:
            return start.pose
        goal = self.keys[n + 1]
        return Pose(_on_spline(start, goal, part), squad(
            start.pose.orientation, start.control, goal.control, goal.pose.orientation, part))

    def stride(self, time: float) -> Stride:
        """At a time since `begin`."""
        if not self.keys:
            return Stride(self.type, min(time, self.length))
        if not self._distances:
            return Stride(self.type, time, None, True)
        n, part = self.place(time)
        chord = int(part * _CHORDS)
        start, goal = (self._distances[min(n * _CHORDS + one, len(self._distances) - 1)]
                       for one in (chord, chord + 1))
        return Stride(self.type, time, start + (goal - start) * (part * _CHORDS - chord), True)


class ActorPath:
    """The path of an actor.

    Args:
        actor: the actor.
        durations: of its animations by name, s.
    """

    def __init__(self, actor: Actor, durations: Mapping[str, float]) -> None:
        self._actor = actor
        self._legs: List[_Leg] = []
        self._length = 0.0
        by_distance = {one.name for one in actor.animations if one.interpolate_x}
        for one in actor.trajectories:
            leg = _Leg(one, self._length, durations.get(one.type, 0.0), one.type in by_distance)
            if leg.keys or leg.length > 0.0:
                self._legs.append(leg)
                self._length += leg.length

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

    def _leg_at(self, at: float) -> Optional[_Leg]:
        return next((leg for leg in reversed(self._legs) if leg.begin <= at), None)

    def stride_at(self, time: float) -> Optional[Stride]:
        """The animation that the trajectory of a sim time (s) names, from the trajectory's begin.

        Gazebo's rule. None before the script begins.
        """
        at = self.script_time(time)
        if at is None:
            return None
        leg = self._leg_at(at)
        return Stride("", at) if leg is None else leg.stride(at - leg.begin)

    def pose_at(self, time: float) -> Pose:
        """In the world, at a sim time in s."""
        at = self.script_time(time)
        leg = None if at is None else self._leg_at(at)
        if at is None or leg is None or not leg.keys:
            return self._actor.pose
        return leg.pose(at - leg.begin)


def _slopes(points: List[Vec3], tension: float) -> List[Vec3]:
    """Slopes of a cardinal spline, independent of the durations (ignition::math::Spline).

    `tension` 0: Catmull-Rom; 1: straight, with a halt at each point.
    """
    if len(points) < 2:
        return [(0.0, 0.0, 0.0)] * len(points)
    around = with_neighbours(points)
    return [scale(subtract(around[n + 2], around[n]), 0.5 * (1.0 - tension))
            for n in range(len(points))]


def _on_spline(start: Key, goal: Key, part: float) -> Vec3:
    """Position at a part, 0 to 1, of a segment."""
    rest = 1.0 - part
    way = subtract(goal.pose.position, start.pose.position)
    bend = subtract(scale(start.slope, rest), scale(goal.slope, part))
    straight = add(start.pose.position, scale(way, part * part * (3.0 - 2.0 * part)))
    return add(straight, scale(bend, part * rest))


def _distances(keys: List[Key]) -> List[float]:
    """m along the path from the first waypoint to the ends of all chords."""
    found, at = [0.0], keys[0].pose.position
    for start, goal in zip(keys, keys[1:]):
        for n in range(1, _CHORDS + 1):
            there = _on_spline(start, goal, n / _CHORDS)
            found.append(found[-1] + norm(subtract(there, at)))
            at = there
    return found


def _in_order(waypoints: List[Waypoint]) -> List[Tuple[float, Pose]]:
    """In the order of their times; of those of one time the last counts."""
    return sorted({one.time: one.pose for one in waypoints}.items(), key=lambda key: key[0])


_CLOSED = 1e-3
"""Ends of which no member (m, or of a quaternion) differs by more are one (ignition::math)."""
_SMALL = 1e-3
"""Below this the sine of an angle stands for the angle."""


Point = TypeVar("Point", bound=Sequence[float])


def with_neighbours(points: Sequence[Point]) -> List[Point]:
    """Two points or more with the one before the first and the one after the last.

    Of a closed path, whose ends are one point, these are from its other end; else the ends again.
    """
    closed = all(abs(a - b) <= _CLOSED for a, b in zip(points[0], points[-1]))
    before, after = (points[-2], points[1]) if closed else (points[0], points[-1])
    return [before, *points, after]


def controls_of(turns: Sequence[Quat]) -> List[Quat]:
    """Return the inner control point of Shoemake's spline (1985) at each orientation.

    The rules are those of the editor's page (web/js/turn_spline.ts). The spline does not depend on
    how long segments take (ignition::math::RotationSpline): turns swing by some degrees about
    straight parts of a path, and widely where the yaw passes from pi to -pi, whose quaternions are
    far from each other.
    """
    if len(turns) < 2:
        return list(turns)
    around = with_neighbours(turns)
    found: List[Quat] = []
    for n, turn in enumerate(turns):
        back = conjugate(turn)
        ahead, behind = _log(multiply(back, around[n + 2])), _log(multiply(back, around[n]))
        found.append(multiply(turn, _exp([-0.25 * (a + b) for a, b in zip(ahead, behind)])))
    return found


def squad(start: Quat, start_control: Quat, goal_control: Quat, goal: Quat, part: float) -> Quat:
    """Return the orientation at a part, 0 to 1, of a segment (Shoemake's squad)."""
    straight = slerp(start, goal, part)
    bent = _along_arc(start_control, goal_control, part)
    return normalised(_along_arc(straight, bent, 2.0 * part * (1.0 - part)))


def _along_arc(a: Quat, b: Quat, part: float) -> Quat:
    """From `a` to `b`, not to -`b`, which is the same orientation."""
    cosine = sum(x * y for x, y in zip(a, b))
    start, end = 1.0 - part, part
    if abs(cosine) < 1.0 - _SMALL:
        angle = math.acos(cosine)
        start, end = (math.sin(start * angle) / math.sin(angle),
                      math.sin(end * angle) / math.sin(angle))
    return normalised((start * a[0] + end * b[0], start * a[1] + end * b[1],
                       start * a[2] + end * b[2], start * a[3] + end * b[3]))


def _log(turn: Quat) -> List[float]:
    """The axis, as long as half the angle; 0 to pi, as the quaternion says."""
    half = math.acos(max(-1.0, min(turn[3], 1.0)))
    sine = math.sin(half)
    factor = half / sine if abs(sine) >= _SMALL else 1.0
    return [factor * turn[0], factor * turn[1], factor * turn[2]]


def _exp(axis: List[float]) -> Quat:
    half = math.sqrt(sum(one * one for one in axis))
    sine = math.sin(half)
    factor = sine / half if abs(sine) >= _SMALL else 1.0
    return (factor * axis[0], factor * axis[1], factor * axis[2], math.cos(half))
