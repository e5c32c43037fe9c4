"""Services apply_body_wrench, apply_joint_effort, clear_body_wrenches, clear_joint_forces."""
from __future__ import annotations

from typing import Any

import rospy

from ...errors import CommandError
from ...simulator.registry import UnknownEntityError
from ...simulator.simulator import Simulator
from ..message_conversion import FORCE, LENGTH, check_number, check_vector, vector_of
from .entity_errors import gazebo_prefix

NO_TIME = "; ignored: duration is 0"


class WrenchServices:
    """Applies and clears timed wrenches and efforts; see `simulator.wrenches` for frames."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def apply_wrench(self, request: Any, _response: Any) -> str:
        """Apply a wrench (N, N m) to a link."""
        force = check_vector(vector_of(request.wrench.force), FORCE, "N", "wrench.force")
        torque = check_vector(vector_of(request.wrench.torque), FORCE, "N m", "wrench.torque")
        point = check_vector(vector_of(request.reference_point), LENGTH, "m", "reference_point")
        with gazebo_prefix("body does not exist", "reference_frame not found"):
            self._simulator.wrenches.apply_wrench(request.body_name, force, torque,
                                                  frame=request.reference_frame, point=point,
                                                  start_ns=request.start_time.to_nsec(),
                                                  duration_ns=request.duration.to_nsec())
        return "wrench set" + ("" if request.duration.to_nsec() else NO_TIME)

    def apply_effort(self, request: Any, _response: Any) -> str:
        """Apply an effort (N m or N) to the first axis of a joint."""
        effort = check_number(request.effort, -FORCE, FORCE, "effort", "N m or N")
        with gazebo_prefix("joint not found"):
            self._simulator.wrenches.apply_effort(request.joint_name, effort,
                                  start_ns=request.start_time.to_nsec(),
                                  duration_ns=request.duration.to_nsec())
        return "effort set" + ("" if request.duration.to_nsec() else NO_TIME)

    def clear_wrenches(self, request: Any, _response: Any) -> str:
        """Clear all wrenches on a link; an unknown link is no error (Gazebo behaviour)."""
        try:
            self._simulator.wrenches.clear_wrenches(request.body_name)
        except UnknownEntityError as fault:
            rospy.logwarn_throttle_identical(1.0, f"ClearBodyWrenches: {fault}")
        return ""

    def clear_efforts(self, request: Any, _response: Any) -> str:
        """Clear all efforts on a joint; an unscoped name means that of every model (Gazebo)."""
        name = request.joint_name
        scoped = [f"{entity.model.name}::{name}"
                  for entity in self._simulator.models.inventory()[1]
                  if any(joint.name == name for joint in entity.model.joints)]
        for joint in scoped or [name]:
            try:
                self._simulator.wrenches.clear_efforts(joint)
            except CommandError as fault:
                rospy.logwarn_throttle_identical(1.0, f"ClearJointForces: {fault}")
        return ""
