"""Runs one world: `python world_run.py PATH BEGAN SECONDS`; says what it did as a line of JSON.

BEGAN is the monotonic time at which the run was asked for. The line holds `end` and `why` where
the world was refused or did not come to its end in SECONDS, else or besides:

  first    s from BEGAN to the first step
  silent   s, longest time without a word before that
  rtf      sim time by wall time from the first step on; sim: sim time that was reached, s
  moved    models by name that moved more than 1 mm between 5 and 10 s: how far, m
  fell     models by name that are more than 1 m below where they began, and below -1 m: z, m
  crashes  what was said when an engine died
  models, errors   how many
"""
from __future__ import annotations

import json
import math
import sys
import time
from typing import Any, Dict, List, Tuple

from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.errors import CommandError, InputError, Issue, Severity
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.lifecycle.engine_supply import EngineSupply
from my_simulations.simulator.simulator import Simulator
from my_simulations.simulator.world_loading import start_world

_SETTLED_NS, _END_NS = 5_000_000_000, 10_000_000_000
_MOVED_M = 0.001
_FELL_M = 1.0

Places = Dict[str, Dict[str, Tuple[float, float, float]]]


class Words:
    """Hears what is said, and for how long nothing was."""

    def __init__(self, began: float) -> None:
        self._last = began
        self.silent = 0.0
        self.errors = 0
        self.crashes: List[str] = []

    def __call__(self, issue: Issue) -> None:
        self.heard()
        self.errors += issue.severity is Severity.ERROR
        if issue.code in ("engine-died", "engine-lost", "engine-stalled"):
            self.crashes.append(issue.message)

    def heard(self) -> None:
        """Something was heard now."""
        now = time.monotonic()
        self.silent, self._last = max(self.silent, now - self._last), now


def places(simulator: Simulator) -> Places:
    """Where the links are of every model that may move and could lie on something.

    What has no collision shape falls in Gazebo, too.
    """
    try:
        entities, snapshot = simulator.states.fresh()
    except CommandError:  # the engine has died, which is counted
        entities, snapshot = simulator.states.latest()
    return {entity.model.name: {
        link: snapshot.link(entity.first_link_row + n)[0].position
        for n, link in enumerate(entity.link_names)}
        for entity in entities
        if not entity.model.static and any(link.collisions for link in entity.model.links)}


def run(path: str, began: float, seconds: float) -> Dict[str, Any]:
    """See the module's text."""
    words = Words(began)
    engines = EngineSupply(ProcessEngine)
    try:
        simulator = start_world(path, Resolver.from_environment(), engines, words)
    except (InputError, CommandError) as fault:
        engines.close()
        return {"end": "refused", "why": str(fault)}
    try:
        return _watched(simulator, words, began, seconds)
    finally:
        simulator.close()


def _watched(simulator: Simulator, words: Words, began: float, seconds: float) -> Dict[str, Any]:
    at_start, epoch = places(simulator), simulator.clock.sim_ns
    simulator.clock.unpause()

    def reach(sim_ns: int) -> None:
        while simulator.clock.sim_ns - epoch < sim_ns and time.monotonic() - began < seconds:
            time.sleep(0.002)

    reach(1)
    words.heard()
    first = time.monotonic()
    found: Dict[str, Any] = {"first": first - began, "silent": words.silent}
    reach(_SETTLED_NS)
    settled = places(simulator)
    reach(_END_NS)
    sim, wall = (simulator.clock.sim_ns - epoch) * 1e-9, time.monotonic() - first
    at_end = places(simulator)
    if sim * 1e9 < _END_NS:
        found.update(end="late", why=f"{sim:.2f} s of sim time in {seconds:.0f} s")
    found.update(rtf=sim / wall, sim=sim, moved=_moved(settled, at_end),
                 fell=_fell(at_start, at_end), crashes=words.crashes, errors=words.errors,
                 models=len(simulator.models.names()))
    return found


def _moved(before: Places, after: Places) -> Dict[str, float]:
    ways = {name: max((math.dist(before[name][link], at) for link, at in links.items()),
                      default=0.0)
            for name, links in after.items() if name in before}
    return {name: way for name, way in ways.items() if way > _MOVED_M}


def _fell(before: Places, after: Places) -> Dict[str, float]:
    found = {}
    for name, links in after.items():
        for link, at in links.items():
            if at[2] < -_FELL_M and at[2] < before[name][link][2] - _FELL_M:
                found[name] = min(at[2], found.get(name, 0.0))
    return found


if __name__ == "__main__":
    answer = run(sys.argv[1], float(sys.argv[2]), float(sys.argv[3]))
    print("\n" + json.dumps(answer), flush=True)
