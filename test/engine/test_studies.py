"""Studies with real engines, some of which are killed."""
from __future__ import annotations

import csv
import errno
import fcntl
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from my_simulations.cli import study_command
from my_simulations.editor.logs.state_log import LogReader
from my_simulations.errors import CommandError
from my_simulations.python_api import OpenWorld, WorldChoice
from my_simulations.studies.command import main
from my_simulations.studies.journal import Journal
from my_simulations.studies.plan import CasePlan
from my_simulations.studies.slot import final_hash
from my_simulations.studies.slot_pool import SlotPool
from my_simulations.studies.study_file import read_study

SOURCE = Path(__file__).resolve().parents[2] / "src"
BOX = """<sdf version="1.7"><model name="box"><link name="link">
<inertial><mass>1</mass><inertia><ixx>0.0067</ixx><iyy>0.0067</iyy><izz>0.0067</izz></inertia>
</inertial><collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
</collision></link></model></sdf>"""
DROP = """study: drop
models:
  box: {file: box.sdf, pose: [0, 0, 1]}
duration: 0.4
vary:
  height: {set: pose.box.z, range: {from: 0.2, to: 0.6, count: 20}}
  tilt: {set: pose.box.roll, values: [0, 0.3, 0.6]}
measure:
  rest: final(pose.box.z)
  touched: contact(box, ground_plane)
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "box.sdf").write_text(BOX)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(folder, text, *more, hook=None, name="s"):
    (folder / f"{name}.yaml").write_text(text)
    return main(["study", "run", f"{name}.yaml", *more], hook)


def table(folder, name="s"):
    with open(folder / name / "results.csv", newline="") as stream:
        return list(csv.DictReader(stream))


def one_after_the_other(folder, text):
    """The final hash of every third case, each in an engine of its own, without the runner."""
    (folder / "bare.yaml").write_text(text)
    plan = CasePlan(read_study(str(folder / "bare.yaml"))[0])
    found = {}
    for case in list(plan.cases())[::3]:
        height, tilt = case.settings["height"], case.settings["tilt"]
        with OpenWorld(WorldChoice()) as world:
            world.spawn(BOX, pose=[0, 0, height, tilt, 0, 0])
            world.step(round(plan.study.duration / world.step_size))
            found[case.id] = final_hash(world)
    return found


def test_poisoned_cases_do_not_touch_the_others(folder):
    def poison(case, attempt, world):
        pid = world.simulator.engine_pid
        if case.index % 10 == 3:
            os.kill(pid, signal.SIGSEGV)
        if case.index % 20 == 5 and attempt == 1:
            os.kill(pid, signal.SIGKILL)

    text = DROP.replace("count: 20", "count: 8")
    assert run(folder, text, "--slots", "2", hook=poison) == 1
    rows = table(folder)
    assert [int(row["index"]) for row in rows] == list(range(24))
    crashed = [row for row in rows if row["status"] == "crashed"]
    assert [int(row["index"]) for row in crashed] == [3, 13, 23]
    assert {(row["signal"], row["attempt"], row["hash"], row["rest"]) for row in crashed} == {
        ("SIGSEGV", "2", "", "")}
    assert all("SIGSEGV" in row["issue"] for row in crashed)
    flaky = [row for row in rows if row["flaky"] == "True"]
    assert [(int(row["index"]), row["status"], row["signal"]) for row in flaky] == [
        (5, "ok", "SIGKILL")]
    assert sum(row["status"] == "ok" for row in rows) == 21
    bare = one_after_the_other(folder, text)
    alike = {row["case"]: row["hash"] for row in rows if row["status"] == "ok"}
    alone = {case: found for case, found in bare.items() if case in alike}
    assert len(alone) > 5 and alone.items() <= alike.items()


@pytest.mark.parametrize("fault, told", [
    ("os._exit(3)", "its process ended with exit status 3"),
    ("sys.exit(4)", "SystemExit: 4"), ("", "")])
def test_a_plugin_that_fails_in_a_case_fails_only_this_case(folder, monkeypatch, fault, told):
    (folder / "ending.py").write_text(
        "import os, sys\n"
        "from my_simulations.plugins.base import Plugin\n"
        "class Ending(Plugin):\n"
        "    def load(self):\n"
        "        self.context.every(100.0, self.turn)\n"
        "    def turn(self):\n"
        "        if self.context.link('link').pose.position[2] > 0.35:\n"
        f"            {fault or 'pass'}\n")
    package = folder / "packages" / "ending"
    package.mkdir(parents=True)
    (package / "package.xml").write_text(
        "<package><name>ending</name><export>"
        "<my_simulations plugin='ending:Ending' library='libending.so'/></export></package>")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(package.parent))
    monkeypatch.setenv("PYTHONPATH", str(folder), prepend=os.pathsep)
    monkeypatch.syspath_prepend(str(folder))
    (folder / "box.sdf").write_text(BOX.replace(
        "</model>", "<plugin name='p' filename='libending.so'/></model>"))
    text = DROP.replace("range: {from: 0.2, to: 0.6, count: 20}", "values: [0.2, 0.6]").replace(
        "[0, 0.3, 0.6]", "[0]")
    assert run(folder, text, "--slots", "1") == (1 if told else 0)
    low, high = table(folder)
    assert (low["status"], low["issue"]) == ("ok", "")
    assert high["status"] == ("failed" if told else "ok") and told in high["issue"]

    def ids():
        return {case.id for case in CasePlan(read_study(str(folder / "s.yaml"))[0]).cases()}

    assert ids() == {low["case"], high["case"]}
    (folder / "ending.py").write_text((folder / "ending.py").read_text() + "# changed\n")
    assert not ids() & {low["case"], high["case"]}


def test_cases_that_crashed_run_again_on_request(folder, capsys):
    def crash(case, attempt, world):
        if case.index == 1:
            os.kill(world.simulator.engine_pid, signal.SIGSEGV)

    text = "duration: 0.01\nseeds: 3\n"
    assert run(folder, text, "--slots", "1", hook=crash) == 1
    assert run(folder, text) == 1                       # a crash is a result
    assert run(folder, text, "--retry", "failed") == 1  # and not one of this status
    capsys.readouterr()
    assert main(["study", "resume", "s", "--retry", "crashed"]) == 0
    assert "1/1" in capsys.readouterr().err             # that case alone
    assert [row["status"] for row in table(folder)] == ["ok"] * 3
    assert "SIGSEGV" not in (folder / "s" / "report.html").read_text()
    assert len((folder / "s" / "journal.jsonl").read_text().splitlines()) == 5


def test_a_driver_killed_at_any_moment_goes_on_to_the_same_table(folder):
    assert run(folder, DROP, "--slots", "2", name="whole") == 0
    (folder / "cut.yaml").write_text(DROP)
    random_moment = random.Random(4)
    command = [sys.executable, "-m", "my_simulations.studies"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(
        [str(SOURCE), os.environ.get("PYTHONPATH", "")])}
    journal = folder / "cut" / "journal.jsonl"
    arguments = ["run", "cut.yaml", "--slots", "2"]
    kills = 0
    for _again in range(20):
        before = journal.read_bytes().count(b"\n") if journal.exists() else 0
        with subprocess.Popen([*command, *arguments], env=environment,
                              stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as driver:
            more = random_moment.randint(1, 15)
            while driver.poll() is None:
                if journal.exists() and journal.read_bytes().count(b"\n") >= before + more:
                    time.sleep(random_moment.uniform(0.0, 0.02))  # anywhere in a case
                    driver.kill()
                    kills += 1
                    break
                time.sleep(0.001)
        arguments = ["resume", "cut", "--slots", "2"]
        if driver.returncode == 0:
            break
    assert driver.returncode == 0 and kills >= 3
    assert table(folder, "cut") == table(folder, "whole")
    assert main(["study", "status", "cut"]) == 0


def test_shards_make_the_table_of_the_whole(folder, capsys):
    text = DROP.replace("count: 20", "count: 5")
    assert run(folder, text, "--slots", "1", name="whole") == 0
    for number in (1, 2, 3):
        assert run(folder, text, "--slots", "1", "--shard", f"{number}/3", name="parts") == 0
        assert main(["study", "status", "parts", "--json"]) == int(number < 3)
        told = json.loads(capsys.readouterr().out.splitlines()[-1])
        assert (told["cases"], told["done"]) == (15, 5 * number)
    assert table(folder, "parts") == table(folder, "whole")
    assert len(list((folder / "parts").glob("journal-*-of-3.jsonl"))) == 3


def test_resume_tells_of_shards_that_have_not_begun(folder, capsys):
    text = "duration: 0.01\nseeds: 4\n"
    assert run(folder, text, "--slots", "1", "--shard", "1/2") == 0
    assert main(["study", "resume", "s", "--slots", "1"]) == 1
    told = capsys.readouterr().err.splitlines()[-1]
    assert "shard 2 of 2 has not begun" in told
    command = told[told.index("study run"):].split()
    assert main([*command, "--slots", "1"]) == 0
    assert main(["study", "resume", "s", "--slots", "1"]) == 0
    assert len(table(folder)) == 4


def test_a_run_that_is_refused_leaves_the_copy_of_the_study_file(folder, capsys):
    text = "duration: 0.01\n"
    assert run(folder, text) == 0
    assert run(folder, text + "seeds: 2\n", "--out", "s", name="other") == 2
    assert "of study 's'" in capsys.readouterr().err
    assert (folder / "s" / "study.yaml").read_text() == text
    with open(folder / "s" / "journal.jsonl", "rb") as journal:
        fcntl.flock(journal, fcntl.LOCK_EX)  # as by a run that goes on
        assert run(folder, text + "seeds: 2\n") == 2
    assert (folder / "s" / "study.yaml").read_text() == text
    assert main(["study", "resume", "s"]) == 0   # with the study file as it is now
    assert (folder / "s" / "study.yaml").read_text() == text + "seeds: 2\n"


def test_a_full_disk_is_told(folder, capsys, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Journal, "append", full)
    assert run(folder, "duration: 0.01\n") == os.EX_IOERR
    told = capsys.readouterr().err
    assert "No space left on device; `study resume` goes on" in told and "Traceback" not in told
    monkeypatch.undo()
    monkeypatch.setattr(shutil, "copyfile", full)  # of the study file
    assert main(["study", "resume", str(folder / "s")]) == os.EX_IOERR
    monkeypatch.undo()
    assert main(["study", "resume", str(folder / "s")]) == 0


def test_rows_of_former_ids_do_not_count_as_cases_of_the_study(folder, capsys):
    def told(action):
        code = main(["study", action, "s", "--json"])
        found = json.loads(capsys.readouterr().out.splitlines()[-1])
        return code, found["cases"], found["done"], found["ok"], found["failed"]

    text = "duration: 0.01\nseeds: 2\n"
    assert run(folder, text, "--slots", "1") == 0
    failing = text + "require:\n  late: final(time) > 1\n"
    (folder / "s.yaml").write_text(failing)
    capsys.readouterr()
    assert told("status") == (1, 2, 0, 0, 0)
    assert told("resume") == (1, 2, 2, 0, 2)
    assert told("status") == (1, 2, 2, 0, 2)
    report = (folder / "s" / "report.html").read_text()
    assert "2 of 2 have run" in report and "2 rows of the table are of former ids" in report
    (folder / "s.yaml").write_text(text.replace("2", "3"))
    assert told("status") == (1, 3, 2, 2, 0)
    assert main(["study", "resume", "s"]) == 0
    assert "1/1" in capsys.readouterr().err   # only what has no row is to be done
    assert len(table(folder)) == 5


def test_what_became_of_a_case_is_told(folder, capsys):
    (folder / "bad.world").write_text("<sdf version='1.6'><world name='w'>")
    text = """duration: 0.1
