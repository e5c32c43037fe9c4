"""Characters that XML or file names cannot hold, found before a world is saved with them.

Source: XML 1.0 (fifth edition), section 2.2, production Char.
"""
from __future__ import annotations

import re
from typing import Any, Iterator, Tuple

from .errors import CommandError

_FORBIDDEN = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")

_NOT_SHOWN = re.compile("[\0-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
"""Control characters, ends of lines, and characters that change the direction of a text."""


def forbidden_character(text: str) -> str:
    """The first character of a text that XML cannot hold, e.g. `U+0001 at position 4`; "" for none.

    Positions are counted from 1.
    """
    return _first(_FORBIDDEN, text)


def without_forbidden(text: str) -> str:
    """The text with a blank for each character that XML cannot hold."""
    return _FORBIDDEN.sub(" ", text)


def check_characters(text: str, what: str) -> str:
    """The text itself; `what` names it in the message.

    Raises CommandError: it contains a character that XML cannot hold.
    """
    found = forbidden_character(text)
    if found:
        raise CommandError(f"{what} contains the character {found}, which an XML file cannot hold")
    return text


def check_file_name(name: str) -> None:
    """Refuse a file name that is not shown as it is: with line ends or changes of direction.

    Raises CommandError: it contains such a character.
    """
    found = hidden_character(name)
    if found:
        raise CommandError(f"the file name contains the character {found}, which is not shown")


def hidden_character(text: str) -> str:
    """The first character of a text that is not shown, e.g. `U+202E at position 4`; "" for none.

    Positions are counted from 1.
    """
    return _first(_NOT_SHOWN, text)


def without_hidden(text: str) -> str:
    """The text with a blank for each character that is not shown."""
    return _NOT_SHOWN.sub(" ", text)


def _first(pattern: "re.Pattern[str]", text: str) -> str:
    found = pattern.search(text)
    return f"U+{ord(found.group()):04X} at position {found.start() + 1}" if found else ""


def check_tree(tree: Any, what: str) -> None:
    """As `check_characters`, for all texts in lists and dictionaries (JSON), keys included."""
    for path, text in _texts(tree, what):
        check_characters(text, path)


def _texts(tree: Any, what: str) -> Iterator[Tuple[str, str]]:
    """Each text with its path; without recursion, since a tree may be deep."""
    waiting = [(what, tree)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, str):
            yield path, value
        elif isinstance(value, dict):
            for key, item in value.items():
                yield f"a key of {path}", str(key)
                waiting.append((f"{path}.{key}", item))
        elif isinstance(value, (list, tuple)):
            waiting += [(f"{path}[{n}]", item) for n, item in enumerate(value)]
