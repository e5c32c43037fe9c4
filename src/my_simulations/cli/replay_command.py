"""`replay`: writes a recorded run as one HTML file that plays it without a server."""
from __future__ import annotations

import argparse
import math
import os
import sys
from typing import List, Optional, Sequence

from ..editor.logs.replay_page import STATES_HZ, write_replay
from ..editor.logs.state_log import FILE
from ..errors import CommandError
from ..program_end import exit_cleanly
from ..resources.resolver import Resolver
from ..ros.arguments import Parser

NAME = "replay"


def parser() -> argparse.ArgumentParser:
    made = Parser(
        prog=NAME, description="Write a recorded run as one HTML file with time bar and 3D view,"
        " which a browser plays without a server and without a network. Needs no ROS master.",
        epilog="Exit code: 0 on success, 1 if the run cannot be read or the file cannot be"
        " written, 2 for an invalid command line.")
    made.add_argument("run", metavar="RUN", help="a state log, or the folder that contains it;"
                      " the editor, gzserver -r and `study export --log` record them")
    made.add_argument("-o", "--output", metavar="FILE", default="",
                      help="the HTML file (default: RUN.html in the working directory)")
    made.add_argument("--title", default="", help="title of the page (default: name of the run)")
    made.add_argument("--rate", type=float, default=STATES_HZ, metavar="HZ", help="states for each"
                      " second of sim time; the page interpolates between them (default:"
                      " %(default)g)")
    made.add_argument("--last", type=float, default=math.inf, metavar="SECONDS",
                      help="only so many seconds of sim time at the end of the run (default: all)")
    made.add_argument("--plot", metavar="NAMES", default="", help="numbers of recorded topics that"
                      " the page plots from the start, such as"
                      " /odom.twist.twist.linear.x,/scan.nearest")
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    options = parser().parse_args((sys.argv if argv is None else list(argv))[1:])
    stem = os.path.splitext(os.path.basename(os.path.abspath(options.run)))[0]
    output = options.output or f"{stem}.html"
    try:
        missing = replay(options.run, output, options.title, options.rate, options.last,
                         options.plot.replace(",", " ").split())
    except CommandError as fault:
        print(f"{NAME}: {fault}", file=sys.stderr)
        return 1
    for address in missing:
        print(f"{NAME}: {os.path.basename(address)} was not found; its model is shown without it",
              file=sys.stderr)
    print(os.path.abspath(output), flush=True)
    return 0


def replay(run: str, output: str, title: str = "", rate: float = STATES_HZ,
           last: float = math.inf, plot: Sequence[str] = ()) -> List[str]:
    """Write a recorded run as one HTML file.

    Args:
        run: a state log, or the folder that contains it.
        output: the HTML file; one that exists is replaced.
        title: title of the page; default: name of the run.
        rate: states for each second of sim time, between which the page interpolates.
        last: only so many seconds of sim time at the end of the run.
        plot: numbers of recorded topics that the page plots from the start, such as
            `/odom.twist.twist.linear.x`.

    Returns:
        Addresses of meshes and pictures that were not found.

    Raises:
        CommandError: the run cannot be read or the file cannot be written.
    """
    return write_replay(log_of(run), output, Resolver.from_environment(), title, rate, last,
                        plot)


def log_of(run: str) -> str:
    """The state log of a run: the file itself, or `state.log` in its folder."""
    return os.path.join(run, FILE) if os.path.isdir(run) else run
