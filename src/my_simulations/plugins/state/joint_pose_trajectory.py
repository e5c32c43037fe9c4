"""libgazebo_ros_joint_pose_trajectory.so: joints that are put where a trajectory says.

Parameters, defaults, topic and service are those of gazebo_plugins. `header.frame_id` names a
link that stays where it is, or `world` or `map` for the model. Where it differs: `time_from_start`
counts from the start, as the message says (the original adds the times up); only this model is
taken from the physics meanwhile, not the whole world.
"""
from __future__ import annotations

from typing import Any, List, Tuple

from ...geometry import Pose, compose, inverse, normalised, pose_is_finite
from ..base import Plugin
from ..call_slot import CallSlot
from ..context import Joint, Link, PluginError
from ..finite_messages import is_all_finite

_WORLD = ("world", "map")
_FIRM = 1e5  # N m or N: what holds joints between two points


class JointPoseTrajectory(Plugin):
    """Plays trajectory_msgs/JointTrajectory; another one replaces what is left of the first."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._joints: List[Joint] = []
        self._points: List[Tuple[int, List[float]]] = []
        self._anchor: "Link | None" = None
        self._next = CallSlot()
        self._held = False
        topic = p.text("topicName", "set_joint_trajectory")
        service = p.text("serviceName", "set_joint_trajectory")
        if topic:
            context.subscribe(topic, "trajectory_msgs/JointTrajectory", self._receive, queue=100)
        if service:
            context.serve(service, "gazebo_msgs/SetJointTrajectory", self._answer)

    def reset(self) -> None:
        self._end()

    clock_set = reset

    def _receive(self, message: Any) -> None:
        try:
            self._begin(message, True)
        except PluginError as fault:  # of this trajectory
            self.context.warn(str(fault))

    def _answer(self, request: Any, response: Any) -> None:
        try:
            if request.model_name not in ("", self.context.model):
                raise PluginError(f"this is model '{self.context.model}', not"
                                  f" '{request.model_name}'")
            if request.set_model_pose:
                at, turn = request.model_pose.position, request.model_pose.orientation
                pose = Pose((at.x, at.y, at.z), (turn.x, turn.y, turn.z, turn.w))
                if not pose_is_finite(pose):
                    raise PluginError("the pose of the model is not finite")
                self.context.move(Pose(pose.position, normalised(pose.orientation)))
            self._begin(request.joint_trajectory, bool(request.disable_physics_updates))
            response.success, response.status_message = True, "the trajectory is played"
        except PluginError as fault:
            response.success, response.status_message = False, str(fault)

    def _begin(self, message: Any, without_physics: bool) -> None:
        context, frame = self.context, message.header.frame_id
        joints, columns = self._find_joints(message.joint_names)
        for n, point in enumerate(message.points):
            if len(point.positions) != len(message.joint_names):
                raise PluginError(f"point {n} of the trajectory has {len(point.positions)} "
                                  f"positions for {len(message.joint_names)} joints")
            if not is_all_finite(point.positions):
                raise PluginError(f"a position of point {n} of the trajectory is not finite")
        anchor = None if frame.lstrip("/") in _WORLD else context.link(frame)
        self._end()
        stamp = message.header.stamp
        start = max(stamp.secs * 10 ** 9 + stamp.nsecs, context.now_ns)
        self._joints, self._anchor = joints, anchor
        self._points = [(start + point.time_from_start.secs * 10 ** 9
                         + point.time_from_start.nsecs,
                         [point.positions[n] for n in columns]) for point in message.points]
        if self._points and without_physics:
            self._held = True
            context.hold(True)
        if self._points and self._points[0][0] <= context.now_ns:
            self._play()
        else:
            self._await()

    def _find_joints(self, names: Any) -> Tuple[List[Joint], List[int]]:
        """Return the existing joints and their columns; report and skip the others."""
        joints, columns = [], []
        for n, name in enumerate(names):
            try:
                joints.append(self.context.joint(name))
                columns.append(n)
            except PluginError as fault:
                self.context.warn(f"{fault}; skipped")
        return joints, columns

    def _await(self) -> None:
        """Schedule the next point at its time; each step applies one, as in the original."""
        if self._points:
            self._next.set(self.context.once(self._points[0][0], self._play))
        else:
            self._end()

    def _play(self) -> None:
        """Put the joints where the first of the points that are left says."""
        positions = self._points.pop(0)[1]
        pose = self.context.pose
        fixed = pose if self._anchor is None else self._anchor.pose
        self.context.set_joint_positions(
            {joint.name: value for joint, value in zip(self._joints, positions)})
        moved = self.context.pose if self._anchor is None else self._anchor.pose
        self.context.move(compose(compose(fixed, inverse(moved)), self.context.pose))
        if self._held:
            for joint in self._joints:
                joint.drive(0.0, _FIRM)
        self._await()

    def _end(self) -> None:
        self._points = []
        self._next.end()
        if self._held:
            self._held = False
            self.context.hold(False)
            for joint in self._joints:
                joint.drive(0.0, 0.0)
