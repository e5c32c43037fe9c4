"""doc/first_hour.md, read and typed in: every command of the three ways, from a fresh clone on."""
from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import List

import pytest
from free_ports import free_port
from generated_messages import DEVEL, copy_messages

REPOSITORY = Path(__file__).resolve().parents[2]
PAGE = REPOSITORY / "doc" / "first_hour.md"
OWN = DEVEL.parent / ".my_simulations"
"""Where it has what it fetched; fetching is not what the page is about."""
OLDER = ["find", ".", "-path", "*/compat/*", "-type", "f", "-exec",
         "touch", "-d", "2020-01-01", "{}", "+"]
"""make generates again what is older than its definition: definitions of a clone are old."""

BLOCK = re.compile(r"^```(\w+)(?: ([\w-]+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMAND_SECONDS = 900.0
START_SECONDS = 300.0
READY = "the world editor is at http"


@dataclass
class Block:
    """What is typed into one terminal, and what must come out of it."""

    script: str
    stays: bool
    shown: List[str]


def ways():
    """The page's sections with blocks, by number."""
    parts = re.split(r"^## Way (\d).*$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {number: blocks(text) for number, text in zip(parts[1::2], parts[2::2])}


def blocks(text):
    """Return the blocks of a section in order. Shown output belongs to the block before it."""
    found: List[Block] = []
    for language, word, body in BLOCK.findall(text):
        if language == "bash":
            found.append(Block(body, word == "keeps-running", []))
        elif language == "text":
            found[-1].shown += body.splitlines()
    return found


class Terminals:
    """A home folder, and terminals that are opened in it."""

    def __init__(self, home: Path) -> None:
        self.home = home
        self.environment = {
            "HOME": str(home), "PATH": "/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin",
            "LANG": "C.UTF-8", "MY_SIMULATIONS_NO_BROWSER": "1",
            "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}", "ROS_IP": "127.0.0.1",
            # Marks the processes that belong to the tests.
            **{key: value for key, value in os.environ.items()
               if key.startswith("MY_SIMULATIONS_TEST")},
        }
        self._running = None

    def type(self, block: Block) -> None:
        """Run a block; what keeps running ends when the next such block begins."""
        if block.stays:
            self.end()
            self._start(block.script)
            return
        done = subprocess.run(["bash", "-e", "-c", block.script], env=self.environment,
                              cwd=self.home, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=COMMAND_SECONDS)
        assert done.returncode == 0, f"{block.script}\n{done.stdout[-4000:]}"
        lines = [line.strip() for line in done.stdout.splitlines()]
        for line in block.shown:
            assert line in lines, f"{block.script}\n{done.stdout}"

    def _start(self, script):
        log = self.home / "terminal.log"
        with open(log, "w", encoding="utf-8") as output:
            self._running = subprocess.Popen(
                ["bash", "-e", "-c", script], env=self.environment, cwd=self.home,
                stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                start_new_session=True)
        until = time.monotonic() + START_SECONDS
        while READY not in log.read_text(encoding="utf-8"):
            assert self._running.poll() is None, f"{script}\n{log.read_text()}"
            assert time.monotonic() < until, f"{script}\n{log.read_text()}"
            time.sleep(0.05)

    def end(self) -> None:
        """Press Ctrl-C where something runs."""
        if self._running is None:
            return
        running, self._running = self._running, None
        os.killpg(running.pid, signal.SIGINT)
        try:
            running.wait(60.0)
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()
            raise


@pytest.fixture(scope="module")
def repository(tmp_path_factory):
    """The files under test as a repository that can be cloned."""
    folder = tmp_path_factory.mktemp("origin") / "my_simulations"
    shutil.copytree(REPOSITORY, folder, symlinks=True, ignore=shutil.ignore_patterns(
        ".git", "node_modules", "__pycache__"))
    author = ["-c", "user.name=test", "-c", "user.email=test@localhost"]
    for words in (["init", "-q"], ["add", "-A"], [*author, "commit", "-qm", "x"]):
        subprocess.run(["git", *words], cwd=folder, check=True)
    return folder


@pytest.fixture
def terminals(tmp_path, repository):
    home = tmp_path / "home"
    own = home / "simulation_ws" / ".my_simulations"
    own.mkdir(parents=True)
    for name in ("venv", "node_modules", ".page"):
        (own / name).symlink_to(OWN / name)
    copy_messages(lambda _package: home / "simulation_ws" / "devel")
    clone = home / "my_simulations_clone"
    subprocess.run(["git", "clone", "-q", str(repository), str(clone)], check=True)
    subprocess.run(OLDER, cwd=clone, check=True)
    opened = Terminals(home)
    yield opened
    opened.end()


def test_page_has_the_three_ways():
    found = ways()
    assert sorted(found) == ["1", "2", "3"]
    assert all(sum(block.stays for block in way) == 3 for way in found.values())


@pytest.mark.parametrize("number", ["1", "2", "3"])
def test_every_command_of_a_way_does_what_the_page_says(terminals, number):
    began = time.monotonic()
    for block in ways()[number]:
        terminals.type(block)
    print(f"way {number}: {time.monotonic() - began:.0f} s", file=sys.stderr)
