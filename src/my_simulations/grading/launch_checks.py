"""Checks that run launch files: one of the submission must start, a rostest must pass."""
from __future__ import annotations

import contextlib
import os
import re
import shutil
import time
from dataclasses import replace
from typing import List, NamedTuple, Optional, Sequence, Tuple, Union

from lxml import etree

from ..child_process import wait_or_kill
from ..errors import InputError, error
from ..resources.resolver import Resolver
from ..ros.lifecycle import master_api
from ..studies.junit import results_below
from ..studies.scenario_files import declared_arguments
from .assignment import Assignment, Launch, Rostest
from .file_checks import read_world_file
from .launched_world import PROPERTIES, SIMULATOR, different_world, model_names, simulator_command
from .mark import CheckResult, GradingError, score_check
from .program import TESTS, Program, submission_account, tester_account
from .program_graph import free_port, graph_environment, start_master
from .submission import find_matching, reason_for_no_match, summarize_names

_POLL_S = 0.1
_START_S = 120.0      # until all nodes are there
_END_S = 20.0         # roslaunch gives its nodes 15 s to end, then 2 s
_LARGEST = 5 << 20     # bytes of a file beside a test
_CALLER = "/grade"


class LaunchChecks:
    """Runs launch files of one submission.

    Args:
        assignment: the assignment.
        scratch: folder of the box.
        slot: number of the slot.
        unreadable: files of the submission that were left out because they cannot be read.
        until: `time.monotonic()` at which all checks end.
    """

    def __init__(self, assignment: Assignment, scratch: str, slot: int,
                 unreadable: Sequence[str], until: float) -> None:
        self._assignment = assignment
        self._scratch = scratch
        self._folder = os.path.join(scratch, "submission")
        self._slot = slot
        self._unreadable = unreadable
        self._until = until

    def decide(self, check: Union[Launch, Rostest]) -> CheckResult:
        """Decide a check; the result is meaningless once the time is over."""
        return self._launch(check) if isinstance(check, Launch) else self._rostest(check)

    def _ending(self, seconds: float) -> float:
        """The time after so many seconds, or the end of all checks."""
        return min(time.monotonic() + seconds, self._until)

    def _launch(self, check: Launch) -> CheckResult:
        """Start a launch file; it passes if its nodes run for the time of the check."""
        name = find_matching(self._folder, check.file)
        if not name:
            return score_check(check, 0.0, reason_for_no_match(self._folder, check.file,
                                                               self._unreadable))
        port = free_port()
        uri = f"http://127.0.0.1:{port}/"
        words = ["roslaunch", "-p", str(port), os.path.join(self._folder, name),
                 *check.arguments]
        with contextlib.closing(self._program(words, uri)) as program:
            nodes = (*check.nodes, *((SIMULATOR,) if check.runs_world else ()))
            missing = self._wait_for_nodes(program, uri, nodes)
            fault = _fault(program, self._folder)
            if check.runs_world and not (missing or fault):
                fault = self._other_world(program, uri)
            until = self._ending(check.seconds)
            while not (missing or fault) and time.monotonic() < until:
                time.sleep(_POLL_S)
                fault = _fault(program, self._folder)
            self._end(program)
        if fault:
            return score_check(check, 0.0, fault.message, fault.file or name, fault.line)
        if missing:
            return score_check(check, 0.0, f"no node {missing} within {_START_S:g} s", name)
        return score_check(check, 1.0)

    def _other_world(self, program: Program, uri: str) -> Optional[LaunchFault]:
        """Why the simulator does not run the world of the submission; None if it does."""
        patterns = self._assignment.form.world
        name = find_matching(self._folder, patterns)
        if not name:
            return LaunchFault(reason_for_no_match(self._folder, patterns, self._unreadable))
        fault = different_world(simulator_command(program, uri, self._scratch),
                                self._folder, name)
        if fault:
            return LaunchFault(fault)
        loaded = self._loaded_models(program, uri)
        if loaded is None:
            return _fault(program, self._folder) or LaunchFault(
                f"{SIMULATOR} did not load its world within {_START_S:g} s")
        world = read_world_file(self._folder, name, Resolver.from_environment()).world
        lost = [model.name for model in world.models if model.name not in loaded] if world else []
        return LaunchFault(f"the simulator has not loaded {summarize_names(lost)} of {name}"
                           ) if lost else None

    def _loaded_models(self, launched: Program, uri: str) -> Optional[List[str]]:
        """The models of the running simulator; None if it does not answer in time."""
        account = tester_account(self._scratch, self._slot)
        account = replace(account, output=f"{account.output}.models")
        until = self._ending(_START_S)
        while launched.running and time.monotonic() < until:
            with contextlib.suppress(OSError):
                if master_api.call(uri, "lookupService", _CALLER, PROPERTIES):
                    break
            time.sleep(_POLL_S)
        with contextlib.closing(Program(["rosservice", "call", PROPERTIES], account.temporary,
                                        self._scratch, self._assignment.limits, account,
                                        graph_environment(uri))) as asking:
            while asking.running and time.monotonic() < until:
                time.sleep(_POLL_S)
            return model_names(asking.output())

    def _rostest(self, check: Rostest) -> CheckResult:
        """Run a rostest of the assignment; its argument `submission` is the folder, if declared.

        The nodes of the file run as the submission. The tests run as another user, whose files
        and processes the submission cannot reach.
        """
        if shutil.which("rostest") is None:
            raise GradingError("rostest is not installed")
        started, tests = self._copy_rostest(check.file)
        words = [*check.arguments]
        try:
            declared = declared_arguments(check.file)
        except InputError as fault:
            raise GradingError(str(fault.first)) from None
        if "submission" in declared:
            words.append(f"submission:={self._folder}")
        uri, master = start_master()
        try:
            with contextlib.closing(self._program(["roslaunch", started, *words], uri)) as program:
                reason = self._wait_for_start(program, uri)
                if reason:
                    return score_check(check, 0.0, f"no test ran: {reason}")
                return self._run_tests(check, [tests, *words], uri)
        finally:
            master.terminate()
            wait_or_kill(master, _END_S)

    def _run_tests(self, check: Rostest, words: Sequence[str], uri: str) -> CheckResult:
        """Run the tests of a rostest; `words` are the file and its arguments."""
        account = tester_account(self._scratch, self._slot)
        results = os.path.join(account.home, "results")
        folder = os.path.dirname(words[0])
        command = ["rostest", "--reuse-master", "--pkgdir", folder, "--package", "grade",
                   "--results-base-dir", results, *words]
        # A package of the submission must not take the place of one that a test names.
        packages = os.pathsep.join([os.environ.get("ROS_PACKAGE_PATH", ""),
                                    *package_folders(self._folder)])
        environment = {**graph_environment(uri), "ROS_PACKAGE_PATH": packages,
                       "ROS_TEST_RESULTS_DIR": results}
        until = self._ending(check.seconds)
        with contextlib.closing(Program(command, folder, self._scratch, self._assignment.limits,
                                        account, environment)) as program:
            while program.running and time.monotonic() < until:
                time.sleep(_POLL_S)
            timed_out = program.running
            self._end(program)
            last = last_line(program.output())
        found = results_below(results)
        shutil.rmtree(results, ignore_errors=True)
        if timed_out:
            return score_check(check, 0.0, f"the test took longer than {check.seconds:g} s")
        if not found.tests:
            return score_check(check, 0.0, f"no test ran: {last}")
        passed = found.tests - found.failures
        return score_check(check, passed / found.tests, found.first and
                           f"{passed} of {found.tests} tests passed; {found.first}")

    def _copy_rostest(self, file: str) -> Tuple[str, str]:
        """Copies of a rostest: of its nodes for the submission, of its tests for the tester.

        Each has the files beside the rostest, as its user can read them.
        """
        try:
            parts = split_rostest(file)
        except InputError as fault:
            raise GradingError(str(fault.first)) from None
        copies = []
        for part, above in zip(parts, (self._scratch, os.path.join(self._scratch, TESTS))):
            folder = os.path.join(above, "test")
            os.makedirs(folder, exist_ok=True)
            for entry in os.scandir(os.path.dirname(file)):
                if entry.is_file(follow_symlinks=False) and entry.stat().st_size <= _LARGEST:
                    shutil.copy(entry.path, folder)
            copies.append(os.path.join(folder, os.path.basename(file)))
            with open(copies[-1], "wb") as stream:
                stream.write(part)
            for name in os.listdir(folder):
                path = os.path.join(folder, name)
                os.chmod(path, 0o755 if os.access(path, os.X_OK) else 0o644)
        return copies[0], copies[1]

    def _wait_for_start(self, program: Program, uri: str) -> str:
        """Wait until the nodes of a rostest are being started; why they are not, or ""."""
        until = self._ending(_START_S)
        while time.monotonic() < until:
            is_running = program.running
            with contextlib.suppress(OSError):
                if master_api.call(uri, "hasParam", _CALLER, STARTED):
                    return ""
            if not is_running:
                fault = _fault(program, self._folder)
                return fault.message if fault else ""
            time.sleep(_POLL_S)
        return f"the nodes did not start within {_START_S:g} s"

    def _program(self, words: Sequence[str], uri: str) -> Program:
        packages = os.pathsep.join([*package_folders(self._folder),
                                    os.environ.get("ROS_PACKAGE_PATH", "")])
        return Program(words, self._folder, self._scratch, self._assignment.limits,
                       submission_account(self._scratch, self._slot),
                       {**graph_environment(uri), "ROS_PACKAGE_PATH": packages})

    def _wait_for_nodes(self, program: Program, uri: str, nodes: Sequence[str]) -> str:
        """The first node that does not come; "" if all are there."""
        waiting = list(nodes)
        until = self._ending(_START_S)
        is_up = False
        while (waiting or not is_up) and program.running and time.monotonic() < until:
            with contextlib.suppress(OSError):
                master_api.call(uri, "getPid", _CALLER)
                is_up = True
                while waiting and master_api.running_node(uri, waiting[0]) is not None:
                    del waiting[0]
            if waiting or not is_up:
                time.sleep(_POLL_S)
        return waiting[0] if waiting else "" if is_up else "of the ROS master"

    @staticmethod
    def _end(program: Program) -> None:
        program.interrupt()
        until = time.monotonic() + _END_S
        while program.running and time.monotonic() < until:
            time.sleep(_POLL_S)


