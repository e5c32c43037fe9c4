"""The kinematic tree of a robot while it is read: bodies and connections."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Iterator, List, Optional, Set, Tuple

from ...description.model import Inertial, Joint, Link
from ...description.shapes import Collision, Visual
from ...geometry import IDENTITY, Pose

LUMP = "_fixed_joint_lump__"


@dataclass
class Body:
    """A link of the file.

    Attributes:
        link: the resulting link; its collisions and visuals are added at the end.
        element: its `<link>`.
        inertial: its inertial; None if the file has none.
        collisions, visuals: shapes, each with the stem of its future name.
        up: connection to the parent; None for the root.
        down: connections to the children, sorted by joint name.
        into: the body it was lumped into, which itself was not lumped; None if it is kept.
        offset: pose of its link frame in the body it was lumped into.
        set_tags: tags of its `<gazebo>` blocks that set the link.
    """

    link: Link
    element: Any
    inertial: Optional[Inertial] = None
    collisions: List[Tuple[str, Collision]] = field(default_factory=list)
    visuals: List[Tuple[str, Visual]] = field(default_factory=list)
    up: Optional["Connection"] = None
    down: List["Connection"] = field(default_factory=list)
    into: Optional["Body"] = None
    offset: Pose = IDENTITY
    set_tags: Set[str] = field(default_factory=set)


@dataclass
class Connection:
    """A joint of the file; `origin` is the pose of the child link frame in the parent link frame.

    `keep` is "fixed" for a fixed joint that is kept, "revolute" for one that becomes a locked
    revolute joint, "" for one whose child is lumped into the parent.
    """

    joint: Joint
    element: Any
    origin: Pose
    parent: Body
    child: Body
    keep: str = ""


def parents_first(root: Body) -> Iterator[Body]:
    """`root` and the bodies below it, depth first, siblings by joint name."""
    waiting = [root]
    while waiting:
        body = waiting.pop()
        yield body
        waiting += [connection.child for connection in reversed(body.down)]
