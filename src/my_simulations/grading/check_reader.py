"""Reads the checks of an assignment: the first key that is a kind of check decides which one."""
from __future__ import annotations

import difflib
import importlib.util
import pkgutil
import re
from importlib.machinery import ModuleSpec
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from ..errors import warning
from ..messages.definitions import standard_definitions
from ..objects.yaml_source import KeyPath
from ..studies.expressions import Expression, ExpressionError, parse
from ..studies.value_reader import ValueReader
from .assignment import (
    COUNTED,
    Check,
    EntityCount,
    Launch,
    NoContact,
    Place,
    Requirement,
    Rostest,
    ServiceAnswer,
    TopicRate,
    ValidFile,
)

SHAPES = ("box", "sphere", "cylinder", "plane", "mesh", "capsule", "ellipsoid", "cone",
          "heightmap", "polyline")
_COMMON = ("points", "name")
_MOST_S = 3600.0
_ROS_NAME = re.compile(r"/?[A-Za-z]\w*(/\w+)*\Z")
_MEASURED = re.compile(r"\{([^{}]*)\}")

Fields = Dict[str, Any]


class CheckReader:
    """Reads single checks; faults go to the reader of the file."""

    def __init__(self, values: AssignmentValues) -> None:
        self._values = values
        self._kinds: Dict[str, Tuple[Tuple[str, ...], Callable[[Fields, KeyPath, Fields],
                                                               Optional[Check]]]] = {
            "check_model": ((), self._valid_file),
            "count": (("not", "shape", "at_least", "at_most", "exactly", "partial"),
                      self._count),
            "place": (("at", "tolerance", "within", "partial"), self._place),
            "require": (("within", "partial", "message"), self._require),
            "no_contact": (("within",), self._no_contact),
            "topic": (("type", "rate", "within"), self._topic),
            "service": (("type", "within"), self._service),
            "launch": (("args", "seconds", "nodes", "world"), self._launch),
            "rostest": (("args", "seconds"), self._rostest)}

    def check(self, value: Any, path: KeyPath) -> Optional[Check]:
        """The check; None if it has a fault that leaves nothing to check."""
        kinds = [kind for kind in self._kinds if isinstance(value, dict) and kind in value]
        if len(kinds) != 1:
            self._values.fault(path, "a check has exactly one of the keys "
                               + ", ".join(self._kinds), code="grade-key")
            return None
        kind = kinds[0]
        more, read = self._kinds[kind]
        inside = self._values.mapping(value, path, (*_COMMON, kind, *more))
        if "points" not in inside:
            self._values.fault(path, "'points' is missing: what the check gives",
                               code="grade-key")
        points = self._values.number(inside.get("points", 1), (*path, "points"), least=0.0,
                                     most=1e6)
        shown = value[kind] if isinstance(value[kind], (str, int, float)) else ""
        name = self._values.text(inside.get("name", f"{kind} {shown}".strip()), (*path, "name"))
        line = self._values.line_of(path)
        return read(inside, path, {"points": points, "name": name, "line": line})

    # -- files -----------------------------------------------------------------------------------

    def _valid_file(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        strict = self._one_of(inside["check_model"], (*path, "check_model"),
                              ("strict", "lenient"))
        return ValidFile(**common, strict=strict == "strict")

    def _count(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        values = self._values
        kind = self._one_of(inside["count"], (*path, "count"), COUNTED)
        shape = self._one_of(inside["shape"], (*path, "shape"), SHAPES) if "shape" in inside else ""
        if not {"at_least", "at_most", "exactly"} & set(inside):
            values.fault(path, "'count' needs at_least, at_most or exactly", code="grade-key")
        least = values.integer(inside.get("at_least", 0), (*path, "at_least"))
        most = values.integer(inside["at_most"],
                              (*path, "at_most")) if "at_most" in inside else None
        if "exactly" in inside:
            least = most = values.integer(inside["exactly"], (*path, "exactly"))
        return EntityCount(**common, kind=kind, excluded=values.names(
            inside.get("not"), (*path, "not")), shape=shape, least=least, most=most,
            partial=self._flag(inside, "partial", path))

    # -- the running world -----------------------------------------------------------------------

    def _place(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        values = self._values
        at = values.numbers(inside.get("at"), (*path, "at"), (2, 3))
        return Place(
            **common, within=self._within(inside, path),
            model=values.text(inside["place"], (*path, "place")),
            at=(at[0], at[1], at[2] if len(at) == 3 else None),
            tolerance=values.number(inside.get("tolerance", 0.1), (*path, "tolerance"), above=0.0),
            partial=values.number(inside.get("partial", 0.0), (*path, "partial"), least=0.0))

    def _require(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        return Requirement(
            **common, within=self._within(inside, path, needed=True),
            require=self._expression(inside["require"], (*path, "require"), True),
            partial=self._expression(inside["partial"], (*path, "partial"), False)
            if "partial" in inside else None,
            message=self._message(inside.get("message", ""), (*path, "message")))

    def _no_contact(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        names = self._values.names(inside["no_contact"], (*path, "no_contact"))
        if len(names) != 2:
            self._values.fault((*path, "no_contact"), "'no_contact' must name two models")
            names = ("", "")
        return NoContact(**common, within=self._within(inside, path, needed=True),
                         first=names[0], second=names[1])

    def _topic(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        return TopicRate(
            **common, within=self._within(inside, path, needed=True),
            topic=self._ros_name(inside["topic"], (*path, "topic")),
            type_name=self._type(inside, path, MESSAGE) if "type" in inside else "",
            rate=self._values.number(inside.get("rate", 0.0), (*path, "rate"), least=0.0))

    def _service(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        return ServiceAnswer(
            **common, within=self._within(inside, path, needed=True),
            service=self._ros_name(inside["service"], (*path, "service")),
            type_name=self._type(inside, path, SERVICE))

    # -- programs of ROS -------------------------------------------------------------------------

    def _launch(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        values = self._values
        return Launch(
            **common, file=values.names(inside["launch"], (*path, "launch")),
            arguments=values.names(inside.get("args"), (*path, "args")),
            seconds=values.number(inside.get("seconds", 5.0), (*path, "seconds"), above=0.0,
                                  most=_MOST_S),
            nodes=values.names(inside.get("nodes"), (*path, "nodes")),
            runs_world=self._flag(inside, "world", path))

    def _rostest(self, inside: Fields, path: KeyPath, common: Fields) -> Check:
        values = self._values
        return Rostest(
            **common, file=values.file(inside["rostest"], (*path, "rostest")),
            arguments=values.names(inside.get("args"), (*path, "args")),
            seconds=values.number(inside.get("seconds", 300.0), (*path, "seconds"), above=0.0,
                                  most=_MOST_S))

    # -- values ----------------------------------------------------------------------------------

    def _within(self, inside: Fields, path: KeyPath, needed: bool = False) -> float:
        if needed and "within" not in inside:
            self._values.fault(path, "'within' is missing: s of sim time", code="grade-key")
        return self._values.number(inside.get("within", 0.0), (*path, "within"), least=0.0,
                                   most=_MOST_S)

    def _flag(self, inside: Fields, key: str, path: KeyPath) -> bool:
        value = inside.get(key, False)
        if not isinstance(value, bool):
            self._values.fault((*path, key), f"'{key}' of this check must be true or false")
        return value is True

    def _type(self, inside: Fields, path: KeyPath, sort: str) -> str:
        path = (*path, "type")
        kind = self._values.text(inside.get("type"), path)
        fault = type_fault(kind, sort) if kind else None
        if fault is not None and fault.is_certain:
            self._values.fault(path, fault.message, fault.hint, "grade-type")
        elif fault is not None:
            self._values.advise(path, fault.message, fault.hint, "grade-type-unknown")
        return kind

    def _ros_name(self, value: Any, path: KeyPath) -> str:
        name = self._values.text(value, path)
        if name and not _ROS_NAME.match(name):
            self._values.fault(path, f"{name!r} is not a name of ROS", "a name has letters, digits,"
                               " _ and /, such as /scan")
        return name if name.startswith("/") else f"/{name}"

    def _one_of(self, value: Any, path: KeyPath, known: Tuple[str, ...]) -> str:
        if value in known:
            return str(value)
        self._values.fault(path, f"'{path[-1]}' must be one of {', '.join(known)}, is {value!r}")
        return known[0]

    def _message(self, value: Any, path: KeyPath) -> Tuple[Union[str, Expression], ...]:
        """The parts of a text with `{EXPRESSION}`."""
        parts = _MEASURED.split(self._values.text(value, path)) if value != "" else []
        found = [self._expression(part, path, False) if number % 2 else part
                 for number, part in enumerate(parts)]
        return tuple(part for part in found if part)

    def _expression(self, value: Any, path: KeyPath, condition: bool) -> Optional[Expression]:
        text = self._values.text(value, path)
        try:
            found = parse(text) if text else None
        except ExpressionError as fault:
            self._values.fault(path, str(fault), "doc/studies.md lists what can be measured",
                               "grade-expression")
            return None
        if found is not None and found.condition != condition:
            wanted = "a condition" if condition else "a number"
            self._values.fault(path, f"'{path[-1]}' takes {wanted}", code="grade-expression")
        if found is not None and any(signal.kind == "vary" for signal in found.signals):
            self._values.fault(path, "an assignment varies nothing: there is no 'vary'",
                               code="grade-expression")
        return found


MESSAGE, SERVICE = "msg", "srv"
_TYPE = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*\Z")


class TypeFault(NamedTuple):
    """What is wrong with the name of a type.

    Attributes:
        message: the fault.
        hint: a similar name, or what to do.
        is_certain: False if the type may exist on another machine.
    """

    message: str
    hint: str
    is_certain: bool


def type_fault(kind: str, sort: str) -> Optional[TypeFault]:
    """Return the fault of a type's name; None if the type exists.

    Types are those of this library and those whose Python modules can be imported: packages of
    Debian do not always have the files they were generated from.

    Args:
        kind: such as `std_msgs/String`.
        sort: MESSAGE or SERVICE.
    """
    noun = "message" if sort == MESSAGE else "service"
    example = "std_msgs/String" if sort == MESSAGE else "std_srvs/Empty"
    if not _TYPE.match(kind):
        return TypeFault(f"{kind!r} is not a {noun} type", f"write for instance {example}", True)
    package = kind.partition("/")[0]
    standard = _standard_types(sort)
    of_ros = _types_of_ros(package, sort)
    if kind in standard or kind in (of_ros or ()):
        return None
    near = difflib.get_close_matches(kind, [*standard, *(of_ros or ())], 1, 0.7)
    hint = f"did you mean {near[0]}?" if near else ""
    if of_ros is not None:
        return TypeFault(f"the package {package} has no {noun} type {kind}", hint, True)
    source = f"source the workspace that defines {package}"
    return TypeFault(f"the {noun} type {kind} cannot be found", f"{hint} Otherwise {source}"
                     if hint else source, _module("genpy") is not None)


def _standard_types(sort: str) -> List[str]:
    names = standard_definitions()
    if sort == SERVICE:
        return [name[:-len("Request")] for name in names if name.endswith("Request")
                and f"{name[:-len('Request')]}Response" in names]
    return [name for name in names if not name.endswith(("Request", "Response"))]


def _types_of_ros(package: str, sort: str) -> Optional[List[str]]:
    """The types of a package of ROS; None if it cannot be imported."""
    found = _module(f"{package}.{sort}")
    if found is None:
        other = SERVICE if sort == MESSAGE else MESSAGE
        return None if _module(f"{package}.{other}") is None else []
    return [f"{package}/{module.name[1:]}" for module in pkgutil.iter_modules(
        found.submodule_search_locations) if module.name.startswith("_")]


def _module(name: str) -> Optional[ModuleSpec]:
    try:
        return importlib.util.find_spec(name)
    except ImportError:      # of its package
        return None


class AssignmentValues(ValueReader):
    document = "assignment"

    def fault(self, path: Sequence[str], message: str, hint: str = "",
              code: str = "grade-value") -> None:
        """Note a fault of an assignment; codes of studies become those of assignments."""
        super().fault(path, message, hint, code.replace("study-", "grade-"))

    def advise(self, path: KeyPath, message: str, hint: str, code: str) -> None:
        """Note a warning about the value at a path of keys."""
        self.issues.append(warning(code, message, hint=hint, **self._source.where(path)))

    def line_of(self, path: KeyPath) -> int:
        """The line of a key or an item of a list; 0 if unknown."""
        return self._source.lines.get(path, 0)
