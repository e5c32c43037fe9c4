"""`gz`: the words of Gazebo's command of that name, on what this simulator offers.

`gz model`, `world`, `physics`, `stats` and `topic` ask a running node (`gz_running.py`); `gz sdf`
and `gz log` read files. Options are Gazebo 11's; what is not offered says what to use instead.
"""
from __future__ import annotations

import argparse
import sys
from typing import Callable, Dict, List, NoReturn, Optional, Sequence

from ..description.light import Light
from ..description.model import Model
from ..description.world import World
from ..errors import CommandError, InputError
from ..resources.database.download_notes import DownloadNotes
from ..resources.resolver import Resolver
from . import gz_queries, object_client

OK, FAILED, USAGE = 0, 1, 2

INSTEAD = {
    "camera": "the editor's view: right click, Follow",
    "debug": "--verbose of gzserver",
    "joint": "rosservice call /gazebo/apply_joint_effort, or the joints panel of the editor",
    "marker": "RViz",
    "plugin": "rosservice list: the ROS interface is built in",
}
"""Commands of Gazebo's gz that are not offered, and what there is."""


class _Parser(argparse.ArgumentParser):
    """Takes negative numbers as values, and ends with status 2."""

    def error(self, message: str) -> NoReturn:
        """Says what is wrong with the command line."""
        self.exit(USAGE, f"{self.prog}: {message}; see {self.prog} --help\n")


def main(argv: Optional[Sequence[str]] = None) -> int:
    """Runs one command.

    Args:
        argv: the whole command line, program name first; default `sys.argv`.

    Returns:
        0 when it was done, 1 when it failed, 2 for wrong usage.
    """
    words, remappings = object_client.plain_words(argv)
    if not words or words[0] in ("help", "-h", "--help"):
        asked = words[1:2]
        if asked and asked[0] in _COMMANDS:
            _COMMANDS[asked[0]](["--help"], remappings)
        print(_usage())
        return OK if words else USAGE
    name, rest = words[0], words[1:]
    if name in INSTEAD:
        print(f"gz {name} is not offered here; use {INSTEAD[name]}", file=sys.stderr)
        return USAGE
    if name not in _COMMANDS:
        print(f"gz: there is no command {name!r}\n{_usage()}", file=sys.stderr)
        return USAGE
    return object_client.run(f"gz {name}", lambda: _COMMANDS[name](rest, remappings))


def _usage() -> str:
    return ("usage: gz COMMAND [options]\n"
            "  log      tell what a state log holds\n"
            "  model    list, show, move, add and delete models\n"
            "  physics  show and change gravity, step and rate\n"
            "  sdf      check, convert and print SDF and URDF files\n"
            "  stats    print how fast time goes on\n"
            "  topic    list and show topics\n"
            "  world    pause, step and reset\n"
            "gz COMMAND --help tells the options of one.")


def parser_of(name: str, about: str) -> argparse.ArgumentParser:
    """The parser of one command, with the options that all have."""
    made = _Parser(prog=f"gz {name}", description=about)
    made.add_argument("-w", "--world-name", default="", help="accepted: a node has one world")
    made.add_argument("--node", default="gazebo", metavar="NAME",
                      help="the simulator's node (default %(default)s)")
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
    made.add_argument("-p", "--pause", type=int, choices=(0, 1), help="1 to pause, 0 to go on")
    made.add_argument("-s", "--step", action="store_true", help="make one step")
    made.add_argument("-m", "--multi-step", type=int, metavar="N", help="make N steps")
    made.add_argument("-r", "--reset-all", action="store_true", help="reset time and models")
    made.add_argument("-t", "--reset-time", action="store_true", help="reset time")
    made.add_argument("-o", "--reset-models", action="store_true", help="reset models")
    return made


def _model() -> argparse.ArgumentParser:
    made = parser_of("model", "List, show, move, add and delete models.")
    made.add_argument("-m", "--model-name", metavar="NAME", help="the model")
    made.add_argument("-l", "--list", action="store_true", help="list all models")
    made.add_argument("-i", "--info", action="store_true", help="show the model's parts")
    made.add_argument("-p", "--pose", action="store_true", help="print x y z R P Y (m, rad)")
    made.add_argument("-d", "--delete", action="store_true", help="delete the model")
    made.add_argument("-f", "--spawn-file", metavar="FILE", help="add the model of this file")
    made.add_argument("-s", "--spawn-string", action="store_true", help="add it from the input")
    for word, long, what in (("-x", "--pose-x", "x (m)"), ("-y", "--pose-y", "y (m)"),
                             ("-z", "--pose-z", "z (m)"), ("-R", "--pose-R", "roll (rad)"),
                             ("-P", "--pose-P", "pitch (rad)"), ("-Y", "--pose-Y", "yaw (rad)")):
        made.add_argument(word, long, type=float, dest=word[1:], help=f"put it there: {what}")
    return made


def _physics() -> argparse.ArgumentParser:
    made = parser_of("physics", "Show the physics settings, or change them.")
    made.add_argument("-g", "--gravity", metavar="X,Y,Z", help="m/s^2")
    made.add_argument("-s", "--step-size", type=float, metavar="SECONDS", help="of one step")
    made.add_argument("-u", "--update-rate", type=float, metavar="HZ",
                      help="steps a second; 0 for as fast as it goes")
    made.add_argument("-i", "--iters", type=int, metavar="N", help="iterations of the solver")
    return made


def _stats() -> argparse.ArgumentParser:
    made = parser_of("stats", "Print how fast time goes on, until Ctrl-C.")
    made.add_argument("-d", "--duration", type=float, default=float("inf"), metavar="SECONDS",
                      help="wall seconds after which to end")
    made.add_argument("-p", "--plot", action="store_true", help="numbers between commas")
    return made


def _topic() -> argparse.ArgumentParser:
    made = parser_of("topic", "ROS topics of the simulator; they take the place of Gazebo's.")
    made.add_argument("-l", "--list", action="store_true", help="list them")
    made.add_argument("-e", "--echo", metavar="TOPIC", help="print messages (rostopic echo)")
    made.add_argument("-i", "--info", metavar="TOPIC", help="who publishes (rostopic info)")
    made.add_argument("-z", "--hz", metavar="TOPIC", help="how often (rostopic hz)")
    made.add_argument("-b", "--bw", metavar="TOPIC", help="how much (rostopic bw)")
    return made


def _sdf(words: List[str], _remappings: Sequence[str]) -> int:
    made = parser_of("sdf", "Check, convert and print files.")
    made.add_argument("-k", "--check", metavar="FILE", help="say what is wrong with a file")
    made.add_argument("-p", "--print", metavar="FILE", help="print it as SDF, with all includes")
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
    raise object_client.ToolError(f"{file} holds nothing that can be printed")


def _log(words: List[str], _remappings: Sequence[str]) -> int:
    made = parser_of("log", "Tell what a state log holds.")
    made.add_argument("-i", "--info", action="store_true", help="print its times")
    made.add_argument("-f", "--file", metavar="FILE", help="the log")
    made.add_argument("-d", "--record", type=int, choices=(0, 1),
                      help="not offered: use gzserver -r, or Ctrl+D in the editor")
    options = made.parse_args(words)
    if options.record is not None:
        made.error("a node records from its start with gzserver -r or recording:=true, "
                   "and on demand from its editor (Ctrl+D)")
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


if __name__ == "__main__":
    sys.exit(main())
