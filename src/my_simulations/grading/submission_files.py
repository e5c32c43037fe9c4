"""Lists the files of a submission, whatever a student has put into its folder."""
from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from typing import List, Tuple

from ..errors import SimulationError

MOST_FILES = 20000
MOST_DEPTH = 50
"""Folders in each other; a deeper tree exhausts the stack of programs that walk it."""

_MAC_FOLDER = "__MACOSX"   # what macOS adds to zip files: it is not of the student


class SubmissionError(SimulationError):
    """A submission whose files cannot be graded, through a fault of its own."""


@dataclass(frozen=True)
class Content:
    """The files of a submission.

    Attributes:
        files: relative and full path of each regular file that can be read, sorted.
        unreadable: relative paths of files and folders whose permissions forbid reading, sorted.
    """

    files: List[Tuple[str, str]]
    unreadable: List[str]


def content_of(path: str) -> Content:
    """List the files of a submission.

    Links, sockets, pipes and devices are left out: they may lead out of the submission. A file that
    no permission allows to read is unreadable for root, too: the mark is the same for all graders.

    Args:
        path: folder or file.

    Raises:
        SubmissionError: it has more than MOST_FILES files or MOST_DEPTH folders in each other.
        OSError: it does not exist.
    """
    files: List[Tuple[str, str]] = []
    unreadable: List[str] = []
    if not os.path.isdir(path):
        full = os.path.realpath(path)      # a grader may link to it
        _add(os.path.basename(path), full, os.lstat(full).st_mode, files, unreadable)
        return Content(files, unreadable)
    waiting = [("", path)]
    count = 0
    while waiting:
        above, folder = waiting.pop()
        if above.count(os.sep) > MOST_DEPTH:
            raise SubmissionError(f"it has more than {MOST_DEPTH} folders in each other")
        for name in os.listdir(folder):
            count += 1
            if count > MOST_FILES:
                raise SubmissionError(f"it has more than {MOST_FILES} files")
            full, relative = os.path.join(folder, name), above + name
            mode = os.lstat(full).st_mode
            if stat.S_ISDIR(mode):
                if name.startswith(".") or name == _MAC_FOLDER:
                    continue
                if _is_readable(full, mode):
                    waiting.append((relative + os.sep, full))
                else:
                    unreadable.append(relative)
            else:
                _add(relative, full, mode, files, unreadable)
    return Content(sorted(files), sorted(unreadable))


def _add(relative: str, full: str, mode: int, files: List[Tuple[str, str]],
         unreadable: List[str]) -> None:
    if not stat.S_ISREG(mode):
        return
    if _is_readable(full, mode):
        files.append((relative, full))
    else:
        unreadable.append(relative)


def _is_readable(path: str, mode: int) -> bool:
    needed = os.R_OK | os.X_OK if stat.S_ISDIR(mode) else os.R_OK
    return bool(mode & 0o444) and os.access(path, needed)
