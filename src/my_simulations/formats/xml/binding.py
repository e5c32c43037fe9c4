"""Fills dataclasses from elements, by their tables (`tables`)."""
from __future__ import annotations

import math
import re
from typing import Any, Dict, List, Mapping, Optional, Set, Tuple, Union

from ...description.validate import closest_name_hint
from .source import FaultLevel, Source
from .tables import Entry, Group, Kept, Nested, Part, Table, Value
from .values import LIMIT, UNSET, Kind

Found = Dict[str, List[Any]]
"""Elements that have their own readers, by tag, in the order of the file."""

BAD = "(bad)"
"""Key in `Found` of the elements with an unreadable value."""


def fill(target: Any, element: Any, table: Table, source: Source, extra: List[str],
         level: Optional[FaultLevel] = None) -> Found:
    """Fill `target` from `element` by `table`.

    Args:
        target: an instance of the table's dataclass.
        element: lxml element.
        table: the table of the element.
        source: receives faults.
        extra: receives the XML of children that are kept or unknown.
        level: fault level of unreadable values; None for that of the table.

    Returns:
        The children that have their own readers, poses with attributes, and under `BAD` the
        elements with an unreadable value.
    """
    found: Found = {}
    _Filler(table, source, extra, found, level).fill(
        target, element, table.children, table.attributes, table.known_attributes, ()
    )
    return found


def set_value(target: Any, value: Value, text: str, element: Any, name: str, source: Source,
              level: FaultLevel, strict: bool = False) -> bool:
    """Set a field from text; an empty or unset text changes nothing.

    Args:
        target: the object with the field.
        value: the field and its kind.
        text: the text to read.
        element: the element that has it, for issues.
        name: the tag or `@attribute`, for issues.
        source: receives faults.
        level: fault level of an unreadable text.
        strict: reject a text that is only partly a value.

    Returns:
        False if the text is unreadable; the field is unchanged.
    """
    text = text.strip()
    if not text or text == UNSET:
        return True
    if value.part:
        target = getattr(target, value.part)
    shown = f"attribute {name[1:]} of <{element.tag}>" if name[0] == "@" else f"<{name}>"
    parsed = read_text(value.kind, text, shown, element, source, level, strict)
    if parsed is REFUSED:
        return False
    if parsed is DEFAULT:
        return True
    if value.repeated:
        getattr(target, value.field).append(parsed)
    else:
        setattr(target, value.field, parsed)
    return True


REFUSED, DEFAULT = object(), object()
"""Results of `read_text` for an unreadable text, and for an unusable value that the default
replaces."""


def read_text(kind: Kind, text: str, shown: str, element: Any, source: Source, level: FaultLevel,
              strict: bool = False) -> Any:
    """The value of a text, `REFUSED` or `DEFAULT`.

    Args:
        kind: kind of value.
        text: the text to read.
        shown: name of the element or attribute in issues.
        element: the element that has it, for issues.
        source: receives faults.
        level: fault level of an unreadable text.
        strict: reject a text that is only partly a value.
    """
    try:
        return kind.parse(text)
    except ValueError as refusal:
        fault = refusal
    hint = "the text is xacro; expand it with the xacro command first" if "${" in text else ""
    try:
        if strict:
            raise fault
        value = kind.parse_leniently(text)
    except ValueError:
        source.report(level, "bad-value", f"{shown}: {fault}", element, hint)
        return REFUSED
    endless = isinstance(value, float) and not math.isfinite(value)
    if endless and (kind is not LIMIT or value != value):
        source.tolerate("value-not-finite", f"{shown}: {fault}; its default is used", element)
        return DEFAULT
    source.tolerate("value-odd", f"{shown}: {fault}; read as {kind.format(value)!r}, as Gazebo"
                    " reads it", element, hint)
    return value


_MOST_UNKNOWN = 500
"""Most unknown names reported one by one; a document with more is of another kind."""


