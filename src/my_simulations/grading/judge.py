"""Grades one submission inside of its box, and sends the results out of it.

    python3 -m my_simulations.grading.judge TASK

TASK is JSON: the path of the assignment file, the folder SCRATCH of the box with the submission in
SCRATCH/submission, the file descriptor for the results, the number of the slot, and the files that
were left out because they cannot be read.
"""
from __future__ import annotations

import contextlib
import json
import os
import sys
import time
from dataclasses import replace
from typing import Any, Dict, Iterator, List, Optional, Sequence

from ..child_process import die_with_parent
from ..editor.logs.replay_page import write_replay
from ..editor.logs.world_record import LogRecord
from ..errors import InputError, SimulationError, errors_of
from ..python_api import OpenWorld
from ..python_api.robots import RobotOptions
from ..studies.provenance import digest_of_file
from .assignment import Assignment, Launch, Rostest, Timed
from .assignment_file import read_assignment
from .box_process import contains
from .confined_resolver import ConfinedResolver
from .file_checks import (
    NO_WORLD,
    WorldFile,
    check_files,
    invalid_model_file,
    read_world_file,
)
from .final_picture import PICTURE, final_picture
from .launch_checks import LaunchChecks, package_folders
from .mark import CheckResult, GradingError, score_check
from .program import OUTPUT, Program, PythonError, end_of_output, submission_account
from .program_choice import choose_program
from .program_graph import RosGraph, graph_environment
from .result_stream import ResultWriter
from .submission import (
    describe_ambiguity,
    find_all_matching,
    find_matching,
    reason_for_no_match,
    summarize_names,
)
from .world_run import WorldRun, world_choice_of

_EVERY_S = 1.0 / 30.0   # between two states of the replay, s of sim time
REPLAY = "replay.html"
_MOST_TOPIC_BYTES = 20e6
"""Of all recorded messages."""


def main(words: List[str]) -> int:
    """Grade; returns 0 if every check was decided."""
    die_with_parent()     # also where no namespace ends it
    task: Dict[str, Any] = json.loads(words[1])
    assignment, _ = read_assignment(task["assignment"])
    writer = ResultWriter(task["descriptor"])
    os.environ["ROS_HOME"] = os.path.join(task["scratch"], "judge", ".ros")
    os.environ.pop("ROS_LOG_DIR", None)
    writer.isolation(os.environ.get("BOX_ISOLATION", ""))
    in_time = Judge(assignment, task["scratch"], task["slot"], task["unreadable"], writer).run()
    writer.end(in_time)
    return 0


class ThinnedRecorder:
    """Records 30 states for each second of sim time."""

    def __init__(self, record: LogRecord) -> None:
        self.record = record
        self._next = 0.0

    def record_state(self, world: OpenWorld) -> None:
        """Add the present state if it is due."""
        if world.time >= self._next - 1e-9:
            self.record.record_state(world)
            self._next = world.time + _EVERY_S


