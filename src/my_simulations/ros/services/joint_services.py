"""get_joint_properties, set_joint_properties and set_model_configuration."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Dict, List, Optional, Sequence

from gazebo_msgs import srv

from ...description.model import INFINITE, Joint, JointAxis
from ...engine.ring_rows import AXES
from ...errors import CommandError
from ...simulator.simulator import Simulator
from ..message_conversion import FORCE, SPIN, check_number
from .entity_errors import gazebo_prefix

TYPES = {
    "revolute": srv.GetJointPropertiesResponse.REVOLUTE,
    "continuous": srv.GetJointPropertiesResponse.CONTINUOUS,
    "prismatic": srv.GetJointPropertiesResponse.PRISMATIC,
    "fixed": srv.GetJointPropertiesResponse.FIXED,
    "ball": srv.GetJointPropertiesResponse.BALL,
    "universal": srv.GetJointPropertiesResponse.UNIVERSAL,
    "revolute2": srv.GetJointPropertiesResponse.UNIVERSAL,
    "screw": srv.GetJointPropertiesResponse.REVOLUTE,
    "gearbox": srv.GetJointPropertiesResponse.REVOLUTE,
}
"""Joint types of the service by those of SDF, which has more."""

CONFIGURABLE = ("revolute", "continuous", "prismatic", "universal")
"""Types of joints that set_model_configuration moves, along their first axis (Gazebo behaviour)."""

ACTING = ("damping", "hiStop", "loStop", "fmax", "vel")
ODE_ONLY = ("erp", "cfm", "stop_erp", "stop_cfm", "fudge_factor")
"""Parameters of ODE that Bullet does not have."""

NO_JOINT = "joint not found"


class JointServices:
    """Reads and sets joint properties and positions."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def get(self, request: Any, response: Any) -> str:
        """Type, and damping (N m s/rad or N s/m), position and rate of each axis.

        A joint without axes has the position NaN and the rate 0 (Gazebo behaviour).
        """
        with gazebo_prefix(NO_JOINT):
            _, joint, _ = self._simulator.joints.find(request.joint_name)
            states = self._simulator.joints.states(request.joint_name)
        response.type = TYPES["continuous" if _is_continuous(joint) else joint.type]
        response.damping = [axis.damping for axis in _axes(joint)]
        response.position = [position for position, _ in states] or [math.nan]
        response.rate = [rate for _, rate in states] or [0.0]
        return "got properties"

    def set(self, request: Any, _response: Any) -> str:
        """Set joint properties; arrays have one element per axis, empty ones change nothing."""
        with self._simulator.change_lock:
            return self._set(request)

    def _set(self, request: Any) -> str:
        config = request.ode_joint_config
        with gazebo_prefix(NO_JOINT):
            owner, joint, _ = self._simulator.joints.find(request.joint_name)
        count = AXES.get(joint.type, 0)
        for name in (*ACTING, *ODE_ONLY):
            values = getattr(config, name)
            if len(values) > count:
                raise CommandError(f"{name} has {len(values)} elements, the {joint.type} joint "
                                   f"{joint.name!r} has {count or 'no'} "
                                   f"{'axis' if count == 1 else 'axes'}")
            if not all(math.isfinite(value) for value in values):
                raise CommandError(f"{name} contains NaN or infinity: {tuple(values)}")
        axes = [_set_axis(axis, config, number) for number, axis in enumerate(_axes(joint)[:count])]
        if any(getattr(config, name) for name in ACTING):
            self._simulator.joints.edit(f"{owner}::{joint.name}", _with_axes(joint, axes))
        idle = [name for name in ODE_ONLY if getattr(config, name)]
        return "properties set" + ("; ignored, not supported by Bullet: "
                                   f"{', '.join(idle)}" if idle else "")

    def configure(self, request: Any, _response: Any) -> str:
        """Set joint positions (rad or m), clamped to the joint limits, with zero velocity."""
        names, positions = request.joint_names, request.joint_positions
        with gazebo_prefix("model does not exist"):
            model = self._simulator.models.get(request.model_name)
        if len(names) != len(positions):
            raise CommandError("joint name and position list have different lengths: "
                               f"{len(names)} and {len(positions)}")
        joints = {joint.name: joint for joint in model.joints}
        scope = f"{request.model_name}::"
        wanted: Dict[str, float] = {}
        left: List[str] = []
        for name, position in zip(names, positions):
            check_number(position, -SPIN, SPIN, f"position of {name}")
            plain = name[len(scope):] if name.startswith(scope) else name
            joint = joints.get(plain)
            if joint is None or joint.type not in CONFIGURABLE:
                left.append(name)
                continue
            axis = joint.axis or JointAxis()
            wanted[scope + plain] = max(axis.lower, min(axis.upper, position))
        if wanted:
            self._simulator.joints.set_positions(wanted)
        if not left:
            return "success"
        settable = [name for name, joint in joints.items() if joint.type in CONFIGURABLE]
        return ("success; skipped unknown or non-settable joints: "
                f"{', '.join(left)}; settable joints: {', '.join(settable) or 'none'}")


def _axes(joint: Joint) -> List[JointAxis]:
    count = AXES.get(joint.type, 0)
    return [axis or JointAxis() for axis in (joint.axis, joint.axis2)[:count]]


def _with_axes(joint: Joint, axes: Sequence[JointAxis]) -> Joint:
    second: Optional[JointAxis] = axes[1] if len(axes) > 1 else joint.axis2
    return replace(joint, axis=axes[0], axis2=second)


def _is_continuous(joint: Joint) -> bool:
    return joint.type == "revolute" and all(
        axis.lower <= -INFINITE and axis.upper >= INFINITE for axis in _axes(joint))


def _set_axis(axis: JointAxis, config: Any, number: int) -> JointAxis:
    """The axis with what the request says about it."""
    def given(name: str, low: float, high: float, default: float) -> float:
        values = getattr(config, name)
        if len(values) <= number:
            return default
        return check_number(values[number], low, high, f"{name}[{number}]")

    lower = given("loStop", -INFINITE, INFINITE, axis.lower)
    upper = given("hiStop", -INFINITE, INFINITE, axis.upper)
    if lower > upper:
        raise CommandError(f"loStop[{number}] is {lower:g}, greater than hiStop[{number}] "
                           f"{upper:g}")
    return replace(axis, lower=lower, upper=upper,
                   damping=given("damping", 0.0, FORCE, axis.damping),
                   friction=given("fmax", 0.0, FORCE, axis.friction),
                   motor_rate=given("vel", -SPIN, SPIN, axis.motor_rate))
