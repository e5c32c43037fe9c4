"""Runs the shards of a study as an array of Slurm jobs."""
from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from typing import List, Sequence

from ..errors import CommandError
from .replacing import replacement_file

SCRIPT = "study.sbatch"
_OPTION = re.compile(r"[a-z][a-z-]*(=[^\n]*)?\Z")
_OURS = ("array", "job-name", "output", "cpus-per-task")


def job_script(name: str, study_file: str, folder: str, shards: int, slots: int,
               options: Sequence[str] = ()) -> str:
    """The script of a job array, one task a shard (sbatch(1), section JOB ARRAY SUPPORT).

    The environment of `sbatch` is handed on, as Slurm does by default. A task that is started again
    runs what has no row yet.

    Args:
        name: of the study.
        study_file: absolute path; the nodes must see it there.
        folder: absolute path of the results, which all nodes share.
        shards: number of tasks.
        slots: processors of a task, and cases that run at a time on them.
        options: further options of sbatch without their dashes, such as `time=01:00:00`.

    Raises:
        CommandError: an option cannot be one of sbatch, or is set here.
    """
    for option in options:
        if not _OPTION.match(option):
            raise CommandError(f"'{option}' is no option of sbatch; write it as time=01:00:00")
        if option.partition("=")[0] in _OURS:
            raise CommandError(f"'{option}' cannot be given: it follows from --shards, --slots and"
                               " --out")
    # %A and %a are job and task; a % of the folder is written %% (sbatch(1), FILENAME PATTERN).
    logs = os.path.join(folder.replace("%", "%%"), "slurm", "%A_%a.txt")
    lines: List[str] = [
        "#!/bin/bash",
        "# Runs a study in shards. Submit it again to run what is missing.",
        f"#SBATCH --job-name={re.sub(r'[^A-Za-z0-9_.-]', '_', name)}",
        f"#SBATCH --array=1-{shards}",
        f"#SBATCH --cpus-per-task={slots}",
        "#SBATCH --ntasks=1",
        "#SBATCH --requeue",
        f'#SBATCH --output="{logs}"',
        *(f"#SBATCH --{option}" for option in options),
        f"exec {shlex.quote(sys.executable)} -m my_simulations.studies run"
        f" {shlex.quote(study_file)} \\",
        f"  --out {shlex.quote(folder)} --slots {slots} \\",
        f'  --shard "$SLURM_ARRAY_TASK_ID/{shards}"']
    return "\n".join(lines) + "\n"


def write_script(folder: str, text: str) -> str:
    """Write the script, and make the folder of its output; returns its path.

    Raises CommandError.
    """
    path = os.path.join(folder, SCRIPT)
    try:
        os.makedirs(os.path.join(folder, "slurm"), exist_ok=True)
        with replacement_file(path) as part, open(part, "w", encoding="utf-8") as stream:
            stream.write(text)
    except OSError as fault:
        raise CommandError(f"{path} cannot be written: {fault.strerror}") from None
    return path


def can_submit() -> bool:
    """Whether this machine has `sbatch`."""
    return shutil.which("sbatch") is not None


def submit(path: str) -> str:
    """Submit a script; returns what sbatch says. Raises CommandError if it refuses."""
    done = subprocess.run(["sbatch", path], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    if done.returncode:
        raise CommandError(f"sbatch refused {path}: {done.stdout.strip()}")
    return done.stdout.strip()