models:
  box: {file: box.sdf, pose: [0, 0, 1]}
vary:
  world: {set: world, values: [worlds/empty.world, bad.world]}
measure:
  z: final(pose.box.z)
require:
  high: final(pose.box.z) > 5
"""
    assert run(folder, text, "--slots", "1", "--json") == 1
    failed, bad = table(folder)
    assert (failed["status"], failed["high"]) == ("failed", "False") and "high" in failed["issue"]
    assert float(failed["z"]) == pytest.approx(1 - 0.5 * 9.8 * 0.1 * 0.101)
    assert bad["status"] == "refused" and "bad.world:1" in bad["issue"]
    told = json.loads(capsys.readouterr().out)
    assert (told["cases"], told["failed"], told["refused"]) == (2, 1, 1)
    report = (folder / "s" / "report.html").read_text()
    assert f"study show --in {folder / 's'} {failed['case']}" in report
    assert "http" not in report and "<script" not in report


def test_a_name_that_is_not_there_refuses_or_fails_the_case(folder, capsys):
    text = "duration: 0.1\nvary:\n  m: {set: mass.nobody, values: [1, 2]}\n"
    assert run(folder, text) == 1
    first = table(folder)[0]
    assert first["status"] == "refused" and "nobody" in first["issue"]
    assert "its models are ground_plane" in first["issue"]
    assert capsys.readouterr().out.splitlines()[-1] == (
        f"2 refused: {first['issue']} (study show {first['case']} --in {folder / 's'})")
    assert run(folder, "duration: 0.1\nmeasure:\n  z: final(pose.nobody.z)\n", name="t") == 1
    assert table(folder, "t")[0]["status"] == "failed"
    assert "nobody" in table(folder, "t")[0]["issue"]


LONG = """duration: 3000
models:
  box: {file: box.sdf, pose: [0, 0, 1]}
