"""Entities of the world by name, and name resolution."""
from __future__ import annotations

import difflib
from dataclasses import dataclass
from itertools import chain, repeat
from typing import (
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    Optional,
    Sequence,
    Set,
    Tuple,
)

from ..description.light import Light
from ..description.model import Joint
from ..description.scoped_names import split_scoped
from ..engine.ring import RingReader, Snapshot
from ..errors import CommandError
from ..geometry import IDENTITY, STILL, Pose, Twist, compose
from .entity import Entity
from .nested_models import NestedModel
from .order_slot import OrderSlot

_FEW = 3
"""Most names that a message suggests."""

_MOST_LISTED = 8
"""Most names that a message lists if none is similar."""

WORLD_FRAMES = ("", "world", "map", "/map")
"""The names of the world frame (Gazebo behaviour)."""


class UnknownEntityError(CommandError):
    """A model, link, joint or light that does not exist."""


class NameTakenError(CommandError):
    """Another entity of the world has that name."""


class UnknownFrameError(CommandError):
    """A reference frame that is neither the world nor an entity."""


@dataclass(frozen=True)
class ReferenceFrame:
    """A resolved reference frame: an offset from a link, or a fixed pose.

    Attributes:
        row: row of the link; -1 for a fixed pose.
        offset: pose in the link frame; world pose if `row` is -1.
    """

    row: int
    offset: Pose = IDENTITY

    def state(self, snapshot: Snapshot) -> Tuple[Pose, Twist]:
        if self.row < 0:
            return self.offset, STILL
        pose, twist = snapshot.link(self.row)
        return compose(pose, self.offset), twist

    def newest(self, ring: RingReader) -> Tuple[Pose, Twist]:
        """Return the `state` in the newest snapshot; only the row of its link is copied."""
        if self.row < 0:
            return self.offset, STILL
        pose, twist = ring.link(self.row)
        return compose(pose, self.offset), twist


