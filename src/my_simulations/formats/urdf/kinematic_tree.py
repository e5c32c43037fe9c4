"""A robot while it is read: bodies, what connects them, and what of them is left in the end."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Iterator, List, Optional, Tuple

from ...description.model import Inertial, Joint, Link
from ...description.shapes import Collision, Visual
from ...geometry import IDENTITY, Pose

LUMP = "_fixed_joint_lump__"


@dataclass
class Body:
    """A link of the file.

    Attributes:
        link: what becomes of it; its collisions and visuals are put in at the end.
        element: the element it comes from.
        inertial: None where the file gives none.
        collisions, visuals: with the stem of the name each will have.
        up: what connects it with its parent, None for the root.
        down: what connects it with its children, sorted by joint name.
        into: the body it has become part of, itself not lumped; None where it stays.
        offset: its frame in the body that stands for it.
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


@dataclass
class Connection:
    """A joint of the file; `origin` is the child's frame in the parent's.

    `keep` is "fixed" for a fixed joint that stays one, "revolute" for one that stays as a locked
    hinge, "" for one whose child is lumped into the parent.
    """

    joint: Joint
    element: Any
    origin: Pose
    parent: Body
    child: Body
    keep: str = ""


def parents_first(root: Body) -> Iterator[Body]:
    """The bodies below and with `root`, depth first, siblings by joint name."""
    waiting = [root]
    while waiting:
        body = waiting.pop()
        yield body
        waiting += [connection.child for connection in reversed(body.down)]