vary:
  gravity: {set: gravity.z, values: [-9.8, -5]}
limits: {processor_seconds: 0.75}
"""


def test_a_case_that_uses_up_its_processor_time_is_ended(folder):
    assert run(folder, LONG, "--slots", "1") == 1
    assert [row["status"] for row in table(folder)] == ["timed out", "timed out"]
    assert all(0 < int(row["step"]) < 3_000_000 for row in table(folder))


def test_a_case_that_fills_the_memory_is_ended_and_told(folder):
    text = LONG.replace("processor_seconds: 0.75", "memory_mb: 20")
    assert run(folder, text, "--slots", "1") == 1
    assert [row["status"] for row in table(folder)] == ["too large", "too large"]
    assert "20 MB" in table(folder)[0]["issue"]


def test_a_state_that_diverges_is_told(folder):
    def push(case, attempt, world):
        if case.index == 1:
            world.apply_wrench("box::link", force=[1e308, 1e308, 0])

    assert run(folder, DROP.replace("count: 20", "count: 2"), "--slots", "1", hook=push) == 1
    assert [row["status"] for row in table(folder)] == ["ok", "diverged"] + 4 * ["ok"]
    assert "box" in table(folder)[1]["issue"]


def test_too_many_steps_are_refused(folder):
    assert run(folder, "duration: 10\nlimits: {steps: 100}\n") == 1
    assert "10000 steps" in table(folder)[0]["issue"]


def test_drawn_values_that_cannot_be_set_and_cases_without_steps_are_refused(folder):
    text = """duration: 0.01
