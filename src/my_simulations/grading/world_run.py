"""Runs a world once and decides all checks of the running world."""
from __future__ import annotations

import math
import time
from typing import Any, Callable, Dict, List, Optional, Protocol, Sequence

import numpy as np

from ..description.model import Model
from ..description.plugin_namespace import with_namespace
from ..errors import CommandError, EngineLostError, SimulationError
from ..python_api import OpenWorld, WorldChoice
from ..studies.expressions import Samples, Signal
from ..studies.sampling import SignalReader
from .assignment import (
    Assignment,
    NoContact,
    Place,
    Requirement,
    ServiceAnswer,
    Timed,
    TopicRate,
    signals_of,
)
from .mark import CheckResult, late_reason, score_check

_SHOWN = 3   # decimals of a length, m
_MOST_MEASURED = 6


class Recorder(Protocol):
    """Records the world for the replay."""

    def record_state(self, world: OpenWorld) -> None:
        """Add the present state."""


class Graph(Protocol):
    """The ROS graph of the world with the program of the submission."""

    def step(self, steps: int) -> None:
        """Make steps, then wait until the program has done what follows from them."""

    def result(self, check: Timed) -> CheckResult:
        """Decide a check of a topic or service at the present sim time."""


class WorldRun:
    """Runs a world, and decides the checks of an assignment meanwhile.

    Args:
        assignment: the assignment.
        world: the open world, before its first step.
        name: name of the world file in the submission; "" for that of the assignment.
        until: `time.monotonic()` at which the run ends, if it has not ended before.
        graph: the ROS graph; None for a world that runs alone.
    """

    def __init__(self, assignment: Assignment, world: OpenWorld, name: str, until: float,
                 graph: Optional[Graph] = None) -> None:
        self._assignment = assignment
        self._world = world
        self._name = name
        self._until = until
        self._graph = graph
        self._readers: Dict[str, SignalReader] = {}
        self._faults: Dict[str, str] = {}

    def run(self, recorder: Optional[Recorder], done: Callable[[CheckResult], None]) -> bool:
        """Make the steps of the longest check; `done` gets each result as soon as it is decided.

        Returns:
            False if the time ended before all checks were decided.
        """
        checks = sorted(self._assignment.of(Timed), key=lambda check: float(check.within))
        size = self._world.step_size
        period = max(1, round(self._assignment.sample / size))
        made = 0
        while checks:
            try:
                self._sample(checks)
                if recorder is not None:
                    recorder.record_state(self._world)
                while checks and made >= round(checks[0].within / size):
                    done(self._decide_check(checks[0]))
                    del checks[0]
                if checks and time.monotonic() > self._until:
                    self._end(checks, late_reason(self._assignment), done)
                    return False
                if checks:
                    steps = min(period, max(1, round(checks[0].within / size) - made))
                    self._step(steps)
                    made += steps
            except SimulationError as fault:
                self._end(checks, f"the simulation ended after {made * size:g} s: {fault}", done)
        return True

    def _end(self, checks: List[Timed], reason: str, done: Callable[[CheckResult], None]) -> None:
        """Give no points for the checks that are left, which are removed."""
        while checks:
            done(score_check(checks.pop(0), 0.0, reason, self._name))

    def _step(self, steps: int) -> None:
        if self._graph is None:
            self._world.step(steps)
        else:
            self._graph.step(steps)

    def _sample(self, checks: Sequence[Timed]) -> None:
        """Add a sample to each check that can be read; a name may come to exist later."""
        for check in checks:
            signals = signals_of(check)
            try:
                if check.name not in self._readers and signals:
                    self._readers[check.name] = SignalReader(self._world, signals, {})
                if check.name in self._readers:
                    self._readers[check.name].add_sample()
                self._faults.pop(check.name, None)
            except EngineLostError:
                raise
            except CommandError as fault:
                self._faults[check.name] = str(fault)
                self._readers.pop(check.name, None)

    def _decide_check(self, check: Timed) -> CheckResult:
        if isinstance(check, (TopicRate, ServiceAnswer)):
            if self._graph is None:
                return score_check(check, 0.0, "the submission contains no program")
            return self._graph.result(check)
        if check.name in self._faults:
            return score_check(check, 0.0, self._faults[check.name], self._name)
        samples = self._readers[check.name].samples()
        return _DECIDE[type(check)](check, samples, self._name)


def world_choice_of(assignment: Assignment, path: str) -> WorldChoice:
    """Return the arguments of `OpenWorld`: the world file `path` and the assignment's models."""
    namespaces = {model.name: model.namespace for model in assignment.models}

    def add_namespace(model: Model) -> Model:
        namespace = namespaces.get(model.name, "")
        return with_namespace(model, namespace) if namespace else model

    return WorldChoice(path, models=tuple((model.name, model.file, model.pose)
                                          for model in assignment.models),
                       alter_model=add_namespace)


def _check_place(check: Place, samples: Samples, name: str) -> CheckResult:
    now = [float(samples[signal][-1]) for signal in signals_of(check)]
    distance = math.sqrt(sum((value - wanted) ** 2 for value, wanted in zip(now, check.at)
                             if wanted is not None))
    if distance <= check.tolerance:
        return score_check(check, 1.0)
    share = 0.0
    if check.partial > check.tolerance:
        share = (check.partial - distance) / (check.partial - check.tolerance)
    place = ", ".join(f"{value:.{_SHOWN}f}" for value in now)
    return score_check(
        check, share, f"{check.model} is at ({place}) m after {check.within:g} s,"
        f" {distance:.{_SHOWN}f} m from its place; {check.tolerance:g} m are allowed", name)


def _check_requirement(check: Requirement, samples: Samples, name: str) -> CheckResult:
    if check.require is None:
        return score_check(check, 0.0, "there is no condition")
    if check.require.value(samples):
        return score_check(check, 1.0)
    reason = "".join(part if isinstance(part, str) else f"{part.value(samples):.2f}"
                     for part in check.message)
    if not reason:
        reason = "; ".join([
            f"not true within {check.within:g} s of sim time: {check.require.text}",
            *check.require.measured(samples)[:_MOST_MEASURED]])
    share = 0.0
    if check.partial is not None:
        share = float(check.partial.value(samples))
        share = 0.0 if math.isnan(share) else min(max(share, 0.0), 1.0)
        reason += f"; {100.0 * share:.0f} % of the points"
    return score_check(check, share, reason, name)


def _apart(check: NoContact, samples: Samples, name: str) -> CheckResult:
    touched = np.flatnonzero(samples[signals_of(check)[0]])
    if not len(touched):
        return score_check(check, 1.0)
    time = float(samples[Signal("time")][touched[0]])
    return score_check(check, 0.0, f"{check.first} touches {check.second} at {time:.2f} s", name)


_DECIDE: Dict[type, Callable[[Any, Samples, str], CheckResult]] = {
    Place: _check_place, Requirement: _check_requirement, NoContact: _apart}
