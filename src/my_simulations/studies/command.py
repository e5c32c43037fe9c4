"""The command `study`: runs, resumes and shows studies. Needs no ROS."""
from __future__ import annotations

import argparse
import contextlib
import json
import os
import shlex
import shutil
import signal
import sys
from functools import partial
from types import FrameType
from typing import Callable, List, Mapping, Optional, Sequence, Set, Tuple

from ..errors import CommandError, InputError, SimulationError
from ..program_end import is_disk_full
from . import slurm
from .case_world import open_case, run_case
from .cluster_address import SLURM, TlsFiles, scheduler_address
from .command_line import parser
from .folder import REPORT, Cause, StudyFolder, shard_of
from .journal import Journal, finished_cases
from .plan import ALL_CASES, Case, CasePlan, Shard, number_of
from .replacing import replacement_file
from .replays import Record, WriteReplay, keep_replays
from .report import write_report
from .row import OK
from .row_recorder import Recorder
from .scenario_slot import launch_words, require_ros
from .slot import Hook, final_hash
from .study_file import read_study
from .study_progress import Progress
from .study_runner import Rate, Report, StudyRunner
from .table import rows_in_order

NOT_ALL_OK, INVALID, INTERRUPTED = 1, 2, 130
_MOST_CAUSES = 3   # that are printed

Records = Mapping[str, Callable[[str], Record]]


def main(argv: Optional[Sequence[str]] = None, hook: Optional[Hook] = None,
         records: Optional[Records] = None, write_replay: Optional[WriteReplay] = None) -> int:
    """Run the command.

    Args:
        argv: the whole command line, program name first; default `sys.argv`.
        hook: see `Slot`.
        records: what makes the file of `export --bag` and of `export --log`, by "bag" and "log".
        write_replay: writes a replay; None: failed cases keep none.

    Returns:
        The exit code, see `command_line.parser`.
    """
    options = parser().parse_args((sys.argv if argv is None else list(argv))[1:])
    try:
        if options.action == "export" and (options.bag or options.log):
            return _record(options, records or {})
        options.keep_replays = None
        if write_replay is not None and records is not None and "log" in records:
            options.keep_replays = partial(keep_replays, record=records["log"], write=write_replay)
        return _ACTIONS[options.action](options, hook)
    except InputError as fault:
        for issue in fault.issues:
            _print_error(str(issue))
        return INVALID
    except SimulationError as fault:
        _print_error(f"study: {fault}")
        return INVALID
    except BrokenPipeError:  # the reader of the output has ended: no fault of the study
        raise
    except OSError as fault:  # what has finished is in the journal
        _print_error(f"study: {fault}; `study resume` goes on")
        return os.EX_IOERR if is_disk_full(fault) else INVALID
    except KeyboardInterrupt:
        _print_error("study: interrupted; `study resume` goes on")
        return INTERRUPTED


def _run(options: argparse.Namespace, hook: Optional[Hook]) -> int:
    stem = os.path.splitext(os.path.basename(options.file))[0]
    folder = StudyFolder(options.out or stem)
    plan = _plan(options.file)
    if options.on != SLURM:
        folder.check_shards(options.shard.of)
    folder.create()
    if options.on == SLURM:
        return _on_slurm(options, folder, plan)
    return _work(options, folder, plan, options.shard, hook)


def _resume(options: argparse.Namespace, hook: Optional[Hook]) -> int:
    folder = StudyFolder(options.dir)
    header = folder.header()
    plan = _plan(header["file"])
    if options.on == SLURM:
        return _on_slurm(options, folder, plan)
    code = max([_work(options, folder, plan, shard_of(path), hook) for path in folder.journals()])
    for shard in folder.missing_shards():
        _print_error(f"study: shard {shard.index} of {shard.of} has not begun in {folder.path}:"
                     f" study run {shlex.quote(plan.study.file)} --shard"
                     f" {shard.index}/{shard.of} --out {shlex.quote(folder.path)}")
        code = max(code, NOT_ALL_OK)
    return code


def _on_slurm(options: argparse.Namespace, folder: StudyFolder, plan: CasePlan) -> int:
    shards = min(options.shards, len(plan))
    if shards < 1:
        raise CommandError(f"--shards must be at least 1, is {options.shards}")
    folder.check_shards(shards)
    path = slurm.write_script(folder.path, slurm.job_script(
        plan.study.name, plan.study.file, folder.path, shards, _slots(options, 1), options.sbatch))
    told = slurm.submit(path) if slurm.can_submit() else ""
    if options.json:
        _print(json.dumps({"script": path, "shards": shards, "submitted": bool(told)}))
    else:
        _print(path)
        _print_error(told or "this machine has no sbatch; run on a machine that has it:"
                     f" sbatch {path}")
    return 0


