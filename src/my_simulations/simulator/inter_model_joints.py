"""Joints between models: their commands for the engine, and their description for saving."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import List, Optional, Sequence, Tuple

from ..description.model import WORLD, Joint
from ..description.saved_state import InitialState
from ..engine.body_plan import TIE_TYPES
from ..engine.commands import ConnectModels
from ..errors import Issue, warning
from ..geometry import IDENTITY, Pose, compose, inverse
from .entity import Entity
from .order_slot import OrderSlot
from .registry import Registry, UnknownEntityError

_WORLD_ROW = -1


@dataclass(frozen=True)
class _Connection:
    """`parent_from_joint`: the joint frame in the parent link's frame, in the world as loaded."""

    joint: Joint
    parent_from_joint: Pose = IDENTITY


class InterModelJoints:
    """Joints whose parent and child are links of different models, by scoped name. Immutable."""

    def __init__(self, joints: Sequence[Joint] = ()) -> None:
        self._all = [_Connection(joint) for joint in joints]

    @property
    def joints(self) -> List[Joint]:
        """The joints that are located, in order."""
        return [one.joint for one in self._all]

    def has_prismatic_joint(self, model: str) -> bool:
        """Whether a prismatic joint connects a link of that model."""
        return any(one.joint.type == "prismatic" and _connects(one.joint, model)
                   for one in self._all)

    def without_model(self, model: str) -> "InterModelJoints":
        return self._make([one for one in self._all if not _connects(one.joint, model)])

    def of_model(self, model: str) -> "InterModelJoints":
        """The joints that connect a model, which are deleted with it."""
        return self._make([one for one in self._all if _connects(one.joint, model)])

    def with_joints(self, others: "InterModelJoints") -> "InterModelJoints":
        return self._make(self._all + others._all)

    def with_model_renamed(self, old: str, new: str, kept: Sequence[str]) -> "InterModelJoints":
        """The same joints after a model was renamed; those of the names `kept` keep theirs."""
        return self._make([replace(one, joint=replace(
            one.joint, name=one.joint.name if one.joint.name in kept
            else _rescope(one.joint.name, old, new), parent=_rescope(one.joint.parent, old, new),
            child=_rescope(one.joint.child, old, new))) for one in self._all])

    def with_existing_links(self, registry: Registry) -> "InterModelJoints":
        """The joints whose parent and child links exist in the registry."""
        return self._make([one for one in self._all if all(
            _row(registry, end, "", None) is not None
            for end in (one.joint.parent, one.joint.child))])

    def locate(self, registry: Registry) -> Tuple["InterModelJoints", List[Issue]]:
        """The joints with their poses in the world as loaded; warnings about unusable ones."""
        found, issues = [], []
        for joint in self.joints:
            child, parent = (_initial(registry, name) for name in (joint.child, joint.parent))
            if joint.type not in TIE_TYPES:
                issues.append(warning("joint-not-held", f"joint '{joint.name}' of type "
                                      f"{joint.type} connects two models, which is not "
                                      "supported; ignored",
                                      hint="put both links into one model"))
            elif child is not None and parent is not None:
                at = compose(child, joint.pose)
                found.append(_Connection(joint, compose(inverse(parent), at)))
        return self._make(found), issues

    def with_joint(self, registry: Registry, joint: Joint, parent_from_joint: Pose
              ) -> "InterModelJoints":
        """With one more, whose links must be there. Raises UnknownEntityError."""
        for end in (joint.parent, joint.child):
            if end != WORLD:
                registry.link(end)
        return self._make([one for one in self._all if one.joint.name != joint.name]
                          + [_Connection(joint, parent_from_joint)])

    def with_name(self, name: str) -> "InterModelJoints":
        return self._make([one for one in self._all if one.joint.name == name])

    def without_joints(self, names: Sequence[str]) -> "InterModelJoints":
        return self._make([one for one in self._all if one.joint.name not in names])

    def commands(self, registry: Registry, model: str = "",
                 instead: Optional[Entity] = None) -> List[ConnectModels]:
        """Commands that create the joints; with `model`, only the joints of that model.

        `instead`: the entity that is about to replace `model`.
        """
        made = []
        for one in self._all:
            joint = one.joint
            if model and not _connects(joint, model):
                continue
            parent, child = (_row(registry, name, model, instead)
                             for name in (joint.parent, joint.child))
            if parent is not None and child is not None:
                made.append(ConnectModels(joint, parent, one.parent_from_joint, child, joint.pose))
        return made

    @staticmethod
    def _make(connections: List[_Connection]) -> "InterModelJoints":
        made = InterModelJoints()
        made._all = connections
        return made


@dataclass(frozen=True)
class DeletedModel:
    """What restores a deleted model: its position in the order, its joints to other models.

    `launched`, `start`, `articulated`: see `Entity`.
    """

    slot: OrderSlot
    joints: InterModelJoints
    launched: bool = False
    start: Optional[InitialState] = None
    articulated: bool = False


def _connects(joint: Joint, model: str) -> bool:
    return any(end.startswith(model + "::") for end in (joint.parent, joint.child))


def _rescope(name: str, old: str, new: str) -> str:
    return new + name[len(old):] if name.startswith(old + "::") else name


def _initial(registry: Registry, name: str) -> Optional[Pose]:
    """World pose of a link as loaded; identity for the world; None if the link does not exist."""
    if name == WORLD:
        return IDENTITY
    try:
        entity, index = registry.link(name)
    except UnknownEntityError:
        return None
    return compose(entity.initial_pose, entity.model.links[index].pose)


def _row(registry: Registry, name: str, model: str, instead: Optional[Entity]) -> Optional[int]:
    if name == WORLD:
        return _WORLD_ROW
    if instead is not None and name.startswith(model + "::"):
        plain = name[len(model) + 2:]
        return (instead.first_link_row + instead.link_names.index(plain)
                if plain in instead.link_names else None)
    try:
        entity, index = registry.link(name)
    except UnknownEntityError:
        return None
    return entity.first_link_row + index
