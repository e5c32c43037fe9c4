"""URDF joints: type, links, axis, limits, mimic."""
from __future__ import annotations

from typing import Any, Dict, Optional

from ...description.model import INFINITE, Joint, JointAxis, Mimic, SoftLimits
from ...description.validate import closest_name_hint
from ...geometry import Quat, conjugate, norm, rotate, scale
from ..xml.binding import Found, fill
from ..xml.source import FaultLevel, Source
from .kinematic_tree import Body, Connection
from .link import read_origin
from .urdf_tables import (
    AXIS,
    DYNAMICS,
    JOINT,
    LIMIT_TABLE,
    MIMIC,
    SAFETY,
    Axis,
    Ends,
    Limits,
    Safety,
)

TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


def read_connection(element: Any, source: Source, bodies: Dict[str, Body]) -> Optional[Connection]:
    """A joint, added to both of its links; None, with an issue, if a link is missing.

    Source: URDF specification, joint; the joint frame is the child's link frame.
    """
    name, joint_type = element.get("name", ""), (element.get("type") or "").strip()
    ends = Ends()
    found = fill(ends, element, JOINT, source, [])
    if joint_type not in TYPES:
        source.report(FaultLevel.FATAL, "joint-type-unknown", f"joint {name!r} has the unknown type"
                      f" {joint_type!r}", element, closest_name_hint(joint_type, list(TYPES)))
        return None
    for role, link in (("parent", ends.parent), ("child", ends.child)):
        if link not in bodies:
            what = f"names {link!r} as its {role}, which is not a link" if link else (
                f"has no {role} link")
            source.report(FaultLevel.FATAL, "joint-link-unknown" if link else "joint-link-missing",
                          f"joint {name!r} {what} of the robot", element,
                          closest_name_hint(link, list(bodies)))
            return None
    joint = Joint(name, joint_type, ends.parent, ends.child)
    joint.axis = _axis(joint, found, element, source)
    if joint_type == "continuous":
        joint.type = "revolute"
    for mimic in found.get("mimic", ()):
        _follow(joint, mimic, source)
    origin = read_origin(found.get("origin", ()), source)
    return Connection(joint, element, origin, bodies[ends.parent], bodies[ends.child])


def _follow(joint: Joint, element: Any, source: Source) -> None:
    """Read `<mimic>`: q = multiplier q_joint + offset. Source: URDF specification, joint/mimic."""
    mimic = Mimic("")
    fill(mimic, element, MIMIC, source, [])
    if not mimic.joint or joint.axis is None:
        source.warn("mimic-joint-missing", f"joint {joint.name!r}: <mimic> names no joint, or has"
                    " no axis to turn; it is skipped", element)
        return
    joint.axis.mimic = mimic


def _axis(joint: Joint, found: Found, element: Any, source: Source) -> Optional[JointAxis]:
    if joint.type not in ("revolute", "continuous", "prismatic"):
        return None
    given = Axis()
    for child in found.get("axis", ()):
        fill(given, child, AXIS, source, [])
    length = norm(given.xyz)
    if length < 1e-12:
        source.tolerate("joint-axis-zero", f"the axis of joint {joint.name!r} has no direction; the"
                        " x axis of the model is used, as by ODE", found["axis"][0])
    # `turned_to` completes an axis without a direction when the link poses are known.
    axis = JointAxis(scale(given.xyz, 1.0 / length) if length >= 1e-12 else NOWHERE)
    limits = None
    for child in found.get("limit", ()):
        limits = Limits()
        fill(limits, child, LIMIT_TABLE, source, [])
    for child in found.get("dynamics", ()):
        fill(axis, child, DYNAMICS, source, [])
    for child in found.get("safety_controller", ()):
        safety = Safety()
        fill(safety, child, SAFETY, source, [])
        axis.soft = SoftLimits(safety.lower, safety.upper, safety.k_position, safety.k_velocity)
    if limits is not None:
        _limit(axis, limits, joint, found["limit"][0], source)
    elif joint.type != "continuous":
        source.report(FaultLevel.FATAL, "joint-limit-missing", f"joint {joint.name!r} of type"
                      f" {joint.type} has no <limit>", element,
                      "a revolute joint without limits is of type continuous")
    return axis


NOWHERE = (0.0, 0.0, 0.0)


def turned_to(axis: JointAxis, link: Quat) -> None:
    """Set the direction of an axis without one to the x axis of the model, as ODE does.

    Args:
        axis: the axis of a joint.
        link: orientation of the joint's child link in the model.
    """
    if axis.xyz == NOWHERE:
        axis.xyz = rotate(conjugate(link), (1.0, 0.0, 0.0))


def _limit(axis: JointAxis, limits: Limits, joint: Joint, element: Any, source: Source) -> None:
    axis.effort, axis.velocity = limits.effort, limits.velocity
    if joint.type == "continuous":
        axis.lower, axis.upper = -INFINITE, INFINITE
        return
    axis.lower, axis.upper = limits.lower, limits.upper
    if axis.lower > axis.upper:
        axis.lower, axis.upper = axis.upper, axis.lower
        source.warn("joint-limits-reversed", f"the limits of joint {joint.name!r} are exchanged:"
                    f" lower is above upper", element)
