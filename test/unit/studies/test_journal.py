"""The journal: whole lines, one writer, a cut that leaves what was finished."""
from __future__ import annotations

import errno
import math
import os

import numpy as np
import pytest

from my_simulations.errors import CommandError
from my_simulations.studies.case_output import CaseTrajectory
from my_simulations.studies.journal import (
    Journal,
    finished_cases,
    header_of,
    read_rows,
    rows,
    statuses,
)
from my_simulations.studies.row import CRASHED, OK, TIMED_OUT, Row
from my_simulations.studies.row_recorder import Recorder
from my_simulations.studies.table import rows_in_order

HEADER = {"study": "s", "cases": 3}


def row(number, status=OK, **more):
    return Row(status, f"{number:016x}", number, 0, {"a": 1.5}, **more)


def test_rows_are_read_as_they_were_written(tmp_path):
    path = str(tmp_path / "j.jsonl")
    journal = Journal(path, HEADER)
    first = row(1, values={"z": 0.1, "n": float("inf"), "yes": True}, issue='a "quote"\n')
    journal.append([first, row(2, CRASHED, signal="SIGSEGV")])
    journal.close()
    assert header_of(path)["cases"] == 3
    assert list(rows(path)) == [first, row(2, CRASHED, signal="SIGSEGV")]
    assert finished_cases(path) == {1, 2}
    assert statuses([path]) == {1: OK, 2: CRASHED}


def test_nan_is_kept(tmp_path):
    path = str(tmp_path / "j.jsonl")
    journal = Journal(path, HEADER)
    journal.append([row(1, values={"n": float("nan")})])
    journal.close()
    (found,) = rows(path)
    assert math.isnan(found.values["n"])


def test_a_journal_cut_anywhere_keeps_the_rows_before_the_cut(tmp_path):
    path = str(tmp_path / "j.jsonl")
    journal = Journal(path, HEADER)
    journal.append([row(number) for number in range(3)])
    journal.close()
    with open(path, "rb") as stream:
        whole = stream.read()
    ends = [offset + len(line) for offset, line in read_rows(path)]
    for length in range(len(whole)):
        with open(path, "wb") as stream:
            stream.write(whole[:length])
        again = Journal(path, HEADER)
        left = finished_cases(path)
        assert len(left) == sum(end <= length for end in ends)
        again.append([row(number) for number in range(3) if number not in left])
        again.close()
        with open(path, "rb") as stream:
            assert stream.read() == whole


def test_a_row_that_does_not_fit_on_the_disk_leaves_no_trace_and_ends_the_journal(
        tmp_path, monkeypatch):
    path = str(tmp_path / "j.jsonl")
    journal = Journal(path, HEADER)
    journal.append([row(1)])
    write, left = os.write, [50]

    def on_a_full_disk(file, data):
        if not left[0]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        done = write(file, data[:left[0]])
        left[0] -= done
        return done

    monkeypatch.setattr(os, "write", on_a_full_disk)
    with pytest.raises(OSError, match="No space"):
        journal.append([row(2)])
    monkeypatch.undo()   # others freed some, and another case has ended
    with pytest.raises(OSError, match="No space"):
        journal.append([row(3)])
    journal.close()
    assert list(rows(path)) == [row(1)] and finished_cases(path) == {1}
    again = Journal(path, HEADER)
    again.append([row(2)])
    again.close()
    assert finished_cases(path) == {1, 2}


def test_two_processes_do_not_write_one_journal_and_studies_are_not_mixed(tmp_path):
    path = str(tmp_path / "j.jsonl")
    journal = Journal(path, HEADER)
    with pytest.raises(CommandError, match="another process"):
        Journal(path, HEADER)
    journal.close()
    with pytest.raises(CommandError, match="of study 's'"):
        Journal(path, {"study": "other"})


def test_what_is_no_journal_is_told(tmp_path):
    path = tmp_path / "j.jsonl"
    path.write_text("{}\n")
    with pytest.raises(CommandError, match="not the journal"):
        header_of(str(path))
    path.write_text('{"journal": 1}\n{"status":"ok"}\n')
    with pytest.raises(CommandError, match="no row"):
        list(rows(str(path)))
    with pytest.raises(CommandError, match="no row"):
        statuses([str(path)])


def test_of_two_rows_of_a_case_the_last_counts(tmp_path):
    paths = [str(tmp_path / name) for name in ("a.jsonl", "b.jsonl")]
    for path, found in zip(paths, ([row(1), row(2, TIMED_OUT)], [row(2), row(3, CRASHED)])):
        journal = Journal(path, HEADER)
        journal.append(found)
        journal.close()
    assert statuses(paths) == {1: OK, 2: OK, 3: CRASHED}
    assert finished_cases(paths[1], [CRASHED]) == {2}
    assert [(found.index, found.status) for found in rows_in_order(paths)] == [
        (1, OK), (2, OK), (3, CRASHED)]


def test_a_row_is_written_after_the_file_with_its_trajectory(tmp_path):
    path = str(tmp_path / "j.jsonl")
    journal = Journal(path, HEADER)
    recorder = Recorder(journal, str(tmp_path), "t")
    motion = CaseTrajectory(np.array([0.0, 1.0]), ("box",), np.zeros((2, 1, 7)))
    recorder.add(row(1), motion)
    assert finished_cases(path) == set() and not os.path.exists(str(tmp_path / "t-000001.npz"))
    recorder.add(row(2), None)
    assert finished_cases(path) == {2}
    recorder.close()
    journal.close()
    assert [found.trajectory for found in rows(path)] == ["", "t-000001.npz"]
    with np.load(str(tmp_path / "t-000001.npz")) as kept:
        assert kept["0000000000000001.pose"].shape == (2, 1, 7)
        assert list(kept["0000000000000001.names"]) == ["box"]
    (tmp_path / "t-000007.npz.part").write_text("")  # left by a killed process
    journal = Journal(path, HEADER)
    recorder = Recorder(journal, str(tmp_path), "t")
    recorder.add(row(3), motion)
    recorder.close()
    journal.close()
    assert (tmp_path / "t-000008.npz").exists()
