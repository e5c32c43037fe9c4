"""`class`: worlds for all students of a class on one server."""
from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
import urllib.request
from typing import Any, Callable, Dict, List, Optional, Sequence
from urllib.error import URLError
from urllib.parse import urlsplit

from ..classroom.class_file import read_class
from ..classroom.class_marks import marks_folder
from ..classroom.class_plan import ClassPlan, Student
from ..classroom.class_state import ClassState
from ..classroom.containers import KUBECTL, Containers
from ..classroom.manifests import compose, kubernetes
from ..classroom.student_files import collect_submission, send_file
from ..errors import CommandError, InputError
from ..grading.box_support import isolation_fault
from ..program_end import exit_cleanly
from ..ros.arguments import Parser

NAME = "class"
OK, FAILED, INVALID = 0, 1, 2
_END_S = 120.0
_CALL_S = 60.0


def parser() -> argparse.ArgumentParser:
    made = Parser(
        prog=NAME, description="Run a world with an editor for each student of a class, and a page"
        " for the tutor (doc/classroom.md).",
        epilog="Exit code: 0 on success, 1 on failure, 2 for a faulty class file or command line.")
    commands = made.add_subparsers(dest="command", metavar="COMMAND", required=True,
                                   parser_class=Parser)

    def add(name: str, text: str) -> argparse.ArgumentParser:
        one = commands.add_parser(name, help=text, description=text)
        one.add_argument("file", metavar="CLASS", help="class file")
        return one

    add("start", "start the class; runs until it is interrupted or stopped")
    status = add("status", "print the state of each student's world")
    status.add_argument("--json", action="store_true", help="print JSON")
    stop = add("stop", "stop the class, or the worlds of some students")
    stop.add_argument("students", nargs="*", metavar="STUDENT")
    collected = add("collect", "copy the submissions of all students, to be graded")
    collected.add_argument("--out", default="submissions", metavar="FOLDER",
                           help="folder of the submissions (default: %(default)s)")
    collected.add_argument("--grade", default="", metavar="ASSIGNMENT", help="then grade them, as"
                           " the command grade; the tutor's page shows the marks")
    collected.add_argument("--jobs", type=int, default=0, metavar="N",
                           help="submissions that are graded at a time")
    send = add("broadcast", "copy a file into the folder `received` of each home")
    send.add_argument("data", metavar="FILE")
    send.add_argument("--to", nargs="+", default=[], metavar="STUDENT",
                      help="only to these students")
    add("compose", "print a file for Docker Compose")
    add("kubernetes", "print manifests for Kubernetes")
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    options = parser().parse_args((sys.argv if argv is None else list(argv))[1:])
    try:
        plan, issues = read_class(options.file)
    except InputError as fault:
        for issue in fault.issues:
            print(issue, file=sys.stderr)
        return INVALID
    for issue in issues:
        print(issue, file=sys.stderr)
    try:
        return _COMMANDS[options.command](plan, options)
    except CommandError as fault:
        print(f"{NAME}: {fault}", file=sys.stderr)
        return FAILED


def _start(plan: ClassPlan, _options: argparse.Namespace) -> int:
    if plan.containers == KUBECTL:
        raise CommandError("a class in Kubernetes has no tutor's page: use status, broadcast and"
                           " collect; see doc/classroom.md")
    problem = "" if plan.containers else isolation_fault()
    if problem:
        raise CommandError(f"students cannot be isolated: {problem}; see doc/classroom.md")
    from ..classroom.class_manager import ClassManager
    from ..editor.transport.page_files import PageFiles
    from ..editor.transport.protocol import Protocol

    version = Protocol.from_folder(PageFiles.own_folder()).version
    ClassManager(plan, version, lambda line: print(line, flush=True)).run()
    return OK


def _status(plan: ClassPlan, options: argparse.Namespace) -> int:
    if plan.containers:
        return _container_status(plan, options)
    found = _request(ClassState(plan).manager(), "status.json")
    if options.json:
        print(json.dumps(found))
        return OK
    for one in found["students"]:
        shown = [one["name"], one["state"], one["world"] or "-", f"{one['factor']:.2f}",
                 f"{one['memory_mb']:.0f} MB", one["error"] or one["reason"]]
        print("  ".join(shown).rstrip())
    return OK


