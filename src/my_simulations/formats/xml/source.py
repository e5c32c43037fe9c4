"""The file being read: location of its elements, issues found, resolution of its URIs."""
from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Optional, Set, Tuple

from ...description.model import Model
from ...errors import Issue, Severity
from ...resources.resolver import Resolver, ResourceNotFoundError
from ..include_overrides import IncludeOverrides

_MOST_PATHS = 1000
"""Most issues with an XPath: finding one takes time proportional to the number of siblings."""

_LAST_LINE = 65535
"""Largest line number of libxml2; elements further down have this line number, too."""


_ONLY_SHOWN = ("actor", "road")
"""Elements that the world editor draws and that have no effect on motion."""
_TOLD_APART_BY = {"sensor": "type", "plugin": "filename"}
"""Attributes that distinguish elements of the same name."""


class FaultLevel(enum.Enum):
    """Effect of a faulty value or element on the entity that contains it."""

    FATAL = "fatal"      # an error; the whole model (or light) cannot be used
    ERROR = "error"      # an error; only the element is skipped
    WARNING = "warning"  # a warning; Gazebo continues as well


class IssueCollector:
    """Issues of one document and its includes, without duplicates.

    Attributes:
        fatal: number of issues that make their entity unusable.
        includes: number of includes followed for the model that is being read.
        nested: number of nested models of the models that were begun.
        reported: kinds of elements that were already reported as not simulated.
        unknown: number of unknown elements and attributes.
    """

    def __init__(self) -> None:
        self.issues: List[Issue] = []
        self.fatal = 0
        self.includes = 0
        self.nested = 0
        self.reported: Set[str] = set()
        self.unknown = 0
        self._seen: Set[Issue] = set()

    def add(self, issue: Issue, fatal: bool = False) -> None:
        """Add an issue; `fatal` ones are counted even if they repeat."""
        self.fatal += fatal
        if issue not in self._seen:
            self._seen.add(issue)
            self.issues.append(issue)


@dataclass
class Source:
    """A file (or text) being read.

    Attributes:
        file: path, or a name for text from elsewhere.
        base_dir: folder from which relative URIs start; "" if there is no file.
        resolver: resolves URIs.
        read_robot: reads the `<robot>` of an included file (see `urdf.robot.read_robot`).
        log: receives issues; shared with included files.
        trail: files that are being included, outermost first.
        parsed: roots of included files by path; shared with included files.
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
        severity = Severity.WARNING if level is FaultLevel.WARNING else Severity.ERROR
        issue = Issue(severity, code, message, hint=hint, **self.where(element))
        self.log.add(issue, fatal=level is FaultLevel.FATAL)

    def warn(self, code: str, message: str, element: Optional[Any] = None, hint: str = "") -> None:
        """Add a warning about a fault that Gazebo tolerates, too."""
        self.report(FaultLevel.WARNING, code, message, element, hint)

    def resolve(self, uri: str, element: Any) -> str:
        """The path of a URI that `element` names. Raises ResourceNotFoundError."""
        return self._locate_file(self.resolver.resolve, uri, element)

    def model_file(self, uri: str, element: Any) -> str:
        """The description file of a model's URI. Raises ResourceNotFoundError."""
        return self._locate_file(self.resolver.model_file, uri, element)

    def _locate_file(self, locate: Callable[[str, str], str], uri: str, element: Any) -> str:
        self.report_home_path(uri, element)
        try:
            return locate(uri, self.base_dir)
        except ResourceNotFoundError:
            folder = self.resolver.add_unlisted_folder(uri, self.base_dir)
            if not folder:
                raise
            self.tolerate("model-folder-unlisted", f"{uri!r} is in {folder}, which is not in the"
                          " model path; it is added", element,
                          f"Gazebo needs GAZEBO_MODEL_PATH={folder}")
            return locate(uri, self.base_dir)

    def report_home_path(self, uri: str, element: Any) -> None:
        """Warn of a URI in the home folder of another machine; see `Resolver.replaced_home`."""
        here = self.resolver.replaced_home(uri)
        if here:
            self.tolerate("home-path", f"{uri!r} is a path on another machine; {here} is used",
                          element, f"write {here}")

    def tolerate(
        self, code: str, message: str, element: Optional[Any] = None, hint: str = ""
    ) -> None:
        """Add a fault that was read as Gazebo reads it; the message says how."""
        self.log.add(Issue(Severity.WARNING, code, message, hint=hint, tolerated=True,
                           **self.where(element)))

    def report_unused(self, element: Any) -> None:
        """Note once per kind that elements of this kind are saved but not simulated."""
        told_apart_by = _TOLD_APART_BY.get(element.tag)
        which = (element.get(told_apart_by) or "") if told_apart_by else ""
        kind = f"{element.tag} {which}".strip()
        if kind in self.log.reported:
            return
        self.log.reported.add(kind)
        what = ("shown, but not simulated" if element.tag in _ONLY_SHOWN
                else "kept, but not simulated")
        self.log.add(Issue(Severity.NOTE, "not-simulated", f"<{kind}> is {what}",
                           **self.where(element)))
