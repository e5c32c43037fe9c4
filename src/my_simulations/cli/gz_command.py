"""`gz`: Gazebo's command line tool for this simulator.

`gz model`, `world`, `physics`, `stats` and `topic` call a running node (`gz_queries.py`); `gz sdf`
and `gz log` read files. Options are those of Gazebo 11; unsupported commands name an alternative.
"""
from __future__ import annotations

import argparse
import sys
from typing import Callable, Dict, List, NoReturn, Optional, Sequence

from ..description.light import Light
from ..description.model import Model
from ..description.world import World
from ..errors import CommandError, InputError
from ..program_end import exit_cleanly
from ..resources.database.download_notes import DownloadNotes
from ..resources.resolver import Resolver
from ..ros.arguments import Parser
from . import gz_queries, object_client

OK, FAILED, USAGE = 0, 1, 2

INSTEAD = {
    "camera": "Follow in the context menu of the world editor",
    "debug": "gzserver --verbose",
    "joint": "rosservice call /gazebo/apply_joint_effort, or the joints panel of the editor",
    "marker": "RViz",
    "plugin": "rosservice list: the ROS interface is built in",
}
"""Unsupported commands of Gazebo's gz, and their alternatives."""


class _Parser(Parser):
    """Reports errors in one line."""

    def error(self, message: str) -> NoReturn:
        """Print the error and exit with status 2."""
        self.exit(USAGE, f"{self.prog}: {message}; see {self.prog} --help\n")


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first.

    Returns 0 on success, 1 on failure, 2 for an invalid command line.
    """
    words, remappings = object_client.split_command_line(argv)
    if not words or words[0] in ("help", "-h", "--help"):
        asked = words[1:2]
        if asked and asked[0] in _COMMANDS:
            _COMMANDS[asked[0]](["--help"], remappings)
        print(_usage())
        return OK if words else USAGE
    name, rest = words[0], words[1:]
    if name in INSTEAD:
        print(f"gz {name} is not supported; use {INSTEAD[name]}", file=sys.stderr)
        return USAGE
    if name not in _COMMANDS:
        print(f"gz: unknown command {name!r}\n{_usage()}", file=sys.stderr)
        return USAGE
    return object_client.run(f"gz {name}", lambda: _COMMANDS[name](rest, remappings))


def _usage() -> str:
    return ("usage: gz COMMAND [options]\n"
            "  log      print information about a state log\n"
            "  model    list, show, move, spawn and delete models\n"
            "  physics  show and change gravity, step size and update rate\n"
            "  sdf      check, convert and print SDF and URDF files\n"
            "  stats    print real-time factor and times\n"
            "  topic    list and echo topics\n"
            "  world    pause, step and reset the world\n"
            "Run gz COMMAND --help for the options of a command.")


def parser_of(name: str, about: str) -> argparse.ArgumentParser:
    """The parser of one command, with the options that all have."""
    made = _Parser(prog=f"gz {name}", description=about)
    made.add_argument("-w", "--world-name", default="", help="ignored: a node has one world")
    made.add_argument("--node", default="gazebo", metavar="NAME",
                      help="name of the simulator node (default %(default)s)")
    return made


def _running(make: Callable[[], argparse.ArgumentParser],
             work: Callable[[argparse.Namespace, gz_queries.Running], int]
             ) -> Callable[[List[str], Sequence[str]], int]:
    def command(words: List[str], remappings: Sequence[str]) -> int:
        options = make().parse_args(words)
        return work(options, gz_queries.Running(options.node, remappings))

    return command


def _world() -> argparse.ArgumentParser:
    made = parser_of("world", "Pause, step and reset the world.")
    made.add_argument("-p", "--pause", type=int, choices=(0, 1), help="1 to pause, 0 to resume")
    made.add_argument("-s", "--step", action="store_true", help="execute one step")
    made.add_argument("-m", "--multi-step", type=int, metavar="N", help="execute N steps")
    made.add_argument("-r", "--reset-all", action="store_true", help="reset time and models")
    made.add_argument("-t", "--reset-time", action="store_true", help="reset time")
    made.add_argument("-o", "--reset-models", action="store_true", help="reset models")
    return made


def _model() -> argparse.ArgumentParser:
    made = parser_of("model", "List, show, move, spawn and delete models.")
    made.add_argument("-m", "--model-name", metavar="NAME", help="name of the model")
    made.add_argument("-l", "--list", action="store_true", help="list all models")
    made.add_argument("-i", "--info", action="store_true", help="print the model's links, "
                                                                "collisions and joints")
    made.add_argument("-p", "--pose", action="store_true", help="print x y z R P Y (m, rad)")
    made.add_argument("-d", "--delete", action="store_true", help="delete the model")
    made.add_argument("-f", "--spawn-file", metavar="FILE", help="spawn the model from a file")
    made.add_argument("-s", "--spawn-string", action="store_true", help="spawn the model from "
                                                                        "standard input")
    for word, long, what in (("-x", "--pose-x", "x (m)"), ("-y", "--pose-y", "y (m)"),
                             ("-z", "--pose-z", "z (m)"), ("-R", "--pose-R", "roll (rad)"),
                             ("-P", "--pose-P", "pitch (rad)"), ("-Y", "--pose-Y", "yaw (rad)")):
        made.add_argument(word, long, type=float, dest=word[1:], help="move or spawn the model "
                                                                      f"at {what}")
    return made


def _physics() -> argparse.ArgumentParser:
    made = parser_of("physics", "Show or change the physics settings.")
    made.add_argument("-g", "--gravity", metavar="X,Y,Z", help="m/s^2")
    made.add_argument("-s", "--step-size", type=float, metavar="SECONDS", help="step size")
    made.add_argument("-u", "--update-rate", type=float, metavar="HZ",
                      help="steps per second; 0 for as fast as possible")
    made.add_argument("-i", "--iters", type=int, metavar="N", help="solver iterations")
    return made


def _stats() -> argparse.ArgumentParser:
    made = parser_of("stats", "Print real-time factor, sim time and real time until Ctrl-C.")
    made.add_argument("-d", "--duration", type=float, default=float("inf"), metavar="SECONDS",
                      help="exit after this wall time")
    made.add_argument("-p", "--plot", action="store_true", help="print comma-separated values")
    return made


def _topic() -> argparse.ArgumentParser:
    made = parser_of("topic", "List and echo the ROS topics of the simulator.")
    made.add_argument("-l", "--list", action="store_true", help="list topics")
    made.add_argument("-e", "--echo", metavar="TOPIC", help="print messages (rostopic echo)")
    made.add_argument("-i", "--info", metavar="TOPIC", help="print publishers and subscribers "
                                                            "(rostopic info)")
    made.add_argument("-z", "--hz", metavar="TOPIC", help="print the publishing rate (rostopic hz)")
    made.add_argument("-b", "--bw", metavar="TOPIC", help="print the bandwidth (rostopic bw)")
    return made


def _sdf(words: List[str], _remappings: Sequence[str]) -> int:
    made = parser_of("sdf", "Check files and convert them to SDF.")
    made.add_argument("-k", "--check", metavar="FILE", help="report errors and warnings of a file")
    made.add_argument("-p", "--print", metavar="FILE", help="print a file as SDF, includes "
                                                            "expanded")
    options = made.parse_args(words)
    if options.check:
        from . import check_model_command

        status = check_model_command.main(["check_model", options.check])
        if status == OK:
            print("Check complete")
        return status
    if options.print:
        print(_as_sdf(options.print), end="")
        return OK
    made.error("give -k FILE or -p FILE")


def _as_sdf(file: str) -> str:
    from ..formats.sdf.writer.entities import write_entity, write_world
    from .check_model_command import check

    resolver = Resolver.from_environment(DownloadNotes(lambda note: print(note, file=sys.stderr)))
    loaded, issues = check(file, resolver)
    object_client.show(issues)
    if isinstance(loaded, World):
        return write_world(loaded).decode("utf-8")
    if isinstance(loaded, (Model, Light)):
        return write_entity(loaded).decode("utf-8")
    raise object_client.ToolError(f"{file} contains no world, model or light")


def _log(words: List[str], _remappings: Sequence[str]) -> int:
    made = parser_of("log", "Print information about a state log.")
    made.add_argument("-i", "--info", action="store_true", help="print start, end and duration")
    made.add_argument("-f", "--file", metavar="FILE", help="the log")
    made.add_argument("-d", "--record", type=int, choices=(0, 1),
                      help="not supported: use gzserver -r, or Alt+R in the editor")
    options = made.parse_args(words)
    if options.record is not None:
        made.error("not supported; record with gzserver -r, recording:=true, or Alt+R in the "
                   "editor")
    if not (options.info and options.file):
        made.error("give -i -f FILE")
    from ..editor.logs.state_log import LogReader

    try:
        log = LogReader(options.file)
    except (CommandError, InputError, OSError) as fault:
        raise object_client.ToolError(str(fault)) from fault
    with_times = (log.begin, log.end, log.end - log.begin)
    log.close()
    print("Start: {:.3f} s\nEnd: {:.3f} s\nDuration: {:.3f} s".format(*with_times))
    return OK


_COMMANDS: Dict[str, Callable[[List[str], Sequence[str]], int]] = {
    "log": _log,
    "model": _running(_model, gz_queries.model),
    "physics": _running(_physics, gz_queries.physics),
    "sdf": _sdf,
    "stats": _running(_stats, gz_queries.stats),
    "topic": _running(_topic, gz_queries.topic),
    "world": _running(_world, gz_queries.world),
}
