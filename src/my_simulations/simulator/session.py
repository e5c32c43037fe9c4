"""Shared state of the simulator's parts: engine, entities, description and locks."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import Any, Callable, Iterable, List, Optional, Sequence

from ..description.cost_budget import Cost, budget_faults, cost_of, world_excess
from ..description.model import Model
from ..description.shapes import MeshTable
from ..description.world import World
from ..engine.api import Reply
from ..engine.commands import Command, SetModelState
from ..engine.ring import JOINTS, LINKS, RingReader, Snapshot
from ..engine.ring_rows import axis_rows
from ..errors import CommandError, Issue, OutdatedCommandError, warning
from ..geometry import Pose
from ..xml_characters import check_characters, hidden_character
from .entity import Entity
from .registry import NameTakenError, Registry
from .row_layout import RowAllocator
from .supervisor import Supervisor

_POST_S = 0.002
"""How long a command that can be posted waits for another one, or for a change of models."""
_CHANGE_S = 1.0
"""How long a command waits for a change of models before it is refused."""


class Session:
    """One running world, shared by the simulator's parts. Front ends use the parts only.

    Two locks, taken in this order when both are needed:

    - `structure_lock`: one change of models, clock or settings at a time. It is held while the
      engine works.
    - `registry_lock`: names, rows and descriptions. It is never held while the engine works, so
      that reads are answered meanwhile.

    Attributes:
        supervisor: runs the engine.
        world: the description, with lights and scene as last set; models as they were loaded.
        registry: the entities in the world. Read and changed with `registry_lock` held.
        log: receives issues that no caller waits for.
        before_advance: called before an advance; see `SyncPoints.attach`.
        before_plugins: called before a model with plugins is added; see `SyncPoints.on_plugins`.
    """

    def __init__(self, world: World, supervisor: Supervisor, log: Callable[[Issue], None]) -> None:
        self.supervisor = supervisor
        self.world = world
        self.log = log
        self.before_advance: Callable[[], None] = do_nothing
        self.before_plugins: Callable[[], None] = do_nothing
        self.structure_lock = threading.RLock()
        self.registry_lock = threading.RLock()
        self.registry = Registry(lambda: self.world.lights,
                                 lambda text: log(warning("name-ambiguous", text)))
        self._link_rows = RowAllocator(LINKS)
        self._joint_rows = RowAllocator(JOINTS)
        self._last_id = 0
        self._cost = Cost()

    def call(self, command: Command) -> Reply:
        """Send an engine command and wait for its reply; see `Supervisor.call` for errors."""
        return self.supervisor.call(command)

    def await_posted(self) -> None:
        """Wait until snapshots show the effect of all posted commands.

        Call it before reading states, without the registry lock. Raises CommandError.
        """
        self.supervisor.await_posted()

    def post(self, look_up: Callable[[], SetModelState]) -> None:
        """Send what `look_up` makes of the registry; reading states waits for its effect.

        For commands that the engine can refuse only if a model is gone: no model is removed
        meanwhile. While other changes of models are under way it calls `move`. Raises what
        `look_up` raises, and CommandError.
        """
        if self.structure_lock.acquire(timeout=_POST_S):
            try:
                with self.registry_lock:
                    command = look_up()
                if self.supervisor.post(command):
                    return
            finally:
                self.structure_lock.release()
        self.call_looked_up(look_up)

    def call_looked_up(self, look_up: Callable[[], Command]) -> None:
        """Call the command that `look_up` makes while the registry is locked.

        If a model was removed in between, it is looked up again by its name, because an edit
        replaces the entity of a model. Raises CommandError, and what `look_up` raises.
        """
        with self.registry_lock:
            command = look_up()
        while True:
            try:
                self.call(command)
                return
            except OutdatedCommandError:
                again = self._look_up_again(look_up)
                if again == command:
                    raise
                command = again

    def _look_up_again(self, look_up: Callable[[], Command]) -> Command:
        # A replacement changes the engine first, and the registry next. The wait is limited: the
        # change may itself wait for a plugin that moves something.
        held = self.structure_lock.acquire(timeout=_CHANGE_S)
        try:
            with self.registry_lock:
                return look_up()
        finally:
            if held:
                self.structure_lock.release()

    @property
    def ring(self) -> RingReader:
        """The ring with the engine's snapshots."""
        return self.supervisor.engine.ring

    def snapshot(self) -> Snapshot:
        """A copy of the newest snapshot; raises CommandError before the first one.

        Call `await_posted` before.
        """
        found = self.ring.read()
        if found is None:
            raise CommandError("the physics engine is not running yet")
        return found

    def new_id(self) -> int:
        """A new id, unique among models and timed forces. Requires `structure_lock`."""
        self._last_id += 1
        return self._last_id

    def new_entity(self, model: Model, initial_pose: Pose, meshes: MeshTable,
                   articulated: bool) -> Entity:
        """A new entity with its id and rows, not yet in the registry.

        Requires both locks. Raises CommandError if the ring has no free rows, or if the model or
        the world would exceed its budget (`description.cost_budget`).
        """
        cost = cost_of(model, meshes)
        for fault in budget_faults(cost, model):
            raise CommandError(f"{fault.message} ({fault.hint})")
        excess = world_excess(self._cost + cost)
        if excess:
            raise CommandError(excess)
        links, joints = len(model.links), len(axis_rows(model))
        first_link = self._link_rows.allocate(links)
        first_joint = self._joint_rows.allocate(joints)
        if first_link is None or first_joint is None:
            if first_link is not None:
                self._link_rows.free(first_link, links)
            raise CommandError(f"limit of {LINKS} links and {JOINTS} joint axes per world "
                               "exceeded")
        self._cost += cost
        return Entity(self.new_id(), model, initial_pose, first_link, first_joint, meshes,
                      articulated=articulated, cost=cost)

    def free_rows(self, entity: Entity) -> None:
        """Free the rows of an entity that was deleted from the engine. Requires both locks."""
        self._cost -= entity.cost
        self._link_rows.free(entity.first_link_row, len(entity.link_names))
        self._joint_rows.free(entity.first_joint_row, len(entity.joint_names))

    def replace_entities(self, entities: Sequence[Entity]) -> None:
        """Replace all entities by others with ids and rows of this or another session.

        Requires both locks.
        """
        for entity in self.registry.entities():
            self.free_rows(entity)
        for entity in entities:
            self._link_rows.claim(entity.first_link_row, len(entity.link_names))
            self._joint_rows.claim(entity.first_joint_row, len(entity.joint_names))
        self.registry.replace_all(entities)

    def reserve_ids(self, used: Iterable[int]) -> None:
        """Make `new_id` return larger ids than these. Requires `structure_lock`."""
        self._last_id = max((self._last_id, *used))

    def check_name_is_free(self, name: str) -> None:
        """Raises CommandError if a model or light has that name. Requires `registry_lock`."""
        if name in self.registry or any(light.name == name for light in self.world.lights):
            raise NameTakenError(f"a model or light named '{name}' already exists")

    def set_world_fields(self, **fields: Any) -> None:
        """Replace fields of the description that the engine does not simulate."""
        with self.structure_lock, self.registry_lock:
            self.world = replace(self.world, **fields)
            self.registry.revision += 1
        self.supervisor.engine.notify_host()

    def entities(self) -> List[Entity]:
        with self.registry_lock:
            return self.registry.entities()

    def link_row(self, name: str) -> int:
        """Row of a link by plain or scoped name. Raises UnknownEntityError."""
        with self.registry_lock:
            entity, index = self.registry.link(name)
            return entity.first_link_row + index

    def axis_row(self, joint: str) -> int:
        """Row of a joint axis (`joint::1` is the second axis).

        Raises:
            UnknownEntityError: no such joint.
            CommandError: the joint has no axis.
        """
        with self.registry_lock:
            entity, found, number = self.registry.joint(joint)
            row: Optional[int] = entity.axis_row(found.name, number)
        if row is None:
            raise CommandError(f"joint '{joint}' of type {found.type} has no axis")
        return row


def do_nothing() -> None:
    """For `Session.before_advance` and `before_plugins`."""


LONGEST_NAME = 1000
"""Characters of the name of a model or light: each message about all models contains it."""


def check_name(name: str, kind: str) -> None:
    """Check a name; `kind` is `model` or `light`. Raises CommandError."""
    if not name:
        raise CommandError(f"the name of a {kind} must not be empty")
    if len(name) > LONGEST_NAME:
        raise CommandError(f"the name of a {kind} may have {LONGEST_NAME} characters, not"
                           f" {len(name)}: '{name[:20]}...'")
    check_characters(name, f"the name of the {kind}")
    hidden = hidden_character(name)
    if hidden:
        raise CommandError(f"the name of the {kind} contains the character {hidden}, which is not"
                           " shown")
