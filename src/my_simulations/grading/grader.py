"""Grades submissions, several side by side; those that have not changed keep their marks."""
from __future__ import annotations

import contextlib
import fcntl
import os
import queue
import shutil
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Callable, Dict, Iterator, List, Optional, Sequence, Tuple

from .. import __version__
from ..errors import CommandError
from ..resources.database.archive import ArchiveError, extract
from ..resources.database.http_download import Limits
from ..simulator.safe_file import write_atomically
from ..studies.provenance import digest_of_file
from .assignment import Assignment
from .box_process import GradingStoppedError, contains, grade_in_box
from .mark import FAILED, GRADED, Mark, all_failed, mark_of
from .program import workspace_paths
from .submission import ARCHIVES, Submission, content_key, size_of
from .submission_files import MOST_FILES, SubmissionError, content_of

STUDENTS = "students"
"""Folder of the students' folders."""

MARK = "mark.json"

Told = Callable[[Mark, bool], None]
"""Called for each mark, with whether it was kept from a run before."""


class Grader:
    """Grades into a folder.

    Args:
        assignment: the assignment.
        out: folder of the marks; created.
        jobs: submissions that are graded at a time.
        namespaces: whether to isolate submissions by namespaces.
        told: called for each mark, in the order in which they come, from any thread.

    Raises:
        CommandError: the folder cannot be written.
    """

    def __init__(self, assignment: Assignment, out: str, jobs: int, namespaces: bool,
                 told: Told) -> None:
        self._assignment = assignment
        self._out = os.path.abspath(out)
        self._jobs = jobs
        self._namespaces = namespaces
        self._told = told
        self._digests: Dict[str, str] = {}
        self._stop = threading.Event()
        self._slots: "queue.Queue[int]" = queue.Queue()
        self._base = self._key_of_assignment()
        try:
            os.makedirs(os.path.join(self._out, STUDENTS), exist_ok=True)
        except OSError as fault:
            raise CommandError(f"cannot write to {out}: {fault.strerror}") from None

    def run(self, submissions: Sequence[Submission]) -> List[Mark]:
        """The marks of all submissions, in order.

        Raises:
            KeyboardInterrupt: after all boxes have ended; marks so far are kept.
            CommandError: there are no user ids for the submissions.
        """
        hidden = [self._out, *(submission.path for submission in submissions),
                  *self._folders_of(submissions)]
        with reserve_slots(self._jobs) as slots, ThreadPoolExecutor(self._jobs, "grader") as pool:
            self._slots = queue.Queue()
            for slot in slots:
                self._slots.put(slot)
            waiting = [pool.submit(self._grade, one, hidden) for one in submissions]
            try:
                return [one.result() for one in waiting]
            except BaseException:
                self._stop.set()
                for one in waiting:
                    one.cancel()
                raise

    def _folders_of(self, submissions: Sequence[Submission]) -> List[str]:
        """The folders in which submissions lie beside others, as far as nothing else needs them."""
        needed = [os.getcwd(), os.path.expanduser("~"), *self._assignment.files,
                  *workspace_paths()]
        return [folder for folder in {os.path.dirname(one.path) for one in submissions}
                if not any(contains(os.path.realpath(folder), os.path.realpath(path))
                           for path in needed)]

    def folder_of(self, student: str) -> str:
        return os.path.join(self._out, STUDENTS, student)

    def _grade(self, submission: Submission, hidden: Sequence[str]) -> Mark:
        if self._stop.is_set():
            raise GradingStoppedError
        folder = self.folder_of(submission.student)
        slot = self._slots.get()
        try:
            mark, was_kept = self._kept_or_new(submission, folder, slot, hidden)
        except SubmissionError as fault:
            mark, was_kept = self._refuse(submission, GRADED, f"cannot be graded: {fault}"), False
        except (OSError, ValueError) as fault:   # such as a full disk: one submission, not all
            reason = (f"could not be graded: {fault}" if os.path.exists(submission.path)
                      else "was deleted")
            mark, was_kept = self._refuse(submission, FAILED, reason), False
        finally:
            self._slots.put(slot)
        if not was_kept:
            os.makedirs(folder, exist_ok=True)
            write_atomically(os.path.join(folder, MARK), mark.to_json().encode(), overwrite=True)
        self._told(mark, was_kept)
        return mark

    def _kept_or_new(self, submission: Submission, folder: str, slot: int, hidden: Sequence[str]
                     ) -> Tuple[Mark, bool]:
        """The mark, and whether it is that of a run before."""
        limit = int(self._assignment.limits.file_mb * 1e6)
        size = size_of(submission.path)
        key = content_key(submission.path, self._base) if size <= limit else ""
        kept = self._find_kept_mark(submission.student, key) if key else None
        if kept is not None:
            return kept, True
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder, exist_ok=True)
        if not key:          # such files are not even read
            return self._refuse(submission, GRADED, f"has {size / 1e6:.0f} MB, the limit is"
                                f" {limit / 1e6:.0f} MB"), False
        try:
            with unpack_submission(submission, folder, limit) as content:
                mark = grade_in_box(self._assignment, content, slot, hidden, folder,
                                    self._namespaces, self._stop)
        except ArchiveError as fault:
            mark = self._refuse(submission, GRADED, f"cannot be unpacked: {fault}")
        if self._key_of(submission) != key:
            note = "the submission was changed while it was graded; the next run grades it again"
            return replace(mark, notes=[*mark.notes, note]), False
        return replace(mark, key=key), False

    def _refuse(self, submission: Submission, status: str, reason: str) -> Mark:
        """A mark without points; `reason` continues "the submission"."""
        return all_failed(self._assignment, submission.student, status,
                          f"the submission {reason}")

    def _key_of(self, submission: Submission) -> str:
        """Key of the submission now; "" if it cannot be read."""
        with contextlib.suppress(OSError, SubmissionError):
            return content_key(submission.path, self._base)
        return ""

    def _find_kept_mark(self, student: str, key: str) -> Optional[Mark]:
        """The mark of a run before, if it is of the same submission and was decided."""
        with contextlib.suppress(OSError, ValueError, TypeError, KeyError):
            with open(os.path.join(self.folder_of(student), MARK), encoding="utf-8") as stream:
                mark = mark_of(stream.read())
            if mark.key == key and mark.status != FAILED and all(
                    self._digest(path) == digest for path, digest in mark.library):
                return mark
        return None

    def _digest(self, path: str) -> str:
        """The digest of a file, which many submissions may include."""
        if path not in self._digests:
            self._digests[path] = digest_of_file(path)
        return self._digests[path]

    def _key_of_assignment(self) -> str:
        """Of all that decides a mark besides the submission."""
        own = os.path.dirname(os.path.abspath(__file__))
        keys = [content_key(path) for path in (*self._assignment.files, own)]
        return "\0".join([__version__, str(self._namespaces), *keys])


