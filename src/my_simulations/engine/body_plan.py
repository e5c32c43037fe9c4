"""Plans the PyBullet bodies of a model: rigid bodies and trees of links. Independent of PyBullet.

A link without joints is a rigid body. Links connected by joints form a tree, as required by
reduced coordinates: every link except the root has one parent joint. Joints to the world connect to
a fixed, massless base, and so do kinematic links with joints, rigidly; whatever is connected to
them hangs on the same base. Static models become fixed links, with or without joints.
"""
from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace
from typing import Deque, Dict, List, Optional, Set, Tuple

from ..description.model import WORLD, Joint, Link, Model
from ..geometry import IDENTITY, Pose, Vec3, compose, inverse, scale
from .api import CommandRefusedError
from .ring_rows import AXES

BASE = -1
"""The link index of a base: the root link, or the fixed one of a body joined to the world."""

NO_LINK = -1
"""`TreeLink.index` of the massless link between the two axes of a joint, and of a piece."""

TIE_TYPES = ("fixed", "revolute", "continuous", "ball", "universal", "revolute2", "prismatic")
"""Types of joints between models that can be modelled by constraints."""

MAX_TREE_LINKS = 127
"""Most links of a multibody besides the base; Bullet drops the rest silently (measured)."""


@dataclass
class TreeLink:
    """One link of a body.

    Attributes:
        index: position in `Model.links`, or NO_LINK.
        parent: position of the parent in `BodyPlan.links`, or BASE.
        joint: its parent joint; None for the root.
        kind: motion relative to its parent: revolute, prismatic, fixed or ball.
        axis: unit vector in the joint frame, such that the joint's position is positive in the
            direction of the description; None for fixed and ball joints.
        number: number of the joint's axis; None if it has no row.
        link_from_frame: the joint frame in the link's own frame (identity for the root).
        parent_from_frame: the joint frame in the parent's joint frame, at position 0.
        carried: positions of the link's collisions that it carries; None for all.
        of: for a piece (index NO_LINK), the position in `Model.links` of the link it belongs to.
    """

    index: int
    parent: int
    joint: Optional[Joint] = None
    kind: str = "fixed"
    axis: Optional[Vec3] = None
    number: Optional[int] = None
    link_from_frame: Pose = IDENTITY
    parent_from_frame: Pose = IDENTITY
    carried: Optional[Tuple[int, ...]] = None
    of: Optional[int] = None


@dataclass
class BodyPlan:
    """One PyBullet body.

    Attributes:
        links: the root first unless `fixed_base`; parents before children.
        fixed_base: the base is fixed and massless at the model frame, none of the links.
    """

    links: List[TreeLink] = field(default_factory=list)
    fixed_base: bool = False

    @property
    def is_rigid(self) -> bool:
        """A single link without joints."""
        return len(self.links) == 1 and not self.fixed_base


class BodyPlanError(CommandRefusedError):
    """The model cannot be built; the message is one sentence for the user."""


def plan_bodies(model: Model) -> List[BodyPlan]:
    """The bodies of a flattened model; every link is in exactly one body.

    Joints of unsupported types, and joints that would close a loop, connect nothing. Raises
    BodyPlanError: a joint names a link that does not exist, or a tree exceeds Bullet's limit.
    """
    by_name = {link.name: index for index, link in enumerate(model.links)}
    if model.static:
        return [BodyPlan([TreeLink(index, BASE)]) for index in range(len(model.links))]
    joints = [joint for joint in model.joints if joint.type in AXES]
    _check_ends(model, joints, by_name)
    planner = _Planner(model, joints, by_name)
    bodies = planner.plan()
    for body in bodies:
        count = len(body.links) - (0 if body.fixed_base else 1)
        if count > MAX_TREE_LINKS:
            first = model.links[body.links[0].index].name
            raise BodyPlanError(f"the links joined to '{first}' are {count + 1}, more than the "
                            f"{MAX_TREE_LINKS + 1} that one articulated body may have")
    return bodies


def _check_ends(model: Model, joints: List[Joint], by_name: Dict[str, int]) -> None:
    for joint in joints:
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            if name != WORLD and name not in by_name:
                raise BodyPlanError(
                    f"joint '{joint.name}' of model '{model.name}' names the {role} link "
                    f"'{name}', which the model does not have")