plan: {random: 12}
models:
  box: {file: box.sdf, pose: [0, 0, 1]}
vary:
  m: {set: mass.box, normal: [0.2, 1]}
"""
    assert run(folder, text, "--slots", "1") == 1
    rows = table(folder)
    assert {float(row["m"]) > 0 for row in rows} == {True, False}
    for row in rows:
        assert row["status"] == ("ok" if float(row["m"]) > 0 else "refused")
        assert ("'m' must be above 0" in row["issue"]) == (row["status"] == "refused")
    bad = next(row for row in rows if row["status"] == "refused")
    assert main(["study", "show", bad["case"], "--in", "s", "--write", "x.world"]) == 2
    step = "duration: 0.04\nvary:\n  dt: {set: physics.step_size, values: [0.1]}\n"
    assert run(folder, step, name="t") == 1
    (row,) = table(folder, "t")
    assert row["status"] == "refused" and "no step to make" in row["issue"]


def test_settings_reach_the_world(folder):
    text = """duration: 1.0
models:
  box: {file: box.sdf, pose: [0, 0, 0.1]}
vary:
  mass: {set: mass.box, values: [1, 2]}
  dt: {set: physics.step_size, values: [0.001, 0.002]}
  gravity: {set: gravity.x, values: [0, 2]}
  mu: {set: friction.box, values: [0.0, 1.0]}
