"""joint_trajectory_controller: trajectories by topic and action; the engine follows the splines.

Parameters, topics, rules of joining and tolerances are those of ros_controllers. Tolerances are
checked 100 times a second of sim time, or as often as `controlPeriod` says.
"""
from __future__ import annotations

from functools import partial
from typing import Any, List, NamedTuple, Optional, Sequence, Set, Tuple

from ...engine.drive_commands import PidGains
from ...engine.servo_law import wrapped_angle
from ...engine.spline import Spline, constant_segment, segment_between
from ..actions import ActionServer, Goal
from ..call_slot import CallSlot
from ..context import RequestError
from .controller import RUNNING, Controller
from .hardware import POSITION, HardwareJoint
from .trajectory import (
    GOAL_TOLERANCE_VIOLATED,
    PATH_TOLERANCE_VIOLATED,
    SUCCESSFUL,
    Tolerance,
    TrajectoryError,
    read_joints,
    read_points,
    spliced_spline,
    update_tolerances,
)

_LOOK_HZ = 100.0
_ACTION = "control_msgs/FollowJointTrajectory"


class JointTrajectory(Controller):
    """The joints in the parameter `joints`."""

    @property
    def action_name(self) -> str:
        return f"{self.name}/follow_joint_trajectory"

    def load(self) -> None:
        s = self.settings
        self._names = s.texts("joints")
        self._joints = [self.claim_joint(self.interface, name) for name in self._names]
        self._gains: List[Optional[PidGains]] = [None] * len(self._names)
        if self.interface != POSITION:
            for place, name in enumerate(self._names):
                self._gains[place] = gains = s.needed_gains(f"gains/{name}")
                self.offer_gains(f"gains/{name}", self._joints[place], gains,
                                 partial(self._gains.__setitem__, place))
        self._feedforward = [s.number(f"velocity_ff/{name}", 0.0) for name in self._names]
        self._partial = s.flag("allow_partial_joints_goal", False)
        self._stop_time = s.number("stop_trajectory_duration", 0.0)
        self._state_hz = s.number("state_publish_rate", 50.0)
        self._feedback_hz = s.number("action_monitor_rate", 20.0)
        slow = s.number("constraints/stopped_velocity_tolerance", 0.01)
        self._path = [Tolerance(s.number(f"constraints/{name}/trajectory", 0.0))
                      for name in self._names]
        self._end = [Tolerance(s.number(f"constraints/{name}/goal", 0.0), slow)
                     for name in self._names]
        self._late = s.number("constraints/goal_time", 0.0)
        self._splines: List[Spline] = []
        self._followed: Optional[_Following] = None   # valid while the action has a goal
        self._watch = CallSlot()
        self._begun = 0.0
        self._seen: List[_Tracked] = []
        self._seen_at, self._seen_of = -1, self._splines
        self.subscribe("command", "trajectory_msgs/JointTrajectory", self._receive,
                       checks=True)
        self._state = self.publish("state", "control_msgs/JointTrajectoryControllerState")
        self._action = ActionServer(self.context, self.action_name, _ACTION, self._start_goal,
                                    self._on_cancel)
        self.keep_handle(self._action)
        self.serve("query_state", "control_msgs/QueryTrajectoryState", self._query)

    def start(self) -> None:
        """Hold the joints at their present positions."""
        self._splines = [Spline((constant_segment(joint.position),), self.context.step)
                         for joint in self._joints]
        self._send()
        if self._state_hz > 0.0:
            self.observe(self._state_hz, self._publish_state, [self._state])

    def stop(self) -> None:
        self._watch.end()
        self._action.preempt("the controller was stopped")

    # -- commands ----------------------------------------------------------------------------------

    def _receive(self, message: Any) -> None:
        try:
            self._take_over(message)
        except TrajectoryError as fault:
            self.context.warn(f"controller '{self.name}' ignores a trajectory: {fault}")
            return
        self._action.preempt("another trajectory came")

    def _start_goal(self, goal: Goal) -> None:
        result = self._action.result()
        wanted = goal.message
        try:
            if self.state != RUNNING:
                raise TrajectoryError("the controller is not running")
            named = self._read_joints(wanted.trajectory)   # also of a goal without points
            self._take_over(wanted.trajectory)
        except TrajectoryError as fault:
            result.error_code, result.error_string = fault.code, str(fault)
            self.context.warn(f"controller '{self.name}' rejects a goal: {fault}")
            goal.reject(result, str(fault))
            return
        self._action.preempt("another goal came")
        late = float(wanted.goal_time_tolerance.to_sec())
        followed = named if wanted.trajectory.points else []
        self._followed = _Following(
            goal,
            _of_joints(followed,
                       update_tolerances(self._path, self._names, wanted.path_tolerance)),
            _of_joints(followed, update_tolerances(self._end, self._names, wanted.goal_tolerance)),
            self._late if late == 0.0 else max(0.0, late))
        self._action.follow(goal)
        self._check_goal()

    def _on_cancel(self, goal: Goal) -> None:
        if self._action.current is goal:
            goal.cancel(self._action.result())
            self._hold()

    def _take_over(self, message: Any) -> None:
        """Follow a trajectory message. Raises TrajectoryError; then nothing has changed."""
        if not message.points:
            self._hold()
            return
        places = self._read_joints(message)
        points = read_points(message.points, len(places))
        surplus = len(message.points[0].positions) - len(places)
        if surplus > 0:
            self.context.warn(f"controller '{self.name}' ignores the last {surplus} positions of"
                              f" each point: the trajectory names {len(places)} joints only")
        now, stamp = self._now, message.header.stamp.to_nsec()
        start = now if stamp == 0 else now + (stamp - self.context.now_ns) * 1e-9
        made = {place: spliced_spline(self._splines[place], start, now, points, n,
                              self._joints[place].limits.wraps)
                for n, place in enumerate(places)}
        self._splines = [made.get(place, spline) for place, spline in enumerate(self._splines)]
        self._begun = max(start, now)
        self._send()

    def _read_joints(self, message: Any) -> List[int]:
        """Return the place of each joint of a message. Raises TrajectoryError."""
        return read_joints(list(message.joint_names), self._names, self._partial)

    def _hold(self) -> None:
        """Stay where the joints are, or come to a stop within `stop_trajectory_duration`."""
        now = self._now
        if self._stop_time <= 0.0:
            self._splines = [Spline((constant_segment(joint.position),), self.context.step)
                             for joint in self._joints]
        else:
            self._splines = [_stopping(spline, now, self._stop_time) for spline in self._splines]
        self._begun = self._now
        self._send()

    def _send(self) -> None:
        for joint, spline, gains, ahead in zip(self._joints, self._splines, self._gains,
                                               self._feedforward):
            _follow(joint, spline, gains, ahead, self._time(spline))
        if not self._watch.is_active and self._moves():
            self._watch.set(self.context.every(self.update_hz(_LOOK_HZ), self._check_goal))

    # -- while it moves ----------------------------------------------------------------------------

    @property
    def _now(self) -> float:
        """The splines' time, s."""
        return self._time(self._splines[0]) if self._splines else 0.0

    def _time(self, spline: Spline) -> float:
        return (self.context.step - spline.origin) * self.context.step_size

    def _moves(self) -> bool:
        return self._action.current is not None or any(
            self._time(spline) <= spline.segments[-1].end for spline in self._splines)

    def _check_goal(self) -> None:
        """Check tolerances; when all is done, let the engine stop computing."""
        following = self._followed
        if following is not None and self._action.current is not None:
            self._judge(following, self._tracked())
            self._send_feedback(following)
        if not self._moves():
            self._watch.end()
            self._send()
        elif not self._watch.is_active:
            self._send()

    def _judge(self, following: "_Following", axes: "List[_Tracked]") -> None:
        for n, (axis, spline) in enumerate(zip(axes, self._splines)):
            end = spline.segments[-1].end
            if axis.now < end:
                # Until the goal's trajectory starts, the joint follows the previous one.
                if axis.now >= self._begun and not following.path[n].holds(
                        axis.error, axis.rate_error):
                    self._fail(following, PATH_TOLERANCE_VIOLATED,
                               f"{self._names[n]} path error {axis.error:.6f}")
                    return
            elif following.end[n].holds(axis.error, axis.rate_error):
                following.arrived.add(n)
            elif axis.now >= end + following.late and n not in following.arrived:
                self._fail(following, GOAL_TOLERANCE_VIOLATED,
                           f"{self._names[n]} goal error {axis.error:.6f}")
                return
        if len(following.arrived) == len(self._joints):
            result = self._action.result()
            result.error_code = SUCCESSFUL
            following.goal.succeed(result)

    def _fail(self, following: "_Following", code: int, text: str) -> None:
        result = self._action.result()
        result.error_code, result.error_string = code, text
        following.goal.abort(result, text)

    def _tracked(self) -> "List[_Tracked]":
        """Return the desired and present state of each joint, computed once in a step."""
        step, splines = self.context.step, self._splines
        if self._seen_at != step or self._seen_of is not splines:
            self._seen_at, self._seen_of = step, splines
            dt = self.context.step_size
            self._seen = [_tracked(joint, spline, (step - spline.origin) * dt)
                          for joint, spline in zip(self._joints, splines)]
        return self._seen

    # -- messages ----------------------------------------------------------------------------------

    def _send_feedback(self, following: "_Following") -> None:
        now = self.context.now_ns
        if following.goal.active and self._feedback_hz > 0.0 and (
                now - following.told_ns) * self._feedback_hz >= 1e9:
            following.told_ns = now
            following.goal.feedback(self._filled(self.context.message(f"{_ACTION}Feedback")))

    def _publish_state(self) -> None:
        self._state.publish(self._filled(
            self.context.message("control_msgs/JointTrajectoryControllerState")))

    def _filled(self, message: Any) -> Any:
        message.header.stamp = self.context.stamp()
        message.joint_names = list(self._names)
        axes = self._tracked()
        message.desired.positions = [axis.wanted[0] for axis in axes]
        message.desired.velocities = [axis.wanted[1] for axis in axes]
        message.desired.accelerations = [axis.wanted[2] for axis in axes]
        message.actual.positions = [axis.position for axis in axes]
        message.actual.velocities = [axis.velocity for axis in axes]
        message.error.positions = [axis.error for axis in axes]
        message.error.velocities = [axis.rate_error for axis in axes]
        since = max(0, round((self._now - self._begun) * 1e9))
        for point in (message.desired, message.actual):
            point.time_from_start.secs, point.time_from_start.nsecs = divmod(since, 10 ** 9)
        return message

    def _query(self, request: Any, response: Any) -> None:
        if self.state != RUNNING:
            raise RequestError(f"controller '{self.name}' is not running")
        ahead = (request.time.to_nsec() - self.context.now_ns) * 1e-9
        found = [spline.at(self._time(spline) + ahead) for spline in self._splines]
        response.name = list(self._names)
        response.position = [state[0] for state in found]
        response.velocity = [state[1] for state in found]
        response.acceleration = [state[2] for state in found]