class _Planner:
    """Walks the joint graph of one model, breadth first."""

    def __init__(self, model: Model, joints: List[Joint], by_name: Dict[str, int]) -> None:
        self.model = model
        self.by_name = by_name
        self.at_link: Dict[str, List[Joint]] = {link.name: [] for link in model.links}
        self.at_world: List[Joint] = []
        for joint in joints:
            for end in (joint.parent, joint.child):
                (self.at_world if end == WORLD else self.at_link[end]).append(joint)
        self.children = {joint.child for joint in joints}
        self.kinematic = [link.name for link in model.links
                          if link.kinematic and self.at_link[link.name]]
        self.visited: Set[str] = set()
        self.used: Set[str] = set()

    def plan(self) -> List[BodyPlan]:
        bodies = []
        for joint in self.at_world:
            end = joint.child if joint.parent == WORLD else joint.parent
            if end != WORLD and end not in self.visited and end not in self.kinematic:
                bodies.append(self._from_world(end))
        for name in self.kinematic:
            if name not in self.visited:
                bodies += self._from_kinematic(name)
        roots = [link for link in self.model.links if link.name not in self.children]
        for link in roots + self.model.links:
            if link.name not in self.visited:
                bodies.append(self._grow(BodyPlan([self._root(link)]), link.name, 0))
        bodies = [replace(body, links=depth_first(body.links)) for body in bodies]
        bodies.sort(key=lambda body: max(body.links[0].index, body.links[-1].index)
                    if body.links[0].index == NO_LINK else body.links[0].index)
        return bodies

    def _root(self, link: Link) -> TreeLink:
        self.visited.add(link.name)
        return TreeLink(self.by_name[link.name], BASE)

    def _from_world(self, end: str) -> BodyPlan:
        body = BodyPlan(fixed_base=True)
        joint = next(j for j in self.at_world if end in (j.parent, j.child))
        self.visited.add(end)
        self.used.add(joint.name)
        self._attach_link(body, joint, end, BASE)
        return self._grow(body, end, len(body.links) - 1)

    def _from_kinematic(self, name: str) -> List[BodyPlan]:
        """Plan the bodies of a kinematic link, the links connected to it, and their children."""
        body = self._grow(BodyPlan([self._plan_fixed_link(name)], fixed_base=True), name, 0)
        if any(link.joint is not None for link in body.links):
            return [body]
        return [BodyPlan([TreeLink(link.index, BASE)]) for link in body.links]

    def _plan_fixed_link(self, name: str) -> TreeLink:
        """A kinematic link, on a fixed base."""
        self.visited.add(name)
        index = self.by_name[name]
        return TreeLink(index, BASE, parent_from_frame=self.model.links[index].pose)

    def _grow(self, body: BodyPlan, start: str, at: int) -> BodyPlan:
        position = {start: at}
        queue: Deque[str] = deque([start])
        while queue:
            name = queue.popleft()
            for joint in self.at_link[name]:
                other = joint.child if joint.parent == name else joint.parent
                if joint.name in self.used or other == WORLD or other in self.visited:
                    continue
                if other in self.kinematic:   # its base is fixed; the joint is open
                    body.links.append(self._plan_fixed_link(other))
                else:
                    self.visited.add(other)
                    self.used.add(joint.name)
                    self._attach_link(body, joint, other, position[name])
                position[other] = len(body.links) - 1
                queue.append(other)
        return body

    def _attach_link(self, body: BodyPlan, joint: Joint, name: str, parent: int) -> None:
        """Attach link `name` by `joint` to `body.links[parent]`, or to the fixed base (BASE)."""
        link = self.model.links[self.by_name[name]]
        if joint.child == WORLD:
            model_from_joint = joint.pose
        else:
            child = self.model.links[self.by_name[joint.child]]
            model_from_joint = compose(child.pose, joint.pose)
        model_from_parent = IDENTITY
        if parent != BASE:
            above = body.links[parent]
            model_from_parent = compose(self.model.links[above.index].pose, above.link_from_frame)
        place = compose(inverse(model_from_parent), model_from_joint)
        moves = _moves(joint, joint.child == name)
        for n, (kind, axis, number) in enumerate(moves):
            last = n == len(moves) - 1
            body.links.append(TreeLink(
                self.by_name[name] if last else NO_LINK, parent, joint, kind, axis, number,
                link_from_frame=compose(inverse(link.pose), model_from_joint) if last
                else IDENTITY, parent_from_frame=place))
            parent, place = len(body.links) - 1, IDENTITY


def _moves(joint: Joint, forward: bool) -> List[Tuple[str, Optional[Vec3], Optional[int]]]:
    """The single motions of a joint, from the parent in the tree on: (kind, axis, row).

    `forward`: the joint's child is the child in the tree. Otherwise order and axes are reversed,
    and positions keep their sign.
    """
    if joint.type in ("fixed", "ball"):
        return [(joint.type, None, None)]
    first = joint.axis.xyz if joint.axis is not None else (0.0, 0.0, 1.0)
    second = joint.axis2.xyz if joint.axis2 is not None else first
    moves: List[Tuple[str, Vec3, Optional[int]]]
    if joint.type in ("universal", "revolute2"):
        moves = [("revolute", first, 0), ("revolute", second, 1)]
    elif joint.type == "screw":
        moves = [("revolute", first, 0), ("prismatic", first, None)]
    else:
        moves = [("prismatic" if joint.type == "prismatic" else "revolute", first, 0)]
    if not forward:
        moves = [(kind, scale(axis, -1.0), number) for kind, axis, number in reversed(moves)]
    return list(moves)


def depth_first(links: List[TreeLink]) -> List[TreeLink]:
    """The same tree in depth-first order.

    PyBullet numbers the links of a multibody in this order (measured, 3.2.7).
    """
    below: Dict[int, List[int]] = {}
    for n, link in enumerate(links):
        below.setdefault(link.parent, []).append(n)
    order: List[int] = []
    waiting = below.get(BASE, [])[::-1]
    while waiting:
        order.append(waiting.pop())
        waiting += below.get(order[-1], [])[::-1]
    place = {old: new for new, old in enumerate(order)}
    return [replace(links[old], parent=place.get(links[old].parent, BASE)) for old in order]


def open_joints(model: Model, bodies: List[BodyPlan]) -> List[Joint]:
    """The joints that connect nothing in `bodies`: loops, and unsupported types.

    Not those between links that nothing moves: they have nothing to hold.
    """
    if model.static:
        return []
    used = {link.joint.name for body in bodies for link in body.links if link.joint is not None}
    held = {WORLD} | {link.name for link in model.links if link.kinematic}
    return [joint for joint in model.joints if joint.name not in used
            and not (joint.type in AXES and {joint.parent, joint.child} <= held)]
