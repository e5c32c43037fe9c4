"""What runs a scenario's command ends it, and all that it started."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from my_simulations.studies import scenario_process

SECONDS = 60.0


def start(marked, *command, seconds=1000.0):
    """Run the command; `marked` stands in the environment of all that it starts."""
    words = [sys.executable, "-I", scenario_process.__file__, str(os.getpid()), str(seconds)]
    return subprocess.Popen([*words, *command], env={**os.environ, "MARKED": marked},
                            stderr=subprocess.PIPE)


def processes_with(marked):
    """Process ids of those that have it in their environment."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if marked.encode() in (folder / "environ").read_bytes():
                found.append(int(folder.name))
        except OSError:
            continue
    return found


def wait_for_count(marked, least):
    deadline = time.monotonic() + SECONDS
    while len(processes_with(marked)) < least:
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.fixture
def marked(tmp_path):
    marked = f"scenario of {tmp_path}"
    yield marked
    for process in processes_with(marked):
        os.kill(process, signal.SIGKILL)


def test_the_status_of_the_command_is_its_own(marked):
    assert start(marked, "sh", "-c", "exit 7").wait(SECONDS) == 7
    assert start(marked, "sh", "-c", "kill -KILL $$").wait(SECONDS) == 128 + signal.SIGKILL
    assert start(marked, "sleep", "1000", seconds=0.1).wait(SECONDS) == scenario_process.TIMED_OUT


def test_signals_in_a_row_end_all_that_was_started(marked):
    for _ in range(15):
        process = start(marked, "sh", "-c", "setsid sleep 1000 & exec sleep 1000")
        wait_for_count(marked, 3)
        for _each in range(100):  # the kernel sends one for each thread of a killed driver
            process.send_signal(signal.SIGTERM)
        _, said = process.communicate(timeout=SECONDS)
        assert processes_with(marked) == [] and said == b""
        assert process.returncode == 128 + signal.SIGTERM


def test_a_command_gets_the_signals_that_its_runner_waits_for(marked):
    process = start(marked, "sh", "-c", "grep SigBlk /proc/self/status >&2")
    assert process.communicate(timeout=SECONDS)[1].split()[1] == b"0" * 16
