"""Text of files whose encoding nothing tells."""
from __future__ import annotations


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
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
