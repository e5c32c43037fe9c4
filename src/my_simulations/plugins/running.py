"""Running plugins, by the models of the world that have them."""
from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Callable, Deque, Dict, Iterator, List, Optional, Tuple

from ..description.model import WORLD, Model
from ..errors import Issue
from ..geometry import IDENTITY
from ..simulator.entity import Entity
from ..simulator.session import do_nothing
from ..simulator.simulator import Simulator
from .base import Plugin
from .found_plugins import FoundPlugin, plugins_of, world_plugins
from .plugin_state import FAILED, OFF, RUNNING, WAITING, PluginState
from .simulated_context import SimulatedContext

WORLD_SCOPE = ""
"""Stands for the world among the names of models."""


@dataclass
class RunningPlugin:
    """A running plugin.

    Attributes:
        plugin: None for one that is unknown or was switched off.
        fault: why it is unknown or was switched off.
        end: ends the process of the plugin, if it has one.
        note: why it has no effect although nothing failed; "" for one that has.
        is_busy: a call is under way in its process, and the world continues meanwhile.
    """

    found: FoundPlugin
    context: SimulatedContext
    plugin: Optional[Plugin]
    fault: Optional[Issue] = None
    end: Callable[[], None] = do_nothing
    note: str = ""
    is_busy: bool = False

    def state(self, model: str) -> PluginState:
        """Return the state as a plugin of `model`; from any thread."""
        spec, fault = self.found.spec, self.fault
        kind, reason = (
            (FAILED, fault.message) if fault is not None else (OFF, self.note) if self.note
            else (WAITING, "") if self.plugin is None else (RUNNING, ""))
        return PluginState(model, spec.name, spec.filename, kind, reason,
                           self.context.parameters.declared())

    @property
    def is_callable(self) -> bool:
        return self.plugin is not None and not self.is_busy


class ModelPlugins:
    """Follows those models of a simulator that have plugins.

    Attributes:
        revision: the revision of the models at the last `update`.
        removed: plugins to be ended; the host removes each one that it ends.

    Args:
        simulator: the world.
        rebind: called with each plugin whose model has other rows or was edited.
    """

    def __init__(self, simulator: Simulator,
                 rebind: Callable[[RunningPlugin, Entity], None]) -> None:
        self._simulator, self._rebind = simulator, rebind
        self._models: Dict[str, Tuple[Entity, List[RunningPlugin]]] = {}
        self._to_load: Deque[Tuple[str, FoundPlugin]] = deque()
        self.removed: Deque[RunningPlugin] = deque()
        self.revision = -1

    def all(self) -> Iterator[RunningPlugin]:
        """Iterate over the plugins of all present models; from any thread."""
        for _, running in list(self._models.values()):
            yield from list(running)

    def plugins_of(self, model: str) -> List[RunningPlugin]:
        """The plugins of a model, as far as they are loaded; from any thread."""
        _, running = self._models.get(model, (None, []))
        return list(running)

    def states(self) -> List[PluginState]:
        """Return the states of all plugins, also of those to be loaded; from any thread."""
        waiting = [PluginState(name, found.spec.name, found.spec.filename, WAITING)
                   for name, found in list(self._to_load)]
        present = [running.state(name) for name, (_, all_running) in list(self._models.items())
                   for running in list(all_running)]
        return [*present, *waiting]

    def update(self) -> None:
        """Find the plugins to load and to end; call `rebind` for those that continue."""
        if self._simulator.models.revision == self.revision:
            return
        self.revision, entities = self._simulator.models.entities_with_plugins()
        self._compare({WORLD_SCOPE: self._world_entity(),
                       **{entity.model.name: entity for entity in entities}})

    def next_to_load(self) -> Optional[Tuple[Entity, List[RunningPlugin], FoundPlugin]]:
        """Return the model of the next plugin to load, the list of its plugins, and the plugin."""
        if not self._to_load:
            return None
        name, found = self._to_load.popleft()
        return (*self._models[name], found)

    def end_all(self) -> None:
        for name in list(self._models):
            self._end(name)

    def _compare(self, present: Dict[str, Entity]) -> None:
        for name in [name for name in self._models if name not in present]:
            self._end(name)
        for name, entity in present.items():
            before = self._models.get(name)
            if before is not None and before[0] is entity:
                continue
            found = list(plugins_of(entity.model))
            known = [] if before is None else [
                *(one.found for one in before[1]),
                *(one for owner, one in self._to_load if owner == name)]
            if before is not None and before[0].spawn_id == entity.spawn_id and (
                    _are_same(known, found)):
                kept = self._continuing(name, before, entity, found)
                self._models[name] = (entity, kept)
                for running in kept:
                    self._rebind(running, entity)
                continue
            if before is not None:
                self._end(name)
            self._models[name] = (entity, [])
            self._to_load += [(name, one) for one in found]

    def _continuing(self, name: str, before: Tuple[Entity, List[RunningPlugin]],
                        entity: Entity, found: List[FoundPlugin]) -> List[RunningPlugin]:
        """The plugins that continue; the others are loaded again.

        Other links or joints restart all plugins, any other edit those that failed and those of a
        sensor that was edited.
        """
        old, all_running = before
        if old.model == entity.model:
            return all_running
        other_parts = _parts(old.model) != _parts(entity.model)
        again = [one for one in all_running if other_parts or one.fault is not None
                 or found[found.index(one.found)].sensor != one.found.sensor]
        self.removed += again
        self._to_load += [(name, found[found.index(one.found)]) for one in again]
        return [one for one in all_running if all(one is not other for other in again)]

    def _world_entity(self) -> Entity:
        """Return the entity that represents the world as owner of its plugins."""
        plugins = world_plugins(self._simulator.world)
        before = self._models.get(WORLD_SCOPE)
        if before is not None and before[0].model.plugins == plugins:
            return before[0]
        return Entity(0, Model(WORLD, plugins=plugins), IDENTITY, 0, 0)

    def _end(self, name: str) -> None:
        _, all_running = self._models.pop(name)
        self._to_load = deque(one for one in self._to_load if one[0] != name)
        self.removed += all_running


def _parts(model: Model) -> Tuple[List[str], List[Tuple[str, str, str, str]]]:
    """Return the names of links, and names, types, parents and children of joints."""
    return ([link.name for link in model.links],
            [(joint.name, joint.type, joint.parent, joint.child) for joint in model.joints])


def _are_same(known: List[FoundPlugin], found: List[FoundPlugin]) -> bool:
    """Return whether both lists have the same plugins, in any order."""
    return len(known) == len(found) and all(known.count(one) == found.count(one) for one in found)
