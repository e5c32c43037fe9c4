"""A study: its world, parameters, measurements, kept files and limits."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

from ..geometry import Pose
from .expressions import Expression
from .variation import Parameter


@dataclass(frozen=True)
class PlacedModel:
    """A model that is added to the world of a study or an assignment.

    Attributes:
        name: in the world.
        file: absolute path of a URDF or SDF file.
        pose: its place in the world.
        namespace: `<robotNamespace>` of its plugins that set none; "" for none.
    """

    name: str
    file: str
    pose: Pose
    namespace: str = ""


@dataclass(frozen=True)
class Seeds:
    """Seeds of each combination: `count` numbers from `first` on, or those `listed`."""

    first: int = 0
    count: int = 1
    listed: Tuple[int, ...] = ()

    def __len__(self) -> int:
        return len(self.listed) or self.count

    def at(self, index: int) -> int:
        return self.listed[index] if self.listed else self.first + index


@dataclass(frozen=True)
class Plan:
    """How values are combined: all with all, or `cases` draws.

    Attributes:
        cases: number of draws of a random plan; 0 for a grid.
        seed: of all draws.
    """

    cases: int = 0
    seed: int = 0


@dataclass(frozen=True)
class Trajectory:
    """What is kept of the motion.

    Attributes:
        every: s of sim time between two frames.
        models: names; empty for all.
    """

    every: float
    models: Tuple[str, ...] = ()


@dataclass(frozen=True)
class Limits:
    """What a case may use.

    Attributes:
        processor_seconds: of its engine.
        steps: greatest number of steps of a case.
        attempts: how often a case is started whose engine crashes.
        memory_mb: of its engine, resident, in 10^6 bytes.
        seconds: wall time of a scenario; the others are not of scenarios, `attempts` apart.
    """

    processor_seconds: float = 60.0
    steps: int = 10_000_000
    attempts: int = 2
    memory_mb: float = 4000.0
    seconds: float = 600.0


@dataclass(frozen=True)
class Study:
    """A study file that was read.

    Attributes:
        name: of the study.
        file: absolute path of its file.
        world: world file, as `open_world` takes it, or an absolute path.
        profile: physics preset of the world file; "" for its default.
        objects: objects and groups of the list in every case.
        object_list: absolute path of the list; "" for that of the world.
        models: models in every case.
        duration: s of sim time of each case.
        seeds: seeds of each combination; a random plan takes them in turn.
        plan: how values are combined.
        parameters: the varied parameters.
        measure: expressions by column of the table.
        require: conditions by name; a case in which one is false has failed.
        sample: s of sim time between two samples of signals.
        trajectory: the recorded part of the motion; None for nothing.
        limits: what a case may use.
        scenarios: roslaunch files with tests, each run by rostest instead of a world, as in
            `scenario_path`; empty for a study of worlds.
    """

    name: str
    file: str
    world: str
    profile: str
    objects: Tuple[str, ...]
    object_list: str
    models: Tuple[PlacedModel, ...]
    duration: float
    seeds: Seeds
    plan: Plan
    parameters: Tuple[Parameter, ...]
    measure: Tuple[Tuple[str, Expression], ...]
    require: Tuple[Tuple[str, Expression], ...]
    sample: float
    trajectory: "Trajectory | None"
    limits: Limits
    scenarios: Tuple[str, ...] = ()

    @property
    def results(self) -> Tuple[Tuple[str, bool], ...]:
        """Columns of what is measured, and whether they are conditions."""
        if self.scenarios:
            return (("tests", False), ("failures", False))
        return tuple((name, expression.condition) for name, expression
                     in self.measure + self.require)

    @property
    def count(self) -> int:
        """Number of cases."""
        if self.plan.cases:
            return self.plan.cases
        total = len(self.seeds)
        for parameter in self.parameters:
            total *= parameter.count
        return total
