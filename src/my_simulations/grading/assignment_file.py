"""Reads an assignment file: YAML, every fault with its line and key."""
from __future__ import annotations

import os
import re
from typing import Any, Dict, List, Mapping, Optional, Sequence, Set, Tuple

from ..errors import InputError, Issue
from ..formats.reading import parse_world
from ..studies.value_reader import describe_value, read_document
from .assignment import (
    Assignment,
    Check,
    EntityCount,
    GradeLimits,
    Launch,
    SubmissionForm,
    Timed,
    ValidFile,
)
from .check_reader import AssignmentValues, CheckReader
from .unknown_models import unknown_models

_KEYS = ("lab", "submission", "world", "models", "services", "record", "sample", "limits",
         "checks")
_RECORDED = re.compile(r"/?[A-Za-z]\w*(/\w+)*(\.\w+(\[\d+\])?)*\Z")
_READ, _ALL = "read", "all"
_LIMITS = ("seconds", "processor_seconds", "memory_mb", "processes", "file_mb",
           "replay_mb")
_LONGEST_S = 3600.0


def read_assignment(file: str) -> Tuple[Assignment, List[Issue]]:
    """Read an assignment file; relative paths in it start at its folder.

    Returns:
        The assignment, and warnings.

    Raises:
        InputError: the file has faults; all of them are named.
    """
    return read_document(file, _AssignmentReader, _AssignmentReader.assignment)


class _AssignmentReader(AssignmentValues):
    """Reads the top level of an assignment."""

    def assignment(self, tree: Any, file: str) -> Optional[Assignment]:
        """The assignment; None if it is not a mapping at all."""
        if not isinstance(tree, Mapping):
            self.fault((), f"an assignment must be a mapping, is {describe_value(tree)}",
                       code="grade-value")
            return None
        top = self.mapping(tree, (), _KEYS)
        form = self._form(top.get("submission"))
        world = self.world(top["world"], ("world",)) if "world" in top else ""
        if form.world and world:
            self.fault(("world",), "the world is that of the submission or that of the assignment,"
                                   " not both", code="grade-key")
        checks = self._checks(top.get("checks"), bool(form.world or world), form)
        models = self.models(top.get("models"), ("file", "pose", "namespace"))
        services = top.get("services", _READ if top.get("models") else _ALL)
        if services not in (_READ, _ALL):
            self.fault(("services",), f"'services' must be {_READ} or {_ALL}, is {services!r}")
        if services == _READ and os.path.isfile(world):   # else a program can spawn models
            self._check_names(checks, world, {model.name for model in models})
        stem = os.path.splitext(os.path.basename(file))[0]
        return Assignment(
            self.text(top.get("lab", stem), ("lab",)), file, form, world,
            models,
            self.number(top.get("sample", 0.01), ("sample",), above=0.0, most=_LONGEST_S),
            self._limits(top.get("limits")), checks, services == _ALL,
            self._read_recorded(top.get("record"), form))

    def _form(self, value: Any) -> SubmissionForm:
        path = ("submission",)
        keys = ("world", "run", "models")
        inside = self.mapping(value, path, keys)
        return SubmissionForm(*(self.names(inside.get(key), (*path, key)) for key in keys))

    def _read_recorded(self, value: Any, form: SubmissionForm) -> Tuple[str, ...]:
        names = self.names(value, ("record",))
        for name in names:
            if not _RECORDED.match(name):
                self.fault(("record",), f"{name!r} is neither a topic nor a number of its messages",
                           "write for instance /scan, or /cmd_vel.linear.x for a curve")
        if names and not form.run:
            self.fault(("record",), "'record' needs a program: worlds alone have no topics",
                       "add submission: {run: NAME}", "grade-key")
        return tuple("/" + name.lstrip("/") for name in names)

    def _limits(self, value: Any) -> GradeLimits:
        inside = self.mapping(value, ("limits",), _LIMITS)
        default = vars(GradeLimits())
        numbers: Dict[str, float] = {
            name: self.number(inside.get(name, default[name]), ("limits", name), above=0.0)
            for name in _LIMITS if name != "processes"}
        processes = self.integer(inside.get("processes", default["processes"]),
                               ("limits", "processes"), 1, 10000)
        return GradeLimits(processes=processes, **numbers)

    def _checks(self, value: Any, world: bool, form: SubmissionForm) -> Tuple[Check, ...]:
        if not isinstance(value, list) or not value:
            self.fault(("checks",),
                       f"'checks' must be a list of checks, is {describe_value(value)}")
            return ()
        reader = CheckReader(self)
        found = [reader.check(entry, ("checks", str(index)))
                 for index, entry in enumerate(value)]
        for index, check in enumerate(found):
            path = ("checks", str(index))
            if check is not None and not world and _needs_world(check):
                self.fault(path, f"'{check.name}' needs a world",
                           "add submission: {world: NAME}, or world: FILE", "grade-key")
            if isinstance(check, Launch) and check.runs_world and not form.world:
                self.fault((*path, "world"), f"'world' of '{check.name}' needs the world file of"
                           " the submission", "add submission: {world: NAME}", "grade-key")
            if isinstance(check, Timed) and check.within == 0.0 and form.run:
                self.fault(path, f"'{check.name}' of a program needs 'within', s of sim time",
                           code="grade-key")
        names = [check.name for check in found if check is not None]
        for name in sorted({name for name in names if names.count(name) > 1}):
            self.fault(("checks", str(names.index(name))), f"two checks have the name '{name}'",
                       "give each a name of its own", "grade-key")
        return tuple(check for check in found if check is not None)

    def _check_names(self, checks: Sequence[Check], world: str, models: Set[str]) -> None:
        """Warn of models that the checks name and the assignment's world does not have."""
        try:
            with open(world, "rb") as stream:
                described, _ = parse_world(stream.read(), self._resolver, world)
        except (InputError, OSError) as fault:
            self.fault(("world",), f"the world cannot be read: {fault}", code="grade-world")
            return
        known = models | {model.name for model in described.models}
        for index, check in enumerate(checks):
            unknown = unknown_models(check, known) if isinstance(check, Timed) else []
            if unknown:
                self.advise(("checks", str(index)), f"'{check.name}' names {', '.join(unknown)},"
                            f" which the world does not have; its models are"
                            f" {', '.join(sorted(known)[:10])}",
                            "unless a plugin spawns it, correct the name", "grade-model-unknown")


def _needs_world(check: Check) -> bool:
    return isinstance(check, (Timed, EntityCount, ValidFile))
