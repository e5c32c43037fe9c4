"""Replaces typographic characters that word processors and PDF viewers put into XML.

Listings copied from documents often contain dashes, quotes and angle brackets that XML does not
accept.
"""
from __future__ import annotations

import re
from typing import Callable, List, Match, Tuple

from .repair import Repair

_OPENING = re.compile("‹[/!?A-Za-z][^‹›]*›")
_BRACKET = re.compile("[‹›]")
_COMMENT = re.compile("<!\\s*([–—]+|-(?!-))(.*?)(-->|[–—]>|->)", re.S)
_QUOTED = re.compile("(=\\s*)[“”„‟″]([^“”„‟″<>\"]*)[“”„‟″]|(=\\s*)[‘’‚‛′]([^‘’‚‛′<>']*)[‘’‚‛′]")


def is_suspicious(text: str) -> bool:
    """Whether a well-formed text contains typographic angle brackets."""
    return "‹" in text and _OPENING.search(text) is not None


def replace_typography(text: str) -> Tuple[str, List[Repair]]:
    """Replace typographic brackets, dashes and quotes; return the text and the repairs."""
    repairs: List[Repair] = []
    if is_suspicious(text):
        text = _replace(text, _BRACKET, lambda found: "<" if found.group() == "‹" else ">",
                        "‹ and › stand here for < and >", repairs)
    text = _replace(text, _COMMENT, lambda found: "\n" * found.group().count("\n"),
                    "a comment begins with <!-- and ends with -->, with two hyphens each", repairs)
    text = _replace(text, _QUOTED, lambda found: f'{found.group(1) or found.group(3)}"'
                    f'{found.group(2) or found.group(4) or ""}"',
                    "the quotes of an attribute are typographic ones, not \"", repairs)
    return text, repairs


def _replace(text: str, what: "re.Pattern[str]", becomes: Callable[[Match[str]], str],
             message: str, repairs: List[Repair]) -> str:
    first = what.search(text)
    if first is None:
        return text
    changed, count = what.subn(becomes, text)
    more = f" (and {count - 1} more)" if count > 1 else ""
    at = first.start()
    repairs.append(Repair(message + more, text.count("\n", 0, at) + 1,
                          at - text.rfind("\n", 0, at), unclosed=False))
    return changed
