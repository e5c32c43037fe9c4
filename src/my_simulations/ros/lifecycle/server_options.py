"""Command line of the server: the options of Gazebo's gzserver."""
from __future__ import annotations

import argparse
import os
from dataclasses import dataclass, field
from math import isfinite
from typing import List, Optional, Sequence, Tuple

from ..arguments import Parser, is_remapping, parse_number

DEFAULT_WORLD = "worlds/empty.world"
"""Default world file, as in gzserver."""

ENGINES = ("ode", "bullet", "dart", "simbody")
"""Values of Gazebo's option `-e`."""


RECORD_VARIABLE = "MY_SIMULATIONS_RECORD"
"""Environment variable with the folder in which each server records a state log."""

TOPICS_VARIABLE = "MY_SIMULATIONS_RECORD_TOPICS"
"""Environment variable with names of topics that state logs contain, separated by spaces."""

RECORD_ENCODINGS = ("zlib", "bz2", "txt")
"""Values of Gazebo's option `--record_encoding`."""


@dataclass(frozen=True)
class Recording:
    """Options of the state log.

    Attributes:
        on: record a log.
        encoding: one of RECORD_ENCODINGS; ignored.
        path: folder of the log; "" for the default.
        period: least seconds of sim time between states; negative for every state.
        filter: names of models; ignored.
        resources: include meshes and textures; ignored.
        topics: names of topics whose messages the log contains.
    """

    on: bool = False
    encoding: str = "zlib"
    path: str = ""
    period: float = -1.0
    filter: str = ""
    resources: bool = False
    topics: Tuple[str, ...] = ()


@dataclass(frozen=True)
class ServerOptions:
    """The parsed command line.

    Attributes:
        world: world file as typed; searched in the resource paths.
        paused: start paused.
        verbose: log at debug level.
        notices: log lines about options without effect.
        seed: random seed, used by <population>; None for the default.
        iterations: number of steps after which the world pauses; 0 for never.
        profile: name of the physics preset; "" for the world's default.
        recording: options of the state log.
    """

    world: str = DEFAULT_WORLD
    paused: bool = False
    verbose: bool = False
    notices: List[str] = field(default_factory=list)
    seed: Optional[int] = None
    iterations: int = 0
    profile: str = ""
    recording: Recording = Recording()


def parser(program: str = "gzserver") -> argparse.ArgumentParser:
    """The argument parser; unknown options print the usage and exit with status 2."""
    made = Parser(
        prog=program, allow_abbrev=False,
        description="Run a simulated world as the ROS node /gazebo.",
        epilog="ROS remappings (name:=value, _param:=value, __name:=name) are accepted anywhere.")
    made.add_argument("world", nargs="?", default=DEFAULT_WORLD,
                      help=f"world file, searched in the resource paths (default {DEFAULT_WORLD})")
    made.add_argument("more", nargs="*", help="arguments for system plugins; ignored")
    made.add_argument("-v", "--version", action="store_true", help="print the version and exit")
    made.add_argument("--verbose", action="store_true", help="log debug messages")
    made.add_argument("-u", "--pause", action="store_true", help="start paused")
    made.add_argument("-e", "--physics", metavar="ENGINE", default="bullet",
                      help=f"one of {', '.join(ENGINES)}; ignored, Bullet is always used")
    made.add_argument("-o", "--profile", metavar="NAME", default="",
                      help="name of the physics preset to use")
    made.add_argument("--seed", type=_seed, metavar="N",
                      help="random seed (default 0)")
    made.add_argument("--iters", type=_count, default=0, metavar="N",
                      help="pause after N steps")
    made.add_argument("-s", "--server-plugin", metavar="FILE", action="append", default=[],
                      help="ignored: the ROS API is built in")
    made.add_argument("-g", "--gui-plugin", "--gui-client-plugin", dest="gui_plugin",
                      metavar="FILE", action="append", default=[], help=argparse.SUPPRESS)
    made.add_argument("--lockstep", action="store_true",
                      help="ignored: sensors are always in step with the world")
    made.add_argument("--minimal_comms", action="store_true",
                      help="ignored: messages are sent to subscribers only")
    made.add_argument("-p", "--play", metavar="LOG", help="not supported: open logs in the world "
                                                          "editor")
    _add_recording(made)
    return made