measure:
  weight: mean(force(box, ground_plane))
  far: final(pose.box.x)
"""
    run(folder, text)
    for row in table(folder):
        mass, pull, mu = float(row["mass"]), float(row["gravity"]), float(row["mu"])
        assert int(row["step"]) == round(1.0 / float(row["dt"]))
        assert float(row["weight"]) == pytest.approx(9.8 * mass, rel=0.05)
        assert float(row["far"]) == pytest.approx(0.5 * pull if mu == 0 else 0.0, abs=0.02)


def test_trajectories_are_kept(folder):
    text = DROP.replace("count: 20", "count: 2") + "keep:\n  trajectory: {every: 0.1}\n"
    assert run(folder, text, "--slots", "2") == 0
    for row in table(folder):
        with np.load(folder / "s" / row["trajectory"]) as kept:
            poses = kept[row["case"] + ".pose"]
            assert list(kept[row["case"] + ".names"]) == ["ground_plane", "box"]
            assert kept[row["case"] + ".time"] == pytest.approx([0, 0.1, 0.2, 0.3, 0.4])
        assert poses.shape == (5, 2, 7)
        assert poses[0, 1, 2] == pytest.approx(float(row["height"]))
        assert poses[-1, 1, 2] == float(row["rest"])


def test_a_case_is_written_as_a_world(folder):
    text = DROP.replace("count: 20", "count: 2")
    assert run(folder, text) == 0
    row = table(folder)[4]
    assert main(["study", "show", row["case"][:8], "--in", "s", "--write", "case.world"]) == 0
    with OpenWorld(WorldChoice(str(folder / "case.world"))) as world:
        assert world.states().pose["box"][2] == pytest.approx(float(row["height"]))
    assert main(["study", "show", "nothing", "--in", "s"]) == 2


def test_faults_of_a_study_are_told(folder, capsys):
    assert run(folder, "duration: x\n") == 2
    assert "s.yaml:1: error: 'duration' must be a number" in capsys.readouterr().err
    assert main(["study", "status", str(folder)]) == 2
    assert "there is no study" in capsys.readouterr().err


def test_a_case_is_recorded_as_a_state_log(folder):
    from my_simulations.cli.study_command import main as study
    from my_simulations.editor.logs.state_log import LogReader

    assert run(folder, DROP.replace("count: 20", "count: 2")) == 0
    row = table(folder)[4]
    assert study(["study", "export", row["case"][:8], "--in", "s", "--log", "logs/state.log",
                  "--every", "0.1"]) == 0
    reader = LogReader("logs/state.log")
    assert (reader.begin, reader.end) == (0.0, pytest.approx(0.4))
    number, first = reader.seek(0.0)
    _, last = reader.seek(0.4)
    document = json.loads(reader.text(number))
    assert [model["name"] for model in document["models"]] == ["ground_plane", "box"]
    assert first.values[-1][2] == pytest.approx(float(row["height"]))
    assert last.values[-1][2] == pytest.approx(float(row["rest"]), abs=1e-6)
    # The same again replaces the file; without its front end the command says so.
    assert study(["study", "export", row["case"], "--in", "s", "--log", "logs/state.log"]) == 0
    assert main(["study", "export", row["case"], "--in", "s", "--log", "x"]) == 2


def test_a_log_is_only_replaced_by_a_whole_one(folder, capsys, monkeypatch):
    from my_simulations.cli.study_command import main as study
    from my_simulations.editor.logs.state_log import LogWriter

    def full(*_):
        raise CommandError("the disk is full")

    world = "<sdf version='1.6'><world name='w'>"
    (folder / "w.world").write_text(world + "</world></sdf>")
    assert run(folder, "world: w.world\nduration: 0.01\n") == 0
    (folder / "keep.log").write_text("of before")
    export = ["study", "export", table(folder)[0]["case"], "--in", "s", "--log"]
    monkeypatch.setattr(LogWriter, "poses", full)
    assert study([*export, "keep.log"]) == 2
    assert (folder / "keep.log").read_text() == "of before"
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    (folder / "logs").mkdir()
    assert study([*export, "logs"]) == 2 and "is a folder" in capsys.readouterr().err
    assert study([*export, "keep.log"]) == 0
    assert (folder / "keep.log").read_bytes() != b"of before"
    (folder / "w.world").write_text(world)  # cannot be read
    bad = CasePlan(read_study(str(folder / "s.yaml"))[0]).case(0).id
    before = (folder / "keep.log").read_bytes()
    assert study(["study", "export", bad, "--in", "s", "--log", "keep.log"]) == 2
    assert (folder / "keep.log").read_bytes() == before
    assert not list(folder.glob("*.part"))


def test_a_slurm_array_runs_every_case_once(folder, capsys, monkeypatch):
    (folder / "s.yaml").write_text(DROP.replace("count: 20", "count: 2"))
    (folder / "bin").mkdir()
    # Stands for Slurm: runs the tasks of the array one after the other, the last one first.
    (folder / "bin" / "sbatch").write_text("""#!/bin/bash