class _Tracked(NamedTuple):
    """A joint on its spline at the spline's time `now`, s; rad and rad/s, or m and m/s.

    Attributes:
        wanted: position, rate and acceleration of the spline.
        error: of the position, the shortest way round for a joint that wraps.
    """

    now: float
    wanted: Tuple[float, float, float]
    position: float
    velocity: float
    error: float
    rate_error: float


def _tracked(joint: HardwareJoint, spline: Spline, now: float) -> _Tracked:
    wanted = spline.at(now)
    position, velocity = joint.position, joint.velocity
    error = wanted[0] - position
    return _Tracked(now, wanted, position, velocity,
                    wrapped_angle(error) if joint.limits.wraps else error, wanted[1] - velocity)


class _Following:
    """A goal that is being followed."""

    def __init__(self, goal: Goal, path: List[Tolerance], end: List[Tolerance],
                 late: float) -> None:
        self.goal, self.path, self.end, self.late = goal, path, end, late
        self.arrived: Set[int] = set()
        self.told_ns = 0


def _of_joints(places: Sequence[int], tolerances: Sequence[Tolerance]) -> List[Tolerance]:
    """Keep the tolerances of the joints that a goal moves; the others may be anywhere."""
    return [tolerance if place in places else Tolerance()
            for place, tolerance in enumerate(tolerances)]


def _follow(joint: HardwareJoint, spline: Spline, gains: Optional[PidGains], ahead: float,
            now: float) -> None:
    """Hand a spline to the engine; one that has ended is a target, which may cost nothing."""
    if now > spline.segments[-1].end:
        target = spline.at(now)[0]
        if gains is None:
            joint.command(target)
        else:
            joint.follow(target, gains=gains, by_rates=True, feedforward=ahead)
    else:
        joint.follow(spline=spline, gains=gains, by_rates=gains is not None, feedforward=ahead)


def _stopping(spline: Spline, now: float, duration: float) -> Spline:
    """From what is wanted now to rest within a time: half of a way there and back."""
    position, rate, _ = spline.at(now)
    there_and_back = segment_between(now, (position, rate), now + 2.0 * duration,
                                     (position, -rate))
    rest = Spline((there_and_back,)).at(now + duration)[0]
    return Spline((segment_between(now, (position, rate), now + duration, (rest, 0.0)),),
                  spline.origin)
