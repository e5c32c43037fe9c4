"""The shell behind tools/test that runs checks side by side."""
from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]

HEAD = """set -euo pipefail
for part in progress checks lanes; do . "$LIB/$part.sh"; done
LOGS="$HOME/logs"; mkdir -p "$LOGS"; STEPS=9
trap 'end_lanes; end_leftovers' EXIT
trap 'exit 130' INT TERM
"""
TAIL = """
run_queue
for fault in "${FAULTS[@]}"; do say "FAILED $fault"; done
say "$PASSED passed, $FAILED failed, $STEP steps"
"""


def started(tmp_path, script, lanes=2):
    return subprocess.Popen(
        ["bash", "-c", HEAD + script + TAIL], text=True, start_new_session=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env={**os.environ, "HOME": str(tmp_path), "LIB": str(REPOSITORY / "tools" / "lib"),
             "MY_SIMULATIONS_TEST_LANES": str(lanes)})


def output(tmp_path, script, lanes=2):
    process = started(tmp_path, script, lanes)
    text, _ = process.communicate(timeout=60)
    assert process.returncode == 0, text
    return text.splitlines()


@pytest.mark.parametrize("lanes", [1, 2, 5])
def test_every_check_is_told_of_in_one_line_and_counted(tmp_path, lanes):
    script = "\n".join(f"queue check part{n} 20 true" for n in range(4))
    lines = output(tmp_path, script + "\nqueue check broken 20 bash -c 'echo the reason; exit 3'",
                   lanes)
    told = sorted(line.partition("] ")[2].partition(" (")[0] for line in lines
                  if line.startswith("["))
    assert told == ["broken ... FAILED", *(f"part{n} ... ok" for n in range(4))]
    assert [line.partition("/")[0] for line in lines if line.startswith("[")] == [
        f"[{n}" for n in range(1, 6)]
    assert "the reason" in lines
    assert lines[-2:] == [f"FAILED broken: 1 failed, see {tmp_path}/logs/broken.log",
                          "0 passed, 1 failed, 5 steps"]


LEFT_OUT = """
CLONE="$HOME"; RESULTS="$HOME"; TEST_PYTHON={python}; COMPLETE={complete}
for name in cheap dear; do queue pytest_files $name 50 "$HOME/test/test_$name.py"; done
is_left_out "rostest world" && say "world is left out"
is_left_out "rostest worlds" || say "worlds is run"
"""


@pytest.mark.parametrize(("complete", "told"), [
    (0, ["world is left out", "worlds is run", "cheap ... 1 ok", "dear ... ok"]),
    (1, ["worlds is run", "cheap ... 2 ok", "dear ... 1 ok"])])
def test_costly_tests_are_left_out_unless_a_run_is_complete(tmp_path, complete, told):
    folder = tmp_path / "test"
    folder.mkdir()
    (folder / "conftest.py").write_text((REPOSITORY / "test" / "conftest.py").read_text())
    (folder / "test_cheap.py").write_text("def test_a(): pass\ndef test_ab(): pass\n")
    (folder / "test_dear.py").write_text("def test_a(): pass\n")
    (folder / "costly_tests.txt").write_text(
        "9.0 rostest world\n5.5 test/test_cheap.py::test_a\n7.0 test/test_dear.py::test_a\n")
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\n")
    lines = output(tmp_path, LEFT_OUT.format(python=sys.executable, complete=complete), 1)
    assert [line.partition("] ")[2].partition(" (")[0] or line for line in lines][:-1] == told


def test_costly_tests_are_read_from_the_output_of_a_complete_run(tmp_path):
    generate = tmp_path / "tools" / "generate"
    generate.mkdir(parents=True)
    (tmp_path / "test").mkdir()
    shutil.copy(REPOSITORY / "tools" / "generate" / "costly_tests.py", generate)
    (tmp_path / "output").write_text(
        "[5/9] rostest world ... 3 ok (20 s, processor 9.0 s)\n"
        "[6/9] rostest many ... 30 ok (20 s, processor 9.0 s)\n"
        "[7/9] test/unit 1/2 ... 30 ok (20 s, processor 90.0 s)\n"
        "    2.00 test/a/test_b.py::test_c[no token]\n   1.99 test/a/test_b.py::test_d\n")
    subprocess.run([sys.executable, str(generate / "costly_tests.py"), "output"], cwd=tmp_path,
                   check=True, stdout=subprocess.DEVNULL)
    lines = (tmp_path / "test" / "costly_tests.txt").read_text().splitlines()
    assert lines[2:] == ["9.0 rostest world", "2.0 test/a/test_b.py::test_c[no token]"]


