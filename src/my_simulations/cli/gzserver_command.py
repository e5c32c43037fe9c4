"""`gzserver`: the simulation server, as a ROS node named gazebo."""
from __future__ import annotations

import io
import sys
from typing import Any, List, Optional

from .signals import exit_on_signals, ignore_signals


def main(argv: Optional[List[str]] = None, program: str = "gzserver", gui: bool = False) -> int:
    """Run the server until a signal ends it.

    Args:
        argv: the whole command line, program name first; default `sys.argv`.
        program: name in usage and messages.
        gui: start the world editor with the node; else on `~gui` or by service.

    Returns:
        0 after SIGINT or SIGTERM, 1 if the node could not start.
    """
    words = sys.argv if argv is None else argv
    exit_on_signals()
    from ..ros.lifecycle.server_options import parse
    from ..ros.lifecycle.start_profile import StartProfile

    options = parse(words[1:], program)
    if isinstance(sys.stdout, io.TextIOWrapper):
        # rospy logs to stdout: with a pipe, lines must not wait for a full buffer.
        sys.stdout.reconfigure(line_buffering=True)
    profile = StartProfile()
    profile.mark("command line read")
    # The engine starts before all other imports: its own imports take as long as all of ours.
    from ..engine.process_engine import ProcessEngine
    from ..ros.lifecycle.engine_supply import EngineSupply

    engines = EngineSupply(ProcessEngine)
    profile.mark("engine process started")
    from ..ros.lifecycle.server_process import Server
    from .front_ends import FrontEnds
    from .rostest_replay import rostest_replay

    def say(line: str) -> None:
        print(f"{program}: {line}", file=sys.stderr, flush=True)

    front_ends = FrontEnds()
    with rostest_replay(options, words, say) as options:
        status = Server(options, words, say, engines, profile, _make_node, front_ends.edit, gui,
                        front_ends.record, front_ends.await_world).run()
    ignore_signals()
    return status


def _make_node(*arguments: Any) -> Any:
    """Create the ROS node; rospy is imported no earlier."""
    from ..ros.node import Node

    return Node(*arguments)
