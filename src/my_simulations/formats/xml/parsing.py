"""Parses XML: repairs common mistakes, and rejects documents that could exhaust the process.

Many model files are not well formed, and Gazebo's reader is lenient. Documents that can be
repaired without guessing content are read with a warning; truncated ones are errors. Entities are
not expanded, DTDs not loaded, the network is not used, and the depth is limited.
"""
from __future__ import annotations

import functools
import os
import re
from typing import Any, Union

from ...errors import InputError, error
from ...resources.lfs_pointer import LFS_HINT, LFS_POINTER, is_lfs_pointer
from ...resources.limited_file import at_most
from ...xml_characters import forbidden_character, without_forbidden
from .source import IssueCollector

_DECLARATION = re.compile(rb"<\?xml\b[^>]*\?>")
_ENCODING = re.compile(rb"""<\?xml[^>]*\bencoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
_BOMS = (
    (b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\x00\x00\xfe\xff", "utf-32"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"),
)
LARGEST = 64 << 20
"""Largest size of a document, bytes."""

STRAY_END_TAG = "xml-end-tag"
"""Code of the warning about an end tag that closes nothing."""

_MOST_TAGS = 2000000
_COMMENT = re.compile("<!--.*?-->", re.DOTALL)
_LONG_TAG = re.compile(rb"<[^<]{8000,}")


def read_content(path: str) -> bytes:
    """Read a document's file of at most `LARGEST` bytes.

    Raises:
        InputError: it is too large.
        OSError: it cannot be read.
    """
    with open(path, "rb") as stream:
        if os.fstat(stream.fileno()).st_size > LARGEST:
            raise _too_large(path)
        return at_most(stream, LARGEST)  # a pipe has no size; `parse` looks again


def parse(text: Union[str, bytes], file: str, log: IssueCollector) -> Any:
    """Parse a document and return its root element.

    Args:
        text: the document; a `str` may carry any encoding declaration.
        file: name of the document in issues.
        log: receives warnings about repairs.

    Raises:
        InputError: unusable: empty, truncated, without an element, with entities, or too deep.
    """
    from lxml import etree

    if len(text) > LARGEST:
        raise _too_large(file)
    data = _encode_text(text, file) if isinstance(text, str) else text
    if len(data) > LARGEST:
        raise _too_large(file)
    if is_lfs_pointer(data):
        raise _fault("git-lfs-pointer", LFS_POINTER, file, hint=LFS_HINT)
    if not data.strip(b" \t\r\n\0"):
        raise _fault("xml-empty", "the document is empty", file)
    _refuse_entities(data, file)
    _refuse_masses(data, file)
    try:
        root = etree.fromstring(
            _declaration_first(data), _parser("utf-8" if isinstance(text, str) else "", False)
        )
        if b"\xe2\x80\xb9" in data:  # a single guillemet, in UTF-8
            root = _replace_typographic_characters(data, root, file, log)
    except etree.XMLSyntaxError as fault:
        root = _recover(_decode_text(data, isinstance(text, str), file, log), fault, file, log)
    if root is None:
        raise _fault("xml-no-root", "the document contains no element", file)
    return root


def _fault(code: str, message: str, file: str, line: int = 0, column: int = 0,
           hint: str = "") -> InputError:
    return InputError([error(code, message, file=file, line=line, column=column, hint=hint)])


def _encode_text(text: str, file: str) -> bytes:
    try:
        return text.encode("utf-8")
    except UnicodeEncodeError:  # a surrogate without its other half
        _refuse_bad_characters(text, file)
        raise


def _without_bad_characters(text: str, file: str, log: IssueCollector) -> str:
    """The text, without what XML cannot hold where that is in comments or behind the end.

    Raises InputError where it is elsewhere.
    """
    from ...errors import warning

    text = text.rstrip("\0 \t\r\n")
    if not forbidden_character(text):
        return text
    plain = _COMMENT.sub(lambda found: without_forbidden(found.group()), text)
    _refuse_bad_characters(plain, file)
    log.add(warning("xml-malformed", "not well formed: a comment contains a character that XML "
                    "cannot hold", file=file, tolerated=True))
    return plain


def _refuse_bad_characters(text: str, file: str) -> None:
    bad = forbidden_character(text)
    if bad:
        before = text[:int(bad.rpartition(" ")[2]) - 1]
        raise _fault("xml-malformed", f"not well formed: the character {bad.split()[0]}, which an "
                     "XML file cannot hold", file, before.count("\n") + 1,
                     len(before) - before.rfind("\n"))


def _too_large(file: str) -> InputError:
    return _fault("xml-too-large", f"the document is larger than {LARGEST >> 20} MB", file)


def _refuse_entities(data: bytes, file: str) -> None:
    plain = data.replace(b"\0", b"") if b"\0" in data[:400] else data
    if b"<!ENTITY" in plain and b"<!DOCTYPE" in plain:
        line = plain[: plain.index(b"<!ENTITY")].count(b"\n") + 1
        raise _fault(
            "xml-entities", "the document declares entities, which are not read", file, line,
            hint="write the text out instead",
        )


def _refuse_masses(data: bytes, file: str) -> None:
    """Reject documents that would exhaust memory or take the parser minutes."""
    from .repair import MOST_ATTRIBUTES

    if data.count(b"<") > _MOST_TAGS:
        raise _fault("xml-too-large", f"the document contains more than {_MOST_TAGS} tags", file)
    for found in _LONG_TAG.finditer(data):
        tag = found.group().split(b">", 1)[0]
        if tag.count(b"=") > MOST_ATTRIBUTES:
            line = data.count(b"\n", 0, found.start()) + 1
            raise _fault("xml-too-large", f"an element has more than {MOST_ATTRIBUTES} attributes",
                         file, line)


def _declaration_first(data: bytes) -> bytes:
    """Move the XML declaration to the front; line numbers are kept."""
    if data[:5] == b"<?xml" or data[:2] in (b"\xff\xfe", b"\xfe\xff") or data[:1] == b"\0":
        return data
    start = 3 if data[:3] == b"\xef\xbb\xbf" else 0
    found = _DECLARATION.search(data, start, start + 20000)
    if found is None or found.start() == start:
        return data
    before = data[start:found.start()]
    if before.strip() and not before.lstrip().startswith(b"<!--"):
        return data
    return found.group() + before + data[found.end():]


@functools.lru_cache(maxsize=4)
def _parser(encoding: str, recover: bool) -> Any:
    from lxml import etree

    return etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False,
        huge_tree=False, remove_comments=True, remove_pis=True, recover=recover,
        encoding=encoding or None,
    )


def _decode_text(data: bytes, was_text: bool, file: str, log: IssueCollector) -> str:
    if was_text:
        return data.decode("utf-8")
    encoding = next((name for mark, name in _BOMS if data.startswith(mark)), "")
    if not encoding:
        declared = _ENCODING.search(data[:2000])
        encoding = declared.group(1).decode("ascii") if declared else "utf-8"
        if encoding.lower().startswith(("utf-16", "utf-32")):  # the declaration itself is not
            encoding = "utf-8"
    try:
        return data.decode(encoding).lstrip("\ufeff")
    except (UnicodeError, LookupError) as fault:
        from ...errors import warning

        at = fault.start if isinstance(fault, UnicodeDecodeError) else 0
        log.add(warning("xml-encoding", f"the text is not {encoding}; read as Latin-1", file=file,
                        line=data.count(b"\n", 0, at) + 1))
        return data.decode("latin-1")


def _replace_typographic_characters(data: bytes, root: Any, file: str, log: IssueCollector) -> Any:
    """The root of a well-formed document, after replacing typographic brackets if it has any."""
    from lxml import etree

    from .typography import is_suspicious

    text = data.decode("utf-8", "replace")
    if not is_suspicious(text):
        return root
    return _recover(text, etree.XMLSyntaxError("text in ‹›", 0, 1, 1), file, log)


def _recover(text: str, fault: Any, file: str, log: IssueCollector) -> Any:
    """Parse again with balanced tags; raises InputError for a truncated document."""
    from lxml import etree

    from ...errors import warning
    from .repair import balance_tags
    from .typography import replace_typography  # rarely needed, and start-up time counts

    line, column = fault.position
    if "Excessive depth" in fault.msg:
        raise _fault("xml-too-deep", "elements are nested too deeply", file, line, column)
    text = _without_bad_characters(text, file, log)
    text, retypings = replace_typography(text)
    result = balance_tags(text)
    result.repairs[:0] = retypings
    if result.is_unrepairable:
        raise _fault("xml-malformed", f"not well formed: {result.is_unrepairable}", file, line,
                     column)
    if result.elements == 0:
        raise _fault("xml-no-root", "the document contains no element", file, line, column)
    if result.cut_off:
        raise _fault(
            "xml-truncated", f"the document is cut off: {result.cut_off}", file,
            result.cut_off_line, hint="the end of the file is missing",
        )
    parser = _parser("utf-8", True)
    # The declaration may name another or an unknown encoding; the text is UTF-8 by now.
    plain = _DECLARATION.sub(_only_lines, result.text.encode("utf-8", "replace"), 1)
    try:
        root = etree.fromstring(plain.lstrip(b" \t\r"), parser)
    except etree.XMLSyntaxError:
        raise _fault("xml-malformed", f"not well formed: {fault.msg}", file, line, column) from None
    faults = [
        entry for entry in parser.error_log
        if entry.domain_name != "NAMESPACE" and entry.level_name != "WARNING"
    ]
    if root is None or sum(1 for _ in root.iter()) < result.elements:
        message = faults[-1].message if faults else fault.msg
        raise _fault("xml-malformed", f"not well formed: {message}", file, line, column)
    for repair in result.repairs:
        log.add(warning(STRAY_END_TAG if repair.stray else "xml-malformed", repair.message,
                        file=file, line=repair.line, column=repair.column, tolerated=True,
                        hint="read as if it were closed there" if repair.unclosed else ""))
    if faults:
        first = faults[0]
        more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
        log.add(warning("xml-malformed", f"not well formed: {first.message}{more}", file=file,
                        line=first.line, column=first.column, tolerated=True))
    return root


def _only_lines(found: Any) -> bytes:
    return b"\n" * int(found.group().count(b"\n"))
