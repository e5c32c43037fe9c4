"""Inserts missing end tags and removes stray ones.

A mismatched end tag closes all elements that are open inside the element it names; one that names
no open element is removed. The recovery of libxml2 closes the innermost element regardless of the
name, which nests everything that follows one level too deep.
"""
from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import List, Tuple

_STOP = re.compile(r"""["'>]""")
_NAME = re.compile(r"[A-Za-z_:À-￿][^\s/>\"'<=]*")
_ATTRIBUTE = re.compile(r"""([A-Za-z_:][\w:.-]*)\s*=\s*("[^"]*"|'[^']*'|[^\s"'=]+)""")
MAX_DEPTH = 200
MOST_ATTRIBUTES = 1000
"""Most repairs of a document: parsing time grows with their square."""

_MAX_REPAIRS = 200
_SKIP = (("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">"))


@dataclass(frozen=True)
class Repair:
    """One change of the text.

    Attributes:
        unclosed: whether an end tag was missing.
        stray: whether an end tag closed nothing, such as one with a wrong name.
    """

    message: str
    line: int
    column: int
    unclosed: bool
    stray: bool = False


@dataclass
class Balanced:
    """A text with matching tags.

    Attributes:
        text: the repaired text; line numbers are those of the original.
        elements: number of start tags.
        is_unrepairable: why repairing was given up; "" if it was not.
        repairs: the changes.
        cut_off: the part missing at the end of a truncated text; "" if it is complete.
        cut_off_line: line where the incomplete part begins.
    """

    text: str = ""
    elements: int = 0
    is_unrepairable: str = ""
    repairs: List[Repair] = field(default_factory=list)
    cut_off: str = ""
    cut_off_line: int = 0


def balance_tags(text: str) -> Balanced:
    """Add and remove tags of `text` until all match, in linear time."""
    return _Balancer(text).run()


class _Balancer:
    def __init__(self, text: str) -> None:
        self._text = text
        self._result = Balanced()
        self._parts: List[str] = []
        self._kept = 0  # everything before it is in _parts
        self._open: List[Tuple[str, int]] = []  # (name, position)
        self._strays = 0

    def run(self) -> Balanced:
        text, result = self._text, self._result
        at = text.find("<")
        if text[:max(at, 0)].strip():
            self._parts.append("\n" * text.count("\n", 0, at))
            self._kept = at
            self._repair("what precedes the first element is ignored", 0)
        while at >= 0 and not result.cut_off and not result.is_unrepairable:
            after = self._handle_markup(at)
            if result.elements and not self._open:
                self._drop_rest(after)
                break
            at = text.find("<", after)
        if not result.cut_off and self._open:
            name, position = self._open[-1]
            self._cut_off(f"<{name}> is never closed", position)
        self._parts.append(self._text[self._kept:])
        result.text = "".join(self._parts)
        return result

    def _drop_rest(self, after: int) -> None:
        rest = self._text[after:]
        self._text = self._text[:after]
        if rest.strip("\0 \t\r\n") and not rest.lstrip().startswith("<!--"):
            self._repair("what follows the root element is ignored", after)

    def _handle_markup(self, at: int) -> int:
        """Handle the markup at position `at`; returns the position after it."""
        text = self._text
        for start, stop in _SKIP:
            if text.startswith(start, at):
                end = self._doctype_end(at) if start == "<!" else text.find(stop, at + len(start))
                if end < 0:
                    self._cut_off(f"{start} has no {stop}", at)
                    return len(text)
                return end + len(stop)
        if text.startswith("</", at):
            return self._end_tag(at)
        name = _NAME.match(text, at + 1)
        if name is None:
            self._strays += 1  # reported by libxml2
            if self._strays > _MAX_REPAIRS:
                self._result.is_unrepairable = f"more than {_MAX_REPAIRS} mistakes in its markup"
            return at + 1
        return self._start_tag(name.group(), at, name.end())

    def _doctype_end(self, at: int) -> int:
        bracket = self._text.find("[", at)
        close = self._text.find(">", at)
        if 0 <= bracket < close:
            inside = self._text.find("]", bracket)
            return self._text.find(">", inside) if inside >= 0 else -1
        return close

    def _start_tag(self, name: str, at: int, position: int) -> int:
        end = self._tag_end(position)
        if end < 0:
            self._cut_off(f"<{name} has no >", at)
            return len(self._text)
        self._result.elements += 1
        self._quote(at, position, end)
        if self._text[end - 1] != "/":
            self._open.append((name, at))
            if len(self._open) > MAX_DEPTH:
                self._result.is_unrepairable = "elements are nested too deeply"
        return end + 1

    def _quote(self, at: int, position: int, end: int) -> None:
        """Insert missing quotes and spaces of attributes."""
        inside = self._text[position:end]
        found = list(_ATTRIBUTE.finditer(inside))
        if len(found) > MOST_ATTRIBUTES:
            self._result.is_unrepairable = f"an element has more than {MOST_ATTRIBUTES} attributes"
            return
        bare = [a for a in found if a.group(2)[0] not in "\"'"]
        tight = [a for a in found if a.start() and not inside[a.start() - 1].isspace()]
        if not bare and not tight:
            return
        parts, last = [], 0
        for attribute in found:
            value = attribute.group(2)
            slash = value.endswith("/") and attribute.end() == len(inside)
            quoted = value if value[0] in "\"'" else '"' + (value[:-1] if slash else value) + '"'
            parts += [inside[last:attribute.start()], " ", attribute.group(1), "=", quoted]
            parts += ["/"] if slash and value[0] not in "\"'" else []
            last = attribute.end()
        self._parts += [self._text[self._kept:position], *parts, inside[last:]]
        self._kept = end
        lacking = "quotes" if bare else "blank before it"
        name = (bare or tight)[0].group(1)
        self._repair(f"attribute {name} has no {lacking}", at)

    def _tag_end(self, position: int) -> int:
        """Position of the `>` of a start tag: the first one outside quotes."""
        text = self._text
        first = text.find(">", position)
        while True:
            stop = _STOP.search(text, position)
            if stop is None:
                return first
            if stop.group() == ">":
                return stop.start()
            closing = text.find(stop.group(), stop.end())
            # A value cannot contain `<`: its quote was not closed.
            if closing < 0 or "<" in text[stop.end():closing]:
                return first
            position = closing + 1

    def _end_tag(self, at: int) -> int:
        text = self._text
        end = text.find(">", at)
        if end < 0 or text.find("<", at + 1, end) >= 0:
            self._cut_off(f"{text[at:at + 20]!r} has no >", at)
            return len(text)
        name = text[at + 2:end].strip()
        if self._open and self._open[-1][0] == name:
            self._open.pop()
        elif any(name == opened for opened, _ in reversed(self._open)):
            self._close_down_to(name, at)
        else:
            self._repair(f"</{name}> closes nothing", at, stray=True)
            self._parts.append(text[self._kept:at])
            # Line breaks are kept, so that line numbers stay correct.
            self._parts.append("\n" * text.count("\n", at, end))
            self._kept = end + 1
        return end + 1

    def _close_down_to(self, name: str, at: int) -> None:
        self._parts.append(self._text[self._kept:at])
        self._kept = at
        while self._open[-1][0] != name:
            inner, position = self._open.pop()
            self._repair(f"<{inner}> is never closed", position, unclosed=True)
            self._parts.append(f"</{inner}>")
        self._open.pop()

    def _repair(self, message: str, at: int, unclosed: bool = False, stray: bool = False
                ) -> None:
        line, column = self._place(at)
        self._result.repairs.append(Repair(message, line, column, unclosed, stray))
        if len(self._result.repairs) > _MAX_REPAIRS:
            self._result.is_unrepairable = f"more than {_MAX_REPAIRS} mistakes in its markup"

    def _cut_off(self, message: str, at: int) -> None:
        self._result.cut_off = message
        self._result.cut_off_line = self._place(at)[0]

    def _place(self, at: int) -> Tuple[int, int]:
        return self._text.count("\n", 0, at) + 1, at - (self._text.rfind("\n", 0, at) + 1) + 1
