"""Trajectories of messages as splines, joined to what a joint is doing. Source: ros_controllers."""
from __future__ import annotations

import math
from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

from ...engine.servo_law import wrapped_angle
from ...engine.spline import Segment, Spline, State, segment_between
from ..context import PluginError

SUCCESSFUL, INVALID_GOAL, INVALID_JOINTS, OLD_HEADER_TIMESTAMP = 0, -1, -2, -3
PATH_TOLERANCE_VIOLATED, GOAL_TOLERANCE_VIOLATED = -4, -5


class TrajectoryError(PluginError):
    """A trajectory that cannot be followed; `code` is of FollowJointTrajectoryResult."""

    def __init__(self, text: str, code: int = INVALID_GOAL) -> None:
        super().__init__(text)
        self.code = code


class Waypoint(NamedTuple):
    """Where joints are to be at a time, s after the trajectory's start: a state of each."""

    time: float
    states: Tuple[State, ...]


def read_joints(named: Sequence[str], joints: Sequence[str], partial: bool) -> List[int]:
    """Return the index in `joints` of each name of a message. Raises TrajectoryError."""
    unknown = [name for name in named if name not in joints]
    if unknown:
        raise TrajectoryError(f"'{unknown[0]}' is not a joint of this controller; there are"
                              f" {', '.join(joints)}", INVALID_JOINTS)
    if len(set(named)) != len(named):
        raise TrajectoryError("a joint is named twice", INVALID_JOINTS)
    if not partial and len(named) != len(joints):
        missing = [name for name in joints if name not in named]
        raise TrajectoryError(f"joint '{missing[0]}' is missing, and allow_partial_joints_goal is"
                              " not set", INVALID_JOINTS)
    if not named:
        raise TrajectoryError("no joint is named", INVALID_JOINTS)
    return [list(joints).index(name) for name in named]


def read_points(points: Sequence[Any], count: int) -> List[Waypoint]:
    """Return the points of a trajectory_msgs/JointTrajectory of `count` joints.

    As in ros_controllers a point can have more values than joints are named, the same number of
    positions, velocities and accelerations; the first ones count. Raises TrajectoryError.
    """
    found: List[Waypoint] = []
    for number, point in enumerate(points):
        known = [list(point.positions), list(point.velocities), list(point.accelerations)]
        size = max(count, len(known[0]))
        for what, values in zip(("positions", "velocities", "accelerations"), known):
            if len(values) != size and (values or what == "positions"):
                raise TrajectoryError(f"point {number} has {len(values)} {what} of {size} joints")
            if not all(map(math.isfinite, values)):
                raise TrajectoryError(f"point {number} has {what} that are not finite")
        if not known[1]:
            known = known[:1]
        states = tuple(zip(*(values[:count] for values in known if values)))
        time = float(point.time_from_start.to_sec())
        if found and time <= found[-1].time:
            raise TrajectoryError("the times of the points do not increase")
        found.append(Waypoint(time, states))
    return found


def spliced_spline(current: Spline, start: float, now: float, points: Sequence[Waypoint],
                   place: int, wraps: bool) -> Spline:
    """Return the spline of one joint: the current one until the new points begin, then these.

    Args:
        current: the spline that the joint follows.
        start: start time of the points, s of the spline's time.
        now: present time, likewise; points before it are left out.
        points: the new points.
        place: index of the joint in the points.
        wraps: whether the joint turns without limits and takes the shorter way.

    Raises:
        TrajectoryError: all points are in the past.
    """
    coming = [(start + point.time, point.states[place]) for point in points
              if start + point.time > now]
    if not coming:
        raise TrajectoryError(f"all {len(points)} points lie in the past, the last one"
                              f" {now - start - points[-1].time:.3f} s", OLD_HEADER_TIMESTAMP)
    begin = max(start, now)
    before: State = current.at(begin)
    offset = 0.0
    if wraps:
        way = wrapped_angle(coming[0][1][0] - before[0])
        if abs(abs(way) - math.pi) < 1e-9:
            way = math.copysign(way, coming[0][1][0] - before[0])
        offset = before[0] + way - coming[0][1][0]
    kept = current.segments[current.index(now):current.index(begin) + 1]
    made: List[Segment] = []
    at, state = begin, before
    for time, after in coming:
        after = (after[0] + offset, *after[1:])
        made.append(segment_between(at, state, time, after))
        at, state = time, after
    return Spline((*kept, *made), current.origin)


class Tolerance(NamedTuple):
    """How far from its target a joint may be; 0 for any distance."""

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0

    def holds(self, position_error: float, velocity_error: float) -> bool:
        return not (0.0 < self.position < abs(position_error)
                    or 0.0 < self.velocity < abs(velocity_error))

    def apply_message(self, message: Any) -> "Tolerance":
        """Apply a control_msgs/JointTolerance: 0 keeps a limit, a negative number removes it."""
        return Tolerance(*(old if new == 0.0 else max(0.0, float(new)) for old, new in zip(
            self, (message.position, message.velocity, message.acceleration))))


def update_tolerances(tolerances: Sequence[Tolerance], joints: Sequence[str],
                      messages: Sequence[Any]) -> List[Tolerance]:
    """Apply control_msgs/JointTolerance messages to the tolerances of joints."""
    said: Dict[str, Any] = {message.name: message for message in messages}
    return [tolerance.apply_message(said[name]) if name in said else tolerance
            for name, tolerance in zip(joints, tolerances)]
