"""SDF `<link>` in a robot's `<gazebo>`, for links outside of the tree that URDF describes."""
from __future__ import annotations

from typing import Any, Dict, Sequence

from ...description.model import Model
from ...geometry import IDENTITY, Pose, compose, inverse
from ..sdf.frame_graph import FrameError, FrameTree
from ..sdf.link import LinkReader
from ..xml.source import Source
from .kinematic_tree import Body

_ROOT = "__model__"


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
