"""The server's command line: gzserver's options, as far as they mean something here."""
from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from typing import List, Optional, Sequence

DEFAULT_WORLD = "worlds/empty.world"
"""What gzserver loads when it is given no world."""

ENGINES = ("ode", "bullet", "dart", "simbody")
"""The physics engines that Gazebo's `-e` knows."""


@dataclass(frozen=True)
class ServerOptions:
    """What the command line asks for.

    Attributes:
        world: the world file as typed; looked up like any resource.
        paused: start without stepping.
        verbose: log at debug level.
        notices: one line each on options that are accepted and do nothing.
    """

    world: str = DEFAULT_WORLD
    paused: bool = False
    verbose: bool = False
    notices: List[str] = field(default_factory=list)


def is_remapping(word: str) -> bool:
    """True for ROS's `name:=value` words, which rospy reads by itself."""
    return ":=" in word and not word.startswith("-")


def parser(program: str = "gzserver") -> argparse.ArgumentParser:
    """The argument parser; an unknown option ends the program with the usage and status 2."""
    made = argparse.ArgumentParser(
        prog=program, allow_abbrev=False,
        description="Run a simulated world as the ROS node /gazebo.",
        epilog="ROS remappings (name:=value, _param:=value, __name:=name) are accepted anywhere.")
    made.add_argument("world", nargs="?", default=DEFAULT_WORLD,
                      help="world file; looked up in the resource paths (default %(default)s)")
    made.add_argument("-u", "--pause", action="store_true", help="start paused")
    made.add_argument("--verbose", action="store_true", help="log more")
    made.add_argument("-v", "--version", action="store_true", help="print the version and end")
    made.add_argument("-e", "--physics", metavar="ENGINE", default="bullet",
                      help=f"one of {', '.join(ENGINES)}; Bullet moves the world in any case")
    made.add_argument("-s", "--server-plugin", metavar="FILE", action="append", default=[],
                      help="accepted and ignored: the ROS API is built in")
    for ignored in (("-g", "--gui-client-plugin"), ("-o", "--profile")):
        made.add_argument(*ignored, metavar="X", action="append", default=[],
                          help=argparse.SUPPRESS)
    made.add_argument("-r", "--record", action="store_true", help=argparse.SUPPRESS)
    made.add_argument("--lockstep", "--minimal_comms", dest="lockstep", action="store_true",
                      help=argparse.SUPPRESS)
    made.add_argument("--seed", type=int, help=argparse.SUPPRESS)
    return made


def parse(argv: Sequence[str], program: str = "gzserver") -> ServerOptions:
    """Read the words after the program's name.

    Raises:
        SystemExit: status 2 after the usage for a word that is not understood, 0 after `--help`.
    """
    reader = parser(program)
    words = [word for word in argv if not is_remapping(word)]
    given = reader.parse_args(words)
    if given.version:
        from .. import __version__

        reader.exit(0, f"my_simulations {__version__}\n")
    return ServerOptions(world=given.world, paused=given.pause, verbose=given.verbose,
                         notices=_notices(given, reader))


def _notices(given: argparse.Namespace, reader: argparse.ArgumentParser) -> List[str]:
    notices: List[str] = []
    if given.physics not in ENGINES:
        reader.error(f"argument -e/--physics: {given.physics!r} is not one of {', '.join(ENGINES)}")
    if given.physics != "bullet":
        notices.append(f"physics engine {given.physics!r} was asked for; Bullet moves this world")
    plugins = given.server_plugin + given.gui_client_plugin
    if plugins:
        notices.append(f"plugins of the command line are not loaded: {', '.join(plugins)}")
    idle: List[Optional[str]] = [
        "--profile" if given.profile else None,
        "--lockstep or --minimal_comms" if given.lockstep else None,
        "--record" if given.record else None,
        "--seed" if given.seed is not None else None,
    ]
    named = [option for option in idle if option]
    if named:
        notices.append(f"accepted without effect: {', '.join(named)}")
    return notices
