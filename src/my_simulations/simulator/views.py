"""What can be read of a running world: from the ring and the registry, never from the engine."""
from __future__ import annotations

import threading
from typing import Dict, List, Optional, Tuple

from ..description.model import Link, Model
from ..engine.ring import (
    BELL,
    DEMAND_NS,
    LINK_WIDTH,
    POSE_DEMAND_NS,
    RingReader,
    Snapshot,
)
from ..errors import CommandError
from ..geometry import IDENTITY, Pose, Twist, compose
from .frames import relative
from .layout import Layout, lay_out
from .registry import Entity, Registry
from .states import States, collect
from .supervisor import Supervisor


class WorldViews:
    """The reading half of the simulator. Safe from any thread."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor
        self._lock = threading.RLock()    # the registry and rows; never held while the engine works
        self._registry = Registry()
        self._cached: Optional[States] = None
        self._layout: Optional[Layout] = None
        self._demands: Dict[str, Tuple[float, float, bool]] = {}

    @property
    def engine_pid(self) -> int:
        """Process number of the engine."""
        return self._supervisor.engine.pid

    @property
    def ring(self) -> RingReader:
        """Where the states are."""
        return self._supervisor.engine.ring

    def step(self) -> int:
        """Steps since the start or the last reset."""
        return self.ring.step

    def sim_ns(self) -> int:
        """Sim time, nanoseconds."""
        step, clock = self.ring.clock()
        return clock.sim_ns(step)

    def model_names(self) -> List[str]:
        """All top-level models in load order."""
        with self._lock:
            return self._registry.names()

    def has_model(self, name: str) -> bool:
        """Whether there is a model of that name."""
        with self._lock:
            return name in self._registry

    def model(self, name: str) -> Model:
        """The flattened description. Raises UnknownEntity."""
        with self._lock:
            return self._registry.model(name).model

    def launched(self) -> List[str]:
        """The models that the launch file of this simulator spawned (see `Entity`)."""
        with self._lock:
            return [entity.model.name for entity in self._registry.entities() if entity.launched]

    def link(self, name: str) -> Link:
        """The description of a link, by plain or scoped name. Raises UnknownEntity."""
        with self._lock:
            entity, index = self._registry.link(name)
            return entity.model.links[index]

    def model_state(self, name: str, frame: str = "") -> Tuple[Pose, Twist]:
        """Pose and twist of a model frame in `frame` (see `Registry.frame`).

        Raises UnknownEntity, UnknownFrame.
        """
        with self._lock:
            entity = self._registry.model(name)
            anchor = self._registry.frame(frame)
            if anchor is None and entity.link_names:
                pose, twist = self.ring.link(entity.canonical_row)
                if entity.link_from_model != IDENTITY:
                    pose = compose(pose, entity.link_from_model)
                return pose, twist
            snapshot = self._snapshot()
        return relative(entity.state(snapshot), anchor, snapshot)

    def link_state(self, name: str, frame: str = "") -> Tuple[Pose, Twist]:
        """Pose and twist of a link in `frame`. Raises UnknownEntity, UnknownFrame."""
        with self._lock:
            entity, index = self._registry.link(name)
            anchor = self._registry.frame(frame)
            row = entity.first_link_row + index
            if anchor is None:
                return self.ring.link(row)
            snapshot = self._snapshot()
        return relative(snapshot.link(row), anchor, snapshot)

    def joint_state(self, name: str) -> Tuple[float, float]:
        """Position and rate of a movable joint. Raises UnknownEntity."""
        with self._lock:
            row = self._registry.joint_row(name)
            return self._snapshot().joint(row)

    def moment(self) -> Tuple[List[Entity], Snapshot]:
        """Everything there is, in load order, and where it is, of one moment."""
        with self._lock:
            entities, snapshot = self._registry.entities(), self._snapshot()
        # One that is being deleted may have left the engine, and its rows the table, already.
        rows = len(snapshot.links) // LINK_WIDTH
        return [entity for entity in entities
                if entity.first_link_row + len(entity.link_names) <= rows
                or not entity.link_names], snapshot

    def states(self) -> States:
        """The states of everything, for the topics; the same object while nothing changes."""
        with self._lock:
            cached = self._cached
            if (cached is not None and cached.revision == self._registry.revision
                    and cached.sequence == self.ring.latest):
                return cached
            self._cached = collect(self._registry.entities(), self._snapshot(),
                                   self._registry.revision)
            return self._cached

    def raw_states(self) -> Tuple[Layout, int, bytes]:
        """What `states` is made of: who is where, the snapshot's sequence, its link rows.

        The layout is the same object until a name changes; a row is `ring.LINK_WIDTH` doubles.
        """
        with self._lock:
            return (self._laid_out(), *self.ring.raw_links())

    def raw_poses(self) -> Tuple[Layout, bytes]:
        """Who is where, and rows as in `raw_states` of which only the poses are the newest."""
        with self._lock:
            return self._laid_out(), self.ring.raw_poses()

    def _laid_out(self) -> Layout:
        if self._layout is None or self._layout.revision != self._registry.revision:
            self._layout = lay_out(self._registry.entities(), self._registry.revision)
        return self._layout

    def set_demand(self, who: str, *, states_hz: float = 0.0, poses_hz: float = 0.0,
                   bell: bool = False) -> None:
        """Say how often `who` wants states, or poses only, and whether to ring at each step.

        0 is not at all. The most that anybody wants is what the engine is asked for.
        """
        with self._lock:
            self._demands[who] = (states_hz, poses_hz, bell)
            words = self.ring.words
            for n, word in enumerate((DEMAND_NS, POSE_DEMAND_NS)):
                most = max(demand[n] for demand in self._demands.values())
                words[word] = int(1e9 / most) if most > 0.0 else 0
            words[BELL] = int(any(bell for _, _, bell in self._demands.values()))

    def wait_step(self, after_step: int, timeout: float) -> bool:
        """Wait until the step count is not `after_step` any more, or something has changed."""
        if self.ring.step != after_step:
            return True
        return self._supervisor.engine.wait_bell(timeout)

    def _snapshot(self) -> Snapshot:
        found = self.ring.read()
        if found is None:
            raise CommandError("the physics engine has not started")
        return found