def _container_status(plan: ClassPlan, options: argparse.Namespace) -> int:
    containers = Containers(plan)
    found = [containers.status(student) for student in plan.students]
    if options.json:
        print(json.dumps({"class": plan.name, "students": found}))
        return OK
    for one in found:
        shown = [one["name"], one["state"], f"{one['models']} models", f"{one['time']:.0f} s",
                 f"{one['memory_mb']:.0f} MB", one["reason"]]
        print("  ".join(shown).rstrip())
    return OK


def _stop(plan: ClassPlan, options: argparse.Namespace) -> int:
    manager = ClassState(plan).manager()
    if options.students:
        for student in _select_students(plan, options.students):
            _request(manager, f"students/{student.name}/stop", b"")
        return OK
    os.kill(int(manager["pid"]), signal.SIGTERM)
    until = time.monotonic() + _END_S
    while time.monotonic() < until:
        try:
            ClassState(plan).manager()
        except CommandError:
            return OK
        time.sleep(0.2)
    raise CommandError(f"process {manager['pid']} of the class does not end")


def _collect(plan: ClassPlan, options: argparse.Namespace) -> int:
    def copy(student: Student) -> int:
        if plan.containers:
            return Containers(plan).collect(student, options.out)
        return collect_submission(plan, student, options.out)

    def describe(student: Student) -> str:
        count = copy(student)
        where = "" if count else f": nothing is in ~/{plan.submission}"
        return f"{student.name}: {count} files{where}"

    status = _for_each(plan.students, describe)
    if not options.grade:
        return status
    from .grade_command import main as grade

    folders = [os.path.join(options.out, student.name) for student in plan.students]
    if not any(map(os.path.isdir, folders)):
        raise CommandError("no student has handed in anything")
    for folder in folders:     # who has handed in nothing gets a mark, too
        os.makedirs(folder, exist_ok=True)
    words = [options.grade, *folders, "--out", marks_folder(plan)]
    if options.jobs:
        words += ["--jobs", str(options.jobs)]
    return grade(["grade", *words]) or status


def _broadcast(plan: ClassPlan, options: argparse.Namespace) -> int:
    try:
        with open(options.data, "rb") as stream:
            content = stream.read()
    except OSError as fault:
        raise CommandError(f"{options.data} cannot be read: {fault.strerror}") from None
    name = os.path.basename(options.data)

    def send(student: Student) -> str:
        if plan.containers:
            return Containers(plan).send(student, name, content)
        return send_file(plan, student, name, content)

    return _for_each(_select_students(plan, options.to) or list(plan.students), lambda student: (
        f"{student.name}: {send(student)}"))


def _for_each(students: Sequence[Student], work: Callable[[Student], str]) -> int:
    """Do something for all students, also if it fails for some."""
    status = OK
    for student in students:
        try:
            print(work(student))
        except CommandError as fault:
            print(f"{NAME}: {fault}", file=sys.stderr)
            status = FAILED
    return status


def _compose(plan: ClassPlan, _options: argparse.Namespace) -> int:
    print(compose(plan, ClassState(plan).tokens(plan)), end="")
    return OK


def _kubernetes(plan: ClassPlan, _options: argparse.Namespace) -> int:
    print(kubernetes(plan, ClassState(plan).tokens(plan)), end="")
    return OK


def _select_students(plan: ClassPlan, names: Sequence[str]) -> List[Student]:
    known = {student.name: student for student in plan.students}
    for name in names:
        if name not in known:
            raise CommandError(f"there is no student {name!r}")
    return [known[name] for name in names]


def _request(manager: Dict[str, Any], path: str, data: Optional[bytes] = None) -> Any:
    """Ask the manager. Raises CommandError."""
    address = urlsplit(manager["address"])
    url = f"{address.scheme}://{address.netloc}/{path}?{address.query}"
    try:
        with urllib.request.urlopen(urllib.request.Request(url, data), timeout=_CALL_S) as answer:
            return json.load(answer)
    except (URLError, OSError, ValueError) as fault:
        raise CommandError(f"the class does not answer: {fault}") from None


_COMMANDS: Dict[str, Callable[[ClassPlan, argparse.Namespace], int]] = {
    "start": _start, "status": _status, "stop": _stop, "collect": _collect,
    "broadcast": _broadcast, "compose": _compose, "kubernetes": _kubernetes}
