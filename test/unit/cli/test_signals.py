"""Signals at the end of a program."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = """
import signal, sys
import lxml.etree, numpy  # the end of an interpreter takes a while with them
from my_simulations.cli import signals

signal.signal({number}, lambda *_: None)
print("ready", flush=True)
sys.stdin.readline()
signals.ignore_signals()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_at_the_very_end_changes_no_exit_status(number):
    with subprocess.Popen([sys.executable, "-c", PROGRAM.format(number=int(number))],
                          env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE) as ending:
        assert ending.stdout.readline() == b"ready\n"
        ending.stdin.close()
        while ending.poll() is None:
            ending.send_signal(number)
        assert ending.returncode == 0
