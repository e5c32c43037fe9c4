"""`gzserver`: the simulation server, as a ROS node named gazebo."""
from __future__ import annotations

import io
import sys
from typing import TYPE_CHECKING, Any, Dict, List, Optional

if TYPE_CHECKING:
    from ..editor.server import EditorServer
    from ..resources.resolver import Resolver
    from ..simulator.simulator import Simulator


def main(argv: Optional[List[str]] = None, program: str = "gzserver", gui: bool = False) -> int:
    """Run the server until a signal ends it.

    Args:
        argv: the whole command line, program name first; default `sys.argv`.
        program: the name in usage and messages.
        gui: start the world editor at once; else when the parameter `~gui` or a service asks.

    Returns:
        0 after SIGINT or SIGTERM, 1 when the node could not start.
    """
    words = sys.argv if argv is None else argv
    from ..ros.options import parse
    from ..ros.profile import StartProfile

    options = parse(words[1:], program)
    if isinstance(sys.stdout, io.TextIOWrapper):
        # rospy writes its log lines there: behind a pipe they must not wait for a full buffer.
        sys.stdout.reconfigure(line_buffering=True)
    profile = StartProfile()
    profile.mark("command line read")
    # The engine comes before every other import: its own imports take as long as all of ours.
    from ..engine.process import ProcessEngine
    from ..ros.engines import EngineSupply

    engines = EngineSupply(ProcessEngine)
    profile.mark("engine process started")
    from ..ros.server import Server

    def say(line: str) -> None:
        print(f"{program}: {line}", file=sys.stderr, flush=True)

    return Server(options, words, say, engines, profile, start_editor, gui).run()


def start_editor(simulator: "Simulator", resolver: "Resolver",
                 settings: Dict[str, Any]) -> "EditorServer":
    """Start the world editor; nothing of it is imported before.

    Raises CommandError: it cannot listen, or what it needs is not installed.
    """
    from ..errors import CommandError

    try:
        from .. import editor

        return editor.start(simulator, resolver, editor.EditorOptions(**settings))
    except ImportError as missing:
        raise CommandError(f"{missing}; tools/run installs what the editor needs") from missing


if __name__ == "__main__":
    sys.exit(main())
