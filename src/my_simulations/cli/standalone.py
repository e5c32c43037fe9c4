"""Runs a world and its editor without ROS."""
from __future__ import annotations

import signal
import sys
import threading
from typing import TYPE_CHECKING, Callable, List, Optional

from ..errors import CommandError, InputError, Issue, Severity
from .front_ends import FrontEnds
from .signals import end_quietly
from .web_browser import show

if TYPE_CHECKING:
    from ..editor.logs.recorder import Recorder
    from ..resources.resolver import Resolver
    from ..ros.lifecycle.server_options import Recording
    from ..simulator.simulator import Simulator

OK, FAILED = 0, 1


def main(words: List[str], program: str) -> int:
    """Run the world of the command line with its editor until a signal ends it.

    Returns:
        0 after SIGINT or SIGTERM, 1 if the world or the editor could not be started.
    """
    from ..ros.lifecycle.server_options import parse

    end_quietly()  # also while the world is read
    options = parse(words[1:], program)
    def say(line: object) -> None:
        print(f"{program}: {line}", file=sys.stderr, flush=True)

    say("no ROS master found; running without ROS")
    for notice in options.notices:
        say(notice)
    from ..engine.commands import FOREVER
    from ..engine.process_engine import ProcessEngine
    from ..resources.resolver import Resolver
    from ..ros.lifecycle.engine_supply import EngineSupply
    from ..simulator.issue_log import IssueLog
    from ..simulator.world_loading import start_world

    def tell(issue: Issue) -> None:
        if options.verbose or issue.severity is not Severity.NOTE or issue.code == "meshes":
            say(issue)

    log = IssueLog()
    log.open(tell)
    engines = EngineSupply(ProcessEngine)
    try:
        resolver = Resolver.from_environment()
        simulator = start_world(options.world, resolver, engines, log, seed=options.seed or 0,
                                profile=options.profile,
                                steps=options.iterations or FOREVER)
    except InputError as fault:
        for issue in fault.issues:
            say(issue)
        engines.close()
        return FAILED
    say(f"the world file is {simulator.world.file}")
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: ended.set())
    front_ends = FrontEnds()
    recorder = _record(front_ends, simulator, resolver, options.recording, say)
    try:
        if not options.paused:
            simulator.clock.unpause()
        editor = front_ends.edit(simulator, resolver, {"log": lambda issue: say(issue)})
        log.also(editor.tell)
        show(editor.url, program)
        ended.wait()
        editor.stop()
        return OK
    except CommandError as fault:
        say(fault)
        return FAILED
    finally:
        _finish(recorder, say)
        simulator.close()


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
