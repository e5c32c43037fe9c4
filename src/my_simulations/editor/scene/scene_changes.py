"""What has changed in the world since it was last sent to the clients."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional

from ...description.light import Light
from ...engine.ring import Snapshot
from ...simulator.entity import Entity
from ...simulator.simulator import Simulator
from .scene_json import Documents


@dataclass
class SceneChange:
    """A push, and the links whose poses every client must receive again (None: all)."""

    push: Dict[str, Any]
    links: Optional[List[int]] = field(default_factory=list)


class Mirror:
    """Compares the world with what was last sent. For one thread at a time."""

    def __init__(self, simulator: Simulator, documents: Documents) -> None:
        self._simulator = simulator
        self._documents = documents
        self.revision = -1
        self._entities: Dict[str, Entity] = {}
        self._poses: Dict[str, Any] = {}
        self._lights: Dict[str, Light] = {}
        self._order: List[str] = []
        self._around: Dict[str, Any] = {}
        self._rest: Any = None

    def world_push(self) -> Dict[str, Any]:
        """Return the push `world`; `changes` still reports what is new in it."""
        revision, _ = self._simulator.models.inventory()
        entities, snapshot = self._simulator.states.latest()
        return {"type": "world", "revision": revision,
                "document": self._document(entities, snapshot)}

    def changes(self) -> Optional[SceneChange]:
        """What has changed since the last call; None when nothing has."""
        revision, _ = self._simulator.models.inventory()
        if revision == self.revision:
            return None
        entities, snapshot = self._simulator.states.latest()
        world = self._simulator.world
        rest = (world.roads, world.actors, world.file)
        if self.revision < 0 or rest != self._rest:
            document = self._document(entities, snapshot)
            change = SceneChange({"type": "world", "revision": revision, "document": document},
                                 None)
            self._store(revision, entities, document, self._order_names(entities))
        else:
            change = self._difference(revision, entities, snapshot)
        self._rest = rest
        return change

    def _document(self, entities: List[Entity], snapshot: Snapshot) -> Dict[str, Any]:
        simulator = self._simulator
        models = [self._documents.entity(entity, snapshot) for entity in entities]
        return self._documents.world(simulator.world, simulator.physics.settings,
                                     simulator.physics.gravity, models)

    def _surroundings(self) -> Dict[str, Any]:
        simulator = self._simulator
        return self._documents.surroundings(simulator.world, simulator.physics.settings,
                                            simulator.physics.gravity)

    def _order_names(self, entities: List[Entity]) -> List[str]:
        """All models, then all lights, as they stand in the world."""
        return [*(entity.model.name for entity in entities),
                *(light.name for light in self._simulator.lights.all())]

    def _store(self, revision: int, entities: List[Entity], document: Dict[str, Any],
                  order: List[str]) -> None:
        self.revision = revision
        self._entities = {entity.model.name: entity for entity in entities}
        self._poses = {entity.model.name: entity.pose for entity in entities}
        self._order = order
        self._lights = {light.name: light for light in self._simulator.lights.all()}
        self._around = {name: value for name, value in document.items()
                        if name not in ("models", "lights", "roads", "actors")}

    def _difference(self, revision: int, entities: List[Entity], snapshot: Snapshot) -> SceneChange:
        push: Dict[str, Any] = {"type": "change", "revision": revision}
        models: Dict[str, Any] = {name: None for name in self._entities}
        links: List[int] = []
        for entity in entities:
            name = entity.model.name
            if self._entities.get(name) is entity and (
                    entity.link_names or self._poses[name] == entity.pose):
                del models[name]
                continue
            models[name] = self._documents.entity(entity, snapshot)
            links += entity.link_ids
        lights: Dict[str, Any] = {name: None for name in self._lights}
        for light in self._simulator.lights.all():
            if self._lights.get(light.name) is light:
                del lights[light.name]
            else:
                lights[light.name] = self._documents.light(light)
        around = self._surroundings()
        world = {name: value for name, value in around.items()
                 if self._around.get(name) != value}
        order = self._order_names(entities)
        if order != self._order:
            push["order"] = order
        push.update({name: value for name, value in (
            ("models", models), ("lights", lights), ("world", world)) if value})
        self._store(revision, entities, around, order)
        return SceneChange(push, links)