def test_the_list_of_costly_tests_names_tests_that_exist():
    lines = (REPOSITORY / "test" / "costly_tests.txt").read_text().splitlines()
    names = [line.partition(" ")[2] for line in lines if not line.startswith("#")]
    assert len(names) > 50
    for name in names:
        if name.startswith("rostest "):
            assert (REPOSITORY / "test" / "rostest" / f"{name.split()[1]}.test").is_file(), name
        else:
            file, _, test = name.partition("::")
            function = test.partition("[")[0].rpartition("::")[2]
            assert f"def {function}(" in (REPOSITORY / file).read_text(), name


def shown(tmp_path, log):
    """What is printed of a check that has written `log` and failed."""
    (tmp_path / "log.txt").write_text(log)
    script = "MOST_FAILURE_LINES=50\nqueue check broken 20 bash -c 'cat $HOME/log.txt; exit 1'"
    return "\n".join(output(tmp_path, script))


TAP = """TAP version 13
not ok 1 - a file is read
  ---
  error: 'File is not defined'
  ...
""" + "".join(f"ok {n} - part {n}\n  ---\n  duration_ms: 1\n  ...\n" for n in range(2, 90)) + (
    "1..89\n# tests 89\n# fail 1\n")
PYTEST = "".join(f"test/test_{n}.py ..\n" for n in range(99)) + (
    "=================================== FAILURES ===================================\n"
    "____ test_falls ____\nE   assert 1 == 2\n" + "stdout\n" * 200 +
    "=========================== short test summary info ============================\n"
    "FAILED test/test_7.py::test_falls\n")
ROSTEST = ("[ROSTEST]----\n[pkg.rosunit-a/test_stays][passed]\n"
           "\x1b[1;31m[pkg.rosunit-a/test_falls][FAILURE]-----------\x1b[0m\n"
           "too low\n" + "-" * 80 + "\n" + "[INFO] left\n" * 90)


@pytest.mark.parametrize(("log", "reason", "success"), [
    (TAP, "  error: 'File is not defined'", "part 3"), (PYTEST, "E   assert 1 == 2", "test_3.py"),
    (ROSTEST, "too low", "test_stays")])
def test_failed_tests_are_shown_and_others_are_not(tmp_path, log, reason, success):
    text = shown(tmp_path, log)
    assert reason in text.splitlines() and success not in text
    assert log.splitlines()[-1] in text


def test_failure_without_a_known_form_shows_the_last_lines(tmp_path):
    text = shown(tmp_path, "\n".join(f"line {n}" for n in range(100)))
    assert "line 99" in text and "line 41" in text and "line 3\n" not in text


def test_long_failure_does_not_hide_the_other_checks(tmp_path):
    assert len(shown(tmp_path, PYTEST).splitlines()) < 90


def test_processor_time_of_a_check_and_its_programs_is_added_up(tmp_path):
    # `times` is what the shell itself counts; 0.3 s are used by a program of a program.
    burn = 'import time\nwhile time.process_time() < 0.3: pass'
    lines = output(tmp_path, f"""queue check burns 30 bash -c "python3 -c '{burn}'; true"
queue check rests 30 sleep 0.4
trap 'printf "%s\\n" "${{PROCESSOR[@]}}" "$PROCESSOR_MS all"' EXIT""")
    used = {name: float(seconds) for seconds, name in (
        line.split() for line in lines if line.endswith((" burns", " rests", " all")))}
    assert used["burns"] >= 0.3 > used["rests"]
    assert used["all"] == pytest.approx(1000 * (used["burns"] + used["rests"]))


def test_two_lanes_run_at_the_same_time(tmp_path):
    # Each waits for what the other writes.
    meet = "touch $HOME/{0}; until [ -e $HOME/{1} ]; do sleep 0.05; done"
    script = (f"queue check a 20 bash -c '{meet.format('a', 'b')}'\n"
              f"queue check b 20 bash -c '{meet.format('b', 'a')}'")
    assert output(tmp_path, script)[-1] == "0 passed, 0 failed, 2 steps"


def test_a_lane_that_is_killed_is_a_failure(tmp_path):
    lines = output(tmp_path, "doomed() { kill -KILL $BASHPID; }\n"
                             "queue doomed\nqueue check a 9 true")
    assert "FAILED doomed : ended without a result" in lines
    assert lines[-1] == "0 passed, 1 failed, 2 steps"


def test_programs_in_lanes_hear_of_interrupts(tmp_path):
    python = ("import signal; assert signal.getsignal(signal.SIGINT) is "
              "signal.default_int_handler")
    assert output(tmp_path, f'queue check a 20 python3 -c "{python}"')[-1].startswith(
        "0 passed, 0 failed")


