"""SDF joints: their links, their axes, and the frames both are given in."""
from __future__ import annotations

from typing import Any, Callable, List, Optional, Tuple

from ..description.model import INFINITE, Joint, JointAxis
from ..description.validate import JOINT_TYPES
from ..geometry import Pose, Quat, Vec3, conjugate, norm, rotate, scale
from .sdf_frames import FrameFault
from .sdf_tables import AXIS, AXIS2, JOINT
from .sdf_versions import WORLD_AXES
from .source import Level, Source
from .tables import Found, Table, closest, fill
from .values import VECTOR3

MOVED = ("revolute", "prismatic", "fixed")
"""Types the engine moves; others are kept and stand still."""

PoseOf = Callable[[str], Pose]
"""From the name of a frame to its pose in the model; raises `FrameFault`."""


def read_joint(element: Any, source: Source) -> Tuple[Joint, Found]:
    """A joint with its pose as written; `place_axes` completes it once all frames are known.

    Source: SDF spec 1.7, joint.
    """
    joint = Joint(element.get("name", ""), _type(element, source), "", "")
    found = fill(joint, element, JOINT, source, joint.extra)
    joint.axis = _axis("axis", AXIS, found, source, joint)
    joint.axis2 = _axis("axis2", AXIS2, found, source, joint)
    if joint.type == "continuous":
        joint.type = "revolute"
        if joint.axis is not None:
            joint.axis.lower, joint.axis.upper = -INFINITE, INFINITE
    return joint, found


def _axis(tag: str, table: Table, found: Found, source: Source,
          joint: Joint) -> Optional[JointAxis]:
    """The axis without its direction, whose elements go to `found` as `<tag>/xyz`."""
    elements = found.get(tag)
    if not elements:
        return None
    axis = JointAxis()
    kept: List[str] = []
    inside = fill(axis, elements[0], table, source, kept)
    joint.extra += [f"<{tag}>{xml}</{tag}>" for xml in kept]
    found[f"{tag}/xyz"] = inside.get("xyz", [])
    return axis


def _type(element: Any, source: Source) -> str:
    name = element.get("name", "")
    joint_type: str = (element.get("type") or "").strip()
    if not joint_type:
        source.report(Level.FATAL, "joint-type-missing", f"joint {name!r} has no type", element)
    elif joint_type not in JOINT_TYPES and joint_type != "piston":
        source.report(Level.FATAL, "joint-type-unknown",
                      f"joint {name!r} has the unknown type {joint_type!r}", element,
                      closest(joint_type, list(JOINT_TYPES)))
    elif joint_type not in (*MOVED, "continuous"):
        source.warn("joint-unsupported", f"joint {name!r}: the type {joint_type} is not moved yet",
                    element)
    return joint_type


def place_axes(
    joint: Joint, found: Found, source: Source, pose_of: PoseOf, model_turn: Optional[Quat]
) -> None:
    """Bring the axes into the joint frame, as unit vectors.

    Args:
        joint: its `pose` already in the child link's frame.
        found: what `read_joint` returned.
        source: where faults go.
        pose_of: poses of links and frames in the model.
        model_turn: orientation of the model in the world.
    """
    if joint.type == "fixed":
        joint.axis = joint.axis2 = None  # files often keep an axis there; it means nothing
        return
    for which, axis in (("axis", joint.axis), ("axis2", joint.axis2)):
        for xyz in found.get(f"{which}/xyz", ()) if axis is not None else ():
            vector = _vector(xyz, source)
            if vector is None or norm(vector) < 1e-12:
                source.report(Level.FATAL, "joint-axis-zero",
                              f"the {which} of joint {joint.name!r} has no direction", xyz)
                continue
            expressed_in = xyz.get("expressed_in") or ""
            if expressed_in:
                try:
                    vector = _in_joint(vector, expressed_in, joint, pose_of, model_turn)
                except FrameFault as fault:
                    source.report(Level.FATAL, "frame-unknown", f"joint {joint.name!r}: {fault}",
                                  xyz)
            assert axis is not None
            axis.xyz = scale(vector, 1.0 / norm(vector))


def _vector(xyz: Any, source: Source) -> Optional[Vec3]:
    text = (xyz.text or "").strip()
    if not text:
        return (0.0, 0.0, 1.0)
    try:
        return VECTOR3.parse(text)
    except ValueError as fault:
        source.report(Level.FATAL, "bad-value", f"<xyz>: {fault}", xyz)
        return None


def _in_joint(vector: Vec3, expressed_in: str, joint: Joint, pose_of: PoseOf,
              model_turn: Optional[Quat]) -> Vec3:
    if expressed_in == WORLD_AXES:
        if model_turn is not None:
            vector = rotate(conjugate(model_turn), vector)
    else:
        vector = rotate(pose_of(expressed_in).orientation, vector)
    in_child = rotate(conjugate(pose_of(joint.child).orientation), vector)
    return rotate(conjugate(joint.pose.orientation), in_child)


def reverse_axes(joint: Joint) -> None:
    """Turn the axes of a joint whose parent and child were exchanged.

    The position keeps its sign: what turned the child against the parent by an angle about the axis
    turns the parent against the child by it about the opposite axis.
    """
    for axis in (joint.axis, joint.axis2):
        if axis is not None:
            axis.xyz = scale(axis.xyz, -1.0)
