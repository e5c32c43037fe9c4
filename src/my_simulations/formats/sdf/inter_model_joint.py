"""Joints between models of a world, which belong to none of them.

Gazebo looks for links of other models in the whole world; SDF 1.10 has joints of the world.
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
    """Finds the ends of joints, and brings them to the frame of the child.

    Args:
        links: scoped names of all links of the world.
        frames: of the world, those inside its models included.
        source: where faults go.
    """

    def __init__(self, links: Set[str], frames: FrameTree, source: Source) -> None:
        self._links = links
        self._frames = frames
        self._source = source

    def connect(self, one: UnresolvedJoint) -> bool:
        """Complete the joint; False, with an issue, where it cannot be used."""
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
        """Joint pose and axes in the frame of the child; the child is never the world."""
        joint = one.joint
        frame = relative_to(one.found)
        base = self._pose(frame, one) if frame else self._frames.pose(joint.child)
        at = compose(base, joint.pose)
        turned = joint.child == WORLD
        if turned:
            joint.parent, joint.child = WORLD, joint.parent
        if turned or frame:
            joint.pose = compose(inverse(self._frames.pose(joint.child)), at)
        # Axes in world coordinates are so here, where all frames are the world's.
        place_axes(joint, one.found, self._source, lambda name: self._pose(name, one), None)
        if turned:
            reverse_axes(joint)

    def _pose(self, name: str, one: UnresolvedJoint) -> Pose:
        scoped = one.scoped(name)
        # Joints of the world were there before 1.2, too, with axes "in the model frame" by default.
        if name == WORLD or scoped == "__model__":
            return IDENTITY
        return self._frames.pose(scoped if scoped in self._frames else name)

    def _link(self, name: str, one: UnresolvedJoint) -> Optional[str]:
        for candidate in (one.scoped(name), name):
            if candidate in self._links or candidate == WORLD:
                return candidate
        return None