class Judge:
    """Decides all checks of a submission.

    Args:
        assignment: the assignment.
        scratch: folder of the box.
        slot: number of the slot.
        unreadable: files of the submission that were left out because they cannot be read.
        writer: gets the results.
    """

    def __init__(self, assignment: Assignment, scratch: str, slot: int, unreadable: Sequence[str],
                 writer: ResultWriter) -> None:
        self._assignment = assignment
        self._scratch, self._slot = scratch, slot
        self._folder = os.path.join(scratch, "submission")
        self._own = os.path.join(scratch, "judge")
        self._unreadable = unreadable
        self._writer = writer
        self._in_time = True
        self._until = time.monotonic() + assignment.limits.seconds
        self._resolver = ConfinedResolver.from_environment()
        self._resolver.allow(self._folder, self._own, *map(os.path.dirname, (
            path for path in (assignment.world, *(model.file for model in assignment.models))
            if path)))

    def run(self) -> bool:
        """Send all results and files; returns whether the time was enough for all checks."""
        self._decide_checks()
        with contextlib.suppress(FileNotFoundError):    # no program has run
            self._writer.file(OUTPUT, end_of_output(os.path.join(self._own, OUTPUT)))
        self._writer.library([(path, digest_of_file(path)) for path in self._resolver.looked_up
                              if not contains(self._scratch, path)])
        return self._in_time

    def _decide_checks(self) -> None:
        form = self._assignment.form
        file: Optional[WorldFile] = None
        name = find_matching(self._folder, form.world) if form.world else ""
        if name:
            file = read_world_file(self._folder, name, self._resolver)
            self._note(describe_ambiguity(self._folder, form.world))
        if self._unreadable:
            self._note(f"left out, because their permissions forbid reading:"
                       f" {summarize_names(self._unreadable)}")
        for found in check_files(self._assignment, file, self._why_missing(form.world)):
            self._writer.result(found)
        if self._assignment.of(Timed):
            self._check_running_world(name, file)
        launches = LaunchChecks(self._assignment, self._scratch, self._slot, self._unreadable,
                                self._until)
        for check in self._assignment.of(Launch, Rostest):
            if isinstance(check, Launch):
                self._note(describe_ambiguity(self._folder, check.file))
            decided = launches.decide(check) if self._in_time else None
            self._in_time = self._in_time and time.monotonic() < self._until
            if decided is not None and self._in_time:
                self._writer.result(decided)

    def _check_running_world(self, name: str, file: Optional[WorldFile]) -> None:
        """Decide the checks of the running world if its files parse."""
        if file is not None and file.world is None:
            first = errors_of(file.issues)[:1]
            self._refuse_timed(first[0].message if first else NO_WORLD, name,
                               first[0].line if first else 0)
            return
        models = find_all_matching(self._folder, self._assignment.form.models)
        fault = invalid_model_file(self._folder, models, self._resolver)
        if fault is not None:
            self._refuse_timed(fault.message, fault.file, fault.line)
            return
        self._run_world(os.path.join(self._folder, name) if name else self._assignment.world, name)

    def _run_world(self, path: str, name: str) -> None:
        if not path:
            self._refuse_timed(self._why_missing(self._assignment.form.world))
            return
        patterns = self._assignment.form.run
        program, note = choose_program(self._folder, patterns)
        if patterns and not program:
            self._refuse_timed(self._why_missing(patterns))
            return
        self._note(note)
        log = os.path.join(self._own, "state.log")
        try:
            # With a program, the node of the graph runs the plugins of robots.
            robots = RobotOptions(plugins=not self._assignment.form.run, sensors=False)
            with OpenWorld(world_choice_of(self._assignment, path), resolver=self._resolver,
                           robots=robots) as world:
                with contextlib.closing(LogRecord(log)) as record:
                    self._decide(world, name, program, ThinnedRecorder(record))
                self._send_picture(world)
        except GradingError:
            raise
        except InputError as fault:
            first = fault.first
            self._refuse_timed(first.message if first else str(fault), name,
                               first.line if first else 0)
            return
        except SimulationError as fault:
            self._refuse_timed(str(fault), name)
            return
        self._send_replay(log)

    def _decide(self, world: OpenWorld, name: str, file: str, record: ThinnedRecorder) -> None:
        """Run the world, with the program `file` if the assignment asks for one."""
        if not file:
            self._in_time = WorldRun(self._assignment, world, name, self._until).run(
                record, self._writer.result)
            return
        with contextlib.closing(RosGraph(self._assignment, world, self._resolver)) as graph:
            with contextlib.closing(self._program(file, graph.uri)) as program:
                graph.run(program)
                results: List[CheckResult] = []
                with self._recorded_topics(world, graph, record.record):
                    # What the world does is a matter of the program: no place in the world file.
                    run = WorldRun(self._assignment, world, "", self._until, graph)
                    self._in_time = run.run(
                        record, lambda found: self._add_result(results, found))
                graph.look_for_misnamed_topics()
                ended, place = program.why_ended(), program.error if program.status else None
                if graph.busy:
                    place = program.interrupted_at()
                self._explain(results, graph.busy or (ended if place else ""), place)
                if program.status == 0 and all(found.passed for found in results):
                    ended = ""      # a program that has done its task may end
                notes = [] if all(found.passed for found in results) else graph.misnamed
                for note in (ended, graph.busy, graph.refused, *notes):
                    self._note(note)

    def _add_result(self, results: List[CheckResult], found: CheckResult) -> None:
        results.append(found)
        self._writer.result(found)

    def _explain(self, results: Sequence[CheckResult], cause: str, place: Optional[PythonError]
                 ) -> None:
        """Send results without all points again, with the fault of the program and its line."""
        for found in results:
            if not found.passed and cause:
                reason = found.reason if cause in found.reason else f"{found.reason}; {cause}"
                self._writer.result(replace(found, reason=reason,
                                            file=place.file if place else found.file,
                                            line=place.line if place else found.line))

    @contextlib.contextmanager
    def _recorded_topics(self, world: OpenWorld, graph: RosGraph, record: LogRecord
                         ) -> Iterator[None]:
        """Record the topics of the assignment until the graph ends."""
        names = self._assignment.recorded_topics
        if names:
            record.record_topics(world, graph.topics, names, _MOST_TOPIC_BYTES)
        try:
            yield
        finally:
            record.end_topics()

    def _program(self, file: str, uri: str) -> Program:
        path = os.path.join(self._folder, file)
        command = [sys.executable, path] if file.lower().endswith(".py") else self._script(path)
        packages = os.pathsep.join([*package_folders(self._folder),
                                    os.environ.get("ROS_PACKAGE_PATH", "")])
        return Program(command, os.path.dirname(path), self._scratch, self._assignment.limits,
                       submission_account(self._scratch, self._slot),
                       {**graph_environment(uri), "ROS_PACKAGE_PATH": packages})

    def _script(self, path: str) -> List[str]:
        """The command of a script, which archives and Windows may have changed."""
        name = os.path.relpath(path, self._folder)
        with open(path, "rb") as stream:
            first = stream.readline(200)
        if first.endswith(b"\r\n"):
            self._note(f"{name} has line ends of Windows, with which it fails: save it with LF")
        if not os.access(path, os.X_OK):
            os.chmod(path, 0o755)
            self._note(f"{name} is not executable and was run nevertheless: use chmod +x {name}")
        return [path] if first[:2] == b"#!" or first[:4] == b"\x7fELF" else ["/bin/sh", path]

    def _why_missing(self, patterns: Sequence[str]) -> str:
        return reason_for_no_match(self._folder, patterns, self._unreadable)

    def _note(self, text: str) -> None:
        if text:
            self._writer.note(text)

    def _refuse_timed(self, reason: str, file: str = "", line: int = 0) -> None:
        found: List[CheckResult] = [
            score_check(check, 0.0, f"the world does not run: {reason}", file, line)
            for check in self._assignment.of(Timed)]
        for one in found:
            self._writer.result(one)

    def _send_picture(self, world: OpenWorld) -> None:
        try:
            self._writer.file(PICTURE, final_picture(world))
        except SimulationError as fault:
            self._writer.note(f"there is no picture: {fault}")

    def _send_replay(self, log: str) -> None:
        page = os.path.join(self._own, REPLAY)
        try:
            write_replay(log, page, self._resolver, self._assignment.lab,
                         curves=self._assignment.curves)
        except SimulationError as fault:
            self._writer.note(f"there is no replay: {fault}")
            return
        size = os.path.getsize(page)
        limit = self._assignment.limits.replay_mb
        if size > limit * 1e6:
            self._writer.note(f"there is no replay: it has {size * 1e-6:.1f} MB, the limit is"
                              f" {limit:g} MB")
            return
        with open(page, "rb") as stream:
            self._writer.file(REPLAY, stream.read())


if __name__ == "__main__":
    sys.exit(main(sys.argv))
