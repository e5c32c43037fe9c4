"""How the command-line programs end when their output is lost or they are interrupted."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from my_simulations.program_end import exit_cleanly

ROOT = Path(__file__).resolve().parents[3]
CHECK_MODEL = [sys.executable, str(ROOT / "scripts" / "check_model")]
COMMANDS = {
    "check_model": [*CHECK_MODEL, str(ROOT / "urdf" / "robo.urdf")],
    "help": [*CHECK_MODEL, "--help"],
    "study": [sys.executable, "-m", "my_simulations.studies", "--help"],
}
READER_GONE = 128 + signal.SIGPIPE


def ended(command, stdout=None, close=None, unbuffered=""):
    """Exit code and errors of a program; `close` is a descriptor that it does not get."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONUNBUFFERED": unbuffered}
    done = subprocess.run(command, stdout=stdout, stderr=subprocess.PIPE, env=environment,
                          preexec_fn=None if close is None else lambda: os.close(close),
                          text=True, check=False)
    return done.returncode, done.stderr


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_full_disk_is_told_without_a_traceback(name, unbuffered):
    with open("/dev/full", "w") as full:
        code, errors = ended(COMMANDS[name], full, unbuffered=unbuffered)
    assert code == os.EX_IOERR
    assert errors.endswith("cannot write the output: No space left on device\n")
    assert "Traceback" not in errors and "Exception" not in errors


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_reader_that_has_gone_ends_the_program_silently(name, unbuffered):
    reader, writer = os.pipe()
    os.close(reader)
    assert ended(COMMANDS[name], writer, unbuffered=unbuffered) == (READER_GONE, "")
    os.close(writer)


def test_a_program_runs_without_standard_output(tmp_path):
    assert ended(COMMANDS["check_model"], close=1) == (0, "")


def test_the_output_of_a_study_may_be_closed(tmp_path):
    (tmp_path / "study.yaml").write_text("duration: 1\n")
    code, errors = ended([sys.executable, "-m", "my_simulations.studies", "status", str(tmp_path)],
                         close=1)
    assert code == 2 and "Traceback" not in errors


def test_an_interrupted_program_ends_without_a_traceback(tmp_path):
    """It waits for the writer of a pipe, which is an input as good as any other."""
    os.mkfifo(str(tmp_path / "model.sdf"))
    waiting = subprocess.Popen([*CHECK_MODEL, str(tmp_path / "model.sdf")], stderr=subprocess.PIPE,
                               env={**os.environ, "PYTHONPATH": str(ROOT / "src")})
    with open(str(tmp_path / "model.sdf"), "wb"):  # returns when the program has opened it
        waiting.send_signal(signal.SIGINT)
        _, errors = waiting.communicate()
    assert (waiting.returncode, errors) == (128 + signal.SIGINT, b"")


def test_other_faults_pass(capsys):
    @exit_cleanly
    def main() -> int:
        raise FileNotFoundError(2, "gone")

    with pytest.raises(FileNotFoundError):
        main()


def test_the_exit_code_is_that_of_the_program(capsys):
    @exit_cleanly
    def main(code: int) -> int:
        print("done")
        return code

    assert main(3) == 3 and capsys.readouterr().out == "done\n"
