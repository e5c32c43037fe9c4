"""Joints between models of a world.

Gazebo searches the whole world for the links of a joint. SDF 1.10 has joints in `<world>`.
"""
from __future__ import annotations

from typing import Optional, Set

from ...description.model import WORLD
from ...geometry import IDENTITY, Pose, compose, inverse
from ..xml.source import Source
from .frame_graph import FrameError, FrameTree
from .joint import UnresolvedJoint, place_axes, reverse_axes
from .link import relative_to


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
