"""The file being read: where its elements lie, what was found wrong, how its URIs resolve."""
from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Optional, Set, Tuple

from ...description.model import Model
from ...errors import Issue, Severity
from ...resources.resolver import Resolver
from ..include_overrides import IncludeOverrides

_MOST_PATHS = 1000
"""Issues with an XPath; finding one takes as long as the element has siblings."""

_LAST_LINE = 65535
"""libxml2 counts no further; an element that seems to stand there may stand anywhere below."""


_ONLY_SHOWN = ("actor", "road")
"""What the world editor draws and physics knows nothing of."""
_TOLD_APART_BY = {"sensor": "type", "plugin": "filename"}
"""Attributes that make elements of one name different things."""


class FaultLevel(enum.Enum):
    """What a broken value or element does to what it belongs to."""

    FATAL = "fatal"      # an error; the whole model (or light) cannot be used
    ERROR = "error"      # an error; only the element is skipped
    WARNING = "warning"  # Gazebo would go on as well


class IssueCollector:
    """Issues of one reading, without exact repeats (a model may be included a thousand times).

    Attributes:
        fatal: how many of them make the entity they are in unusable.
        includes: how many includes were followed.
        told: kinds of elements of which it was said that they do nothing here.
        unknown: how many unknown elements and attributes were met.
    """

    def __init__(self) -> None:
        self.issues: List[Issue] = []
        self.fatal = 0
        self.includes = 0
        self.told: Set[str] = set()
        self.unknown = 0
        self._seen: Set[Issue] = set()

    def add(self, issue: Issue, fatal: bool = False) -> None:
        """Note an issue; `fatal` ones are counted even when they repeat."""
        self.fatal += fatal
        if issue not in self._seen:
            self._seen.add(issue)
            self.issues.append(issue)


@dataclass
class Source:
    """One file (or text) in the course of being read.

    Attributes:
        file: path, or a name for text from elsewhere.
        base_dir: what relative URIs start from, "" where there is no file.
        resolver: finds URIs.
        read_robot: reads the `<robot>` of an included file (see `urdf.robot.read_robot`).
        log: shared by all files of one reading.
        trail: files that are being included, outermost first.
        parsed: roots of included files by path, shared by all files of one reading.
    """

    file: str
    base_dir: str
    resolver: Resolver
    read_robot: Callable[[Any, "Source", Optional[IncludeOverrides]], Model]
    log: IssueCollector = field(default_factory=IssueCollector)
    trail: Tuple[str, ...] = ()
    parsed: Dict[str, Any] = field(default_factory=dict)

    def where(self, element: Optional[Any]) -> Dict[str, Any]:
        """`file`, `line` and `xpath` of an element, as arguments of an `Issue`."""
        if element is None:
            return {"file": self.file}
        line = element.sourceline or 0
        return {
            "file": self.file,
            "line": line if line < _LAST_LINE else 0,
            "xpath": element.getroottree().getpath(element)
            if len(self.log.issues) < _MOST_PATHS else "",
        }

    def report(
        self, level: FaultLevel, code: str, message: str, element: Optional[Any] = None,
        hint: str = ""
    ) -> None:
        """Note a fault of `element`."""
        severity = Severity.WARNING if level is FaultLevel.WARNING else Severity.ERROR
        issue = Issue(severity, code, message, hint=hint, **self.where(element))
        self.log.add(issue, fatal=level is FaultLevel.FATAL)

    def warn(self, code: str, message: str, element: Optional[Any] = None, hint: str = "") -> None:
        """Note a fault that Gazebo, too, would only mention."""
        self.report(FaultLevel.WARNING, code, message, element, hint)

    def tolerate(
        self, code: str, message: str, element: Optional[Any] = None, hint: str = ""
    ) -> None:
        """Note a fault that was read as Gazebo reads it; the message says what was done instead."""
        self.log.add(Issue(Severity.WARNING, code, message, hint=hint, tolerated=True,
                           **self.where(element)))

    def tell_unused(self, element: Any) -> None:
        """Say, once for each kind, that elements of this kind are kept and do nothing here."""
        told_apart_by = _TOLD_APART_BY.get(element.tag)
        which = (element.get(told_apart_by) or "") if told_apart_by else ""
        kind = f"{element.tag} {which}".strip()
        if kind in self.log.told:
            return
        self.log.told.add(kind)
        what = ("shown, but not simulated" if element.tag in _ONLY_SHOWN
                else "kept, but not simulated")
        self.log.add(Issue(Severity.NOTE, "not-simulated", f"<{kind}> is {what}",
                           **self.where(element)))