class Registry:
    """The entities in load order. Not thread safe: its owner locks.

    Args:
        lights: returns the lights of the world, which are reference frames too.
        on_ambiguous_name: called once for each plain name that several models have, with a
            sentence about it.
    """

    def __init__(self, lights: Callable[[], List[Light]] = list,
                 on_ambiguous_name: Callable[[str], object] = lambda _text: None) -> None:
        self._lights = lights
        self._on_ambiguous_name = on_ambiguous_name
        self._warned: Set[Tuple[str, str]] = set()
        self._entities: Dict[str, Entity] = {}
        # By model id, in the order of models: to remove one is independent of their number.
        self._plain_links: Dict[str, Dict[int, Tuple[Entity, int]]] = {}
        self._plain_nested: Dict[str, Dict[int, NestedModel]] = {}
        self._with_plugins: Dict[int, Entity] = {}
        # By the name of a request; cleared when a model is added, removed or changed.
        self._joints: Dict[str, Tuple[Entity, Joint, int]] = {}
        self.revision = 0

    def __contains__(self, name: str) -> bool:
        return name in self._entities

    def __len__(self) -> int:
        return len(self._entities)

    def entities_with_plugins(self) -> List[Entity]:
        """The models that have a plugin, in the order in which they were added or edited."""
        return list(self._with_plugins.values())

    def names(self) -> List[str]:
        return list(self._entities)

    def entities(self) -> List[Entity]:
        return list(self._entities.values())

    def add(self, entity: Entity, slot: Optional[OrderSlot] = None) -> None:
        """Add a model at a slot, else last; replaces a model of the same name."""
        self.add_all([entity], [slot])

    def add_all(self, entities: Sequence[Entity], slots: Sequence[Optional[OrderSlot]]) -> None:
        """Add models one after the other, as `add`."""
        names: Optional[List[str]] = None
        for entity, slot in zip(entities, slots):
            name = entity.model.name
            if name in self._entities:
                self.remove(name)
                names = names and [one for one in names if one != name]
            if slot is not None and names is None:
                names = list(self._entities)
            if names is not None:
                names.insert(len(names) if slot is None else slot.among(names), name)
            self._entities[name] = entity
            self._index_parts(entity)
        if names is not None:
            self._entities = {one: self._entities[one] for one in names}
            self._sort_links(entities)
        self.revision += 1

    def swap(self, old: Entity, new: Entity) -> None:
        """Replace an entity by its edited form, at the same position in the order."""
        new.spawn_id = old.spawn_id
        self._entities = {(new if entity is old else entity).model.name:
                          new if entity is old else entity
                          for entity in self._entities.values()}
        self._unindex_parts(old)
        self._index_parts(new)
        self._sort_links([new])
        self.revision += 1

    def _index_parts(self, entity: Entity) -> None:
        self._joints.clear()
        for index, link in enumerate(entity.link_names):
            self._plain_links.setdefault(link, {})[entity.model_id] = entity, index
        for nested in reversed(list(entity.nested.values())):
            self._plain_nested.setdefault(nested.model.name, {})[entity.model_id] = nested
        if entity.has_plugins:
            self._with_plugins[entity.model_id] = entity

    def _unindex_parts(self, entity: Entity) -> None:
        self._joints.clear()
        for link in entity.link_names:
            del self._plain_links[link][entity.model_id]
            if not self._plain_links[link]:
                del self._plain_links[link]
        for name in {nested.model.name for nested in entity.nested.values()}:
            del self._plain_nested[name][entity.model_id]
            if not self._plain_nested[name]:
                del self._plain_nested[name]
        self._with_plugins.pop(entity.model_id, None)

    def _sort_links(self, moved: Sequence[Entity]) -> None:
        """An unscoped link name refers to the first model in the order."""
        places = {name: place for place, name in enumerate(self._entities)}
        for link in {link for entity in moved for link in entity.link_names}:
            self._plain_links[link] = dict(sorted(
                self._plain_links[link].items(), key=lambda pair: places[pair[1][0].model.name]))

    def replace_all(self, entities: Iterable[Entity]) -> None:
        for name in self.names():
            self.remove(name)
        for entity in entities:
            self.add(entity)

    def remove(self, name: str) -> Entity:
        entity = self._entities.pop(name)
        self._unindex_parts(entity)
        self.revision += 1
        return entity

    def model(self, name: str) -> Entity:
        """The entity of a model name. Raises UnknownEntityError."""
        found = self._entities.get(name)
        if found is None:
            nested = self.nested_model(name)
            raise UnknownEntityError(
                f"unknown model '{name}'" + self._suggest_models(name) if nested is None else
                f"'{name}' is nested in model '{nested[0].model.name}'; name that model instead")
        return found

    def nested_model(self, name: str) -> Optional[Tuple[Entity, NestedModel]]:
        """A nested model by scoped or plain name (the first in the world).

        None for another name, and for that of a top-level model.
        """
        outermost, rest = split_scoped(name, self._entities.__contains__)
        if outermost:
            entity = self._entities[outermost]
            return (entity, entity.nested[rest]) if rest in entity.nested else None
        found = self._plain_nested.get(name)
        if found is None:
            return None
        entity = next(one for one in self._entities.values() if one.model_id in found)
        return entity, found[entity.model_id]

    def link(self, name: str) -> Tuple[Entity, int]:
        """A link by `model::link` or by its plain name (the first in the world).

        Raises UnknownEntityError.
        """
        found = self._scoped_link(name) or self._plain_link(name)
        if found is None:
            raise UnknownEntityError(f"unknown link '{name}'" + self._suggest_links(name))
        return found

    def scoped_link_row(self, name: str) -> Optional[int]:
        """The row of a link by its scoped name; None for an unknown name."""
        found = self._scoped_link(name)
        return None if found is None else found[0].first_link_row + found[1]

    def joint_row(self, name: str) -> int:
        """The row of a movable joint by plain or scoped name. Raises UnknownEntityError."""
        return self.movable_joint(name)[1]

    def movable_joint(self, name: str) -> Tuple[Entity, int]:
        """Model and row of a movable joint. Raises UnknownEntityError."""
        for entity, joint, number in self._joints_named(name):
            row = entity.axis_row(joint.name, number)
            if row is not None:
                self._warn_if_ambiguous_joint(name, entity)
                return entity, row
        raise UnknownEntityError(f"unknown movable joint '{name}'" + self._suggest_joints(name))

    def joint(self, name: str) -> Tuple[Entity, Joint, int]:
        """Model, joint and axis number of a joint by plain or scoped name, fixed ones too.

        `joint::1` is the second axis. Models are searched in order. Raises UnknownEntityError.
        """
        if name not in self._joints:
            found = next(self._joints_named(name), None)
            if found is None:
                raise UnknownEntityError(f"unknown joint '{name}'" + self._suggest_joints(name))
            self._warn_if_ambiguous_joint(name, found[0])
            self._joints[name] = found
        return self._joints[name]

    def _joints_named(self, name: str) -> Iterator[Tuple[Entity, Joint, int]]:
        """The joint of a scoped name first, then those of that plain name, in order of models."""
        model, rest = split_scoped(name, self._entities.__contains__)
        owner = [(self._entities[model], rest)] if model else []
        for entity, plain in chain(owner, zip(self._entities.values(), repeat(name))):
            found = entity.joints_by_name.get(plain)
            if found is not None:
                yield (entity, *found)

    def frame(self, name: str) -> Optional[ReferenceFrame]:
        """Resolve the name of a reference frame; None for the world frame.

        Entities are searched first (models, links, collisions, nested models, lights), then the
        literals.
        Raises UnknownFrameError.
        """
        entity = self._entities.get(name)
        if entity is not None:
            if not entity.link_names:
                return ReferenceFrame(-1, entity.pose)
            return ReferenceFrame(entity.canonical_row, entity.link_from_model)
        link = self._scoped_link(name) or self._plain_link(name)
        if link is not None:
            return ReferenceFrame(link[0].first_link_row + link[1])
        collision = self._collision(name)
        if collision is not None:
            return collision
        nested = self.nested_model(name)
        if nested is not None:
            return nested_frame(*nested)
        for light in self._lights():
            if light.name == name:
                return ReferenceFrame(-1, light.pose)
        if name in WORLD_FRAMES:
            return None
        raise UnknownFrameError(f"unknown reference frame '{name}'" + self._suggest_models(name))

    def _scoped_link(self, name: str) -> Optional[Tuple[Entity, int]]:
        model, link = split_scoped(name, self._entities.__contains__)
        if not model or link not in self._entities[model].link_names:
            return None
        entity = self._entities[model]
        return entity, entity.link_names.index(link)

    def _plain_link(self, name: str) -> Optional[Tuple[Entity, int]]:
        found = self._plain_links.get(name)
        if found is None:
            return None
        if len(found) > 1 and ("link", name) not in self._warned:
            self._warn_ambiguous("link", name, [entity.model.name for entity, _ in found.values()])
        return next(iter(found.values()))

    def _warn_if_ambiguous_joint(self, name: str, used: Entity) -> None:
        """Log once if the plain name of a joint exists in several models."""
        if ("joint", name) in self._warned or name.startswith(used.model.name + "::"):
            return
        self._warn_ambiguous("joint", name, [
            entity.model.name for entity in self._entities.values()
            if any(joint.name == name for joint in entity.model.joints)
            or name in entity.joint_names])

    def _warn_ambiguous(self, kind: str, name: str, owners: Sequence[str]) -> None:
        if len(owners) < 2 or (kind, name) in self._warned:
            return
        self._warned.add((kind, name))
        others = f"'{owners[1]}'" if len(owners) == 2 else f"{len(owners) - 1} other models"
        self._on_ambiguous_name(
            f"'{owners[0]}' and {others} have a {kind} '{name}'; using that of "
            f"'{owners[0]}'; write '{owners[0]}::{name}' to avoid this warning"
        )

    def _collision(self, name: str) -> Optional[ReferenceFrame]:
        head, _, last = name.rpartition("::")
        link = self._scoped_link(head) if head else None
        if link is None:
            return None
        entity, index = link
        for collision in entity.model.links[index].collisions:
            if collision.name == last:
                return ReferenceFrame(entity.first_link_row + index, collision.pose)
        return None

    def _suggest_models(self, name: str) -> str:
        return _suggest_names(name, self._entities)

    def _suggest_links(self, name: str) -> str:
        """Suggestions for an unknown link: those of a model of that name, else similar names."""
        of_model = self._entities.get(name)
        if of_model is not None:
            named = [f"{name}::{link}" for link in of_model.link_names]
            return (f"; it is a model, its {'link is' if len(named) == 1 else 'links are'} "
                    + ", ".join(named[:_FEW]) + (", ..." if len(named) > _FEW else "")
                    if named else "; it is a model without links")
        return _suggest_scoped(name, {entity.model.name: entity.link_names
                                    for entity in self._entities.values()})

    def _suggest_joints(self, name: str) -> str:
        return _suggest_scoped(name, {
            entity.model.name: [joint.name for joint in entity.model.joints]
            for entity in self._entities.values()})


def nested_frame(entity: Entity, nested: NestedModel) -> ReferenceFrame:
    """The frame of a nested model."""
    return ReferenceFrame(entity.first_link_row + nested.frame_link, nested.link_from_model)


def _suggest_names(name: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(name, list(known), n=_FEW)
    return f"; did you mean {' or '.join(near)}?" if near else ""


def _suggest_scoped(name: str, owned: Mapping[str, Sequence[str]]) -> str:
    """Scoped names (`model::part`) similar to an unknown one."""
    model, _, part = name.partition("::")
    if part and model not in owned:
        return _suggest_names(name,
                             [f"{owner}::{one}" for owner, names in owned.items() for one in names])
    scopes = [model] if part else list(owned)
    plain = {one: f"{owner}::{one}" for owner in reversed(scopes) for one in owned[owner]}
    near = difflib.get_close_matches(part or name, plain, n=_FEW)
    if near:
        return f"; did you mean {' or '.join(plain[one] for one in near)}?"
    there = list(plain.values())
    more = ", ..." if len(there) > _MOST_LISTED else ""
    return f"; there are {', '.join(there[:_MOST_LISTED])}{more}" if there else ""