def package_folders(folder: str) -> List[str]:
    """The folders in a submission that are ROS packages."""
    found = []
    for path, folders, names in os.walk(folder):
        if "package.xml" in names:
            found.append(path)
            folders[:] = []
    return sorted(found)


def _fault(program: Program, folder: str) -> Optional[LaunchFault]:
    """What went wrong in the output, or that the program has ended; None for nothing."""
    found = launch_fault(program.output(), folder)
    if found is not None or program.running:
        return found
    return LaunchFault(f"{program.why_ended()}: {last_line(program.output())}")


STARTED = "/my_simulations_grade/started"
"""Parameter that exists once the parameters of the first part are set."""

_SCOPES = ("group",)
_KEPT = ("arg", "env", "remap", "test")   # besides groups, of the second part


def split_rostest(path: str) -> Tuple[bytes, bytes]:
    """Return the two roslaunch files of a rostest.

    The first one has no tests, and sets the parameter `STARTED`. The second one has the tests of
    the file, with its arguments, groups, remappings and variables, and nothing else: tests in files
    that it includes do not count, because these may belong to the submission. Raises InputError:
    the file is no roslaunch file, or has no test.
    """
    try:
        started, tests = (etree.parse(path, etree.XMLParser(
            resolve_entities=False, remove_comments=True)).getroot() for _ in range(2))
    except (OSError, etree.XMLSyntaxError) as fault:
        raise InputError([error("xml-malformed", str(fault), file=path)]) from None
    for test in list(started.iter("test")):
        test.getparent().remove(test)
    etree.SubElement(started, "param", name=STARTED, type="int", value="1")
    _keep_tests(tests)
    if next(tests.iter("test"), None) is None:
        raise InputError([error("grade-value", "the rostest has no <test>", file=path)])
    return etree.tostring(started), etree.tostring(tests)


