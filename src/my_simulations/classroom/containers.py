"""Starts and stops the containers of a class, and copies files, with docker, podman or kubectl.

All that happens in a container happens as the student. A student may have written its output
and files, so their size is limited, and links are left out.
"""
from __future__ import annotations

import subprocess
import tarfile
from typing import IO, Any, Dict, List, Sequence

import yaml

from ..child_process import wait_or_kill
from ..errors import CommandError
from .class_plan import ClassPlan, Student
from .manifests import ENTRY, WORLD, container_name, label
from .student_files import MOST_FILES, RECEIVED, Store, store_collection

DOCKER, PODMAN, KUBECTL = "docker", "podman", "kubectl"
PROGRAMS = (DOCKER, PODMAN, KUBECTL)
"""Programs that manage containers."""

_END_S = 1.0   # that a program gets to end by itself
_CALL_S = 120.0
_HEAD_BYTES = 4096      # of the archive, for each file
_MEMORY = ("cat /sys/fs/cgroup/memory.current 2>/dev/null"
           " || cat /sys/fs/cgroup/memory/memory.usage_in_bytes 2>/dev/null || echo 0")
_RECEIVE = (f'mkdir -p ~/{RECEIVED} && cat > ~/{RECEIVED}/.new'
            f' && mv -T ~/{RECEIVED}/.new ~/{RECEIVED}/"$1"')
_ARCHIVE = 'cd ~ && if [ -d "$1" ]; then exec tar -C "$1" -cf - .; fi'


class Containers:
    """The containers of a class.

    Args:
        plan: the class; its `containers` names the program.
    """

    def __init__(self, plan: ClassPlan) -> None:
        self._plan = plan
        self._program = plan.containers

    def status(self, student: Student) -> Dict[str, Any]:
        """`name`, `state`, `models`, `time` (s), `memory_mb` and `reason` of a student's world."""
        found: Dict[str, Any] = {"name": student.name, "state": "running", "models": 0, "time": 0.0,
                                 "memory_mb": 0.0, "reason": ""}
        try:
            memory, _, rest = self._run(student, f"{_MEMORY}; exec {ENTRY} rosservice call {WORLD}"
                                        ).decode("utf-8", "replace").partition("\n")
            found["memory_mb"] = int(memory) / 1e6
            world = yaml.safe_load(rest)
            found["models"], found["time"] = len(world["model_names"]), float(world["sim_time"])
        except CommandError as fault:
            found["state"], found["reason"] = "stopped", str(fault)
        except (ValueError, LookupError, TypeError, yaml.YAMLError):
            found["state"], found["reason"] = "stopped", "the world does not answer"
        return found

    def send(self, student: Student, name: str, content: bytes) -> str:
        """Write a file into a home; returns its path there, from the home. Raises CommandError."""
        self._run(student, _RECEIVE, (name,), content)
        return f"{RECEIVED}/{name}"

    def collect(self, student: Student, out: str) -> int:
        """Copy the submission of a student to OUT/NAME; returns the number of files.

        Replaces an earlier collection. Links, hidden folders, and files beyond the limits of the
        class are left out. Raises CommandError: the files cannot be read or written.
        """
        return store_collection(student, out, lambda store: self._unpack(student, store))

    def _unpack(self, student: Student, store: Store) -> None:
        limit = int(self._plan.limits.file_mb * 1e6)
        process = self._exec(student, _ARCHIVE, (self._plan.submission,), subprocess.DEVNULL)
        assert process.stdout is not None and process.stderr is not None
        archive = _LimitedStream(process.stdout, limit + MOST_FILES * _HEAD_BYTES)
        is_whole, problem = False, ""
        try:
            is_whole = _unpack(archive, limit, store)
        except (tarfile.TarError, EOFError) as fault:
            problem = f"the archive is invalid: {fault}" if archive.read_bytes else ""
        finally:
            process.stdout.close()     # a program that still writes ends
            said = process.stderr.read()
            process.stderr.close()
            wait_or_kill(process, _END_S)
            status = process.returncode
        if status and (is_whole or not archive.read_bytes):
            problem = _last_line(said)
        if problem:
            raise CommandError(f"files of {student.name}: {problem}")

    def run_program(self, student: Student, word: str) -> "subprocess.Popen[bytes]":
        """Run `start` or `stop` for a container. Raises CommandError: there is no such program."""
        return self._popen([self._program, word, container_name(self._plan, student)],
                           subprocess.DEVNULL)

    def measure(self, student: Student) -> "subprocess.Popen[bytes]":
        """Print the memory of a container, bytes; fails if it does not run. Raises CommandError."""
        return self._exec(student, _MEMORY, (), subprocess.DEVNULL)

    # -- programs in containers ------------------------------------------------------------------

    def _run(self, student: Student, script: str, arguments: Sequence[str] = (),
             data: bytes = b"") -> bytes:
        process = self._exec(student, script, arguments, subprocess.PIPE)
        try:
            output, said = process.communicate(data, _CALL_S)
        except subprocess.TimeoutExpired:
            raise CommandError(f"the container of {student.name} does not answer") from None
        finally:
            wait_or_kill(process, _END_S)
        if process.returncode:
            raise CommandError(f"container of {student.name}: {_last_line(said)}")
        return output

    def _exec(self, student: Student, script: str, arguments: Sequence[str], source: int
              ) -> "subprocess.Popen[bytes]":
        words = [self._program, "exec", "-i", container_name(self._plan, student)]
        if self._program == KUBECTL:
            words = [KUBECTL, "-n", label(self._plan.name), "exec", "-i",
                     f"deployment/{label(student.name)}", "--"]
        return self._popen([*words, "sh", "-c", script, "sh", *arguments], source)

    def _popen(self, words: List[str], source: int) -> "subprocess.Popen[bytes]":
        try:
            return subprocess.Popen(words, stdin=source, stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE)
        except OSError as fault:
            raise CommandError(f"{words[0]} cannot be run: {fault.strerror}") from None


class _LimitedStream:
    """Reads at most so many bytes of a stream: an archive may contain headers of any size."""

    def __init__(self, stream: IO[bytes], limit: int) -> None:
        self._stream, self._left = stream, limit
        self.read_bytes = 0

    def read(self, size: int) -> bytes:
        """Read bytes. Raises EOFError: the limit is exceeded."""
        if size > self._left:
            raise EOFError("it is too large")
        self._left -= size
        found = self._stream.read(size)
        self.read_bytes += len(found)
        return found


def _unpack(stream: Any, limit: int, store: Store) -> bool:
    """Store the regular files of an archive; returns whether all are within the limits.

    Raises TarError or EOFError.
    """
    left = limit
    with tarfile.open(fileobj=stream, mode="r|") as archive:
        for number, member in enumerate(archive):
            name = member.name[2:] if member.name.startswith("./") else member.name
            if not member.isreg() or any(part.startswith(".") for part in name.split("/")[:-1]):
                continue
            if member.size > left or number > MOST_FILES:
                return False
            left -= member.size
            content = archive.extractfile(member)
            if content is not None:
                store(name, member.mode & 0o111, content.read())
    return True


def _last_line(said: bytes) -> str:
    lines = said.decode("utf-8", "replace").strip().splitlines()
    return lines[-1][:300] if lines else "the command failed"
