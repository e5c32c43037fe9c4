"""The controllers of the package robot_controllers, for `fetch.py`.

Parameters, topics, actions and ends of goals are those of robot_controllers. Where they differ: a
trajectory controller has the topics `command` and `state`, too.
"""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, List, Optional, Tuple

from ...engine.drive_commands import PidGains
from ...engine.spline import Spline, segment_between
from ...geometry import Pose, Vec3, transform
from ..actions import ActionServer, Goal
from ..context import Publication
from ..finite_messages import is_all_finite
from ..stepwise_change import StepwiseChange
from ..time_out import TimeOut
from ..transforms import Transforms
from .controller import RUNNING, Controller
from .diff_drive_controller import DiffDriveController
from .hardware import POSITION, VELOCITY
from .joint_trajectory import JointTrajectory
from .settings import Settings

_LOOK_HZ = 50.0
_LATE = 0.6                                     # s, that a goal may end late
_NEAR, _STALLED = 0.002, 0.005                  # m, of the opening of the gripper
_STALL_TIME = 2.0                               # s


class FetchController(Controller):
    """A controller that starts with its first goal.

    Attributes:
        on_goal: starts the controller; those that use the same joints stop.
    """

    on_goal: Callable[[Controller], None]

    @property
    def autostarts(self) -> bool:
        return False

    def position_gains(self, name: str) -> PidGains:
        """Gains of the position loop of a joint."""
        return Settings(self.context, f"gazebo/{name}").gains("position") or PidGains(0.0)


class FetchTrajectory(JointTrajectory, FetchController):
    """FollowJointTrajectoryController: a position loop commands rates."""

    interface = VELOCITY

    @property
    def action_name(self) -> str:
        return self.name

    def load(self) -> None:
        names = self.settings.texts("joints")
        gains = {name: self.position_gains(name) for name in names}
        tree: Dict[str, Any] = {
            "joints": names, "velocity_ff": dict.fromkeys(names, 1.0),
            "gains": {name: {"p": one.p, "i": one.i, "d": one.d, "i_clamp_min": one.i_min,
                             "i_clamp_max": one.i_max} for name, one in gains.items()},
            "constraints": {"goal_time": _LATE, "stopped_velocity_tolerance": 0.0}}
        self.settings = Settings(self.context, self.name, tree)
        super().load()

    def _start_goal(self, goal: Goal) -> None:
        self.on_goal(self)
        super()._start_goal(goal)


class FetchBase(DiffDriveController, FetchController):
    """DiffDriveBaseController: `command`, `odom`."""

    @property
    def autostarts(self) -> bool:
        return True

    def load(self) -> None:
        s = self.settings
        limits = {axis: {"has_velocity_limits": True, "has_acceleration_limits": True,
                         "max_velocity": s.number(f"max_velocity_{letter}", rate),
                         "max_acceleration": s.number(f"max_acceleration_{letter}", change)}
                  for axis, letter, rate, change in (("x", "x", 1.0, 0.75), ("z", "r", 4.5, 3.0))}
        tree: Dict[str, Any] = {
            "left_wheel": s.texts("l_wheel_joints", [s.text("l_wheel_joint", "l_wheel_joint")]),
            "right_wheel": s.texts("r_wheel_joints", [s.text("r_wheel_joint", "r_wheel_joint")]),
            "wheel_separation": s.number("track_width", 0.37476),
            "wheel_radius": 1.0 / (s.number("radians_per_meter", 16.5289) or math.inf),
            "cmd_vel_timeout": s.number("timeout", 0.25),
            "publish_rate": s.number("publish_frequency", 100.0),
            "odom_frame_id": s.text("odometry_frame", "odom"),
            "base_frame_id": s.text("base_frame", "base_link"),
            "enable_odom_tf": s.flag("publish_tf", True),
            "linear": {"x": limits["x"]}, "angular": {"z": limits["z"]}}
        self.settings = Settings(self.context, self.name, tree)
        super().load()

    def publish(self, topic: str, kind: str, queue: int = 1, latch: bool = False) -> Publication:
        """Advertise the odometry as `odom`, which is not below the controller's name."""
        if topic != "odom":
            return super().publish(topic, kind, queue, latch)
        made = self.context.publish(topic, kind, queue, latch)
        self.keep_handle(made)
        return made

    def subscribe(self, topic: str, kind: str, call: Callable[[Any], None],
                  checks: bool = False) -> None:
        """Subscribe to `command` in place of `cmd_vel`."""
        super().subscribe("command" if topic == "cmd_vel" else topic, kind, call, checks)


class ActionController(FetchController):
    """A controller with one action, whose goal the next one replaces."""

    kind = ""

    def begin_action(self) -> None:
        """Offer the action; call this in `load`."""
        self.watch = StepwiseChange(self.context, _LOOK_HZ, self._look)
        self.action = ActionServer(self.context, self.name, self.kind, self._start_goal,
                                   self._on_cancel)
        self.keep_handle(self.action)

    def follow(self, goal: Goal) -> str:
        """Follow a goal of the running controller; return why that is impossible, or ""."""
        raise NotImplementedError

    def check(self, goal: Goal) -> bool:
        """End a goal that is reached; return whether it has ended."""
        raise NotImplementedError

    def result(self) -> Any:
        return self.action.result()

    def stop(self) -> None:
        self.watch.end()
        self.action.preempt("the controller was stopped", self.result)

    def _start_goal(self, goal: Goal) -> None:
        self.on_goal(self)
        self.action.preempt("another goal came", self.result)
        self.action.follow(goal)
        reason = self.follow(goal)
        if reason:
            goal.abort(self.result(), reason)
            return
        self.watch.begin()

    def _on_cancel(self, goal: Goal) -> None:
        if self.action.current is goal:
            goal.cancel(self.result())

    def _look(self, dt: float) -> bool:
        goal = self.action.current
        return goal is None or self.state == RUNNING and self.check(goal)


