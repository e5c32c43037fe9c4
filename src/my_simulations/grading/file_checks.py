"""Checks of files: the faults of a world file and its entities, and model files that parse."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import Callable, Dict, List, Optional, Sequence

from ..description.flatten import flatten_model
from ..description.model import Model
from ..description.world import World
from ..errors import InputError, Issue, Severity, error, errors_of, tolerated_as_errors
from ..formats.reading import read_any
from ..formats.xml.parsing import STRAY_END_TAG, read_content
from ..resources.resolver import Resolver
from .assignment import (
    DYNAMIC,
    JOINT,
    LIGHT,
    LINK,
    MODEL,
    PLUGIN,
    STATIC,
    Assignment,
    EntityCount,
    ValidFile,
)
from .mark import CheckResult, score_check

_MOST_FAULTS = 4   # shown
NO_WORLD = "the file contains no <world>"


@dataclass(frozen=True)
class WorldFile:
    """A world file that was read.

    Attributes:
        name: path in the submission.
        world: None if it cannot be used.
        issues: all faults and advice.
    """

    name: str
    world: "World | None"
    issues: List[Issue]


def read_world_file(folder: str, name: str, resolver: Resolver) -> WorldFile:
    """Read a world file of a submission. Never raises for a fault of the file.

    A wrong end tag is an error: the editor guesses which elements it was to close, a mark must not.
    """
    path = os.path.join(folder, name)
    try:
        loaded, issues = read_any(read_content(path), resolver, path)
    except InputError as fault:
        return WorldFile(name, None, fault.issues)
    except OSError as fault:
        return WorldFile(name, None, [error(
            "file-unreadable", f"cannot be read: {fault.strerror or fault}", file=path)])
    stray = [replace(issue, severity=Severity.ERROR) for issue in issues
             if issue.code == STRAY_END_TAG and issue.file == path]
    if stray:
        return WorldFile(name, None, stray)
    return WorldFile(name, loaded if isinstance(loaded, World) else None, issues)


def invalid_model_file(folder: str, names: Sequence[str], resolver: Resolver) -> Optional[Issue]:
    """The first error of the first model file that does not parse; None if all parse.

    Args:
        folder: the submission.
        names: paths of the files in it; `Issue.file` of the result is one of them.
        resolver: finds what they refer to.
    """
    for name in names:
        read = read_world_file(folder, name, resolver)
        faults = [issue for issue in errors_of(read.issues) if issue.code.startswith("xml-")
                  or issue.code == "file-unreadable"]
        if faults:
            return replace(faults[0], file=name)
    return None


def check_files(assignment: Assignment, file: "WorldFile | None", missing: str
                ) -> List[CheckResult]:
    """The results of all checks of the world file.

    Args:
        assignment: the assignment.
        file: the world file; None if there is none.
        missing: the reason if there is none.
    """
    if file is None:
        return [score_check(check, 0.0, missing) for check in assignment.of(ValidFile, EntityCount)]
    found = [_valid(check, file) for check in assignment.of(ValidFile)]
    return found + [_count_entities(check, file) for check in assignment.of(EntityCount)]


def _valid(check: ValidFile, file: WorldFile) -> CheckResult:
    faults = sorted(errors_of(tolerated_as_errors(file.issues) if check.strict else file.issues),
                    key=lambda one: one.line or math.inf)
    if not faults and file.world is None:
        return score_check(check, 0.0, NO_WORLD, file.name)
    if not faults:
        return score_check(check, 1.0)
    first = faults[0]
    hint = f"; {first.hint}" if first.hint else ""
    others = [f"; line {one.line}: {one.message}" for one in faults[1:_MOST_FAULTS]]
    more = f"; {len(faults) - _MOST_FAULTS} more" if len(faults) > _MOST_FAULTS else ""
    return score_check(check, 0.0, f"{first.message}{hint}{''.join(others)}{more}", file.name,
                       first.line)


def _count_entities(check: EntityCount, file: WorldFile) -> CheckResult:
    if file.world is None:
        first = errors_of(file.issues)[:1]
        why = f": {first[0].message}" if first else ""
        return score_check(check, 0.0, f"the world file cannot be read{why}", file.name,
                           first[0].line if first else 0)
    names = _NAMES[check.kind](file.world) if not check.shape else _find_shaped(check, file.world)
    counted = [name for name in names if name not in check.excluded]
    number = len(counted)
    if number < check.least:
        share = number / check.least if check.partial else 0.0
        verb = "is" if check.least == 1 else "are"
        return score_check(check, share, f"{_of(number, check)}, {check.least} {verb} needed",
                           file.name)
    if check.most is not None and number > check.most:
        return score_check(check, 0.0, f"{_of(number, check)}, at most {check.most} are allowed",
                           file.name)
    return score_check(check, 1.0, f"found {_join_names(counted)}" if counted else "")


def _of(number: int, check: EntityCount) -> str:
    shape = f" with the shape {check.shape}" if check.shape else ""
    noun = f"{check.kind} model" if check.kind in (STATIC, DYNAMIC) else check.kind
    excluded = f" besides {_join_names(check.excluded)}" if check.excluded else ""
    return f"the world has {number} {noun}{'' if number == 1 else 's'}{shape}{excluded}"


def _join_names(names: Sequence[str]) -> str:
    shown = ", ".join(names[:8])
    return f"{shown}, …" if len(names) > 8 else shown


def _find_shaped(check: EntityCount, world: World) -> List[str]:
    wanted = set(_NAMES[check.kind](world))
    return [model.name for model in world.models if model.name in wanted
            and check.shape in _shapes(model)]


def _shapes(model: Model) -> List[str]:
    found = []
    for link in flatten_model(model).links:
        found += [type(one.geometry).__name__.lower() for one in link.collisions]
        found += [type(one.geometry).__name__.lower() for one in link.visuals]
    return found


def _flat(world: World) -> List[Model]:
    return [flatten_model(model) for model in world.models]


_NAMES: Dict[str, Callable[[World], List[str]]] = {
    MODEL: lambda world: [model.name for model in world.models],
    STATIC: lambda world: [model.name for model in world.models if model.static],
    DYNAMIC: lambda world: [model.name for model in world.models if not model.static],
    LIGHT: lambda world: [light.name for light in world.lights],
    LINK: lambda world: [link.name for model in _flat(world) for link in model.links],
    JOINT: lambda world: [joint.name for model in _flat(world) for joint in model.joints],
    PLUGIN: lambda world: [plugin.name for model in _flat(world) for plugin in model.plugins]
    + [plugin.name for plugin in world.plugins]}