for i in $(sed -n 's/#SBATCH --array=1-//p' "$1" | xargs seq | tac); do
  SLURM_ARRAY_TASK_ID=$i bash "$1" > "slurm-$i.txt" 2>&1 || exit 1
done
echo "Submitted batch job 7"
""")
    (folder / "bin" / "sbatch").chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder / 'bin'}:{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(SOURCE), os.environ["PYTHONPATH"]])
                       if "PYTHONPATH" in os.environ else str(SOURCE))
    assert main(["study", "run", "s.yaml", "--on", "slurm", "--shards", "3", "--sbatch",
                 "time=01:00:00", "--slots", "2", "--out", "a b"]) == 0
    told = capsys.readouterr()
    assert "Submitted batch job 7" in told.err
    script = (folder / "a b" / "study.sbatch").read_text()
    assert told.out.strip() == str(folder / "a b" / "study.sbatch")
    for line in ("#!/bin/bash", "#SBATCH --job-name=drop", "#SBATCH --array=1-3",
                 "#SBATCH --cpus-per-task=2", "#SBATCH --requeue", "#SBATCH --time=01:00:00",
                 f'#SBATCH --output="{folder}/a b/slurm/%A_%a.txt"'):
        assert line in script.splitlines(), script
    assert run(folder, (folder / "s.yaml").read_text(), "--slots", "1") == 0
    assert table(folder, "a b") == table(folder)
    # The table is the work of the last task alone.
    assert ["results.csv" in (folder / f"slurm-{n}.txt").read_text() for n in (3, 2, 1)] == [
        False, False, True]
    assert main(["study", "run", "s.yaml", "--out", "a b", "--shard", "1/2"]) == 2
    assert "in 3 shards, not in 2" in capsys.readouterr().err


def test_engines_that_nobody_uses_end_and_start_again(folder, monkeypatch):
    (folder / "s.yaml").write_text(DROP)
    plan = CasePlan(read_study(str(folder / "s.yaml"))[0])
    pids, found = [], []
    pool = SlotPool(plan, 1, lambda case, attempt, world: pids.append(world.simulator.engine_pid))
    try:
        pool.run(iter([plan.case(0)]), lambda row, kept: found.append(row))
        monkeypatch.setattr("my_simulations.studies.slot_pool._IDLE_S", 0.0)
        deadline = time.monotonic() + 60.0
        while os.path.exists(f"/proc/{pids[0]}"):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        pool.run(iter([plan.case(0)]), lambda row, kept: found.append(row))
    finally:
        pool.close()
    assert pids[0] != pids[1] and found[0].hash == found[1].hash
    assert not os.path.exists(f"/proc/{pids[1]}")


def test_parquet_holds_the_table(folder):
    from pyarrow import parquet

    assert run(folder, DROP.replace("count: 20", "count: 2")) == 0
    found = parquet.read_table(str(folder / "s" / "results.parquet"))
    assert [str(found.schema.field(name).type) for name in ("index", "height", "touched", "case")
            ] == ["int64", "double", "bool", "string"]
    rows = table(folder)
    assert found["case"].to_pylist() == [row["case"] for row in rows]
    assert found["rest"].to_pylist() == [float(row["rest"]) for row in rows]
    assert found["touched"].to_pylist() == [row["touched"] == "True" for row in rows]


def test_a_study_file_that_gained_parameters_and_measurements_goes_on(folder):
    from pyarrow import parquet

    short = "duration: 0.01\nmeasure:\n  t: final(time)\n"
    assert run(folder, short) == 0
    varied = "vary:\n  g: {set: gravity.z, values: [-9.8, -5]}\n"
    assert run(folder, short + varied) == 0
    more = short.replace("final(time)", "final(time) > 0.005") + "  most: max(time)\n" + varied
    assert run(folder, more) == 0
    rows = table(folder)
    assert [(row["g"], row["most"] != "") for row in rows] == [
        ("", False), ("-9.8", False), ("-9.8", True), ("-5.0", False), ("-5.0", True)]
    found = parquet.read_table(str(folder / "s" / "results.parquet"))
    assert found["g"].to_pylist() == [None, -9.8, -9.8, -5.0, -5.0]
    assert found["t"].to_pylist() == [None, None, True, None, True]  # was a number
    assert found["most"].null_count == 3
    assert "most" in (folder / "s" / "report.html").read_text()


def test_a_parameter_of_numbers_and_texts_is_a_column_of_texts(folder):
    from pyarrow import parquet

    assert run(folder, "duration: 0.01\nvary:\n  n: {values: [1, many]}\n") == 0
    found = parquet.read_table(str(folder / "s" / "results.parquet"))
    assert found["n"].to_pylist() == ["1.0", "many"]


def test_a_pyarrow_that_cannot_be_imported_costs_only_its_file(folder, capsys, monkeypatch):
    broken = folder / "broken" / "pyarrow"
    broken.mkdir(parents=True)
    (broken / "__init__.py").write_text("raise ImportError('built for another NumPy')\n")
    monkeypatch.syspath_prepend(str(folder / "broken"))
    for name in [name for name in sys.modules if name.partition(".")[0] == "pyarrow"]:
        monkeypatch.delitem(sys.modules, name)
    assert run(folder, "duration: 0.01\n") == 0
    assert "built for another NumPy" in capsys.readouterr().err
    assert len(table(folder)) == 1 and not (folder / "s" / "results.parquet").exists()


def test_a_world_that_cannot_be_opened_is_told_by_the_same_word_in_any_engine(folder):
    text = DROP.replace("duration: 0.4", "duration: 0.01")
    text = text[:text.index("vary:")] + """vary:
  dt: {set: physics.step_size, values: [20.0, 0.001, 30.0]}
