"""Limits of joints: from the description, and from `joint_limits` on the parameter server."""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Dict, List, Optional

from ...description.model import INFINITE, Joint, Model, SoftLimits
from ...geometry import Vec3, norm, subtract, transform
from ..context import Context
from .settings import Settings

_SPARE = 1.5    # of what holds the links of a joint against gravity


@dataclass(frozen=True)
class JointLimits:
    """Limits of one joint; infinite where there are none. Units: rad or m, s, N m or N."""

    lower: float = -math.inf
    upper: float = math.inf
    rate: float = math.inf
    effort: float = math.inf
    wraps: bool = False
    soft: Optional[SoftLimits] = None


def limits_of(joint: Joint, context: Context) -> JointLimits:
    """What the description says, and then the parameters `joint_limits/NAME/...`.

    Source: joint_limits_interface, joint_limits_rosparam.
    """
    axis = joint.axis
    found = JointLimits()
    if axis is not None:
        turns = joint.type == "revolute" and axis.lower <= -INFINITE and axis.upper >= INFINITE
        found = JointLimits(
            axis.lower if axis.lower > -INFINITE else -math.inf,
            axis.upper if axis.upper < INFINITE else math.inf,
            axis.velocity if axis.velocity >= 0.0 else math.inf,
            axis.effort if axis.effort >= 0.0 else math.inf, turns,
            axis.soft)
    said = Settings(context, f"joint_limits/{joint.name}")
    if said.flag("has_position_limits", False):
        found = replace(found, lower=said.number("min_position", found.lower),
                        upper=said.number("max_position", found.upper), wraps=False)
    elif said.get("has_position_limits") is False:
        found = replace(found, lower=-math.inf, upper=math.inf)
    if said.flag("has_velocity_limits", False):
        found = replace(found, rate=said.number("max_velocity", found.rate))
    if said.flag("has_effort_limits", False):
        found = replace(found, effort=said.number("max_effort", found.effort))
    if said.flag("angle_wraparound", False):
        found = replace(found, wraps=True)
    if said.flag("has_soft_limits", False):
        found = replace(found, soft=SoftLimits(
            said.number("soft_lower_limit", found.lower),
            said.number("soft_upper_limit", found.upper),
            said.number("k_position", 0.0), said.number("k_velocity", 0.0)))
    if found.soft is not None and math.isinf(found.lower) and math.isinf(found.upper):
        # A wheel's `<safety_controller k_velocity="10"/>` has soft limits of 0.
        found = replace(found, soft=replace(found.soft, lower=-math.inf, upper=math.inf))
    return found


def holding_effort(model: Model, joint: Joint, gravity: Vec3) -> float:
    """Return an effort (N m or N) that holds the weight on a joint in any configuration.

    It includes a margin.
    """
    links = {link.name: link for link in model.links}
    if joint.child not in links:
        return 0.0
    below: Dict[str, List[Joint]] = {}
    for one in model.joints:
        below.setdefault(one.parent, []).append(one)
    origin = joint_origin(joint, model)
    load, todo, seen = 0.0, [(joint.child, 0.0, origin)], {joint.parent}
    while todo:
        name, reach, start = todo.pop()
        link = links.get(name)
        if link is None or name in seen:
            continue
        seen.add(name)
        centre = transform(link.pose, link.inertial.pose.position)
        way = reach + norm(subtract(centre, start))
        load += link.inertial.mass * (1.0 if joint.type == "prismatic" else way)
        for one in below.get(name, ()):
            at = joint_origin(one, model)
            todo.append((one.child, reach + norm(subtract(at, start)), at))
    return _SPARE * norm(gravity) * load


def joint_origin(joint: Joint, model: Model) -> Vec3:
    """Return the pose of a joint in its model at joint positions 0."""
    for link in model.links:
        if link.name == joint.child:
            return transform(link.pose, joint.pose.position)
    return joint.pose.position