class ParallelGripper(ActionController):
    """ParallelGripperController: two fingers with one opening."""

    kind = "control_msgs/GripperCommand"

    def load(self) -> None:
        s = self.settings
        self._fingers = [self.claim_joint(POSITION, s.text(f"{side}_gripper_joint",
                                                           f"{side}_gripper_finger_joint"))
                         for side in ("l", "r")]
        self._widest, self._strongest = s.number("max_position", 0.1), s.number("max_effort", 10.0)
        self._stall = TimeOut(self.context, _STALL_TIME)
        self._last = self._wanted = 0.0
        self.begin_action()

    def start(self) -> None:
        """Hold the fingers until a goal comes."""
        for finger in self._fingers:
            finger.follow(finger.position, most_effort=self._strongest)

    @property
    def _opening(self) -> float:
        return sum(finger.position for finger in self._fingers)

    def follow(self, goal: Goal) -> str:
        command = goal.message.command
        if not is_all_finite(command):
            return "the position or the effort is no number"
        self._wanted = float(command.position)
        effort = float(command.max_effort)
        if not 0.0 < effort <= self._strongest:
            effort = self._strongest
        target = max(0.0, min(self._widest, self._wanted)) / 2.0
        for finger in self._fingers:
            finger.follow(target, most_effort=effort)
        self._last = self._opening
        self._stall.begin()
        return ""

    def check(self, goal: Goal) -> bool:
        """Succeed at the goal, and 2 s after the fingers have stopped elsewhere."""
        opening = self._opening
        reached = abs(opening - self._wanted) < _NEAR
        if abs(opening - self._last) > _STALLED:
            self._last = opening
            self._stall.begin()
        if not reached and not self._stall.is_over:
            goal.feedback(self._fill_result("Feedback", False, False))
            return False
        goal.succeed(self._fill_result("Result", not reached, reached))
        return True

    def result(self) -> Any:
        return self._fill_result("Result", False, False)

    def _fill_result(self, part: str, stalled: bool, reached: bool) -> Any:
        message = self.context.message(f"{self.kind}{part}")
        message.position = self._opening
        message.effort = sum(self.hardware.efforts([one.name for one in self._fingers]))
        message.stalled, message.reached_goal = stalled, reached
        return message


class PointHead(ActionController):
    """PointHeadController: pan and tilt of the head, so that it faces a point."""

    kind = "control_msgs/PointHead"
    _pan, _tilt = "head_pan_joint", "head_tilt_joint"

    def load(self) -> None:
        self._joints = [self.claim_joint(VELOCITY, name) for name in (self._pan, self._tilt)]
        self._gains = [self.position_gains(joint.name) for joint in self._joints]
        found = self.context.joint(self._pan)
        self._frames = (found.parent, found.child)   # links of the torso and of the pan joint
        self._transforms = Transforms(self.context)
        self._end_ns, self._wanted = 0, (0.0, 0.0)
        self.begin_action()

    def start(self) -> None:
        """Hold the head until a goal comes."""
        for joint, gains in zip(self._joints, self._gains):
            joint.follow(joint.position, gains=gains)

    def follow(self, goal: Goal) -> str:
        """Move both joints so that they arrive together, within their limits of rate."""
        wanted = goal.message
        angles = self._angles(wanted.target.header.frame_id, wanted.target.point)
        if angles is None:
            return "Could not transform goal."
        most = float(wanted.max_velocity) if wanted.max_velocity > 0.0 else math.inf
        span = max([max(0.0, wanted.min_duration.to_sec()), self.context.step_size, *(
            abs(angle - joint.position) / min(most, joint.limits.rate)
            for angle, joint in zip(angles, self._joints))])
        for joint, angle, gains in zip(self._joints, angles, self._gains):
            way = segment_between(0.0, (joint.position, 0.0, 0.0), span, (angle, 0.0, 0.0))
            joint.follow(spline=Spline((way,), self.context.step), gains=gains, feedforward=1.0)
        self._end_ns, self._wanted = self.context.now_ns + round(span * 1e9), angles
        return ""

    def check(self, goal: Goal) -> bool:
        if self.context.now_ns <= self._end_ns:
            return False
        for joint, angle, gains in zip(self._joints, self._wanted, self._gains):
            joint.follow(angle, gains=gains)   # a target costs less than a spline
        goal.succeed(self.result(), "OK")
        return True

    def _angles(self, frame: str, point: Any) -> Optional[Tuple[float, float]]:
        """Pan and tilt that face a point; None if tf does not connect its frame."""
        poses: List[Optional[Pose]] = [self._transforms.look_up(link, frame)
                                       for link in self._frames]
        if poses[0] is None or poses[1] is None:
            return None
        at: Vec3 = (point.x, point.y, point.z)
        (x, y, _), (tx, ty, tz) = transform(poses[0], at), transform(poses[1], at)
        return math.atan2(y, x), -math.atan2(tz, math.hypot(tx, ty))