measure:
  rest: final(pose.box.z)
"""
    run(folder, text, "--slots", "1")
    found = [(row["status"], row["attempt"], row["step"]) for row in table(folder)]
    assert found == [("failed", "1", "0"), ("ok", "1", "10"), ("failed", "1", "0")]
    assert all("step size" in row["issue"] for row in table(folder)[::2])


def test_failed_cases_keep_replays_and_the_report_leads_to_them(folder):
    text = DROP.replace("count: 20", "count: 3").replace("values: [0, 0.3, 0.6]", "values: [0]")
    (folder / "s.yaml").write_text(text + "require: {low: initial(pose.box.z) < 0.5}\n")
    for _ in range(2):      # the second run keeps what the first one wrote
        assert study_command.main(["study", "run", "s.yaml", "--replays", "2"]) == 1
        failed = [row["case"] for row in table(folder) if row["status"] == "failed"]
        assert len(failed) == 1
        replays = os.listdir(folder / "s" / "replays")
        assert replays == [f"{failed[0]}.html"]
    assert 'id="data"' in (folder / "s" / "replays" / replays[0]).read_text(encoding="utf-8")
    assert f'<a href="replays/{failed[0]}.html">' in (folder / "s" / "report.html").read_text()
    log = folder / "again.log"
    assert study_command.main(["study", "export", failed[0], "--log", str(log), "--in", "s"]) == 0
    assert LogReader(str(log)).end == pytest.approx(0.4)


def test_without_replays_none_are_written(folder):
    text = DROP.replace("count: 20", "count: 2") + "require: {never: final(time) < 0}\n"
    (folder / "s.yaml").write_text(text)
    assert study_command.main(["study", "run", "s.yaml", "--replays", "0"]) == 1
    assert not (folder / "s" / "replays").exists()
