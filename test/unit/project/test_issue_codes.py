"""One registry of issue codes: complete, without leftovers, and documented."""
from __future__ import annotations

import pathlib
import re
import sys

import pytest

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(REPOSITORY / "tools" / "generate"))

from source_codes import code_uses

from my_simulations.issue_codes import CODES, EITHER, SECTIONS, markdown

USES = code_uses()


def test_the_scan_finds_codes_in_every_package():
    packages = {use.path.split("/")[0] for use in USES}
    assert {"building", "cli", "description", "editor", "engine", "formats", "objects",
            "resources", "ros", "simulator"} <= packages


@pytest.mark.parametrize("use", USES, ids=lambda use: f"{use.path}:{use.line}:{use.pattern}")
def test_every_code_in_the_sources_is_registered_with_its_severity(use):
    known = [code for code in CODES if re.fullmatch(use.pattern, code)]
    assert known, f"add {use.pattern} to src/my_simulations/issue_codes.py"
    assert not use.severity or any(CODES[code].severity in (use.severity, EITHER)
                                   for code in known)


def test_every_registered_code_is_used():
    patterns = {use.pattern for use in USES}
    unused = [code for code in CODES
              if not any(re.fullmatch(pattern, code) for pattern in patterns)]
    assert unused == []


def test_a_code_is_registered_once_with_a_meaning_and_an_action():
    entries = [entry for _, section in SECTIONS for entry in section]
    assert len(entries) == len(CODES)
    assert [entry.code for entry in entries
            if not entry.meaning.endswith(".") or not entry.action.endswith(".")] == []


def test_the_page_of_issue_codes_is_up_to_date():
    page = (REPOSITORY / "doc" / "issue_codes.md").read_text(encoding="utf-8")
    assert page == markdown(), "run tools/generate/issue_codes.py"
