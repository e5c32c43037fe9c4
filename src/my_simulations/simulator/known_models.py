"""Which models a running world has."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Optional, Tuple

from ..description.model import Inertial, Link, Model
from .entity import Entity
from .session import Session


class KnownModels:
    """The models of a session, by name; each call takes the registry lock."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def names(self) -> List[str]:
        """Names of the top-level models, in load order."""
        with self._session.registry_lock:
            return self._session.registry.names()

    def has(self, name: str) -> bool:
        with self._session.registry_lock:
            return name in self._session.registry

    @property
    def count(self) -> int:
        """How many top-level models there are."""
        with self._session.registry_lock:
            return len(self._session.registry)

    def with_plugins(self) -> Tuple[int, List[Entity]]:
        """The revision and the models that have a plugin; no other is looked at."""
        with self._session.registry_lock:
            return self._session.registry.revision, self._session.registry.with_plugins()

    def entity(self, name: str) -> Entity:
        """A model with its rows and names. Raises UnknownEntityError."""
        with self._session.registry_lock:
            return self._session.registry.model(name)

    def get(self, name: str) -> Model:
        """The flattened description of a model. Raises UnknownEntityError."""
        with self._session.registry_lock:
            return self._session.registry.model(name).model

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
        """Row and inertial of a link by its scoped name; None where there is none."""
        with self._session.registry_lock:
            row = self._session.registry.link_row_or_none(scoped)
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