def _add_recording(made: argparse.ArgumentParser) -> None:
    made.add_argument("-r", "--record", action="store_true",
                      help="record a state log, to be played in the world editor")
    made.add_argument("--record_path", metavar="FOLDER", default="",
                      help="folder of the log (default ~/.gazebo/log/DATE_AND_TIME)")
    made.add_argument("--record_period", type=_period, default=-1.0, metavar="SECONDS",
                      help="minimum sim time between recorded states")
    made.add_argument("--record_encoding", choices=RECORD_ENCODINGS, default="zlib",
                      help="ignored: there is one log format")
    made.add_argument("--record_filter", metavar="NAME", default="",
                      help="ignored: all models are recorded")
    made.add_argument("--record_resources", action="store_true",
                      help="ignored: logs do not contain meshes and textures")
    made.add_argument("--record_topics", metavar="NAMES", default="",
                      help="topics that the log contains, such as /scan,/odom (default: those of"
                      f" the environment variable {TOPICS_VARIABLE})")


def _count(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of steps")
    return value


def _period(text: str) -> float:
    value = parse_number(text)
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds")
    return value


def _seed(text: str) -> int:
    # Gazebo reads it as a floating-point number.
    value = parse_number(text)
    if not value.is_integer():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number")
    return int(value)


def parse(argv: Sequence[str], program: str = "gzserver") -> ServerOptions:
    """Parse the command line without the program's name.

    Raises SystemExit: status 2 for an invalid command line, 0 after `--help` and `--version`.
    """
    reader = parser(program)
    words = [word for word in argv if not is_remapping(word)]
    # Positional arguments may follow options, as roslaunch's `extra_gazebo_args` do.
    given = reader.parse_intermixed_args(words)
    if given.version:
        from ... import __version__

        reader.exit(0, f"my_simulations {__version__}\n")
    if given.play:
        reader.error(f"argument -p/--play: not supported; open {given.play} in the world editor")
    folder = os.environ.get(RECORD_VARIABLE, "")
    if folder:
        given.record, given.record_path = True, given.record_path or folder
    recording = Recording(
        given.record, given.record_encoding, given.record_path, given.record_period,
        given.record_filter, given.record_resources,
        _topics(given.record_topics or os.environ.get(TOPICS_VARIABLE, "")))
    return ServerOptions(
        world=given.world, paused=given.pause, verbose=given.verbose, notices=_notices(given),
        seed=given.seed, iterations=given.iters, profile=given.profile, recording=recording)


def _topics(text: str) -> Tuple[str, ...]:
    """Names separated by commas or spaces, each with a leading slash."""
    return tuple("/" + name.strip("/") for name in text.replace(",", " ").split())


def _notices(given: argparse.Namespace) -> List[str]:
    notices: List[str] = []
    if given.physics not in ENGINES:
        notices.append(f"unknown physics engine {given.physics!r} (one of {', '.join(ENGINES)}); "
                       "using Bullet")
    elif given.physics != "bullet":
        notices.append(f"physics engine {given.physics!r} is not available; using Bullet")
    plugins = given.server_plugin + given.gui_plugin
    if plugins:
        notices.append(f"ignoring plugins of the command line: {', '.join(plugins)}")
    idle = _idle_recording(given)
    if idle:
        notices.append(f"ignoring options{'' if given.record else ', which need --record'}: "
                       + ", ".join(idle))
    if given.more:
        notices.append(f"ignoring arguments for plugins: {' '.join(given.more)}")
    return notices


def _idle_recording(given: argparse.Namespace) -> List[str]:
    """Recording options without effect."""
    idle = [name for name, used in (
        ("--record_encoding", given.record_encoding != "zlib"),
        ("--record_filter", given.record_filter), ("--record_resources", given.record_resources),
    ) if used]
    if not given.record:
        idle += [name for name, used in (
            ("--record_path", given.record_path), ("--record_period", given.record_period >= 0.0),
        ) if used]
    return idle
