"""doc/messages.md lists every text that users meet, in the words of the house."""
from __future__ import annotations

import pathlib
import re
import sys

import pytest

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(REPOSITORY / "tools" / "generate"))

from messages import PAGE, page

TEXTS = page()

RIDDLES = {
    "internal fault": "internal error", "remark": "warnings, see log",
    "stand still": "pause", "stands still": "is paused", "time stood still": "did not advance",
    "again and again": "repeatedly", "come back": "did not restart within N s",
    "started anew": "restart", "put back": "restored", "no sign of life": "did not respond",
    "steps were not made": "not executed", "nobody hears": "sent to subscribers only",
    "at random": "random seed", "left out, no joints": "skipped unknown or non-settable joints",
    "nothing happens": "ignored: duration is 0", "which do nothing": "ignored",
    "there is a model '": "a model named 'x' already exists",
}
"""Phrases that no user should have to guess at, and what is said instead."""


def test_the_page_of_messages_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == TEXTS, "run tools/generate/messages.py"


def test_the_page_lists_messages_of_every_kind():
    for text in ("- Successfully spawned entity", "- wrench set[; ignored: duration is 0]",
                 "- joint not found", "node is shutting down; {left} steps not executed",
                 "- random seed (default 0)", "| `mesh-not-found` |"):
        assert any(line.startswith(text) or text in line for line in TEXTS.splitlines()), text


@pytest.mark.parametrize("phrase", RIDDLES)
def test_messages_use_plain_terms(phrase):
    found = [line for line in TEXTS.splitlines() if phrase in line.lower()]
    assert found == [], f"write: {RIDDLES[phrase]}"


def test_status_messages_of_services_have_no_final_full_stop():
    start = TEXTS.index("## Status messages of services: success")
    services = TEXTS[start:TEXTS.index("## Errors of requests")]
    assert [line for line in services.splitlines() if re.match(r"- .*[^.]\.\Z", line)] == []
