"""The check of commit subjects, on small repositories."""
from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]
SCRIPT = REPOSITORY / "tools" / "lib" / "commit_subjects.py"
sys.path.insert(0, str(SCRIPT.parent))

from commit_subjects import fault_of


@pytest.mark.parametrize("subject", [
    "formats: copy static from included models",
    "compat/xacro: offer xacro_add_files to CMake",
    "engine, simulator: restore pinned bodies after a crash",
    "set-up: ask before sudo",
    "check_model: count tolerated faults with --strict",
    'Revert "formats: copy static from included models"',
    "a: " + 69 * "x",
])
def test_subject_of_the_right_form_is_accepted(subject):
    assert fault_of(subject) == ""


@pytest.mark.parametrize("subject, word", [
    ("a: " + 70 * "x", "73 characters"),
    ("A node at rest wakes half as often", "form"),
    ("engine: cache bodies.", "form"),
    ("engine:", "form"),
    ("engine:cache", "form"),
    (": cache bodies", "form"),
    ("fixup! engine: cache bodies", "form"),
])
def test_subject_of_another_form_is_refused_with_the_reason(subject, word):
    assert word in fault_of(subject)


class Repository:
    """A git repository with commits at given times."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.seconds = 1_700_000_000
        self.git("init", "-q", "-b", "main")

    def git(self, *words):
        date = f"{self.seconds} +0000"
        environment = {**os.environ, "GIT_COMMITTER_DATE": date, "GIT_AUTHOR_DATE": date,
                       "GIT_CONFIG_GLOBAL": os.devnull}
        subprocess.run(["git", "-c", "user.name=t", "-c", "user.email=t@localhost", *words],
                       cwd=self.folder, env=environment, check=True, capture_output=True)

    def commit(self, subject, *files):
        self.seconds += 60
        for name in files:
            (self.folder / name).write_text(subject)
            self.git("add", name)
        self.git("commit", "-q", "--allow-empty", "-m", subject)

    def check(self, folder=None):
        done = subprocess.run([sys.executable, str(SCRIPT), str(folder or self.folder)],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return done.returncode, done.stdout


@pytest.fixture
def repository(tmp_path):
    folder = tmp_path / "repository"
    folder.mkdir()
    made = Repository(folder)
    made.commit("An old riddle that nobody checks any more")
    made.commit("doc: add a guide for contributors", "CONTRIBUTING.md")
    return made


def test_commits_before_the_rule_are_not_checked(repository):
    assert repository.check() == (0, "0 subjects ok\n")


def test_commit_after_the_rule_that_breaks_it_fails_the_check(repository):
    repository.commit("engine: cache bodies")
    assert repository.check() == (0, "1 subjects ok\n")
    repository.commit("Bodies are cached")
    status, output = repository.check()
    assert status == 1
    assert "Bodies are cached" in output and output.endswith("1 of 2 subjects break the rule\n")


def test_merge_commits_are_exempt(repository):
    repository.git("checkout", "-q", "-b", "side", "HEAD~1")
    repository.commit("formats: read frames")
    repository.git("checkout", "-q", "main")
    repository.seconds += 60
    repository.git("merge", "-q", "--no-ff", "-m", "Merge what was made aside", "side")
    assert repository.check() == (0, "1 subjects ok\n")


def test_tarball_without_history_passes_and_says_so(repository, tmp_path):
    shutil.rmtree(repository.folder / ".git")
    status, output = repository.check()
    assert status == 0 and output.startswith("no history to check: ")


def test_folder_inside_another_repository_passes_and_says_so(repository):
    inner = repository.folder / "inner"
    inner.mkdir()
    repository.commit("This breaks the rule")
    status, output = repository.check(inner)
    assert status == 0 and "not the top of a git repository" in output


def test_shallow_clone_without_the_rules_commit_passes(repository, tmp_path):
    repository.commit("engine: cache bodies")
    clone = tmp_path / "clone"
    words = ["git", "clone", "-q", "--depth", "1", f"file://{repository.folder}", str(clone)]
    subprocess.run(words, check=True, capture_output=True)
    assert repository.check(clone)[0] == 0
