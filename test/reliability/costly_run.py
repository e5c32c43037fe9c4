"""Spawns or opens one costly file: `python3 costly_run.py NAME FOLDER` prints JSON.

A process of its own, so that its peak of memory belongs to this file. Keys: `outcome`, the codes of
errors and of skipped collisions, or `built`; `took_s`; `stall_s`, the longest time in which
simulated time stood still; `stall_engine_s`, the most processor time that the engine used while
time stood still, which other programs of the machine do not change; `turn_s`, the longest time for
which another thread of the node waited for its turn; `useful_mb`, see `useful_bytes`; `node_mb`,
`engine_mb` and `reader_mb`, peaks of resident memory above those before, of the process that reads
untrusted files as a whole.
"""
from __future__ import annotations

import json
import os
import sys
import threading
import time
from typing import Dict, Tuple

from costly_files import ATTACKS

from my_simulations.description.cost_budget import Cost, cost_of
from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Collision, Plane
from my_simulations.description.world import World
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.errors import CommandError, InputError, errors_of
from my_simulations.formats import reader_process
from my_simulations.formats.mesh.loading import collision_meshes
from my_simulations.formats.reading import parse_document, read_world_text
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.simulator import Simulator

_SCHEDULED_CLOCK = 2   # of the clocks that Linux has for each process


def peak(pid: int) -> int:
    """The peak of resident memory of a process, MB; 0 if it does not exist."""
    try:
        with open(f"/proc/{pid}/status", encoding="ascii", errors="replace") as stream:
            return next(int(line.split()[1]) >> 10 for line in stream if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        return 0


def processor_time(pid: int) -> float:
    """The processor time that a process has used, s; 0 if it does not exist."""
    try:
        return time.clock_gettime((~pid << 3) | _SCHEDULED_CLOCK)
    except OSError:
        return 0.0


BODY_BYTES = 8 << 10
"""What Bullet keeps for a body of one box (measured, PyBullet 3.2.7)."""


def useful_bytes(text: str, folder: str, built: Cost) -> int:
    """The size of what a simulation needs of an attack, bytes.

    It is the larger one of the text with the files on disk, without their holes, and of what the
    engine builds: a body for each link, and corners of triangles in double precision.
    """
    files = sum(os.lstat(os.path.join(place, name)).st_blocks * 512
                for place, _, names in os.walk(folder) for name in names)
    return max(len(text) + files, built.links * BODY_BYTES + built.triangles * 3 * 3 * 8)


class Watch(threading.Thread):
    """Looks at simulated time and memory until it is stopped."""

    def __init__(self, simulator: Simulator) -> None:
        super().__init__(daemon=True)
        self.stall = self.stall_engine = self.turn = 0.0
        self.peaks: Dict[str, int] = {"engine": 0, "reader": 0}
        self.stopping = threading.Event()
        self._simulator = simulator

    def run(self) -> None:
        since, before = time.monotonic(), self._simulator.clock.sim_ns
        asleep = since
        used = processor_time(self._simulator.engine_pid)
        while not self.stopping.wait(0.01):
            engine = processor_time(self._simulator.engine_pid)
            now = self._simulator.clock.sim_ns
            self.turn = max(self.turn, time.monotonic() - asleep - 0.01)
            self.stall = max(self.stall, time.monotonic() - since)
            self.stall_engine = max(self.stall_engine, engine - used)
            if now != before:
                since, before, used = time.monotonic(), now, engine
            for name, pid in (("engine", self._simulator.engine_pid),
                              ("reader", reader_process.kept().pid)):
                self.peaks[name] = max(self.peaks[name], peak(pid) if pid else 0)
            asleep = time.monotonic()


def outcome(simulator: Simulator, text: str, folder: str) -> Tuple[str, Cost]:
    """Read and spawn as the ROS service does, or open a world as the editor does.

    Returns what came of it, and the cost of what was built.
    """
    resolver = Resolver(model_paths=[folder])
    try:
        if "<world " in text:
            loaded = read_world_text(text, resolver, "attack.world")
            issues = loaded.issues
            simulator.load_world(loaded.world, loaded.meshes)
            built = sum((cost_of(model, loaded.meshes.get(model.name))
                         for model in loaded.world.models), Cost())
        else:
            document = parse_document(text, resolver, "attack.sdf")
            model, issues = document.read_entity()
            assert isinstance(model, Model)
            meshes, more = collision_meshes(model, document.written(model.name))
            issues = [*issues, *more]
            if errors_of(issues):
                raise InputError(issues)
            simulator.models.spawn(model, meshes=meshes)
            built = cost_of(model, meshes)
    except InputError as fault:
        codes = sorted({one.code for one in errors_of(fault.issues)})
        return "refused: " + ", ".join(codes), Cost()
    except CommandError as fault:
        return f"refused by the simulator: {fault}", Cost()
    return "built" if not issues else f"skipped: {issues[0].code}", built


def beyond(simulator: Simulator, step: int) -> None:
    """Wait until so many steps were made."""
    until = time.monotonic() + 300.0
    while simulator.clock.step <= step:
        assert time.monotonic() < until, "simulated time does not go on"
        time.sleep(0.01)


def main(name: str, folder: str) -> None:
    """Print the figures of one attack."""
    text = ATTACKS[name](folder)
    ground = Model("ground", static=True, links=[Link("l", collisions=[Collision("c", Plane())])])
    simulator = Simulator(World(models=[ground]), engine_factory=ProcessEngine, paused=False,
                          log=lambda issue: None)
    simulator.start()
    watch = Watch(simulator)
    try:
        beyond(simulator, 0)
        own, engine = peak(os.getpid()), peak(simulator.engine_pid)
        watch.peaks["engine"] = engine
        watch.start()
        began = time.monotonic()
        found, built = outcome(simulator, text, folder)
        took = time.monotonic() - began
        beyond(simulator, simulator.clock.step + 10)
        watch.stopping.set()
        watch.join()
        print(json.dumps({
            "outcome": found, "took_s": round(took, 1), "stall_s": round(watch.stall, 1),
            "stall_engine_s": round(watch.stall_engine, 2), "turn_s": round(watch.turn, 1),
            "useful_mb": useful_bytes(text, folder, built) >> 20,
            "node_mb": peak(os.getpid()) - own, "engine_mb": watch.peaks["engine"] - engine,
            "reader_mb": watch.peaks["reader"]}))
    finally:
        simulator.close()
        reader_process.kept().close()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