MOST_SLOTS = 999
"""Of all runs of this machine: user ids of a slot are a first id and its number."""

_FOLDER = "/run/my_simulations_grade"


@contextlib.contextmanager
def reserve_slots(count: int, folder: str = _FOLDER) -> Iterator[List[int]]:
    """Reserve numbers of slots, from 0, that no other run of this machine has.

    A limit of processes counts all processes of a user, also those of another run. Locks of a run
    that was killed are free again. Only root changes the user of a submission, so others need no
    locks.

    Args:
        count: number of slots.
        folder: of the locks; created.

    Raises:
        CommandError: the folder cannot be written, or all slots are in use.
    """
    if os.geteuid() != 0:
        yield list(range(count))
        return
    slots: List[int] = []
    with contextlib.ExitStack() as locks:
        try:
            os.makedirs(folder, 0o700, exist_ok=True)
            for slot in range(MOST_SLOTS):
                if len(slots) < count and _lock(os.path.join(folder, str(slot)), locks):
                    slots.append(slot)
        except OSError as fault:
            raise CommandError(f"cannot reserve user ids in {folder}: {fault.strerror}") from None
        if len(slots) < count:
            raise CommandError(f"only {len(slots)} of {count} user ids are free; use --jobs")
        yield slots


def _lock(path: str, locks: contextlib.ExitStack) -> bool:
    """Whether a file could be locked until the stack ends."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        return False
    locks.callback(os.close, descriptor)
    return True


_SECONDS = 120.0
_MOST_ARCHIVES = 2   # in each other


@contextlib.contextmanager
def unpack_submission(submission: Submission, folder: str, most_bytes: int) -> Iterator[Submission]:
    """Unpack a submission if it is an archive; provide its content for a `with` block.

    An archive is a submission if it is handed in itself, or as the only file of a folder. If it
    contains one archive only, as learning platforms pack uploads, that one is unpacked, too.

    Args:
        submission: the submission as it was handed in.
        folder: existing folder; contains the unpacked files until the `with` block ends. No other
            submission may see it.
        most_bytes: limit of all unpacked files.

    Raises:
        ArchiveError: the archive is damaged, too large, encrypted, or writes outside of its folder.
    """
    with contextlib.ExitStack() as ending:
        until = time.monotonic() + _SECONDS
        for _ in range(_MOST_ARCHIVES):
            archive = archive_of(submission)
            if not archive:
                break
            above = ending.enter_context(tempfile.TemporaryDirectory(prefix=".unpacked_",
                                                                     dir=folder))
            path = os.path.join(above, "files")
            extract(_kind_of(archive), archive, path,
                    Limits(files=MOST_FILES, unpacked_bytes=most_bytes), until, skips_links=True)
            submission = Submission(submission.student, path)
        yield submission


def _kind_of(archive: str) -> str:
    return next(kind for ending, kind in ARCHIVES.items() if archive.lower().endswith(ending))


def archive_of(submission: Submission) -> str:
    """Path of the archive that a submission consists of; "" for none."""
    files = [full for relative, full in content_of(submission.path).files
             if not os.path.basename(relative).startswith(".")]
    is_archive = len(files) == 1 and files[0].lower().endswith(tuple(ARCHIVES))
    return files[0] if is_archive else ""
