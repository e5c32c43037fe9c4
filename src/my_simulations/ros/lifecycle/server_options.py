"""The server's command line: the options of Gazebo's gzserver."""
from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from math import isfinite
from typing import List, Optional, Sequence

from ..arguments import Parser, number

DEFAULT_WORLD = "worlds/empty.world"
"""What gzserver loads when it is given no world."""

ENGINES = ("ode", "bullet", "dart", "simbody")
"""The physics engines that Gazebo's `-e` knows."""


RECORD_ENCODINGS = ("zlib", "bz2", "txt")
"""How Gazebo packs a state log (`--record_encoding`)."""


@dataclass(frozen=True)
class Recording:
    """What `-r` and its companions ask for.

    Attributes:
        on: record at all.
        encoding: one of RECORD_ENCODINGS; not used.
        path: folder of the log; "" for the usual place.
        period: least seconds of sim time between states; negative for all that are shown.
        filter: which models; not used.
        resources: put meshes and textures into the log too; not used.
    """

    on: bool = False
    encoding: str = "zlib"
    path: str = ""
    period: float = -1.0
    filter: str = ""
    resources: bool = False


@dataclass(frozen=True)
class ServerOptions:
    """What the command line asks for.

    Attributes:
        world: the world file as typed; looked up like any resource.
        paused: start without stepping.
        verbose: log at debug level.
        notices: one line each on options that are accepted and do nothing.
        seed: of what a world draws at random; None for the usual one.
        iterations: steps after which the world stands still; 0 for never.
        profile: name of the physics preset to use; "" for the world's own choice.
        recording: the state log that is asked for.
    """

    world: str = DEFAULT_WORLD
    paused: bool = False
    verbose: bool = False
    notices: List[str] = field(default_factory=list)
    seed: Optional[int] = None
    iterations: int = 0
    profile: str = ""
    recording: Recording = Recording()


def is_remapping(word: str) -> bool:
    """True for ROS's `name:=value` words, which rospy reads by itself."""
    return ":=" in word and not word.startswith("-")


def parser(program: str = "gzserver") -> argparse.ArgumentParser:
    """The argument parser; an unknown option ends the program with the usage and status 2."""
    made = Parser(
        prog=program, allow_abbrev=False,
        description="Run a simulated world as the ROS node /gazebo.",
        epilog="ROS remappings (name:=value, _param:=value, __name:=name) are accepted anywhere.")
    made.add_argument("world", nargs="?", default=DEFAULT_WORLD,
                      help=f"world file; looked up in the resource paths (default {DEFAULT_WORLD})")
    made.add_argument("more", nargs="*", help="for plugins of the command line; not used")
    made.add_argument("-v", "--version", action="store_true", help="print the version and end")
    made.add_argument("--verbose", action="store_true", help="log more")
    made.add_argument("-u", "--pause", action="store_true", help="start paused")
    made.add_argument("-e", "--physics", metavar="ENGINE", default="bullet",
                      help=f"one of {', '.join(ENGINES)}; Bullet moves the world in any case")
    made.add_argument("-o", "--profile", metavar="NAME", default="",
                      help="physics preset of the world file to use")
    made.add_argument("--seed", type=_seed, metavar="N",
                      help="for what the world draws at random (default 0)")
    made.add_argument("--iters", type=_count, default=0, metavar="N",
                      help="let time stand still after N steps")
    made.add_argument("-s", "--server-plugin", metavar="FILE", action="append", default=[],
                      help="accepted and not loaded: the ROS API is built in")
    made.add_argument("-g", "--gui-plugin", "--gui-client-plugin", dest="gui_plugin",
                      metavar="FILE", action="append", default=[], help=argparse.SUPPRESS)
    made.add_argument("--lockstep", action="store_true",
                      help="accepted: no sensor is ever behind the world here")
    made.add_argument("--minimal_comms", action="store_true",
                      help="accepted: nothing is sent that nobody hears")
    made.add_argument("-p", "--play", metavar="LOG", help="refused: logs are not played here")
    _add_recording(made)
    return made


def _add_recording(made: argparse.ArgumentParser) -> None:
    made.add_argument("-r", "--record", action="store_true",
                      help="write a state log, which the world editor plays")
    made.add_argument("--record_path", metavar="FOLDER", default="",
                      help="folder of the log (default ~/.gazebo/log/DATE_AND_TIME)")
    made.add_argument("--record_period", type=_period, default=-1.0, metavar="SECONDS",
                      help="least sim time between recorded states")
    made.add_argument("--record_encoding", choices=RECORD_ENCODINGS, default="zlib",
                      help="accepted: logs have one form here")
    made.add_argument("--record_filter", metavar="NAME", default="",
                      help="accepted: everything is recorded")
    made.add_argument("--record_resources", action="store_true",
                      help="accepted: meshes and textures stay where they are")


def _count(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of steps")
    return value


def _period(text: str) -> float:
    value = number(text)
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds")
    return value


def _seed(text: str) -> int:
    # Gazebo reads it as a floating-point number.
    value = number(text)
    if not value.is_integer():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number")
    return int(value)


def parse(argv: Sequence[str], program: str = "gzserver") -> ServerOptions:
    """Read the words after the program's name.

    Raises:
        SystemExit: status 2 after the usage for a word that is not understood, 0 after `--help`.
    """
    reader = parser(program)
    words = [word for word in argv if not is_remapping(word)]
    # What follows the world may stand among options, as roslaunch's `extra_gazebo_args` do.
    given = reader.parse_intermixed_args(words)
    if given.version:
        from ... import __version__

        reader.exit(0, f"my_simulations {__version__}\n")
    if given.play:
        reader.error(f"argument -p/--play: {given.play} cannot be played; name the world file")
    recording = Recording(
        given.record, given.record_encoding, given.record_path, given.record_period,
        given.record_filter, given.record_resources)
    return ServerOptions(
        world=given.world, paused=given.pause, verbose=given.verbose, notices=_notices(given),
        seed=given.seed, iterations=given.iters, profile=given.profile, recording=recording)


def _notices(given: argparse.Namespace) -> List[str]:
    notices: List[str] = []
    if given.physics not in ENGINES:
        notices.append(f"physics engine {given.physics!r} is none of {', '.join(ENGINES)}; "
                       "Bullet moves this world")
    elif given.physics != "bullet":
        notices.append(f"physics engine {given.physics!r} was asked for; Bullet moves this world")
    plugins = given.server_plugin + given.gui_plugin
    if plugins:
        notices.append(f"plugins of the command line are not loaded: {', '.join(plugins)}")
    idle = _idle_recording(given)
    if idle:
        notices.append(f"without effect{'' if given.record else ' unless --record is given'}: "
                       + ", ".join(idle))
    if given.more:
        notices.append(f"arguments for plugins are not used: {' '.join(given.more)}")
    return notices


def _idle_recording(given: argparse.Namespace) -> List[str]:
    """The words on recording that change nothing."""
    idle = [name for name, used in (
        ("--record_encoding", given.record_encoding != "zlib"),
        ("--record_filter", given.record_filter), ("--record_resources", given.record_resources),
    ) if used]
    if not given.record:
        idle += [name for name, used in (
            ("--record_path", given.record_path), ("--record_period", given.record_period >= 0.0),
        ) if used]
    return idle
