"""Clients that note what they were promised, and find out whether it is so."""
from __future__ import annotations

import os
import random
import threading
from typing import Callable, Dict, List

from editor_case import box

from my_simulations.description.model import Model
from my_simulations.description.world import World
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.errors import CommandError, EngineTimeoutError
from my_simulations.formats.reading import parse_world
from my_simulations.formats.sdf.writer.entities import write_world
from my_simulations.geometry import STILL, Pose
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.saving import present_world
from my_simulations.simulator.simulator import Simulator

CELL = 3.0
"""Distance of models, so that none touches another, in metres."""


def floating(*models: Model) -> Simulator:
    """Return a started, paused world without gravity, in which models keep their poses."""
    world = World(models=list(models), gravity=(0.0, 0.0, 0.0))
    simulator = Simulator(world, engine_factory=ProcessEngine, paused=True, log=lambda issue: None)
    simulator.start()
    return simulator


class Client(threading.Thread):
    """Spawns, deletes, moves and reads models of its own until it is told to stop.

    Attributes:
        ledger: where its models are, by name, as the answers said.
        wrong: answers that were not true.
        done: operations that were carried out.
        refused: operations that were refused.
        removed: models that it deleted.
    """

    def __init__(self, simulator: Simulator, number: int, most: int) -> None:
        super().__init__(daemon=True, name=f"client {number}")
        self.ledger: Dict[str, Pose] = {}
        self.wrong: List[str] = []
        self.done = self.refused = self.removed = 0
        self._sim = simulator
        self._number = number
        self._most = most
        self._made = 0
        self._random = random.Random(number)
        self._stopping = threading.Event()

    def run(self) -> None:
        operations: List[Callable[[], None]] = [
            self._spawn, self._spawn, self._delete, self._move, self._move, self._read, self._step]
        while not self._stopping.is_set():
            try:
                self._random.choice(operations)()
            except Exception as defect:
                self.wrong.append(f"{type(defect).__name__}: {defect}")
                return

    def stop(self) -> None:
        """End after the operation that is under way."""
        self._stopping.set()
        self.join(120.0)
        assert not self.is_alive()

    def check(self) -> None:
        """Compare the ledger with the world."""
        for name in self.ledger:
            self._check(name, "at the end")

    def _pose(self) -> Pose:
        cell = self._random.randrange(10000)
        return Pose((CELL * (cell % 100), CELL * (cell // 100), CELL * self._number))

    def _spawn(self) -> None:
        if len(self.ledger) >= self._most:
            return
        self._made += 1
        name, pose = f"c{self._number}_{self._made}", self._pose()
        if any(pose == other for other in self.ledger.values()):
            return
        if self._tried(lambda: self._sim.models.spawn(box(name), pose), name):
            self.ledger[name] = pose
        elif self._sim.models.has(name):
            self.wrong.append(f"{name} is there, though its spawn was refused")

    def _delete(self) -> None:
        if not self.ledger:
            return
        name = self._random.choice(sorted(self.ledger))
        if self._tried(lambda: self._sim.models.delete(name) and None, name):
            del self.ledger[name]
            self.removed += 1
        else:
            self._check(name, "after a deletion that was refused")

    def _move(self) -> None:
        if not self.ledger:
            return
        name, pose = self._random.choice(sorted(self.ledger)), self._pose()
        if any(pose == other for other in self.ledger.values()):
            return
        if self._tried(lambda: self._sim.states.set_model_state(name, pose, STILL), name):
            self.ledger[name] = pose
        self._check(name, "after a move")

    def _read(self) -> None:
        if self.ledger:
            self._check(self._random.choice(sorted(self.ledger)), "when read")

    def _step(self) -> None:
        self._tried(lambda: self._sim.clock.advance(5) and None, "a step")

    def _tried(self, operation: Callable[[], None], name: str) -> bool:
        try:
            operation()
        except EngineTimeoutError:
            raise  # nothing in these proofs takes that long
        except CommandError as refusal:
            if not str(refusal):
                self.wrong.append(f"{name}: refused without a reason")
            self.refused += 1
            return False
        self.done += 1
        return True

    def _check(self, name: str, when: str) -> None:
        found = self._sim.states.model_state(name)[0].position
        wanted = self.ledger[name].position
        if any(abs(a - b) > 1e-6 for a, b in zip(found, wanted)):
            self.wrong.append(f"{name} is at {found} {when}, not at {wanted}")


class Saver(threading.Thread):
    """Writes the world again and again, and reads what it wrote."""

    def __init__(self, simulator: Simulator) -> None:
        super().__init__(daemon=True, name="saver")
        self.saves = 0
        self.wrong: List[str] = []
        self._sim = simulator
        self._stopping = threading.Event()

    def run(self) -> None:
        while not self._stopping.wait(0.2):
            try:
                world = present_world(self._sim)
                read, issues = parse_world(write_world(world, world.state), Resolver())
                if [model.name for model in read.models] != [m.name for m in world.models]:
                    self.wrong.append(f"a save lost models: {issues[:3]}")
                self.saves += 1
            except Exception as defect:
                self.wrong.append(f"save: {type(defect).__name__}: {defect}")

    def stop(self) -> None:
        """End after the save that is under way."""
        self._stopping.set()
        self.join(60.0)
        assert not self.is_alive()


class Crew:
    """Clients and a saver at work on a world of their own, until `finish`.

    Attributes:
        simulator: their world.
        models: how many there were at the end.
    """

    def __init__(self, clients: int, most: int) -> None:
        self.simulator = floating()
        self.models = 0
        self._clients = [Client(self.simulator, number, most) for number in range(clients)]
        self._saver = Saver(self.simulator)

    def __enter__(self) -> "Crew":
        for worker in (*self._clients, self._saver):
            worker.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.simulator.close()

    @property
    def done(self) -> int:
        """Operations that were carried out so far."""
        return sum(client.done for client in self._clients)

    @property
    def removed(self) -> int:
        """Models that were deleted so far."""
        return sum(client.removed for client in self._clients)

    def finish(self) -> None:
        """Have all stop; ledgers, model list and engine agree, and no answer was wrong."""
        workers = (*self._clients, self._saver)
        for worker in workers:
            worker.stop()
        self.models = agree(self.simulator, self._clients)
        assert [wrong for worker in workers for wrong in worker.wrong] == []

    def figures(self) -> Dict[str, int]:
        return {"clients": len(self._clients), "models": self.models, "operations": self.done,
                "refused": sum(client.refused for client in self._clients),
                "saves": self._saver.saves, "lost": 0, "wrong": 0}


def agree(simulator: Simulator, clients: List[Client]) -> int:
    """Compare ledgers, model list and what the engine shows; the number of models."""
    for client in clients:
        client.check()
    told = sorted(name for client in clients for name in client.ledger)
    assert told == sorted(simulator.models.names())
    entities, snapshot = simulator.states.fresh()
    assert sorted(entity.model.name for entity in entities) == told
    for entity in entities:
        position = entity.state(snapshot)[0].position
        assert all(abs(value) < 1e6 for value in position), entity.model.name
    return len(told)


def memory(pid: int) -> float:
    """Resident memory of a process in MB."""
    with open(f"/proc/{pid}/status", encoding="ascii", errors="replace") as stream:
        return next(int(line.split()[1]) for line in stream if line.startswith("VmRSS:")) / 1024


def descriptors(pid: int) -> int:
    """Open files of a process."""
    return len(os.listdir(f"/proc/{pid}/fd"))


def threads(pid: int) -> int:
    return len(os.listdir(f"/proc/{pid}/task"))
