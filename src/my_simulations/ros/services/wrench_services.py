"""Timed wrenches and efforts: apply_body_wrench, apply_joint_effort and what clears them."""
from __future__ import annotations

from typing import Any

import rospy

from ...errors import CommandError
from ...simulator.registry import UnknownEntityError
from ...simulator.simulator import Simulator
from ..message_conversion import FORCE, LENGTH, between, vector, within
from .entity_errors import in_gazebos_words

NO_TIME = "; the duration is 0, so nothing happens"


class LoadServices:
    """What acts on links and joints for a time; see `simulator.wrenches` for frames and times."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def apply_wrench(self, request: Any, _response: Any) -> str:
        """A wrench on a link."""
        force = within(vector(request.wrench.force), FORCE, "N", "wrench.force")
        torque = within(vector(request.wrench.torque), FORCE, "N m", "wrench.torque")
        point = within(vector(request.reference_point), LENGTH, "m", "reference_point")
        with in_gazebos_words("body does not exist", "reference_frame not found"):
            self._simulator.wrenches.apply_wrench(request.body_name, force, torque,
                                                  frame=request.reference_frame, point=point,
                                                  start_ns=request.start_time.to_nsec(),
                                                  duration_ns=request.duration.to_nsec())
        return "wrench set" + ("" if request.duration.to_nsec() else NO_TIME)

    def apply_effort(self, request: Any, _response: Any) -> str:
        """An effort on the first axis of a joint."""
        effort = between(request.effort, -FORCE, FORCE, "effort", "N m or N")
        with in_gazebos_words("joint not found"):
            self._simulator.wrenches.apply_effort(request.joint_name, effort,
                                  start_ns=request.start_time.to_nsec(),
                                  duration_ns=request.duration.to_nsec())
        return "effort set" + ("" if request.duration.to_nsec() else NO_TIME)

    def clear_wrenches(self, request: Any, _response: Any) -> str:
        """End all wrenches on a link; an unknown one has none (Gazebo behaviour)."""
        try:
            self._simulator.wrenches.clear_wrenches(request.body_name)
        except UnknownEntityError as fault:
            rospy.logwarn_throttle_identical(1.0, f"ClearBodyWrenches: {fault}")
        return ""

    def clear_efforts(self, request: Any, _response: Any) -> str:
        """End all efforts on a joint; a plain name means it in every model (Gazebo behaviour)."""
        name = request.joint_name
        scoped = [f"{model}::{name}" for model in self._simulator.models.names()
                  if any(joint.name == name for joint in self._simulator.models.get(model).joints)]
        for joint in scoped or [name]:
            try:
                self._simulator.wrenches.clear_efforts(joint)
            except CommandError as fault:
                rospy.logwarn_throttle_identical(1.0, f"ClearJointForces: {fault}")
        return ""
