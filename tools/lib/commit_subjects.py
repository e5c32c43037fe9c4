#!/usr/bin/env python3
"""Check the subjects of the commits made since CONTRIBUTING.md came: commit_subjects.py FOLDER.

The last line of the output says what was checked. Exit status 1 when a subject breaks the rule;
0 otherwise, also where there is no history to check (a tarball, a shallow clone).
"""
from __future__ import annotations

import os
import re
import subprocess
import sys
from typing import List, NamedTuple

RULE_FILE = "CONTRIBUTING.md"
"""The file that states the rule: commits made before it was added are not checked."""

LONGEST = 72
AREA = r"[a-z0-9][\w./+-]*(?: [\w./+-]+)?"
SUBJECT = re.compile(rf"^{AREA}(?:, {AREA})*: \S.*[^\s.]$")
REVERT = re.compile(r'^Revert "')


class Commit(NamedTuple):
    short: str
    committed: int
    subject: str


class NoHistoryError(Exception):
    """There is nothing to check; the message says why."""


def git(folder: str, *words: str) -> str:
    """The output of a git command. Raises NoHistoryError when there is no git or it fails."""
    try:
        done = subprocess.run(["git", "-C", folder, *words], capture_output=True, check=False)
    except OSError as fault:
        raise NoHistoryError(f"git cannot be run: {fault}") from fault
    if done.returncode:
        lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
        raise NoHistoryError(lines[0] if lines else f"git {words[0]} failed")
    return done.stdout.decode("utf-8", "replace").strip()


def commits(folder: str, *words: str) -> List[Commit]:
    """Commits that `git log` lists, newest first."""
    found = []
    for line in git(folder, "log", "--format=%h%x09%ct%x09%s", *words).splitlines():
        short, committed, subject = line.split("\t", 2)
        found.append(Commit(short, int(committed), subject))
    return found


def commits_to_check(folder: str) -> List[Commit]:
    """The commits that are under the rule, without merges. Raises NoHistoryError."""
    top = git(folder, "rev-parse", "--show-toplevel")
    if os.path.realpath(top) != os.path.realpath(folder):
        raise NoHistoryError(f"{folder} is not the top of a git repository")
    added = commits(folder, "--diff-filter=A", "--", RULE_FILE)
    if not added:
        raise NoHistoryError(f"no commit in this history adds {RULE_FILE}")
    # By time, not by ancestry: branches begun before the rule are merged after it.
    begin = added[-1].committed
    return [commit for commit in commits(folder, "--no-merges") if commit.committed > begin]


def fault_of(subject: str) -> str:
    """What is wrong with a subject; "" when nothing is."""
    if REVERT.match(subject):
        return ""
    if len(subject) > LONGEST:
        return f"{len(subject)} characters, at most {LONGEST} are allowed"
    if not SUBJECT.match(subject):
        return "not of the form 'area: what changes', without a full stop"
    return ""


def main(folder: str) -> int:
    """Check the repository at `folder`; returns the exit status."""
    try:
        checked = commits_to_check(folder)
    except NoHistoryError as reason:
        print(f"no history to check: {reason}")
        return 0
    faults = 0
    for commit in checked:
        fault = fault_of(commit.subject)
        if fault:
            faults += 1
            print(f"{commit.short} {commit.subject}\n  {fault}; see {RULE_FILE}")
    print(f"{faults} of {len(checked)} subjects break the rule" if faults
          else f"{len(checked)} subjects ok")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else os.getcwd()))
