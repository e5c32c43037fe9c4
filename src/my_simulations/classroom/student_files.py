"""Copies files into homes of students and out of them, as the student.

A student may have put links anywhere in the home. So a child process that has the student's user
does the work there, and follows no link.
"""
from __future__ import annotations

import contextlib
import os
import secrets
import stat
import struct
import tempfile
from typing import Callable, Iterator, Tuple

from ..errors import CommandError
from .class_plan import ClassPlan, Student
from .local_world import make_home

RECEIVED = "received"
"""Folder of a home that receives files of the tutor."""

_HEAD = struct.Struct("<HIQ")     # bytes of the name, permissions, bytes of the content
_CHUNK = 1 << 16
MOST_FILES = 20000
"""Files of a submission; more are left out."""

Store = Callable[[str, int, bytes], None]
"""Stores a file of a submission: path in it, permissions to execute, content."""


def send_file(plan: ClassPlan, student: Student, name: str, content: bytes) -> str:
    """Write a file into a home; returns its path there, from the home.

    Raises CommandError: it cannot be written.
    """
    _as_student(plan, student, lambda home, _: _write(home, name, content), lambda _: None)
    return os.path.join(RECEIVED, name)


def collect_submission(plan: ClassPlan, student: Student, out: str) -> int:
    """Copy the submission of a student to OUT/NAME; returns the number of files.

    Replaces an earlier collection. Links, and files beyond the limits of the class, are left out.
    Raises CommandError: the files cannot be read or written.
    """
    limit = int(plan.limits.file_mb * 1e6)

    def copy(store: Store) -> None:
        def receive(reading: int) -> None:
            with os.fdopen(os.dup(reading), "rb") as stream:
                for name, mode, content in _receive_files(stream.read, limit):
                    store(name, mode, content)

        _as_student(plan, student, lambda home, writing: _send_all(
            home, plan.submission, limit, writing), receive)

    return store_collection(student, out, copy)


def store_collection(student: Student, out: str, copy: Callable[[Store], None]) -> int:
    """Replace OUT/NAME by the files that `copy` stores; returns their number.

    Raises CommandError: they cannot be written.
    """
    folder = os.path.join(out, student.name)
    count = [0]
    try:
        os.makedirs(out, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".collect_", dir=out) as temporary:
            made = os.path.join(temporary, student.name)
            os.mkdir(made)

            def store(name: str, mode: int, content: bytes) -> None:
                _store(made, name, mode, content)
                count[0] += 1

            copy(store)
            if os.path.isdir(folder):
                os.rename(folder, os.path.join(temporary, "before"))
            if count[0]:
                os.rename(made, folder)
    except OSError as fault:
        raise CommandError(f"files of {student.name}: {fault.strerror}") from None
    return count[0]


# -- as the student --------------------------------------------------------------------------------

def _as_student(plan: ClassPlan, student: Student, work: Callable[[int, int], None],
                receive: Callable[[int], None]) -> None:
    """Run `work` in a child process that has the student's user, and `receive` in this one.

    `work` gets a descriptor of the home folder, whose parent folders may be closed to the student,
    and the writing end of a pipe, `receive` the reading end. Raises CommandError.
    """
    home = os.open(make_home(plan, student), os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    reading, writing = os.pipe()
    failed, fault = os.pipe()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            os.close(reading)
            os.close(failed)
            if os.geteuid() == 0:
                os.setgroups([])
                os.setgid(student.user)
                os.setuid(student.user)
            work(home, writing)
            status = 0
        except OSError as problem:
            os.write(fault, f"{problem.filename or ''}: {problem.strerror}".encode()[:500])
        finally:
            os._exit(status)
    for descriptor in (writing, fault, home):
        os.close(descriptor)
    try:
        receive(reading)
    finally:
        os.close(reading)     # a child that still writes ends
        with os.fdopen(failed, "rb") as stream:
            said = stream.read().decode("utf-8", "replace")
        status = os.waitpid(child, 0)[1]
    if said or status:
        raise CommandError(f"files of {student.name}: {said or 'they cannot be copied'}")


def _write(home: int, name: str, content: bytes) -> None:
    with contextlib.suppress(FileExistsError):
        os.mkdir(RECEIVED, 0o755, dir_fd=home)
    folder = os.open(RECEIVED, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW, dir_fd=home)
    temporary = f".{secrets.token_hex(8)}"
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o644,
                         dir_fd=folder)
    with os.fdopen(descriptor, "wb") as stream:
        stream.write(content)
    os.rename(temporary, name, src_dir_fd=folder, dst_dir_fd=folder)


def _send_all(home: int, inside: str, limit: int, writing: int) -> None:
    """Write all regular files below a folder to a pipe."""
    folder = home
    for part in inside.split(os.sep):
        try:
            folder = os.open(part, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW, dir_fd=folder)
        except FileNotFoundError:
            return    # nothing was handed in
    left, files = limit, 0
    with os.fdopen(writing, "wb") as stream:
        for path, folders, names, here in os.fwalk(".", dir_fd=folder, follow_symlinks=False):
            folders[:] = sorted(one for one in folders if not one.startswith("."))
            for name in sorted(names):
                found = _open_file(name, here)
                if found is None:
                    continue
                with os.fdopen(found, "rb") as source:
                    status = os.fstat(source.fileno())
                    content = source.read(left + 1)
                relative = os.fsencode(os.path.normpath(os.path.join(path, name)))
                files += 1
                if len(content) > left or files > MOST_FILES or len(relative) > 4000:
                    return
                left -= len(content)
                stream.write(_HEAD.pack(len(relative), status.st_mode & 0o111, len(content)))
                stream.write(relative + content)


def _open_file(name: str, folder: int) -> "int | None":
    """A descriptor of a regular file; None for others and for what cannot be read."""
    try:
        found = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
    except OSError:
        return None
    if stat.S_ISREG(os.fstat(found).st_mode):
        return found
    os.close(found)
    return None


# -- in this process -------------------------------------------------------------------------------

def _receive_files(read: Callable[[int], bytes], limit: int) -> Iterator[Tuple[str, int, bytes]]:
    """Names, permissions to execute and contents of what a student's child sends."""
    left = limit
    while True:
        head = read(_HEAD.size)
        if len(head) < _HEAD.size:
            return
        length, mode, size = _HEAD.unpack(head)
        if size > left:
            return
        left -= size
        name = os.fsdecode(read(length))
        content = read(size)
        if len(content) < size:
            return
        yield name, mode, content


def _store(folder: str, name: str, mode: int, content: bytes) -> None:
    parts = name.split("/")
    if any(part in ("", ".", "..") or "\0" in part for part in parts):
        return
    path = os.path.join(folder, *parts)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as stream:
        stream.write(content)
    os.chmod(path, 0o644 | (0o111 if mode else 0))
