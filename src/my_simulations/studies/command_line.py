"""The command line of `study`."""
from __future__ import annotations

import argparse
import re

from ..program_end import ArgumentParser
from .plan import ALL_CASES, Shard
from .row import STATUSES

_SHARDS = 100
_REPLAYS = 3


def parser() -> argparse.ArgumentParser:
    made = ArgumentParser(
        prog="study", description="Run worlds many times with varied parameters, and measure them."
        " Needs no ROS.", epilog="Exit code: 0 if all cases are ok, 1 if some are not or are"
        " missing, 2 for a faulty study or command line, 74 if the disk"
        " is full, 130 if interrupted.")
    actions = made.add_subparsers(dest="action", metavar="ACTION", required=True)
    run = actions.add_parser("run", help="run a study, or the cases of it that have no result yet")
    run.add_argument("file", metavar="FILE", help="study file (doc/studies.md)")
    run.add_argument("--out", metavar="DIR", help="folder of the results; default: the name of the"
                     " file, in the working directory")
    run.add_argument("--shard", type=_shard, default=ALL_CASES, metavar="I/N",
                     help="run every Nth case only, beginning with number I")
    resume = actions.add_parser("resume", help="go on with a study that was interrupted")
    others = {
        "status": "print how many cases have run, and what became of them",
        "report": "write the table, and the report as one HTML file",
        "export": "write the table as CSV, and as parquet if pyarrow is installed"}
    parsers = {name: actions.add_parser(name, help=text) for name, text in others.items()}
    _add_records(parsers["export"])
    show = actions.add_parser("show", help="open the world of a case in the world editor")
    show.add_argument("case", metavar="CASE", help="id of the case, or its beginning")
    show.add_argument("--write", metavar="FILE", help="only write the world to this file")
    show.add_argument("--in", dest="dir", metavar="DIR", default=".",
                      help="folder of the results; default: the working directory")
    for each in (resume, *parsers.values()):
        each.add_argument("dir", metavar="DIR", nargs="?", default=".",
                          help="folder of the results; default: the working directory")
    for each in (run, resume):
        _add_runner_options(each)
        each.add_argument("--retry", action="append", choices=STATUSES, default=[],
                          metavar="STATUS", help="run the cases again whose result is STATUS, such"
                          " as crashed or 'timed out'; may be repeated")
        each.add_argument("--replays", type=int, metavar="N", default=_REPLAYS,
                          help="failed cases of which a replay is kept, one HTML file each;"
                          f" default: {_REPLAYS}")
    for each in (run, resume, *parsers.values()):
        each.add_argument("--json", action="store_true", help="print JSON")
    return made


def _add_runner_options(each: argparse.ArgumentParser) -> None:
    """Add the options that choose the machines for cases."""
    each.add_argument("--slots", type=int, metavar="N",
                      help="cases that run at a time, on each machine; default: number of"
                      " processors, on Dask that of a worker's threads, on Slurm 1")
    each.add_argument("--on", type=str, default="", metavar="WHERE",
                      help="slurm: write, and submit if sbatch is here, an array of jobs;"
                      " dask://HOST:PORT or dask:FILE: run on the workers of a Dask scheduler,"
                      " named by its address or scheduler file")
    each.add_argument("--shards", type=int, metavar="N", default=_SHARDS,
                      help=f"tasks of the Slurm array; default: {_SHARDS}")
    each.add_argument("--sbatch", action="append", default=[], metavar="OPTION",
                      help="option of sbatch, such as time=01:00:00; may be repeated")
    for name, what in (("ca", "authority that signed the cluster's certificates"),
                       ("cert", "certificate of this side"), ("key", "its private key")):
        each.add_argument(f"--tls-{name}", default="", metavar="PEM",
                          help=f"for Dask: {what}; default: Dask's configuration")


def _add_records(export: argparse.ArgumentParser) -> None:
    """Options that record one case."""
    export.add_argument("--bag", metavar="FILE", help="run the case again whose id"
                        " stands for DIR, and record it as rosbag: /clock,"
                        " /gazebo/model_states and /gazebo/link_states")
    export.add_argument("--log", metavar="FILE", help="the same as state log, which the"
                        " world editor plays")
    export.add_argument("--every", type=float, metavar="S", default=0.01,
                        help="s of sim time between two records; default: 0.01")
    export.add_argument("--in", dest="folder", metavar="DIR", default=".",
                        help="with --bag or --log: folder of the results")


def _shard(text: str) -> Shard:
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    if not found or not 1 <= int(found[1]) <= int(found[2]):
        raise argparse.ArgumentTypeError(f"{text!r} is not I/N with I from 1 to N")
    return Shard(int(found[1]), int(found[2]))
