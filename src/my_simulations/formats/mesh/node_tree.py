"""The nodes of a COLLADA file's scene, and where they are in each other."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from .part import MeshError

MOST_NODES, _DEEPEST = 20_000, 100
_TRANSFORM_TAGS = ("{*}matrix", "{*}translate", "{*}rotate", "{*}scale")
"""Elements that say where a node is; others (lookat, skew) are ignored."""

Array = Any  # a NumPy array; its shape is documented at each use
Placing = Tuple[str, str, Array]
"""The sid, the kind and the numbers of a transform."""


def floats(element: Any) -> Array:
    """The numbers in an element. Raises MeshError: one is not a number."""
    try:
        return np.array("".join(element.itertext()).split(), dtype=np.float64)
    except ValueError as fault:
        raise MeshError(f"<{element.tag.rpartition('}')[2]}>: {fault}",
                        element.sourceline) from None


class Bones:
    """Bones and their parents, parents first.

    Attributes:
        names: by which animations of other files may find it: the sid of a joint, else the name.
        joints: whether it is a joint.
        parents: number of the one that it hangs on, -1 for none.
    """

    def __init__(self) -> None:
        self.names: List[str] = []
        self.joints: List[bool] = []
        self.parents: List[int] = []

    def add(self, name: str, is_joint: bool, parent: int) -> int:
        """Append a bone; returns its number."""
        self.names.append(name)
        self.joints.append(is_joint)
        self.parents.append(parent)
        return len(self.names) - 1

    @property
    def root_joint(self) -> Optional[int]:
        """The joint that hangs on none."""
        return next((n for n, joint in enumerate(self.joints)
                     if joint and not (self.parents[n] >= 0 and self.joints[self.parents[n]])),
                    None)

    def match_bones(self, other: "Bones") -> Dict[int, int]:
        """Number of our node by that of the other tree's that moves it.

        Joints are paired by their order where both skeletons branch alike, whatever they are
        called (Gazebo behaviour), else nodes by their names.
        """
        ours, theirs = self._skeleton(), other._skeleton()
        if ours and [below for _, below in ours] == [below for _, below in theirs]:
            return {there: here for (here, _), (there, _) in zip(ours, theirs)}
        numbers: Dict[str, int] = {}
        for n, name in enumerate(self.names):
            numbers.setdefault(name, n)
        return {n: numbers[name] for n, name in enumerate(other.names) if name and name in numbers}

    def _skeleton(self) -> List[Tuple[int, int]]:
        """The joints from the root joint on, each with how many joints hang on it."""
        root = self.root_joint
        below: Dict[int, int] = {} if root is None else {root: 0}
        for n, parent in enumerate(self.parents):
            if self.joints[n] and parent in below:
                below[n] = 0
                below[parent] += 1
        return list(below.items())


class NodeTree(Bones):
    """The nodes of a scene.

    Attributes:
        elements: XML of each.
        by_id: all elements of the file.
        numbers: of nodes by id.
        rest: (n, 4, 4) where nodes are in their parents, as the file has them.
    """

    def __init__(self, root: Any) -> None:
        super().__init__()
        self.by_id: Dict[str, Any] = {one.get("id"): one for one in root.iter() if one.get("id")}
        self.elements: List[Any] = []
        self.numbers: Dict[str, int] = {}
        instance = root.find("{*}scene/{*}instance_visual_scene")
        scene = (self.by_id.get(instance.get("url", "#")[1:]) if instance is not None
                 else next(root.iter("{*}visual_scene"), None))
        for child in () if scene is None else scene.iterchildren("{*}node"):
            self._walk(child, -1, 0)
        self.rest: Array = np.array([local_matrix(placings_of(element))
                                     for element in self.elements]).reshape(-1, 4, 4)

    def release_xml(self) -> None:
        """Free the XML, which takes most of the memory."""
        self.elements.clear()
        self.by_id.clear()

    def _walk(self, element: Any, parent: int, depth: int) -> None:
        if len(self.elements) >= MOST_NODES or depth > _DEEPEST:
            raise MeshError("its nodes form a cycle or are nested too deeply", element.sourceline)
        joint = element.get("type") == "JOINT"
        self.elements.append(element)
        number = self.add((element.get("sid") if joint else element.get("name")) or "", joint,
                          parent)
        self.numbers.setdefault(element.get("id") or "", number)
        for child in element.iterchildren("{*}node", "{*}instance_node"):
            if child.tag.endswith("instance_node"):
                child = self.by_id.get(child.get("url", "#")[1:])
            if child is not None:
                self._walk(child, number, depth + 1)

    def bone(self, name: str, roots: Sequence[int]) -> int:
        """The node that a skin calls by a name, below `roots` first.

        Raises MeshError: there is none.
        """
        below = [n for n in range(len(self.elements)) if not roots or self._is_below(n, roots)]
        for numbers in (below, range(len(self.elements))):
            for key in ("sid", "id", "name"):
                for n in numbers:
                    if self.elements[n].get(key) == name:
                        return n
        raise MeshError(f"a skin has a joint {name!r}, which no node is")

    def _is_below(self, number: int, roots: Sequence[int]) -> bool:
        while number >= 0:
            if number in roots:
                return True
            number = self.parents[number]
        return False


def placings_of(node: Any) -> List[Placing]:
    """Return the transforms of a `<node>`, in the order of the file."""
    return [(one.get("sid") or "", one.tag.rsplit("}", 1)[-1], floats(one))
            for one in node.iterchildren(*_TRANSFORM_TAGS)]


def local_matrix(placings: Sequence[Placing]) -> Array:
    """(4, 4), parent from node. Raises ValueError: one has not its count of numbers."""
    made = np.eye(4)
    for _, kind, values in placings:
        one = np.eye(4)
        if kind == "matrix":
            one = values.reshape(4, 4)
        elif kind == "translate":
            one[:3, 3] = values.reshape(3)
        elif kind == "scale":
            one[:3, :3] = np.diag(values.reshape(3))
        else:
            one[:3, :3] = _about(values.reshape(4))
        made = made @ one
    return made


def _about(values: Array) -> Array:
    """A turn about an axis by degrees."""
    x, y, z = values[:3] / (np.linalg.norm(values[:3]) or 1.0)
    cosine, sine = math.cos(math.radians(values[3])), math.sin(math.radians(values[3]))
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + sine * across + (1.0 - cosine) * (across @ across)
    return turn
