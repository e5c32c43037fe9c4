"""SDF `<link>` and `<joint>` in a robot's `<gazebo>`, for parts that URDF cannot describe."""
from __future__ import annotations

from typing import Any, Dict, Optional, Sequence

from ...description.model import WORLD, Joint, Model
from ...description.validate import closest_name_hint
from ...geometry import IDENTITY, Pose, compose, inverse
from ..sdf.frame_graph import FrameError, FrameTree
from ..sdf.joint import UnresolvedJoint, is_complete, place_axes, read_joint, reverse_axes
from ..sdf.link import LinkReader
from ..xml.source import Source
from .fixed_joint_lumping import lumped_into
from .kinematic_tree import Body

_ROOT = "__model__"


def read_sdf_joint(element: Any, source: Source, bodies: Dict[str, Body],
                   poses: Dict[str, Pose], robot: str) -> Optional[Joint]:
    """The joint, between the links after lumping; None, with an issue, if unusable.

    Args:
        element: SDF `<joint>` of version 1.7.
        source: its file.
        bodies: links of the file by name.
        poses: poses of the links in the model frame, by name.
        robot: name of the model, which may scope the names of links.
    """
    joint, found = read_joint(element, source)
    if not is_complete(UnresolvedJoint(joint, found, element), source):
        return None
    for role in ("parent", "child"):
        name = getattr(joint, role)
        own = name[len(robot) + 2:] if name.startswith(f"{robot}::") else name
        setattr(joint, role, own)
        if own not in bodies and own != WORLD:
            source.tolerate("joint-link-unknown", f"joint {joint.name!r} names {name!r}, which is"
                            " not a link of the robot; it is skipped", element,
                            closest_name_hint(own, list(bodies)))
            return None
    at = compose(poses.get(joint.child, IDENTITY), joint.pose)
    for role in ("parent", "child"):
        name = getattr(joint, role)
        if name in bodies:
            setattr(joint, role, lumped_into(bodies[name]).link.name)
    turned = joint.child == WORLD
    if turned:  # in the description the world can only be the parent
        joint.parent, joint.child = joint.child, joint.parent
    joint.pose = compose(inverse(poses.get(joint.child, IDENTITY)), at)

    def pose_of(name: str) -> Pose:
        if name == _ROOT:
            return IDENTITY
        if name not in poses:
            raise FrameError(f"there is no frame {name!r}")
        return poses[name]

    place_axes(joint, found, source, pose_of, None)
    if turned:
        reverse_axes(joint)
    return joint


def add_sdf_links(elements: Sequence[Any], source: Source, model: Model, bodies: Dict[str, Body],
                  poses: Dict[str, Pose]) -> Dict[int, Any]:
    """Add the links to the model, and to `bodies` and `poses` for the joints that name them.

    Gazebo's converter copies them into the model as they are (sdformat 9, parser_urdf.cc:
    InsertSDFExtensionRobot), so their poses are in the model frame.

    Args:
        elements: SDF `<link>`s of version 1.7.
        source: their file.
        model: the robot, whose other links are complete.
        bodies: links of the file by name.
        poses: poses of the links in the model frame, by name.

    Returns:
        the elements by id of the object that was read from them.
    """
    frames = FrameTree(_ROOT)
    for name, pose in poses.items():
        frames.add(name, pose, "", None, name)
    reader = LinkReader(source, frames, [link.name for link in model.links])
    links = reader.read_all(elements, model.static)
    for thing, frame, link_name in reader.given_in:
        element = reader.elements[id(thing)]
        try:
            base = frames.pose(link_name) if link_name else IDENTITY
            at = frames.pose(frame)
        except FrameError as fault:
            source.tolerate("frame-unknown", f"{fault}; the pose of this <{element.tag}> is"
                            " taken without it", element)
            continue
        # A link's own name stands for its whole pose; a shape's frame holds its pose.
        thing.pose = compose(inverse(base), compose(at, thing.pose)) if link_name else at
    for link in links:
        bodies[link.name] = Body(link, reader.elements[id(link)])
        poses[link.name] = link.pose
    model.links += links
    return reader.elements
