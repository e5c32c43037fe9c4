"""Writes the fields of an object as children and attributes, by the reader's table."""
from __future__ import annotations

from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Set, Tuple

from lxml import etree

from ...xml.tables import Entry, Group, Kept, Nested, Part, Table, Value, usual_value
from .xml_text import append_fragment, write_value

WriteParts = Mapping[str, Callable[[Any], object]]
"""Writers of the children that have their own readers, by path from the element."""


def fill_element(element: Any, source: Any, table: Table, parts: WriteParts,
                 extra: Sequence[str], required: Tuple[str, ...] = (),
                 leave_out: Tuple[str, ...] = ()) -> None:
    """Write the fields of an object as children and attributes, as its table reads them.

    Args:
        element: the element to fill.
        source: an object of the table's dataclass.
        table: the table of the element.
        parts: writers of children that have their own readers; a tag without a writer is skipped.
        extra: kept XML to add.
        required: paths that are written even with their default value.
        leave_out: paths that are never written.
    """
    _Filler(parts, required, leave_out).fill(element, source, table.of, table.children,
                                             table.attributes, "")
    for xml in extra:
        append_fragment(element, xml, table)


def write_each(write: Callable[[Any, Any], None], parent: Any, items: Iterable[Any]) -> None:
    for item in items:
        write(parent, item)


def _write_nested(parent: Any, source: Any, of: Any, tag: str, entry: Nested) -> None:
    """Write the objects of a nested element, unless they are the default."""
    value = getattr(source, entry.field)
    if value == usual_value(of, entry.field):
        return
    for item in value if isinstance(value, list) else [value]:
        fill_element(etree.SubElement(parent, tag), item, entry.table, {}, item.extra,
                     entry.required)


class _Filler:
    def __init__(self, parts: WriteParts, required: Tuple[str, ...],
                 leave_out: Tuple[str, ...]) -> None:
        self._parts = parts
        self._required = required
        self._leave_out = leave_out
        # A table may hold an old and a new name of one field; the first is written.
        self._written: Set[Tuple[int, str]] = set()

    def fill(self, element: Any, source: Any, of: Any, children: Mapping[str, Entry],
             attributes: Mapping[str, Value], path: str) -> None:
        for name, value in attributes.items():
            text = self._text(value, source, of, f"{path}@{name}")
            if text is not None:
                element.set(name, text)
        for name, entry in children.items():
            here = f"{path}{name}"
            if isinstance(entry, Value):
                self._value(element, source, of, name, entry, here)
            elif isinstance(entry, Group):
                self._group(element, source, of, name, entry, here)
            elif isinstance(entry, Nested):
                _write_nested(element, source, of, name, entry)
            elif isinstance(entry, Part) and here in self._parts:
                self._parts[here](element)
            else:
                assert isinstance(entry, (Part, Kept))

    def _group(self, element: Any, source: Any, of: Any, name: str, entry: Group,
               path: str) -> None:
        inner = getattr(source, entry.part) if entry.part else source
        inner_of = type(inner) if entry.part else of
        if entry.part and inner == usual_value(of, entry.part) and not self._has_more(path):
            return
        child = etree.SubElement(element, name)
        self.fill(child, inner, inner_of, entry.children, entry.attributes, f"{path}/")
        if not len(child) and not child.attrib:
            element.remove(child)

    def _has_more(self, path: str) -> bool:
        """Return whether a required value or a part is below a path; defaults do not show it."""
        return any(each.startswith(f"{path}/") for each in (*self._required, *self._parts))

    def _value(self, element: Any, source: Any, of: Any, name: str, value: Value,
               path: str) -> None:
        if value.repeated:
            for item in getattr(source, value.field) if self._first(value, source) else ():
                write_value(element, name, value.kind, item)
            return
        text = self._text(value, source, of, path)
        if text is not None:
            write_value(element, name, value.kind, text=text)

    def _text(self, value: Value, source: Any, of: Any, path: str) -> Optional[str]:
        """The text of a value; None if it need not be written."""
        owner, kind = source, of
        if value.part:
            owner = getattr(source, value.part)
            kind = type(owner)
        now = getattr(owner, value.field)
        if now is None or (now == usual_value(kind, value.field) and path not in self._required):
            return None
        if path in self._leave_out or not self._first(value, source):
            return None
        return value.kind.format(now)

    def _first(self, value: Value, source: Any) -> bool:
        owner = getattr(source, value.part) if value.part else source
        key = (id(owner), value.field)
        if key in self._written:
            return False
        self._written.add(key)
        return True
