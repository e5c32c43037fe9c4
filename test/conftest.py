"""Names tests, and measures their cost: `pytest --processor-time 30` lists the thirty dearest."""
from __future__ import annotations

import os
import sys
from typing import Dict, Iterator, List, Optional

import pytest

ADOPTER = "MY_SIMULATIONS_ADOPTER"
_TICKS = os.sysconf("SC_CLK_TCK")


def processor_seconds() -> float:
    """Processor time (user and system) that this process and its descendants have used, in seconds.

    Counts descendants that run and those that were waited for. What an orphan used is lost, unless
    a program that adopts orphans (`tools/lib/adopt.py`) runs the tests: its descendants count then.
    """
    children: Dict[int, List[int]] = {}
    used: Dict[int, int] = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as stream:
                fields = stream.read().rpartition(")")[2].split()
        except OSError:     # it has ended
            continue
        children.setdefault(int(fields[1]), []).append(int(name))
        used[int(name)] = sum(map(int, fields[11:15]))      # proc(5): utime, stime, cutime, cstime
    total, waiting = 0, [int(os.environ.get(ADOPTER, os.getpid()))]
    while waiting:
        process = waiting.pop()
        total += used.get(process, 0)
        waiting += children.get(process, [])
    return total / _TICKS


class ProcessorTimes:
    """Adds up the processor time of each test, its fixtures included."""

    def __init__(self, shown: int) -> None:
        self.shown = shown
        self.seconds: Dict[str, float] = {}
        self._before = processor_seconds()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        yield
        now = processor_seconds()
        # Processes killed with their parent are not counted, so the difference can be negative.
        self.seconds[item.nodeid] = max(0.0, now - self._before)
        self._before = now

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        terminalreporter.section("processor seconds")
        terminalreporter.write_line(f"{sum(self.seconds.values()):8.2f} all tests")
        for name in sorted(self.seconds, key=lambda name: -self.seconds[name])[:self.shown]:
            terminalreporter.write_line(f"{self.seconds[name]:8.2f} {name}")


LONGEST_ID = 200


def pytest_make_parametrize_id(val: object, argname: str) -> Optional[str]:
    """A short name for a long text: some are a megabyte, and stand in every file of results."""
    if isinstance(val, (str, bytes)) and len(val) > LONGEST_ID:
        return f"{argname} of {len(val)}"
    return None


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--processor-time", type=int, default=0, metavar="N",
                     help="list the N tests that used the most processor time, children included")
    parser.addoption("--leave-out", default="", metavar="FILE",
                     help="leave out the tests in a file: lines of seconds and the id of a test")


def pytest_configure(config: pytest.Config) -> None:
    shown = config.getoption("--processor-time")
    if shown:
        config.pluginmanager.register(ProcessorTimes(shown), "processor-times")


def pytest_collection_modifyitems(config: pytest.Config, items: List[pytest.Item]) -> None:
    file = config.getoption("--leave-out")
    if not file:
        return
    with open(file, encoding="utf-8") as stream:
        costly = {line.rstrip("\n").partition(" ")[2] for line in stream}
    config.hook.pytest_deselected(items=[one for one in items if one.nodeid in costly])
    items[:] = [one for one in items if one.nodeid not in costly]


@pytest.fixture
def quick_threads() -> Iterator[None]:
    """Threads take turns fifty times as often: more orders are seen, and none spins meanwhile."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(before / 50)
    yield
    sys.setswitchinterval(before)
