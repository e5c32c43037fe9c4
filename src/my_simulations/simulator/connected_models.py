"""The models of a running world by name; pins them, and joins links of different models."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Optional, Tuple

from ..description.model import WORLD, Inertial, Joint, Link, Model
from ..engine.commands import Batch, DisconnectModels
from ..errors import CommandError
from ..geometry import compose, inverse
from .entity import Entity
from .model_connections import ModelConnections
from .nested_models import NestedModel
from .session import Session


class ConnectedModels:
    """The models of a session by name, the joints between them, and which of them are pinned.

    Reads take the registry lock, changes the session's structure lock.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._connections = ModelConnections()

    def names(self) -> List[str]:
        """Names of the top-level models, in load order."""
        with self._session.registry_lock:
            return self._session.registry.names()

    def has(self, name: str) -> bool:
        with self._session.registry_lock:
            return name in self._session.registry

    @property
    def count(self) -> int:
        """Number of top-level models."""
        with self._session.registry_lock:
            return len(self._session.registry)

    def entities_with_plugins(self) -> Tuple[int, List[Entity]]:
        """The revision, and the models that have a plugin."""
        with self._session.registry_lock:
            return self._session.registry.revision, self._session.registry.entities_with_plugins()

    def entity(self, name: str) -> Entity:
        """A model with its rows and names. Raises UnknownEntityError."""
        with self._session.registry_lock:
            return self._session.registry.model(name)

    def get(self, name: str) -> Model:
        """The flattened description of a model. Raises UnknownEntityError."""
        with self._session.registry_lock:
            return self._session.registry.model(name).model

    def nested(self, name: str) -> Optional[NestedModel]:
        """The nested model of a scoped or plain name; None for another or a top-level model."""
        with self._session.registry_lock:
            found = self._session.registry.nested_model(name)
        return None if found is None else found[1]

    def set_extra(self, name: str, extra: List[str]) -> None:
        """Replace the kept XML of a model, which has no effect on the simulation.

        The model is not built again. Raises UnknownEntityError.
        """
        session = self._session
        with session.structure_lock, session.registry_lock:
            entity = session.registry.model(name)
            changed = replace(entity, model=replace(entity.model, extra=extra))
            changed.pose = entity.pose
            session.registry.swap(entity, changed)

    def link(self, name: str) -> Link:
        """The description of a link, by plain or scoped name. Raises UnknownEntityError."""
        with self._session.registry_lock:
            entity, index = self._session.registry.link(name)
            return entity.model.links[index]

    def link_place(self, scoped: str) -> Optional[Tuple[int, Inertial]]:
        """Row and inertial of a link by its scoped name; None for an unknown name."""
        with self._session.registry_lock:
            row = self._session.registry.scoped_link_row(scoped)
            if row is None:
                return None
            entity, index = self._session.registry.link(scoped)
            return row, entity.model.links[index].inertial

    @property
    def revision(self) -> int:
        """Increases with every change of names, descriptions, lights or scene settings."""
        with self._session.registry_lock:
            return self._session.registry.revision

    def inventory(self) -> Tuple[int, List[Entity]]:
        """The revision and all entities in load order; an edited entity is a new object."""
        with self._session.registry_lock:
            return self._session.registry.revision, self._session.registry.entities()

    def launched(self) -> List[str]:
        """The models that the launch file of this simulator spawned (see `Entity`)."""
        return [entity.model.name for entity in self._session.entities() if entity.launched]

    @property
    def inter_model_joints(self) -> List[Joint]:
        """The joints between models in effect; their ends are scoped link names or `world`.

        Without those of `attach`, which belong to the caller that made them.
        """
        return self._connections.permanent_joints.joints

    @property
    def connections(self) -> ModelConnections:
        """Joints between models and pins, as they are now."""
        return self._connections

    def store_connections(self, connections: ModelConnections) -> None:
        """Store joints and pins that the engine has already."""
        self._connections = connections

    def pin(self, names: List[str]) -> None:
        """Pin these models, which then stay at rest where they are set, and release all others.

        Raises UnknownEntityError.
        """
        with self._session.structure_lock:
            with self._session.registry_lock:
                for name in names:
                    self._session.registry.model(name)
            self._apply_pins(replace(self._connections, pinned=tuple(names)))

    def hold(self, name: str, held: bool) -> None:
        """Keep one model at rest where it is put, or release it; besides those that are pinned.

        Raises UnknownEntityError.
        """
        with self._session.structure_lock:
            with self._session.registry_lock:
                self._session.registry.model(name)
            others = tuple(one for one in self._connections.held if one != name)
            self._apply_pins(replace(self._connections, held=(*others, name) if held else others))

    def _apply_pins(self, connections: ModelConnections) -> None:
        with self._session.registry_lock:
            command = connections.pin_command(self._session.registry)
        self._session.call(command)
        self._connections = connections

    def attach(self, name: str, parent: str, child: str) -> None:
        """Join a link to another one, or to the world, as they are now.

        The joint is fixed, and replaces another between models with the same name. It is removed
        with either model, and by a reset of the world.

        Args:
            name: of the joint.
            parent: scoped name of a link, or `world`.
            child: scoped name of a link of another model.

        Raises CommandError: a link does not exist, or the engine refused it.
        """
        session = self._session
        if parent == child:
            raise CommandError(f"cannot attach link '{child}' to itself")
        with session.structure_lock:
            session.await_posted()
            with session.registry_lock:
                snapshot = session.snapshot()
                at = snapshot.link(session.link_row(child))[0]
                if parent != WORLD:
                    at = compose(inverse(snapshot.link(session.link_row(parent))[0]), at)
                wanted = self._connections.joints.with_joint(
                    session.registry, Joint(name, "fixed", parent, child), at)
                (command,) = wanted.with_name(name).commands(session.registry)
            session.call(Batch((DisconnectModels((name,)), command)))
            self._connections = self._connections.with_joint(wanted, name)

    def attachments(self, name: str) -> List[Joint]:
        return self._connections.joints_named(name)

    def detach(self, name: str) -> bool:
        """Remove a joint between models; return whether it existed."""
        with self._session.structure_lock:
            if not self._connections.joints_named(name):
                return False
            self._session.call(DisconnectModels((name,)))
            self._connections = self._connections.without_joint(name)
            return True
