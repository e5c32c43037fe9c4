"""SDF joints: their links, their axes, and the frames of both.

Gazebo searches the whole world for the links of a joint between models. SDF 1.10 has joints in
`<world>`.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, List, Optional, Set, Tuple

from ...description.model import INFINITE, WORLD, Joint, JointAxis, Mimic
from ...description.validate import JOINT_TYPES, closest_name_hint
from ...geometry import IDENTITY, Pose, Quat, Vec3, compose, conjugate, inverse, norm, rotate, scale
from ..xml.binding import REFUSED, Found, fill, read_text
from ..xml.source import FaultLevel, Source
from ..xml.tables import Table, Value
from ..xml.values import FLOAT, TEXT, VECTOR3
from .frame_graph import FrameError, FrameTree
from .link import relative_to
from .model_tables import AXIS, AXIS2, JOINT
from .sensor_parameters import read_sensor
from .upgrade import WORLD_AXES


@dataclass
class UnresolvedJoint:
    """A joint whose links are not both found yet.

    Attributes:
        joint: its pose is as written; its links are names as written or found.
        found: the elements returned by `read_joint`.
        element: its `<joint>`.
        scope: prefix of names of its own model in the model that is searched now; "" in its own.
    """

    joint: Joint
    found: Found
    element: Any
    scope: str = ""

    def scoped(self, name: str) -> str:
        """A name of its own model, scoped for the model that is searched now."""
        return f"{self.scope}{name}" if name and self.scope else name

    def moved_out(self, model: str) -> "UnresolvedJoint":
        """The same joint, to be searched in the model around `model`."""
        self.joint.name = f"{model}::{self.joint.name}"
        return UnresolvedJoint(self.joint, self.found, self.element, f"{model}::{self.scope}")


PoseOf = Callable[[str], Pose]
"""Returns the pose of a frame in the model frame; raises `FrameError`."""


def read_joint(element: Any, source: Source) -> Tuple[Joint, Found]:
    """A joint with its pose as written; `place_axes` completes it when all frames are known.

    Source: SDF spec 1.7, joint.
    """
    joint = Joint(element.get("name", ""), _type(element, source), "", "")
    found = fill(joint, element, JOINT, source, joint.extra)
    joint.sensors = [read_sensor(child, source) for child in found.get("sensor", ())]
    joint.axis = _axis("axis", AXIS, found, source, joint)
    joint.axis2 = _axis("axis2", AXIS2, found, source, joint)
    _default_axes(joint, element, source)
    for child in found.get("screw_thread_pitch", ()):
        _thread(joint, child, source)
    if joint.type == "continuous":
        joint.type = "revolute"
        if joint.axis is not None:
            joint.axis.lower, joint.axis.upper = -INFINITE, INFINITE
    return joint, found


def _axis(tag: str, table: Table, found: Found, source: Source,
          joint: Joint) -> Optional[JointAxis]:
    """The axis without its direction, whose elements are added to `found` as `<tag>/xyz`."""
    elements = found.get(tag)
    if not elements:
        return None
    axis = JointAxis()
    kept: List[str] = []
    inside = fill(axis, elements[0], table, source, kept)
    for child in inside.get("mimic", ()):
        axis.mimic = _mimic(child, source)
    joint.extra += [f"<{tag}>{xml}</{tag}>" for xml in kept]
    found[f"{tag}/xyz"] = inside.get("xyz", [])
    return axis


def _mimic(element: Any, source: Source) -> Mimic:
    """Read `<mimic>`: q = multiplier (q_joint - reference) + offset. Source: SDF spec 1.11."""
    values = _Follow()
    fill(values, element, MIMIC, source, [])
    if not values.joint:
        source.report(FaultLevel.FATAL, "mimic-joint-missing", "<mimic> names no joint", element)
    if element.get("axis") not in (None, "", "axis"):
        source.warn("mimic-axis", "<mimic> follows the second axis of a joint, which is not"
                    " supported; the first axis is used", element)
    return Mimic(values.joint, values.multiplier,
                 values.offset - values.multiplier * values.reference)


@dataclass
class _Follow:
    joint: str = ""
    multiplier: float = 1.0
    offset: float = 0.0
    reference: float = 0.0


MIMIC = Table("mimic", _Follow, {
    name: Value(name, FLOAT) for name in ("multiplier", "offset", "reference")
}, attributes={"joint": Value("joint", TEXT)}, level=FaultLevel.FATAL, known_attributes=("axis",))


def _thread(joint: Joint, element: Any, source: Source) -> None:
    """Convert m per revolution (right-handed) to rad/m (left-handed). Source: SDF spec 1.10."""
    try:
        pitch = FLOAT.parse(element.text or "")
    except ValueError as fault:
        source.report(FaultLevel.FATAL, "bad-value", f"<screw_thread_pitch>: {fault}", element)
        return
    if pitch == 0:
        source.report(FaultLevel.FATAL, "bad-value", "<screw_thread_pitch> must not be 0", element)
        return
    joint.thread_pitch = -2.0 * math.pi / pitch


_TWO_AXES = ("universal", "revolute2", "gearbox")


def _default_axes(joint: Joint, element: Any, source: Source) -> None:
    """Default axes of two-axis joints; other types require their axes."""
    if joint.type == "universal" and joint.axis is None:
        source.warn("joint-axis-missing", f"universal joint {joint.name!r} has no axis; x and y are"
                    " used", element)
        joint.axis = JointAxis((1.0, 0.0, 0.0))
        joint.axis2 = joint.axis2 or JointAxis((0.0, 1.0, 0.0))
    elif joint.type in _TWO_AXES and joint.axis is not None and joint.axis2 is None:
        joint.axis2 = JointAxis()
    elif joint.axis is None and joint.type in ("revolute", "continuous", "prismatic", "screw",
                                               "revolute2", "gearbox"):
        source.tolerate("joint-axis-missing", f"joint {joint.name!r} of type {joint.type} has no"
                        " axis; the x axis of its child link is used, as by ODE", element)


def _type(element: Any, source: Source) -> str:
    name = element.get("name", "")
    joint_type: str = (element.get("type") or "").strip()
    if not joint_type:
        source.report(FaultLevel.ERROR, "joint-type-missing", f"joint {name!r} has no type; it is"
                      " skipped", element)
    elif joint_type == "piston":
        source.warn("joint-unsupported", f"joint {name!r}: type piston is not supported; the"
                    " joint does not move", element,
                    "it was dropped from the format; use prismatic")
    elif joint_type not in JOINT_TYPES:
        source.tolerate("joint-type-unknown", f"joint {name!r} has the unknown type"
                        f" {joint_type!r}; it is skipped", element,
                        closest_name_hint(joint_type, list(JOINT_TYPES)))
    return joint_type


def is_complete(one: UnresolvedJoint, source: Source) -> bool:
    """False for a joint that Gazebo does not create, either, because of its own elements."""
    joint = one.joint
    if joint.type not in (*JOINT_TYPES, "piston"):
        return False  # reported by `read_joint`
    missing = [role for role in ("parent", "child") if not getattr(joint, role)]
    if missing:
        source.report(FaultLevel.ERROR, "joint-link-missing", f"joint {joint.name!r} has no"
                      f" {' and no '.join(missing)} link; it is skipped", one.element)
    elif joint.parent == joint.child:
        source.tolerate("joint-link-repeated", f"joint {joint.name!r} connects {joint.child!r} with"
                        " itself; it is skipped", one.element)
    else:
        return True
    return False


def place_axes(
    joint: Joint, found: Found, source: Source, pose_of: PoseOf, model_turn: Optional[Quat]
) -> None:
    """Transform the axes to the joint frame, as unit vectors.

    Args:
        joint: the joint; its `pose` is already in the frame of the child link.
        found: the elements returned by `read_joint`.
        source: receives faults.
        pose_of: returns poses of links and frames in the model frame.
        model_turn: orientation of the model in the world.
    """
    if joint.type == "fixed":
        joint.axis = joint.axis2 = None  # many files have an axis here; it is unused
        return
    if joint.axis is None and joint.type != "ball":
        joint.axis = JointAxis(rotate(conjugate(joint.pose.orientation), (1.0, 0.0, 0.0)))
        joint.axis2 = JointAxis() if joint.type in _TWO_AXES else None
    for which, axis in (("axis", joint.axis), ("axis2", joint.axis2)):
        for xyz in found.get(f"{which}/xyz", ()) if axis is not None else ():
            vector = _vector(xyz, source)
            expressed_in = xyz.get("expressed_in") or ""
            if norm(vector) < 1e-12:
                source.tolerate("joint-axis-zero", f"the {which} of joint {joint.name!r} has no"
                                " direction; the x axis of the world is used, as by ODE", xyz)
                vector, expressed_in = (1.0, 0.0, 0.0), WORLD_AXES
            if expressed_in:
                try:
                    vector = _in_joint(vector, expressed_in, joint, pose_of, model_turn)
                except FrameError as fault:
                    source.tolerate("frame-unknown", f"joint {joint.name!r}: {fault}; the {which}"
                                    " is taken in the joint's own frame", xyz)
            assert axis is not None
            axis.xyz = _unit(vector)


def _unit(vector: Vec3) -> Vec3:
    """The unit vector; one that is already normalised keeps its exact numbers."""
    length = norm(vector)
    return vector if abs(length - 1.0) < 1e-13 else scale(vector, 1.0 / length)


def _vector(xyz: Any, source: Source) -> Vec3:
    text = (xyz.text or "").strip()
    if not text:
        return (0.0, 0.0, 1.0)
    vector = read_text(VECTOR3, text, "<xyz>", xyz, source, FaultLevel.FATAL)
    return (0.0, 0.0, 1.0) if vector is REFUSED else vector


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
    """Reverse the axes of a joint whose parent and child were exchanged.

    The position keeps its sign: a rotation of the child relative to the parent about an axis is the
    same rotation of the parent relative to the child about the opposite axis.
    """
    for axis in (joint.axis, joint.axis2):
        if axis is not None:
            axis.xyz = scale(axis.xyz, -1.0)


class InterModelJointReader:
    """Finds parent and child of joints, and transforms the joints to the child frame.

    Args:
        links: scoped names of all links of the world.
        frames: all frames of the world, including those inside its models.
        source: receives faults.
    """

    def __init__(self, links: Set[str], frames: FrameTree, source: Source) -> None:
        self._links = links
        self._frames = frames
        self._source = source

    def connect(self, one: UnresolvedJoint) -> bool:
        """Complete the joint; False, with an issue, if it cannot be used."""
        joint = one.joint
        parent, child = self._link(joint.parent, one), self._link(joint.child, one)
        if parent is None or child is None:
            self._source.tolerate("joint-link-unknown", f"joint {joint.name!r} connects"
                                  f" {joint.parent!r} with {joint.child!r}, which are not both in"
                                  " the world; it is skipped", one.element)
            return False
        joint.parent, joint.child = parent, child
        try:
            self._place(one)
        except FrameError as fault:
            self._source.tolerate("frame-unknown", f"joint {joint.name!r}: {fault}; it is skipped",
                                  one.element)
            return False
        return True

    def _place(self, one: UnresolvedJoint) -> None:
        """Transform joint pose and axes to the frame of the child, which is never the world."""
        joint = one.joint
        frame = relative_to(one.found)
        base = self._pose(frame, one) if frame else self._frames.pose(joint.child)
        at = compose(base, joint.pose)
        turned = joint.child == WORLD
        if turned:
            joint.parent, joint.child = WORLD, joint.parent
        if turned or frame:
            joint.pose = compose(inverse(self._frames.pose(joint.child)), at)
        # All frames are given in the world frame here, so such axes need no transform.
        place_axes(joint, one.found, self._source, lambda name: self._pose(name, one), None)
        if turned:
            reverse_axes(joint)

    def _pose(self, name: str, one: UnresolvedJoint) -> Pose:
        scoped = one.scoped(name)
        # SDF before 1.2 had joints in the world, too, with axes in the model frame by default.
        if name == WORLD or scoped == "__model__":
            return IDENTITY
        return self._frames.pose(scoped if scoped in self._frames else name)

    def _link(self, name: str, one: UnresolvedJoint) -> Optional[str]:
        for candidate in (one.scoped(name), name):
            if candidate in self._links or candidate == WORLD:
                return candidate
        return None
