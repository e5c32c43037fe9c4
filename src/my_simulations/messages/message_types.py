"""Message and service types as dataclasses, made from their definitions on first use."""
from __future__ import annotations

import os
from dataclasses import field, make_dataclass
from functools import lru_cache
from typing import Any, Callable, ClassVar, Dict, List, Mapping, Optional, Tuple, Type

import numpy as np

from ..errors import SimulationError
from .definitions import (
    FLOATS,
    INTEGERS,
    SIMPLE,
    Constant,
    Definition,
    DefinitionError,
    Field,
    parse_definition,
    standard_definitions,
    statements_of,
)
from .time_values import Duration, Time

FindPackage = Callable[[str], Optional[str]]
"""Returns the folder of a package; None if it is unknown."""

DTYPES: Mapping[str, str] = {**{name: f"={code}" for name, code in INTEGERS.items()},
                             **{name: f"={code}" for name, code in FLOATS.items()}, "bool": "?"}
"""NumPy's types of the elements of arrays."""

_SIMPLE_DEFAULTS: Mapping[str, Callable[[], Any]] = {
    **dict.fromkeys(INTEGERS, int), **dict.fromkeys(FLOATS, float), "bool": bool, "string": str,
    "time": Time, "duration": Duration}


class UnknownTypeError(SimulationError):
    """There is no message or service type of that name."""


class Message:
    """The base of all messages; a subclass is a dataclass with the fields of its type.

    Arrays of numbers are NumPy arrays of the type of the definition, other arrays are lists.

    Attributes:
        KIND: the type, such as `sensor_msgs/LaserScan`.
        DEFINITION: its fields and constants; the constants are attributes of the class, too.
    """

    KIND: ClassVar[str] = ""
    DEFINITION: ClassVar[Definition] = Definition("", (), {})

    def __eq__(self, other: object) -> bool:
        """Whether all fields are equal, with the same type of message."""
        if not isinstance(other, Message) or other.KIND != self.KIND:
            return NotImplemented
        return all(_equal(getattr(self, one.name), getattr(other, one.name))
                   for one in self.DEFINITION.fields)

    def __reduce__(self) -> Tuple[Any, ...]:
        """Pickle the type by its definition, because its class is made at run time."""
        return _restore_message, (self.DEFINITION, vars(self))

    __hash__ = None  # type: ignore[assignment]  # messages can be changed


def _restore_message(definition: Definition, fields: Dict[str, Any]) -> Message:
    """Return a message that was pickled; its nested messages are complete already."""
    made = (standard_type(definition.kind) if definition.kind in standard_definitions()
            else make_type(definition, lambda kind: Message))
    message = made.__new__(made)
    vars(message).update(fields)
    return message


def _equal(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return bool(np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind == "f"))
    return bool(one == other)


class MessageTypes:
    """Finds types by name: the standard ones, then those of .msg and .srv files of packages.

    Args:
        find_package: finds the folders of packages.
    """

    def __init__(self, find_package: FindPackage = lambda name: None) -> None:
        self._find_package = find_package
        self._types: Dict[str, Type[Message]] = {}

    def message(self, kind: str) -> Type[Message]:
        """The class of `package/Name`. Raises UnknownTypeError."""
        if kind in standard_definitions():
            return standard_type(kind)
        if kind not in self._types:
            self._types[kind] = self._make_type(kind, self._statements(kind, "msg"))
        return self._types[kind]

    def service(self, kind: str) -> Tuple[Type[Message], Type[Message]]:
        """The classes of request and response of `package/Name`. Raises UnknownTypeError."""
        names = f"{kind}Request", f"{kind}Response"
        if names[0] in standard_definitions():
            return standard_type(names[0]), standard_type(names[1])
        if names[0] not in self._types:
            statements = self._statements(kind, "srv")
            at = statements.index("---") if "---" in statements else len(statements)
            for name, part in zip(names, (statements[:at], statements[at + 1:])):
                self._types[name] = self._make_type(name, part)
        return self._types[names[0]], self._types[names[1]]

    def _make_type(self, kind: str, statements: List[str]) -> Type[Message]:
        try:
            definition = parse_definition(kind, statements)
        except DefinitionError as fault:
            raise UnknownTypeError(str(fault)) from fault
        return make_type(definition, self.message)

    def _statements(self, kind: str, sort: str) -> List[str]:
        package, _, name = kind.partition("/")
        folder = self._find_package(package) if package else None
        if folder is None:
            raise UnknownTypeError(f"{kind} is not a standard type, and there is no package"
                                   f" {package!r} that may define it")
        path = os.path.join(folder, sort, f"{name}.{sort}")
        try:
            with open(path, encoding="utf-8", errors="replace") as stream:
                return statements_of(stream.read())
        except OSError as fault:
            raise UnknownTypeError(f"{kind} is not defined: {fault}") from fault


@lru_cache(maxsize=None)
def standard_type(kind: str) -> Type[Message]:
    """The class of a standard type. Raises UnknownTypeError."""
    statements = standard_definitions().get(kind)
    if statements is None:
        raise UnknownTypeError(f"{kind} is not a standard message type")
    return make_type(parse_definition(kind, statements), standard_type)


def make_type(definition: Definition, find: Callable[[str], Type[Message]]) -> Type[Message]:
    """Return a dataclass of a definition; `find` gives the classes of the fields' types."""
    package, _, name = definition.kind.partition("/")
    constants: Mapping[str, Constant] = definition.constants
    fields = [(one.name, _annotation(one, find), field(default_factory=_default(one, find)))
              for one in definition.fields]
    made = make_dataclass(name, fields, bases=(Message,), eq=False, namespace={
        "KIND": definition.kind, "DEFINITION": definition, **constants,
        "__doc__": f"{definition.kind}.", "__module__": f"{__package__}.{package}"})
    return made


def _annotation(one: Field, find: Callable[[str], Type[Message]]) -> Any:
    if one.is_array:
        return np.ndarray if one.kind in DTYPES else list
    return type(_SIMPLE_DEFAULTS[one.kind]()) if one.kind in SIMPLE else find(one.kind)


def _default(one: Field, find: Callable[[str], Type[Message]]) -> Callable[[], Any]:
    element = _SIMPLE_DEFAULTS[one.kind] if one.kind in SIMPLE else find(one.kind)
    if not one.is_array:
        return element
    length = one.length or 0
    if one.kind in DTYPES:
        return lambda: np.zeros(length, DTYPES[one.kind])
    return lambda: [element() for _ in range(length)]
