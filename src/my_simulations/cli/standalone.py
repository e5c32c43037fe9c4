"""Runs a world and its editor without ROS."""
from __future__ import annotations

import signal
import sys
import threading
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Tuple

from ..editor.web_browser import show
from ..errors import CommandError, InputError, Issue, Severity
from .front_ends import FrontEnds
from .signals import exit_on_signals

if TYPE_CHECKING:
    from ..editor.logs.recorder import Recorder
    from ..resources.resolver import Resolver
    from ..ros.lifecycle.engine_supply import EngineSupply
    from ..ros.lifecycle.server_options import Recording, ServerOptions
    from ..simulator.simulator import Simulator

OK, FAILED = 0, 1
_EARLY_S = 1.0
"""Wall seconds after which the browser is opened before the world is there."""


def main(words: List[str], program: str, no_ros: str) -> int:
    """Run the world of the command line with its editor until a signal ends it.

    Args:
        words: the command line.
        program: its name in messages.
        no_ros: why it runs without ROS.

    Returns 0 after SIGINT or SIGTERM, 1 if the world or the editor could not be started.
    """
    from ..ros.lifecycle.server_options import parse

    exit_on_signals()  # also while the world is read
    options = parse(words[1:], program)
    def say(line: object) -> None:
        print(f"{program}: {line}", file=sys.stderr, flush=True)

    say(f"{no_ros}; running without ROS")
    for notice in options.notices:
        say(notice)
    from ..engine.process_engine import ProcessEngine
    from ..ros.lifecycle.engine_supply import EngineSupply
    from ..simulator.issue_log import IssueLog

    def print_issue(issue: Issue) -> None:
        if options.verbose or issue.severity is not Severity.NOTE or issue.code == "meshes":
            say(issue)

    log = IssueLog()
    log.open(print_issue)
    engines = EngineSupply(ProcessEngine)
    front_ends = FrontEnds()
    settings: Dict[str, Any] = {"log": lambda issue: say(issue)}
    try:
        page = front_ends.await_world(settings)
    except CommandError as fault:
        say(fault)
        engines.close()
        return FAILED
    log.add_receiver(lambda issue: page.show_line(issue.message) if issue.code == "meshes"
                     else None)
    # A world that cannot be read is no reason to open a browser; one that takes long is.
    opening = BrowserOpening(page.url, program)
    try:
        simulator, resolver = _load(options, engines, log, page.show)
    except InputError as fault:
        opening.cancel()
        page.stop()
        engines.close()
        return _report_fault(fault, say)
    say(f"the world file is {simulator.world.file}")
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda _number, _frame: ended.set())
    recorder = _record(front_ends, simulator, resolver, options.recording, say)
    try:
        if not options.paused:
            simulator.clock.unpause()
        editor = front_ends.edit(simulator, resolver, settings, page)
        log.add_receiver(editor.show_issue)
        opening.open_now()
        ended.wait()
        editor.stop()
        return OK
    except CommandError as fault:
        say(fault)
        return FAILED
    finally:
        _finish(recorder, say)
        simulator.close()


class BrowserOpening:
    """Opens the browser once: after a delay, or earlier by `open_now`."""

    def __init__(self, url: str, program: str) -> None:
        self._page = (url, program)
        self._lock = threading.Lock()
        self._opened = False
        self._timer = threading.Timer(_EARLY_S, self.open_now)
        self._timer.daemon = True
        self._timer.start()

    def open_now(self) -> None:
        with self._lock:
            opened, self._opened = self._opened, True
        self._timer.cancel()
        if not opened:
            show(*self._page)

    def cancel(self) -> None:
        with self._lock:
            self._opened = True
        self._timer.cancel()


def _load(options: "ServerOptions", engines: "EngineSupply", log: Callable[[Issue], None],
          progress: Callable[[str, str, int, int], None]) -> "Tuple[Simulator, Resolver]":
    """Read the world and start its simulator. Raises InputError."""
    from ..engine.commands import FOREVER
    from ..resources.resolver import Resolver
    from ..simulator.world_loading import start_world

    resolver = Resolver.from_environment()
    return start_world(options.world, resolver, engines, log, seed=options.seed or 0,
                       profile=options.profile, steps=options.iterations or FOREVER,
                       progress=progress), resolver


def _report_fault(fault: InputError, say: Callable[[object], None]) -> int:
    for issue in fault.issues:
        say(issue)
    return FAILED


def _record(front_ends: FrontEnds, simulator: "Simulator", resolver: "Resolver",
            wanted: "Recording", say: Callable[[object], None]) -> "Optional[Recorder]":
    if not wanted.on:
        return None
    try:
        recorder = front_ends.record(simulator, resolver, wanted, say)
    except CommandError as fault:
        say(f"cannot record a state log: {fault}")
        return None
    say(f"recording state log: {recorder.path}")
    return recorder


def _finish(recorder: "Optional[Recorder]", say: Callable[[object], None]) -> None:
    try:
        if recorder is not None:
            recorder.stop()
    except CommandError as fault:
        say(f"state log is incomplete: {fault}")
