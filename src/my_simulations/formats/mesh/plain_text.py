"""Text of files whose encoding nothing tells, and the numbers in its lines."""
from __future__ import annotations

from typing import Iterator, List, Tuple

from .part import MeshError


def text_of(data: bytes) -> str:
    """The text of a file, with one kind of line end.

    UTF-8 where it is that, else Latin-1, in which every byte is a character.
    """
    plain = with_newlines(data)
    try:
        return plain.decode("utf-8")
    except UnicodeDecodeError:
        return plain.decode("latin-1")


def with_newlines(data: bytes) -> bytes:
    """The file with one kind of line end, in whatever encoding it is."""
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def numbered_lines(text: str, continued: bool = False) -> Iterator[Tuple[int, str]]:
    """Line number, from 1, and text of each line that is not empty, one after the other.

    If `continued`, lines that end with a backslash are one with the next one, under the number of
    the first.
    """
    start, line = 0, 0
    begun: List[str] = []
    while start <= len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        row = text[start:end]
        start, line = end + 1, line + 1
        if continued and row.endswith("\\") and end < len(text):
            begun.append(row[:-1])
        elif begun:
            yield line - len(begun), " ".join((*begun, row))
            begun = []
        elif row:
            yield line, row


def three_numbers(words: List[str], line: int) -> Tuple[float, float, float]:
    """The three numbers that a line must have. Raises MeshError."""
    try:
        x, y, z = (float(word) for word in words)
    except ValueError:
        raise MeshError(f"expected 3 numbers, found {' '.join(words)!r}", line) from None
    return x, y, z
