"""Runs one scenario at a time: rostest, with a master, a port and folders of its own."""
from __future__ import annotations

import contextlib
import glob
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from typing import Dict, List, Optional, Tuple

from ..child_process import signal_name, wait_or_kill
from ..errors import CommandError, InputError
from . import scenario_process
from .attempts import repeat_after_crash
from .case_output import ScenarioFiles
from .junit import results_below
from .plan import Case, CasePlan
from .row import CRASHED, FAILED, OK, REFUSED, TIMED_OUT, Row
from .scenario_files import SCENARIO, declared_arguments, scenario_path
from .slot import CaseRefusedError, CaseStoppedError
from .variation import Setting

_LOOK_S = 0.1
_END_S = 40.0            # for rostest and its nodes to end
_MOST_BYTES = 1 << 20    # of a log that is kept
_MOST_LOGS = 20
_LONGEST_RECORDING = 64 << 20   # bytes
RECORDING = "state.log"
"""The recording of the simulator, stored for scenarios that are not ok."""


def require_ros() -> None:
    """Raise CommandError unless rostest is installed and the shell has a ROS environment."""
    if shutil.which("rostest") is None or not os.environ.get("ROS_PACKAGE_PATH"):
        raise CommandError("scenarios are run by rostest, which needs ROS: source the setup.bash of"
                           " your workspace; rostest must be installed")


def launch_words(plan: CasePlan, case: Case) -> List[str]:
    """The scenario of a case and its launch arguments, as roslaunch takes them.

    The seed is passed if the file declares `<arg name="seed">`; else it only repeats the case.

    Raises:
        InputError: the file cannot be used.
        CaseRefusedError: it does not declare what is varied.
    """
    path = scenario_path(str(case.settings[SCENARIO]), plan.study.file)
    known = declared_arguments(path)
    words = [path]
    for parameter in plan.study.parameters:
        name = parameter.target.name
        if parameter.target.kind == "arg":
            if name not in known:
                raise CaseRefusedError(f"{path} declares no <arg name=\"{name}\"/> to vary")
            words.append(f"{name}:={_text(case.settings[parameter.name])}")
    if "seed" in known and not any(word.startswith("seed:=") for word in words):
        words.append(f"seed:={case.seed}")
    return words


def _text(value: Setting) -> str:
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value)


class ScenarioSlot:
    """Runs one scenario at a time, for one thread.

    Args:
        plan: of the study.
        processor: model of the processor, for rows.
        stop: ends the scenario that runs with CaseStoppedError once it is set.
    """

    def __init__(self, plan: CasePlan, processor: str, stop: threading.Event) -> None:
        self._plan = plan
        self._processor = processor
        self._stop = stop

    def close(self) -> None:
        """Do nothing: scenarios share no state."""

    def enforce_limits(self) -> None:
        """Do nothing: the process of the scenario enforces its limits."""

    def run(self, case: Case) -> Tuple[Row, Optional[ScenarioFiles]]:
        """Run a scenario; once more if rostest crashes.

        Raises CaseStoppedError: `stop` was set; there is no result.
        """
        def attempt(number: int) -> Tuple[Row, Optional[ScenarioFiles]]:
            row = Row(OK, case.id, case.index, case.seed, dict(case.settings), attempt=number,
                      processor=self._processor)
            output: Optional[ScenarioFiles] = None
            try:
                output = self._attempt(case, row)
            except InputError as fault:
                row.status, row.issue = REFUSED, str(fault.first)
            except CommandError as fault:
                row.status, row.issue = REFUSED, str(fault)
            return row, output
        return repeat_after_crash(self._plan.study.limits.attempts, attempt)

    def _attempt(self, case: Case, row: Row) -> ScenarioFiles:
        require_ros()
        words = launch_words(self._plan, case)
        with tempfile.TemporaryDirectory(prefix="my_simulations_scenario_") as folder:
            began = time.monotonic()
            code = self._rostest(words, folder)
            row.seconds = round(time.monotonic() - began, 2)
            found = results_below(os.path.join(folder, "results"))
            row.values = {"tests": found.tests, "failures": found.failures}
            limit = self._plan.study.limits.seconds
            if code == scenario_process.TIMED_OUT:
                row.status, row.issue, row.values = TIMED_OUT, f"took longer than {limit:g} s", {}
            elif code > 128:
                row.status, row.signal, row.values = CRASHED, signal_name(code - 128), {}
                row.issue = f"rostest was ended by {row.signal}"
            elif found.failures:
                row.status, row.issue = FAILED, found.first
            elif not found.tests:
                row.status, row.values = REFUSED, {}
                row.issue = _last_line(folder) if code else f"{words[0]} has no <test>"
            elif code:
                row.status, row.issue = FAILED, f"rostest ended with status {code}"
            return ScenarioFiles(_files(folder, found.junit, row.status != OK))

    def _rostest(self, words: List[str], folder: str) -> int:
        """Run rostest; returns the exit status of `scenario_process`."""
        path, *arguments = words
        results, logs = os.path.join(folder, "results"), os.path.join(folder, "log")
        environment = {**os.environ, "ROS_HOME": folder, "ROS_LOG_DIR": logs,
                       "ROS_TEST_RESULTS_DIR": results, "PYTHONUNBUFFERED": "1",
                       "MY_SIMULATIONS_RECORD": os.path.join(folder, "recording")}
        command = [sys.executable, "-I", scenario_process.__file__, str(os.getpid()),
                   str(self._plan.study.limits.seconds), "rostest",
                   "--pkgdir", os.path.dirname(path), "--package", "study",
                   "--results-base-dir", results, path, *arguments]
        with open(os.path.join(folder, "output.txt"), "wb") as output:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output,
                                       stderr=subprocess.STDOUT, env=environment,
                                       cwd=os.path.dirname(path))
        try:
            while True:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    code = process.wait(_LOOK_S)
                    return code if code >= 0 else 128 - code
                if self._stop.is_set():
                    raise CaseStoppedError
        finally:
            if process.poll() is None:
                process.terminate()
                wait_or_kill(process, _END_S)


def _last_line(folder: str) -> str:
    with open(os.path.join(folder, "output.txt"), encoding="utf-8", errors="replace") as output:
        lines = [line.strip() for line in output if line.strip()]
    return lines[-1][:500] if lines else "rostest wrote no results"


def _files(folder: str, junit: bytes, with_logs: bool) -> Dict[str, bytes]:
    """Return results and output; with `with_logs` the recording and the logs of nodes, too."""
    found = {"junit.xml": junit, "output.txt": _end_of(os.path.join(folder, "output.txt"))}
    if with_logs:
        recording = os.path.join(folder, "recording", RECORDING)
        if os.path.isfile(recording) and os.path.getsize(recording) <= _LONGEST_RECORDING:
            with open(recording, "rb") as stream:
                found[RECORDING] = stream.read()
        logs = sorted(glob.glob(os.path.join(folder, "log", "**", "*.log"), recursive=True),
                      key=os.path.getsize, reverse=True)
        for path in logs[:_MOST_LOGS]:
            if not os.path.islink(os.path.dirname(path)):
                found["log-" + os.path.basename(path)] = _end_of(path)
    return found


def _end_of(path: str) -> bytes:
    with open(path, "rb") as stream:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(max(0, size - _MOST_BYTES))
        return stream.read()
