"""Unpacks submissions that are archives, as learning platforms hand them out."""
from __future__ import annotations

import contextlib
import os
import tempfile
import time
from typing import Iterator

from ..resources.database.archive import extract
from ..resources.database.http_download import Limits
from .submission import ARCHIVES, Submission
from .submission_files import MOST_FILES, content_of

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
