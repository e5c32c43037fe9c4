"""get_model_state, set_model_state, get_link_state, set_link_state, as services and as topics."""
from __future__ import annotations

import threading
from collections import Counter
from typing import Any

import rospy
from gazebo_msgs import srv

from ...errors import CommandError
from ...geometry_messages import fill_pose, fill_twist
from ...simulator.simulator import Simulator
from ..message_conversion import (
    pose_from_message,
    seconds_and_nanoseconds,
    twist_from_message,
)
from .entity_errors import gazebo_prefix

NO_FRAME = "specified reference frame entity does not exist"


class _CountedResponse(srv.GetModelStateResponse):
    """Keeps our `header.seq`, which rospy would overwrite in a class that has a header."""

    _has_header = False


class StateServices:
    """Reads and sets poses and twists of models and links."""

    responses = {"get_model": _CountedResponse}

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._calls: "Counter[str]" = Counter()
        self._lock = threading.Lock()

    def get_model(self, request: Any, response: Any) -> str:
        """Pose and twist of a model in a frame; `seq` counts calls per model (Gazebo behaviour)."""
        name, frame = request.model_name, request.relative_entity_name
        with gazebo_prefix("model does not exist"):
            if self._simulator.models.nested(name) is None:
                self._simulator.models.get(name)
        with self._lock:
            self._calls[name] += 1
            response.header.seq = self._calls[name]
        response.header.frame_id = frame
        stamp = response.header.stamp
        stamp.secs, stamp.nsecs = seconds_and_nanoseconds(self._simulator.clock.sim_ns)
        with gazebo_prefix("model does not exist", "reference relative_entity_name not found"):
            pose, twist = self._simulator.states.model_state(name, frame)
        fill_pose(response.pose, pose)
        fill_twist(response.twist, twist)
        return "got properties"

    def get_link(self, request: Any, response: Any) -> str:
        """Pose and twist of a link, by scoped or unscoped name, in a frame."""
        with gazebo_prefix("link not found", "reference reference_frame not found"):
            pose, twist = self._simulator.states.link_state(request.link_name,
                                                            request.reference_frame)
        state = response.link_state
        state.link_name, state.reference_frame = request.link_name, request.reference_frame
        fill_pose(state.pose, pose)
        fill_twist(state.twist, twist)
        return "got state"

    def set_model(self, request: Any, _response: Any) -> str:
        """Set pose and twist of a model; reads after the response return them."""
        self.move_model(request.model_state)
        return "set model state done"

    def set_link(self, request: Any, _response: Any) -> str:
        self.move_link(request.link_state)
        return "success"

    def move_model(self, state: Any) -> None:
        """Apply a gazebo_msgs/ModelState.

        Raises CommandError: unknown model or frame, or a value that is NaN or infinite.
        """
        pose, twist = pose_from_message(state.pose), twist_from_message(state.twist)
        with gazebo_prefix("model does not exist", NO_FRAME):
            self._simulator.states.set_model_state(state.model_name, pose, twist,
                                                   state.reference_frame)

    def move_link(self, state: Any) -> None:
        """Apply a gazebo_msgs/LinkState.

        Raises CommandError: unknown link or frame, or a value that is NaN or infinite.
        """
        pose, twist = pose_from_message(state.pose), twist_from_message(state.twist)
        with gazebo_prefix("link does not exist", NO_FRAME):
            self._simulator.states.set_link_state(state.link_name, pose, twist,
                                                  state.reference_frame)

    def on_model_state(self, state: Any) -> None:
        """Subscriber callback of `move_model`; errors are logged."""
        try:
            self.move_model(state)
        except CommandError as fault:
            rospy.logerr_throttle_identical(1.0, f"SetModelState (topic): {fault}")

    def on_link_state(self, state: Any) -> None:
        """Subscriber callback of `move_link`; errors are logged."""
        try:
            self.move_link(state)
        except CommandError as fault:
            rospy.logerr_throttle_identical(1.0, f"SetLinkState (topic): {fault}")
