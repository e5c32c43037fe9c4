"""Tables that bind the elements of a file to the fields of dataclasses.

A table maps the children and attributes of an element to the fields they fill. The tables also
say which names are known and since which version of the format. Defaults are those of the
dataclass, so each is defined once.
"""
from __future__ import annotations

import enum
import functools
from dataclasses import dataclass, field, fields
from typing import Any, Dict, Iterator, Mapping, Optional, Tuple, Union

from .source import FaultLevel
from .values import Kind


class Use(enum.Enum):
    """How an element is used."""

    SIMULATED = "simulated"        # simulated
    PLUGINS = "used by plugins"    # read by plugins, without effect if the file names none of them
    SHOWN = "shown"                # drawn in the editor, without effect on motion
    KEPT = "kept"                  # read and saved, without other effect
    IGNORED = "ignored"            # neither simulated nor saved


@dataclass(frozen=True)
class Value:
    """A child element (its text) or an attribute with a single value.

    Attributes:
        field: name of the field it fills; a list field gets one entry.
        kind: the kind of value, which parses and formats its text.
        level: fault level of an unreadable text; None for that of the table.
        since: version of the format that introduced it.
        repeated: whether it may occur more than once.
        part: name of the field with the dataclass that has `field`; "" for that of the table.
        use: how it is used; None for that of the table.
    """

    field: str
    kind: Kind
    level: Optional[FaultLevel] = None
    since: str = ""
    repeated: bool = False
    part: str = ""
    use: Optional[Use] = None


@dataclass(frozen=True)
class Group:
    """A child element whose children and attributes fill the same object.

    `part`: name of a field with a dataclass that they fill instead.
    """

    children: Mapping[str, "Entry"] = field(default_factory=dict)
    attributes: Mapping[str, Value] = field(default_factory=dict)
    part: str = ""
    since: str = ""


@dataclass(frozen=True)
class Part:
    """A child element with a reader of its own.

    Attributes:
        since, use: see `Value`.
        reported: note once per kind that the element is not simulated.
        kept: also keep its XML.
    """

    since: str = ""
    use: Optional[Use] = None
    reported: bool = False
    kept: bool = False


@dataclass(frozen=True)
class Nested:
    """A child element that fills a dataclass of its own, by its own table.

    The dataclass has a list `extra` for the XML of unknown children.

    Attributes:
        field: field with the object, with None for no element, or with a list of objects.
        table: the table of the element.
        required: paths in the element that are written even with their default value.
        since, use: see `Value`.
        reported: note once per kind that the element is not simulated.
    """

    field: str
    table: "Table"
    required: Tuple[str, ...] = ()
    since: str = ""
    use: Optional[Use] = None
    reported: bool = False


@dataclass(frozen=True)
class Kept:
    """A child element that is known and kept as XML, not simulated.

    Attributes:
        since, use: see `Value`.
        reported: note once per kind that the element is not simulated.
    """

    since: str = ""
    use: Use = Use.KEPT
    reported: bool = False


Entry = Union[Value, Group, Part, Nested, Kept]


@dataclass(frozen=True)
class Table:
    """The table of an element.

    Attributes:
        name: its tag.
        of: dataclass that it fills.
        attributes, children: by name.
        level: fault level of unreadable values without a level of their own.
        known_attributes: names of attributes that are read elsewhere.
        use: use of entries without a use of their own.
        strict: reject texts that are only partly a value (URDF); otherwise read them leniently, as
            Gazebo does (SDF).
        hint: for an unknown child with a name like no known one; {name} is that name.
    """

    name: str
    of: Any
    children: Mapping[str, Entry] = field(default_factory=dict)
    attributes: Mapping[str, Value] = field(default_factory=dict)
    level: FaultLevel = FaultLevel.ERROR
    known_attributes: Tuple[str, ...] = ()
    use: Use = Use.SIMULATED
    strict: bool = False
    hint: str = ""

    def values(self) -> Iterator[Tuple[str, Value, Any]]:
        """(path, value, default) of every value; attributes as `@name`; for writers and tests."""
        return _values(self.children, self.attributes, self.of, "")


def values_named(kind: Kind, *names: str, use: Optional[Use] = None) -> Dict[str, Value]:
    """Return entries that fill the fields of their own names."""
    return {name: Value(name, kind, use=use) for name in names}


def kept(*names: str, use: Use = Use.KEPT, reported: bool = False) -> Dict[str, Kept]:
    """Return entries that are kept, all alike."""
    return {name: Kept(use=use, reported=reported) for name in names}


def _values(children: Mapping[str, Entry], attributes: Mapping[str, Value], of: Any,
            path: str) -> Iterator[Tuple[str, Value, Any]]:
    for name, value in attributes.items():
        yield f"{path}@{name}", value, default_of(of, value.field)
    for name, entry in children.items():
        if isinstance(entry, Value):
            owner = type(default_of(of, entry.part)) if entry.part else of
            yield f"{path}{name}", entry, default_of(owner, entry.field)
        elif isinstance(entry, Group):
            inner = type(default_of(of, entry.part)) if entry.part else of
            yield from _values(entry.children, entry.attributes, inner, f"{path}{name}/")


def default_of(of: Any, name: str) -> Any:
    """The default of a field of a dataclass; None if it has none."""
    item = _fields_by_name(of).get(name)
    if item is None:
        raise AttributeError(f"{of.__name__} has no field {name}")
    if callable(item.default_factory):
        return item.default_factory()
    return item.default if item.default.__class__.__name__ != "_MISSING_TYPE" else None


@functools.lru_cache(maxsize=None)
def usual_value(of: Any, name: str) -> Any:
    """As `default_of`, one object for all who ask: to compare with, not to keep or change."""
    return default_of(of, name)


@functools.lru_cache(maxsize=None)
def _fields_by_name(of: Any) -> Dict[str, Any]:
    return {item.name: item for item in fields(of)}