def _slots(options: argparse.Namespace, default: int) -> int:
    if options.slots is not None and options.slots < 1:
        raise CommandError(f"--slots must be at least 1, is {options.slots}")
    return options.slots or default


def _plan(file: str) -> CasePlan:
    study, issues = read_study(file)
    for issue in issues:
        _print_error(str(issue))
    return CasePlan(study)


def _work(options: argparse.Namespace, folder: StudyFolder, plan: CasePlan, shard: Shard,
          hook: Optional[Hook]) -> int:
    _slots(options, 1)
    address = scheduler_address(options.on)
    if plan.study.scenarios and not address:
        require_ros()
    total = _count(plan, shard)
    journal = Journal(folder.journal_of(shard), {
        "study": plan.study.name, "file": plan.study.file, "cases": total,
        "all_cases": len(plan), "shard": [shard.index, shard.of], "versions": plan.versions})
    try:
        # Not before: the folder may be that of another study.
        folder.copy_study_file(plan.study.file)
        finished = _find_finished(plan, shard, journal.path, options.retry)
        recorder = Recorder(journal, folder.path, folder.stem("trajectories", shard))
        rate = Rate(total - len(finished))
        progress = Progress(rate, sys.stderr, options.json)
        before = signal.signal(signal.SIGTERM, _interrupt)
        try:
            if address:
                _run_on_dask(options, plan, recorder, finished, address, progress.count_case, shard)
            else:
                StudyRunner(plan, recorder, finished, _slots(options, os.cpu_count() or 1),
                            progress.count_case, hook).run(shard)
        finally:
            signal.signal(signal.SIGTERM, before)
            progress.close()
    finally:
        journal.close()
    files = []
    if shard.of == 1 or folder.is_complete(plan):  # of many, the last one writes the table
        files = folder.write_tables(plan, _print_error)
        if options.keep_replays is not None:
            files += options.keep_replays(plan, folder, options.replays, _print_error)
        files.append(_report(folder, plan))
    return _print_status(folder, plan, shard, options.json, files)


def _find_finished(plan: CasePlan, shard: Shard, journal: str, retried: Sequence[str]) -> Set[int]:
    """The cases of a shard that need not run; rows of former ids are not of the plan any more."""
    found = finished_cases(journal, retried)
    return {number for number in (number_of(case.id) for case in plan.cases(shard))
            if number in found} if found else found


def _run_on_dask(options: argparse.Namespace, plan: CasePlan, recorder: Recorder,
                 finished: Set[int], address: str, told: Report, shard: Shard) -> None:
    try:
        from .dask_runner import DaskRunner
    except ImportError as fault:
        raise CommandError(f"--on dask needs Dask: pip install my_simulations[dask] ({fault})"
                           ) from None
    tls = TlsFiles(options.tls_ca, options.tls_cert, options.tls_key)
    DaskRunner(plan, recorder, finished, _slots(options, 0), address, tls, told,
               lambda text: _print_error(f"study: {text}")).run(shard)


def _interrupt(_: int, __: Optional[FrameType]) -> None:
    raise KeyboardInterrupt


def _status(options: argparse.Namespace, _: Optional[Hook]) -> int:
    folder, plan = _open_folder(options.dir)
    return _print_status(folder, plan, ALL_CASES, options.json, [])


def _print_status(folder: StudyFolder, plan: CasePlan, shard: Shard, as_json: bool,
                 files: List[str]) -> int:
    """Report the results of the cases of a shard, or of all; returns the exit code."""
    total = folder.status_counts(plan, shard)
    cases, name = _count(plan, shard), plan.study.name
    done = sum(total.values())
    if as_json:
        _print(json.dumps({"study": name, "folder": folder.path, "cases": cases,
                           "done": done, **total, "files": files}))
    else:
        became = ", ".join(f"{count} {status}" for status, count in total.items() if count)
        _print(f"{name}: {done} of {cases} cases" + (f": {became}" if became else ""))
        for file in files:
            _print(f"  {file}")
        if total[OK] < done:
            _print_causes(folder.causes(plan, shard), folder.path)
    return 0 if total[OK] == cases else NOT_ALL_OK


def _print_causes(causes: Sequence[Cause], folder: str) -> None:
    """Print the most frequent reasons of cases that are not ok, each with a case to look at."""
    for cause in causes[:_MOST_CAUSES]:
        _print(f"{cause.cases} {cause.status}: {cause.issue or cause.status}"
               f" (study show {cause.example} --in {folder})")
    if len(causes) > _MOST_CAUSES:
        _print(f"{len(causes) - _MOST_CAUSES} more causes are in {REPORT}")


