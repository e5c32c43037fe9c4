"""Reads the XML text of an object from its file.

The text is not parsed here: the simulator checks the XML, can repair more, and reports line and
column.
"""
from __future__ import annotations

import re

from ..errors import InputError, error

_DECLARATION = re.compile(rb"\A\s*<\?xml[^>]*?encoding\s*=\s*[\"']([A-Za-z0-9._-]+)[\"'][^>]*\?>")
_PROLOGUE = re.compile(r"\s+|<\?.*?\?>|<!--.*?-->|<!DOCTYPE(?:[^\[>]|\[[^\]]*\])*>", re.S)
_START_TAG = re.compile(r"<[A-Za-z_][\w.:-]*")


def read_document(file: str) -> str:
    """The text of an XML file, decoded as declared, else as UTF-8.

    Raises InputError: the file is missing, unreadable, empty, or not in the declared encoding.
    """
    try:
        with open(file, "rb") as stream:
            raw = stream.read()
    except OSError as fault:
        raise InputError([error("object-unreadable",
                                f"cannot read the file of the object: {fault.strerror}",
                                file=file)]) from fault
    if not raw.strip():
        raise InputError([error("object-empty", "the file of the object is empty", file=file)])
    return decoded(raw, file)


def decoded(raw: bytes, file: str) -> str:
    """The text of an XML document, decoded as declared, else as UTF-8.

    Args:
        raw: the document.
        file: its file, or where else it comes from, for messages.

    Raises:
        InputError: it is not in the declared encoding.
    """
    declared = _DECLARATION.match(raw)
    encoding = declared.group(1).decode("ascii") if declared else "utf-8"
    try:
        text = raw.decode("utf-8-sig" if encoding.lower() in ("utf-8", "utf8") else encoding)
    except (UnicodeError, LookupError) as fault:
        raise InputError([error("object-encoding", f"this is not {encoding} text: {fault}",
                                file=file, hint="save it as UTF-8")]) from fault
    if declared and encoding.lower() not in ("utf-8", "utf8"):
        # The service message is UTF-8, so the declared encoding would be wrong.
        text = re.sub(r"\A(\s*<\?xml[^>]*?)\s+encoding\s*=\s*[\"'][^\"']*[\"']", r"\1", text)
    return text


def root_tag(xml: str) -> str:
    """The name of the root element; "" if there is none."""
    start = _root_start(xml)
    found = _START_TAG.match(xml, start)
    return found.group(0)[1:] if found else ""


def _root_start(xml: str) -> int:
    at = 1 if xml.startswith("\ufeff") else 0
    while True:
        found = _PROLOGUE.match(xml, at)
        if not found or found.end() == at:
            return at
        at = found.end()
