"""Finds submissions and their files, and hashes their content."""
from __future__ import annotations

import fnmatch
import hashlib
import os
from dataclasses import dataclass
from itertools import chain
from typing import Dict, List, Sequence

from ..errors import CommandError
from .box import open_regular
from .submission_files import content_of

_CHUNK = 1 << 20
_SHOWN_FILES = 5

ARCHIVES = {".zip": "zip", ".tar.gz": "tar", ".tgz": "tar"}
"""Endings of archives that are unpacked, and their kinds."""


@dataclass(frozen=True)
class Submission:
    """A submission of a student.

    Attributes:
        student: name, unique in a run: that of the folder, or of the file without its ending.
        path: absolute path of the folder, file or archive.
    """

    student: str
    path: str


def submissions_of(paths: Sequence[str]) -> List[Submission]:
    """The submissions of a command line.

    Raises CommandError: a path does not exist, or two submissions have one name.
    """
    found: Dict[str, Submission] = {}
    for path in paths:
        full = os.path.abspath(path)
        if not os.path.exists(full):
            raise CommandError(f"there is no submission {path}")
        name = os.path.basename(full)
        student = name if os.path.isdir(full) else _without_ending(name)
        if not student:
            raise CommandError(f"{path} has no name that could be a student's")
        if student in found:
            raise CommandError(f"two submissions have the name {student}: {found[student].path} and"
                               f" {full}")
        found[student] = Submission(student, full)
    return list(found.values())


def _without_ending(name: str) -> str:
    for ending in ARCHIVES:
        if name.lower().endswith(ending):
            return name[:-len(ending)]
    return os.path.splitext(name)[0]


def size_of(path: str) -> int:
    """Bytes of all files of a submission. Raises as content_of."""
    return sum(os.path.getsize(full) for _, full in content_of(path).files)


def content_key(path: str, *more: str) -> str:
    """SHA-256 of names, permissions to execute and contents of all files, and of more texts.

    Raises as content_of.
    """
    digest = hashlib.sha256("\0".join(more).encode())
    content = content_of(path)
    for name in content.unreadable:
        digest.update(os.fsencode(f"\0{name}\0unreadable\0"))
    for relative, full in content.files:
        with open_regular(full) as stream:
            status = os.fstat(stream.fileno())
            runs = bool(status.st_mode & 0o111)
            digest.update(os.fsencode(f"\0{relative}\0{runs}\0{status.st_size}\0"))
            for chunk in iter(lambda: stream.read(_CHUNK), b""):
                digest.update(chunk)
    return digest.hexdigest()


def find_matching(folder: str, patterns: Sequence[str]) -> str:
    """Return the first file of a submission that fits one of the patterns; "" for none.

    A pattern is a path in the submission, or a name alone, which is looked for in all folders;
    earlier patterns, names in the same case, and shorter paths come first. Hidden files are left
    out.
    """
    return next(iter(find_all_matching(folder, patterns)), "")


def find_all_matching(folder: str, patterns: Sequence[str]) -> List[str]:
    """Return all files of a submission that fit a pattern, in the order of `find_matching`."""
    return list(dict.fromkeys(chain.from_iterable(files_by_pattern(folder, patterns))))


def describe_ambiguity(folder: str, patterns: Sequence[str]) -> str:
    """Name the file that `find_matching` chooses among several; "" if only one fits the pattern."""
    for pattern, found in zip(patterns, files_by_pattern(folder, patterns)):
        if len(found) > 1:
            return (f"{found[0]} was graded, which has the fewest folders and then the first name;"
                    f" the submission contains more files that fit {pattern}:"
                    f" {summarize_names(found[1:])}")
        if found:
            return ""
    return ""


def reason_for_no_match(folder: str, patterns: Sequence[str], unreadable: Sequence[str] = ()
                        ) -> str:
    """Explain why `find_matching` found no file; `unreadable` are files that were left out."""
    hidden = [name for name in unreadable for pattern in patterns
              if _fits(name.lower(), pattern.lower())]
    if hidden:
        return f"{hidden[0]} cannot be read: its permissions forbid it"
    names = [relative for relative, _ in content_of(folder).files]
    content = f"it contains {summarize_names(names)}" if names else "it is empty"
    return f"the submission contains no {' or '.join(patterns)}; {content}"


def summarize_names(names: Sequence[str]) -> str:
    """Join the first names with commas and add the number of the others."""
    more = len(names) - _SHOWN_FILES
    return ", ".join(names[:_SHOWN_FILES]) + (f" and {more} more" if more > 0 else "")


def files_by_pattern(folder: str, patterns: Sequence[str]) -> List[List[str]]:
    """The files that fit each pattern, in the order of `find_matching`."""
    names = sorted((relative for relative, _ in content_of(folder).files
                    if not os.path.basename(relative).startswith(".")),
                   key=lambda name: (name.count(os.sep), name))
    found = []
    for pattern in patterns:
        same_case = [name for name in names if _fits(name, pattern)]
        found.append(same_case or [name for name in names
                                   if _fits(name.lower(), pattern.lower())])
    return found


def _fits(name: str, pattern: str) -> bool:
    return fnmatch.fnmatchcase(name, pattern) or (
        "/" not in pattern and fnmatch.fnmatchcase(os.path.basename(name), pattern))