class _Filler:
    __slots__ = ("_table", "_source", "_extra", "_found", "_level")

    def __init__(self, table: Table, source: Source, extra: List[str], found: Found,
                 level: Optional[FaultLevel]) -> None:
        self._level = level
        self._table = table
        self._source = source
        self._extra = extra
        self._found = found

    def fill(self, target: Any, element: Any, children: Mapping[str, Entry],
             attributes: Mapping[str, Value], more: Tuple[str, ...], wrap: Tuple[str, ...]) -> None:
        self._attributes(target, element, attributes, more)
        seen: Set[str] = set()
        for child in element:
            tag = child.tag
            entry = children.get(tag)
            if tag in seen:
                self._report_repeated(child, element)
            elif entry.__class__ is Value:
                if not entry.repeated:  # type: ignore[union-attr]
                    seen.add(tag)
                self._set(target, entry, child.text or "", child, tag)  # type: ignore[arg-type]
                if tag == "pose" and child.attrib:
                    self._found.setdefault("pose", []).append(child)
            elif entry.__class__ is Group:
                assert isinstance(entry, Group)
                seen.add(tag)
                inner = getattr(target, entry.part) if entry.part else target
                self.fill(inner, child, entry.children, entry.attributes, (), (*wrap, tag))
            elif isinstance(entry, Nested):
                self._bind_nested(target, child, entry, seen)
            elif entry is not None:
                self._keep_or_delegate(child, entry, wrap)  # type: ignore[arg-type]
            elif isinstance(tag, str):
                self._unknown_child(child, children, wrap)

    def _attributes(self, target: Any, element: Any, attributes: Mapping[str, Value],
                    more: Tuple[str, ...]) -> None:
        for name, text in element.items():
            known = attributes.get(name)
            if known is not None:
                self._set(target, known, text, element, f"@{name}")
            elif name not in more and ":" not in name and name[0] != "{":
                self._unknown(name, element, [*attributes, *more], is_attribute=True)

    def _bind_nested(self, target: Any, child: Any, entry: Nested, seen: Set[str]) -> None:
        """Fill the object of a child; adds its tag to `seen` if there can be one only."""
        inner = getattr(target, entry.field)
        repeated = isinstance(inner, list)
        if inner is None or repeated:
            inner = entry.table.of()
        fill(inner, child, entry.table, self._source, inner.extra)
        if repeated:
            getattr(target, entry.field).append(inner)
        else:
            setattr(target, entry.field, inner)
            seen.add(child.tag)
        if entry.reported:
            self._source.report_unused(child)

    def _unknown_child(self, child: Any, known: Mapping[str, Entry], wrap: Tuple[str, ...]) -> None:
        tag = child.tag
        self._extra.append(to_xml(child, wrap))
        if ":" not in tag and tag[0] != "{":
            self._unknown(tag, child, list(known))

    def _report_repeated(self, child: Any, parent: Any) -> None:
        """Report a repeated element; Gazebo reads the first of a name only."""
        self._source.tolerate("element-repeated", f"<{child.tag}> is repeated in"
                              f" <{parent.tag}>; the first one is used", child)

    def _keep_or_delegate(self, child: Any, entry: Union[Part, Kept],
                          wrap: Tuple[str, ...]) -> None:
        """Handle a child that has its own reader, or is kept, or both."""
        if isinstance(entry, Part):
            self._found.setdefault(child.tag, []).append(child)
        if isinstance(entry, Kept) or entry.kept:
            self._extra.append(to_xml(child, wrap))
        if entry.reported:
            self._source.report_unused(child)

    def _set(self, target: Any, value: Value, text: str, element: Any, name: str) -> None:
        level = self._level or value.level or self._table.level
        if not set_value(target, value, text, element, name, self._source, level,
                         self._table.strict):
            self._found.setdefault(BAD, []).append(element)

    def _unknown(self, name: str, element: Any, known: List[str],
                 is_attribute: bool = False) -> None:
        log = self._source.log
        log.unknown += 1
        if log.unknown > _MOST_UNKNOWN:
            if log.unknown == _MOST_UNKNOWN + 1:
                self._source.warn("unknown-many", "more unknown elements and attributes follow;"
                                  " they are not listed", element)
            return
        parent = element if is_attribute else element.getparent()
        inside = parent.tag if parent is not None else self._table.name
        hint = closest_name_hint(name, known)
        if not is_attribute:
            hint = hint or self._table.hint.format(name=name)
        what = f"attribute {name}" if is_attribute else f"element <{name}>"
        self._source.warn("unknown-attribute" if is_attribute else "unknown-element",
                          f"{what} is unknown in <{inside}>; it is kept without effect", element,
                          hint)


def has_prefix(xml: str) -> bool:
    """Return whether kept XML is an element with a namespace prefix."""
    return re.match(r"<[A-Za-z_][\w.-]*:[A-Za-z_]", xml) is not None


def to_xml(element: Any, wrap: Tuple[str, ...] = ()) -> str:
    """The element as text, inside the elements named by `wrap` (outermost first)."""
    from lxml import etree

    text: str = etree.tostring(element, encoding="unicode", with_tail=False)
    for tag in reversed(wrap):
        text = f"<{tag}>{text}</{tag}>"
    return text
