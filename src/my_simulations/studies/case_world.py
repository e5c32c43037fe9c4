"""The world of one case, to run, show or record it."""
from __future__ import annotations

from typing import Callable, Sequence, Tuple

from ..errors import InputError, error, errors_of
from ..python_api import OpenWorld, RobotOptions, WorldChoice
from .changes import CaseChanges
from .plan import Case, CasePlan
from .variation import value_requirement

CASE_ROBOTS = RobotOptions(isolate=True)
"""Plugins of users run in processes of their own: one that exits must not end the study."""

_SLICE = 1000  # steps at a time


def world_choice_of(plan: CasePlan, case: Case) -> Tuple[WorldChoice, CaseChanges]:
    """Return the arguments of `OpenWorld` for a case, and the changes that they contain.

    Raises InputError for a value that cannot be set, such as a drawn mass below 0.
    """
    study = plan.study
    for parameter in study.parameters:
        value = case.settings[parameter.name]
        needed = value_requirement(parameter.target, value)
        if needed:
            raise InputError([error("study-value", f"'{parameter.name}' must be {needed}, is"
                                                   f" {value}", file=study.file)])
    changes = CaseChanges(study.parameters, case.settings)
    name, objects = plan.world_and_objects(case.settings)
    return WorldChoice(
        name, case.seed, study.profile, objects, study.object_list,
        tuple((model.name, model.file, model.pose) for model in study.models),
        changes.world, changes.model), changes


def open_case(plan: CasePlan, case: Case) -> OpenWorld:
    """Open the world of a case. Raises InputError: the world file has errors."""
    world = OpenWorld(world_choice_of(plan, case)[0], robots=CASE_ROBOTS)
    if errors_of(world.issues):
        world.close()
        raise InputError(world.issues)
    return world


def run_case(world: OpenWorld, duration: float, every: float,
         watchers: Sequence[Callable[[OpenWorld], None]]) -> None:
    """Make the steps of a case; watchers see the start, every so many s of sim time, and the end.

    Steps are those of the study, bit for bit: how they are divided does not matter.
    """
    steps = round(duration / world.step_size)
    period = max(1, round(every / world.step_size))
    done = 0
    while True:
        if done % period == 0 or done == steps:
            for watch in watchers:
                watch(world)
        if done >= steps:
            return
        end = min(steps, done + _SLICE, done + period - done % period)
        world.step(end - done)
        done = end
