"""Spawning from Python: the three functions that other packages import.

Same names, arguments and results as in Gazebo's package of this name; the waits end: for a service
after a minute, for its answer after five, instead of never.
"""
from __future__ import annotations

from typing import Any, Optional, Sequence

import rospy
from gazebo_msgs.srv import (
    SetModelConfiguration,
    SetModelConfigurationRequest,
    SpawnModel,
    SpawnModelRequest,
)

from my_simulations.ros.call_deadline import CallTimeoutError, call_with_deadline
from my_simulations.ros.service_client import ServiceUnavailableError, api_name, service_proxy

CALL_SECONDS = 300.0
"""How long an answer may take; dividing a big mesh into convex parts takes minutes."""


def spawn_sdf_model_client(model_name: str, model_xml: str, robot_namespace: str,
                           initial_pose: Any, reference_frame: str,
                           gazebo_namespace: str) -> Optional[bool]:
    """Spawn an SDF model.

    Args:
        model_name: its name in the world.
        model_xml: the document.
        robot_namespace: for plugins that name none.
        initial_pose: geometry_msgs/Pose in `reference_frame`.
        reference_frame: a model or link; "" or "world" for the world.
        gazebo_namespace: of the server, usually "/gazebo".

    Returns:
        What the service said, or None when it could not be called.
    """
    return _spawn("spawn_sdf_model", model_name, model_xml, robot_namespace, initial_pose,
                  reference_frame, gazebo_namespace)


def spawn_urdf_model_client(model_name: str, model_xml: str, robot_namespace: str,
                            initial_pose: Any, reference_frame: str,
                            gazebo_namespace: str) -> Optional[bool]:
    """Spawn a URDF model; arguments and result as for `spawn_sdf_model_client`."""
    return _spawn("spawn_urdf_model", model_name, model_xml, robot_namespace, initial_pose,
                  reference_frame, gazebo_namespace)


def set_model_configuration_client(model_name: str, model_param_name: str,
                                   joint_names: Sequence[str], joint_positions: Sequence[float],
                                   gazebo_namespace: str) -> Optional[bool]:
    """Set joint positions (rad or m) of a model.

    Returns:
        What the service said, or None when it could not be called.
    """
    request = SetModelConfigurationRequest(
        model_name=model_name, urdf_param_name=model_param_name,
        joint_names=list(joint_names), joint_positions=list(joint_positions))
    return _call(api_name(gazebo_namespace, "set_model_configuration"), SetModelConfiguration,
                 request)


def _spawn(kind: str, model_name: str, model_xml: str, robot_namespace: str, initial_pose: Any,
           reference_frame: str, gazebo_namespace: str) -> Optional[bool]:
    request = SpawnModelRequest(
        model_name=model_name, model_xml=model_xml, robot_namespace=robot_namespace,
        initial_pose=initial_pose, reference_frame=reference_frame)
    return _call(api_name(gazebo_namespace, kind), SpawnModel, request)


def _call(name: str, service_class: Any, request: Any) -> Optional[bool]:
    try:
        proxy = service_proxy(name, service_class)
        answer = call_with_deadline(CALL_SECONDS, name, lambda: proxy(request))
    except (ServiceUnavailableError, CallTimeoutError, rospy.ServiceException) as fault:
        rospy.logerr("%s: %s", name, fault)
        return None
    rospy.loginfo("%s: %s", name, answer.status_message)
    return bool(answer.success)
