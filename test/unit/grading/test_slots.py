"""Slots of runs that grade at the same time."""
from __future__ import annotations

import os

import pytest

from my_simulations.errors import CommandError
from my_simulations.grading.grader import MOST_SLOTS, reserve_slots


def test_runs_at_the_same_time_have_different_slots(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    folder = str(tmp_path / "locks")
    with reserve_slots(2, folder) as first:
        with reserve_slots(3, folder) as second:
            assert (first, second) == ([0, 1], [2, 3, 4])
        with reserve_slots(1, folder) as third:
            assert third == [2]
    with reserve_slots(2, folder) as again:
        assert again == [0, 1]


def test_too_many_slots_are_an_error(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    with pytest.raises(CommandError, match=f"only {MOST_SLOTS} of"):
        with reserve_slots(MOST_SLOTS + 1, str(tmp_path)):
            pass
    (tmp_path / "file").write_text("")
    with pytest.raises(CommandError, match="cannot reserve user ids"):
        with reserve_slots(1, str(tmp_path / "file")):
            pass


def test_only_root_needs_locks(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with reserve_slots(2, str(tmp_path / "locks")) as slots:
        assert slots == [0, 1]
    assert os.listdir(tmp_path) == []
