"""Limits of all processes of a program together."""
from __future__ import annotations

import os
import sys
from contextlib import closing

from waiting import wait_for

from my_simulations.grading import box
from my_simulations.grading.assignment import GradeLimits
from my_simulations.grading.grader import reserve_slots
from my_simulations.grading.program import Program, submission_account

SECONDS = 60.0
FORKS = """import os
for _ in range(4):
    if os.fork() == 0:
        while True:
            pass
while True:
    try:
        os.wait()
    except ChildProcessError:
        break
"""


def test_the_processor_time_of_all_processes_of_a_program_counts(tmp_path):
    scratch = tmp_path / "box"
    (scratch / "submission").mkdir(parents=True)
    (scratch / "submission" / "go.py").write_text(FORKS)
    limits = GradeLimits(processor_seconds=2.0)
    with reserve_slots(1) as slots, closing(Program(
            [sys.executable, "go.py"], str(scratch / "submission"), str(scratch), limits,
            submission_account(str(scratch), slots[0]), {})) as program:
        pids = wait_for(lambda: (found := box.descendants(program.pid))[5:] and found,
                        "the processes", SECONDS)
        wait_for(lambda: not program.running, "the end of the program", SECONDS)
        assert program.why_ended() == "the program used more processor time than 2 s"
        wait_for(lambda: not any(os.path.exists(f"/proc/{pid}") for pid in pids), "their end",
                 SECONDS)