def _keep_tests(scope: "etree._Element") -> None:
    for child in list(scope):
        if child.tag in _SCOPES:
            _keep_tests(child)
        elif child.tag not in _KEPT:
            scope.remove(child)


_LONGEST = 500
_COLOUR = re.compile(r"\x1b\[[0-9;]*m|\x1b\][^\x07]*\x07")
_INVALID = re.compile(r"RLException: ((?:while processing .+:\n)*)(.*)")
_PROCESSED = re.compile(r"while processing (.+):\n")
_DIED = re.compile(r"^.*(?:has died|cannot launch|Resource not found|Invalid <|error loading).*$",
                   re.MULTILINE | re.IGNORECASE)
_LINE = re.compile(r"\bline (\d+)")
_UNWANTED = ("The traceback for the exception was written",)


class LaunchFault(NamedTuple):
    """A fault of a launch file.

    Attributes:
        message: the fault.
        file: path in the submission; "" for the launch file that was started.
        line: in that file, from 1; 0 if it is unknown.
    """

    message: str
    file: str = ""
    line: int = 0


def launch_fault(output: bytes, folder: str) -> Optional[LaunchFault]:
    """Return the first fault that an output of roslaunch names; None for none.

    Args:
        output: what roslaunch has printed.
        folder: of the submission.
    """
    text = _decode_output(output)
    found = _INVALID.search(text)
    if found is None:
        died = _DIED.search(text)
        return LaunchFault(died[0].strip()[:_LONGEST]) if died else None
    files = _PROCESSED.findall(found[1])
    file = os.path.relpath(files[-1], folder) if files else ""
    if "maximum recursion depth" in found[2] and files:
        return LaunchFault(f"{file} includes itself, directly or by another file", file)
    line = _LINE.search(found[2]) if "XML syntax" in found[2] else None
    return LaunchFault(found[2].strip()[:_LONGEST], file, int(line[1]) if line else 0)


def last_line(output: bytes) -> str:
    """The last line of an output that says something."""
    lines = [line.strip() for line in _decode_output(output).splitlines()]
    wanted = [line for line in lines if line and not line.startswith(_UNWANTED)]
    return wanted[-1][:_LONGEST] if wanted else "no output"


def _decode_output(output: bytes) -> str:
    return _COLOUR.sub("", output.decode("utf-8", "replace"))
