"""Errors that users can cause: issues as data, and one hierarchy of exceptions.

A fault in a user's file or request is an `Issue`; readers collect all they meet in one pass.
`InputError` carries them where nothing usable is left. Every exception that a user can cause
derives from `SimulationError`:

    SimulationError
      InputError             a file or document that cannot be used
      CommandError           a request that cannot be carried out
        UnknownEntityError, UnknownFrameError, EngineTimeoutError, EngineLostError, ...
      ResourceError          a file, model or download that cannot be found or fetched
      CommandRefusedError    a command that the engine rejects
        BodyPlanError, ShapeError, ...
      MeshError, FrameError, ...   raised and handled in one package

Programming errors raise Python's own exceptions and are never turned into issues.
"""
from __future__ import annotations

import enum
from dataclasses import dataclass, replace
from typing import Any, Dict, Iterable, List, Optional, Sequence

_MOST_LINES = 5   # that `group_repeated` names
_ONE_PER_MODEL = {"inertia-zero", "inertia-not-positive", "inertia-impossible"}
"""Codes of which `group_repeated` keeps one issue per model, whatever link the message names."""


class Severity(enum.Enum):
    ERROR = "error"      # the element (or the file) is not usable
    WARNING = "warning"  # used, but not as written
    NOTE = "note"        # used as written, worth knowing


@dataclass(frozen=True)
class Issue:
    """One fault of one input.

    Attributes:
        severity: ERROR, WARNING or NOTE.
        code: stable identifier in kebab-case, listed in `issue_codes`, e.g. `mesh-not-found`.
        message: one sentence, with what was expected and what was found.
        file: path of the file, or a name such as `robot_description` for text from elsewhere.
        line, column: 1-based; 0 where unknown.
        xpath: the element, e.g. `/sdf/world/model[2]/link[1]`.
        hint: what to do about it, or empty.
        tolerated: the file breaks its format, and was read as Gazebo reads it: a fault for those
            who want to be strict.
    """

    severity: Severity
    code: str
    message: str
    file: str = ""
    line: int = 0
    column: int = 0
    xpath: str = ""
    hint: str = ""
    tolerated: bool = False

    @property
    def location(self) -> str:
        """`file:line:column`, as far as known."""
        if not self.file and not self.line:
            return ""
        parts = [self.file or "<text>"]
        if self.line:
            parts.append(str(self.line))
            if self.column:
                parts.append(str(self.column))
        return ":".join(parts)

    def to_json(self) -> Dict[str, Any]:
        """Return all fields for JSON, the severity as text."""
        return {**vars(self), "severity": self.severity.value}

    def __str__(self) -> str:
        where = f"{self.location}: " if self.location else ""
        at = f" [{self.xpath}]" if self.xpath else ""
        hint = f" ({self.hint})" if self.hint else ""
        return f"{where}{self.severity.value}: {self.message}{at}{hint}"


def error(code: str, message: str, **where: object) -> Issue:
    """An `Issue` of severity ERROR; `where` takes file, line, column, xpath and hint."""
    return Issue(Severity.ERROR, code, message, **where)  # type: ignore[arg-type]


def warning(code: str, message: str, **where: object) -> Issue:
    """An `Issue` of severity WARNING; `where` takes file, line, column, xpath and hint."""
    return Issue(Severity.WARNING, code, message, **where)  # type: ignore[arg-type]


def errors_of(issues: Iterable[Issue]) -> List[Issue]:
    """Only those of severity ERROR, in order."""
    return [issue for issue in issues if issue.severity is Severity.ERROR]


def group_repeated(issues: Iterable[Issue]) -> List[Issue]:
    """The first of the issues that differ in their place only, with the lines of the others.

    Robots repeat an element in each of their joints or wheels: the log then has one line for it.
    """
    places: Dict[Issue, List[Issue]] = {}
    for issue in issues:
        if issue.code in _ONE_PER_MODEL:
            key = replace(issue, line=0, column=0, message="", xpath=_model_path(issue.xpath))
        else:
            key = replace(issue, line=0, column=0, xpath="")
        places.setdefault(key, []).append(issue)
    found: List[Issue] = []
    for first, *others in places.values():
        lines = sorted({other.line for other in others if other.line})
        if not lines:
            found += dict.fromkeys((first, *others))
            continue
        shown = ", ".join(map(str, lines[:_MOST_LINES]))
        more = f" and {len(lines) - _MOST_LINES} more" if len(lines) > _MOST_LINES else ""
        noun = "lines" if len(lines) > 1 else "line"
        found.append(replace(first, message=f"{first.message}; also in {noun} {shown}{more}"))
    return found


def _model_path(xpath: str) -> str:
    """The part of an XPath that leads to the innermost model, "" for the robot of a URDF."""
    before, model, after = xpath.rpartition("/model")
    return before + model + after.partition("/")[0]


def tolerated_as_errors(issues: Iterable[Issue]) -> List[Issue]:
    """The same issues, those that were tolerated as errors."""
    return [replace(issue, severity=Severity.ERROR) if issue.tolerated else issue
            for issue in issues]


class SimulationError(Exception):
    """Root of all errors that a user can cause; the text is one sentence for people."""


class InputError(SimulationError):
    """An input file or document that cannot be used.

    Attributes:
        issues: every fault found, at least one of severity ERROR.
    """

    def __init__(self, issues: Sequence[Issue]) -> None:
        self.issues: List[Issue] = list(issues)
        super().__init__(self.summary())

    @property
    def first(self) -> Optional[Issue]:
        """The first error, else the first issue, else None."""
        found = errors_of(self.issues) or self.issues
        return found[0] if found else None

    def summary(self) -> str:
        """The first error and how many more there are, in one line."""
        first = self.first
        if first is None:
            return "unknown error"
        more = len(errors_of(self.issues)) - 1
        return str(first) + (f" (and {more} more)" if more > 0 else "")


class ResourceError(SimulationError):
    """A file, model or download that cannot be found or fetched."""


class CommandError(SimulationError):
    """A request that cannot be carried out: unknown entity, duplicate name, invalid value.

    The message is one sentence for the user, without a prefix.
    """


class OutdatedCommandError(CommandError):
    """A request about a model, link or joint that was removed in the meantime."""


class EngineTimeoutError(CommandError):
    """The engine runs but has not answered in time; the request may still be carried out."""


class EngineLostError(CommandError):
    """The engine process crashed while executing this command; the world was restored."""