def _count(plan: CasePlan, shard: Shard) -> int:
    return len(range(shard.index - 1, len(plan), shard.of))


def _report(folder: StudyFolder, plan: CasePlan) -> str:
    path = os.path.join(folder.path, REPORT)
    write_report(path, plan.study, folder.journals(), sum(folder.status_counts(plan).values()),
                 f"study show --in {folder.path}")
    return path


def _write(options: argparse.Namespace, _: Optional[Hook]) -> int:
    folder, plan = _open_folder(options.dir)
    files = folder.write_tables(plan, _print_error)
    if options.action == "report":
        files.append(_report(folder, plan))
    _print(json.dumps({"files": files}) if options.json else "\n".join(files))
    return 0


def _open_folder(path: str) -> Tuple[StudyFolder, CasePlan]:
    """The folder of a study, and the plan of the study file that it names."""
    folder = StudyFolder(path)
    return folder, _plan(folder.header()["file"])


def _show(options: argparse.Namespace, _: Optional[Hook]) -> int:
    folder, plan = _open_folder(options.dir)
    case = _case(plan, options.case)
    if case is None:
        return INVALID
    if plan.study.scenarios:
        return _show_command(["roslaunch", *launch_words(plan, case)], bool(options.write))
    path = options.write or os.path.join(folder.path, f"case-{case.id}.world")
    path = write_world(plan, case, path)
    if options.write or not can_launch():
        _print(path)
    return _show_command(launch_command(path), bool(options.write))


def _show_command(command: List[str], dry_run: bool) -> int:
    text = " ".join(map(shlex.quote, command))
    if dry_run or not can_launch():
        _print_error("to open it: " + text)
        return 0
    _print_error(text)
    os.execvp(command[0], command)


def _record(options: argparse.Namespace, records: Records) -> int:
    """Run a case again and record it."""
    if not options.every > 0.0:
        raise CommandError(f"--every must be above 0, is {options.every:g}")
    folder, plan = _open_folder(options.folder)
    case = _case(plan, options.dir)
    if case is None:
        return INVALID
    if plan.study.scenarios:
        raise CommandError("a scenario cannot be recorded from here: add a <node pkg=\"rosbag\""
                           " type=\"record\"> to it")
    wanted = {kind: path for kind, path in (("bag", options.bag), ("log", options.log)) if path}
    missing = [kind for kind in wanted if kind not in records]
    if missing:
        raise CommandError(f"--{missing[0]} is of the command `study`, not of"
                           " `python3 -m my_simulations.studies`")
    for path in wanted.values():
        if os.path.isdir(path):
            raise CommandError(f"{path} is a folder, not the name of a file")
    with contextlib.ExitStack() as stack:
        # A file that is there is replaced at the end, not lost to a case that cannot be run.
        world = stack.enter_context(open_case(plan, case))
        files = []
        for kind, path in wanted.items():
            part = stack.enter_context(replacement_file(path))
            files.append(stack.enter_context(contextlib.closing(records[kind](part))))
        run_case(world, plan.study.duration, options.every, [file.record_state for file in files])
        found = final_hash(world)
    known = next((row for row in rows_in_order(folder.journals()) if row.case == case.id), None)
    if known is not None and known.hash and known.hash != found:
        _print_error(f"study: the final state differs from that of the study, which ran on"
                     f" {known.processor}")
    paths = [os.path.abspath(path) for path in wanted.values()]
    _print(json.dumps({"files": paths}) if options.json else "\n".join(paths))
    return 0


def _case(plan: CasePlan, start_of_id: str) -> Optional[Case]:
    case = plan.find(start_of_id)
    if case is None:
        _print_error(f"study: no case has an id that begins with {start_of_id}; ids change with"
                     " the study file and the files it names")
    return case


_ACTIONS = {"run": _run, "resume": _resume, "status": _status, "report": _write,
            "export": _write, "show": _show}


def _print(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _print_error(text: str) -> None:
    sys.stderr.write(text + "\n")


def write_world(plan: CasePlan, case: Case, path: str) -> str:
    """Write the world of a case, as it stands before the first step; returns the file.

    Raises:
        InputError: the world cannot be used.
        CommandError: it cannot be written.
    """
    with open_case(plan, case) as world:
        return world.save_world(path, overwrite=True)


def launch_command(world: str) -> List[str]:
    """Return the command that opens a world in the editor, paused."""
    return ["roslaunch", "gazebo_ros", "empty_world.launch", f"world_name:={world}", "paused:=true"]


def can_launch() -> bool:
    """Whether ROS is there, and this shell knows its packages."""
    return shutil.which("roslaunch") is not None and bool(os.environ.get("ROS_PACKAGE_PATH"))