def test_what_a_check_leaves_running_is_ended_and_its_neighbours_go_on(tmp_path):
    script = ("queue check leaves 20 bash -c 'setsid sleep 600 & echo $! >$HOME/left'\n"
              "queue check stays 20 bash -c 'until [ -e $HOME/left ] && ! [ -e /proc/$(cat "
              "$HOME/left) ]; do sleep 0.05; done'")
    assert output(tmp_path, script)[-1] == "0 passed, 0 failed, 2 steps"


def test_an_interrupt_ends_all_lanes(tmp_path):
    process = started(tmp_path, "for n in 1 2; do queue check part$n 60 bash -c "
                                "\"echo \\$\\$ >$HOME/pid$n; sleep 600\"; done")
    until = time.monotonic() + 30
    paths = [tmp_path / "pid1", tmp_path / "pid2"]
    while not all(path.exists() and path.read_text().strip() for path in paths):
        assert time.monotonic() < until and process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    assert process.wait(30) == 130
    for path in paths:
        stat = Path(f"/proc/{path.read_text().strip()}/stat")
        assert not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z"


def test_the_oldest_python_gets_the_unit_tests_that_import_nothing_of_ros():
    done = subprocess.run(
        ["bash", "-c", ". tools/lib/oldest.sh; tests_without_ros"], cwd=REPOSITORY, text=True,
        capture_output=True, check=True)
    chosen = done.stdout.split()
    assert "test/unit/formats/test_mesh.py" in chosen and len(chosen) > 100
    assert "test/unit/ros/test_ros_texts.py" not in chosen
    for name in chosen:
        assert "\nimport rospy" not in (REPOSITORY / name).read_text(encoding="utf-8"), name
    assert not [name for name in chosen if name.startswith("test/unit/project/")]


def test_a_usual_run_has_the_oldest_python_run_the_tests_of_the_readers():
    done = subprocess.run(
        ["bash", "-c", ". tools/lib/oldest.sh; tests_of_readers; echo; tests_without_ros"],
        cwd=REPOSITORY, text=True, capture_output=True, check=True)
    usual, _, all_tests = (part.split() for part in done.stdout.partition("\n\n"))
    assert {"test/unit/formats/test_mesh.py", "test/unit/objects/test_yaml_lists.py"} <= set(usual)
    assert set(usual) < set(all_tests) and len(usual) > 40
    # What imports a package of another version is among them, or in one of these folders.
    assert {name.split("/")[2] for name in usual} == {
        "description", "formats", "messages", "objects", "resources", "studies"}


def oldest(tmp_path, all_tests, has_pyenv=False, on_path=False, system=False, named=None):
    """(the Python that was chosen, what is said where there is none)"""
    pyenv = tmp_path / "pyenv" / "versions" / "3.8.18" / "bin"
    for path, fits in ((pyenv / "python3.8", has_pyenv),
                       (tmp_path / "bin" / "python3.8", on_path),
                       (tmp_path / "bin" / "python3", system)):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!/bin/sh\nexit {0 if fits else 1}\n", encoding="utf-8")
        path.chmod(0o755)
    environment = {"PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "HOME": str(tmp_path),
                   "PYENV_ROOT": str(tmp_path / "pyenv")}
    if named is not None:
        environment["MY_SIMULATIONS_OLDEST_PYTHON"] = named
    done = subprocess.run(
        ["bash", "-eu", "-c", ". tools/lib/progress.sh; STEPS=1; . tools/lib/oldest.sh\n"
         f"choose_oldest_python {int(all_tests)}\n"
         "echo \"chosen: $OLDEST_PYTHON\"; [ -n \"$OLDEST_PYTHON\" ] || tell_oldest_python"],
        cwd=REPOSITORY, text=True, capture_output=True, check=True, env=environment)
    chosen, _, said = done.stdout.partition("\n")
    return chosen[len("chosen: "):].replace(str(tmp_path), ""), said


def test_all_tests_look_for_the_oldest_python_and_say_if_there_is_none(tmp_path):
    pyenv = "/pyenv/versions/3.8.18/bin/python3.8"
    assert oldest(tmp_path, True, has_pyenv=True, on_path=True)[0] == "python3.8"
    assert oldest(tmp_path, True, has_pyenv=True)[0] == pyenv
    assert oldest(tmp_path, False, has_pyenv=True, on_path=True)[0] == ""
    chosen, said = oldest(tmp_path, True)
    assert chosen == "" and "no Python 3.8 found" in said


def test_the_oldest_python_may_be_named_be_unwanted_or_be_the_system_s_own(tmp_path):
    assert oldest(tmp_path, False, named="/opt/python3.8")[0] == "/opt/python3.8"
    chosen, said = oldest(tmp_path, True, on_path=True, named="none")
    assert chosen == "" and "not wanted" in said
    chosen, said = oldest(tmp_path, True, on_path=True, system=True)
    assert chosen == "" and "all tests run on it" in said
