"""The cases of a study, generated one at a time: a million of them need the memory of one."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Dict, Iterator, Optional, Tuple

from .launched_files import LaunchedFiles
from .provenance import digest_of, digest_of_world, versions
from .scenario_files import SCENARIO, scenario_path
from .study import Study
from .variation import Setting, settings_on_grid

_ID_DIGITS = 16


@dataclass(frozen=True)
class Shard:
    """Which part of the cases: those whose index is `index` - 1 modulo `of`."""

    index: int = 1
    of: int = 1


ALL_CASES = Shard()


@dataclass(frozen=True)
class Case:
    """One run of a world.

    Attributes:
        index: its number in the plan.
        id: 16 hexadecimal digits from all that its result depends on.
        seed: of what the world places at random.
        settings: the value of each parameter.
    """

    index: int
    id: str
    seed: int
    settings: Dict[str, Setting]


def number_of(case_id: str) -> int:
    """An id as a number, which needs less memory where there are many."""
    return int(case_id, 16)


class CasePlan:
    """Makes the cases of a study.

    Files are read when the first case that needs them is made, and not again: what changes later
    counts in the next run.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.versions = versions()
        self._base = digest_of([
            self.versions, study.profile, study.duration, study.sample,
            [(name, expression.text) for name, expression in study.measure + study.require],
            [(model.name, os.path.basename(model.file), model.pose) for model in study.models],
            [(p.name, p.target.kind, p.target.name, p.target.part) for p in study.parameters],
            study.trajectory and [study.trajectory.every, study.trajectory.models]])
        self._worlds = {p.name for p in study.parameters if p.target.kind == "world"}
        self._scenarios: Dict[str, str] = {}
        self._launched: Optional[LaunchedFiles] = None
        self._files: Dict[Tuple[str, Tuple[str, ...]], str] = {}

    def __len__(self) -> int:
        return self.study.count

    def cases(self, shard: Shard = ALL_CASES) -> Iterator[Case]:
        for index in range(shard.index - 1, len(self), shard.of):
            yield self.case(index)

    def case(self, index: int) -> Case:
        study = self.study
        if study.plan.cases:
            settings = {parameter.name: parameter.at_random(index, study.plan.seed)
                        for parameter in study.parameters}
            seed = study.seeds.at(index % len(study.seeds))
        else:
            place, number = divmod(index, len(study.seeds))
            settings = settings_on_grid(study.parameters, place, study.plan.seed)
            seed = study.seeds.at(number)
        files = (self._digest_of_scenario(str(settings[SCENARIO])) if study.scenarios
                 else self._digest_of_files(*self.world_and_objects(settings)))
        draw = index if study.plan.cases else -1  # two draws may give the same values
        content = {name: os.path.basename(str(value)) if name in self._worlds else value
                   for name, value in settings.items()}
        identity = digest_of([self._base, files, seed, content, draw])[:_ID_DIGITS]
        return Case(index, identity, seed, settings)

    def find(self, start_of_id: str) -> Optional[Case]:
        """The first case whose id begins so; None if there is none."""
        return next((case for case in self.cases() if case.id.startswith(start_of_id)), None)

    def world_and_objects(self, settings: Dict[str, Setting]) -> Tuple[str, Tuple[str, ...]]:
        world, objects = self.study.world, self.study.objects
        for parameter in self.study.parameters:
            value = settings[parameter.name]
            if parameter.target.kind == "world":
                world = str(value)
            elif parameter.target.kind == "objects" and isinstance(value, tuple):
                objects += tuple(str(name) for name in value)
        return world, objects

    def _digest_of_scenario(self, name: str) -> str:
        if self._launched is None:
            self._launched = LaunchedFiles()
        if name not in self._scenarios:
            self._scenarios[name] = self._launched.digest(scenario_path(name, self.study.file))
        return self._scenarios[name]

    def _digest_of_files(self, world: str, objects: Tuple[str, ...]) -> str:
        study = self.study
        if (world, objects) not in self._files:
            self._files[world, objects] = digest_of_world(
                world, study.profile, objects, study.object_list,
                [model.file for model in study.models])
        return self._files[world, objects]
