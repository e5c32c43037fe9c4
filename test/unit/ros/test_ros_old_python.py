"""What Debian 11's interpreter needs."""
from __future__ import annotations

import subprocess
import sys
import threading

import pytest

from my_simulations.ros.lifecycle import old_python


@pytest.mark.parametrize("version, races", [
    ((3, 8, 5), True), ((3, 8, 10), False), ((3, 9, 2), True), ((3, 9, 3), False),
    ((3, 11, 2), False), ((3, 13, 5), False)])
def test_the_versions_whose_imports_race_are_known(version, races):
    assert old_python.imports_race(version) is races


def test_what_threads_import_at_the_start_is_imported_before_them():
    # `state_publishers` and `simulator` are what two threads imported half.
    program = ("import sys\nfrom my_simulations.ros.lifecycle import old_python\n"
               "old_python.import_in_turn()\n"
               "for name in ('ros.topics.state_publishers', 'simulator.simulator',"
               " 'ros.lifecycle.editor_launcher', 'resources.resolver'):\n"
               "    assert 'my_simulations.' + name in sys.modules, name\n")
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120)


def test_threads_answer_to_the_name_that_an_old_rospy_uses(monkeypatch):
    monkeypatch.delattr(threading.Thread, "isAlive", raising=False)
    monkeypatch.setattr(old_python, "imports_race", lambda: True)
    monkeypatch.setattr(old_python, "import_in_turn", lambda: None)
    try:
        old_python.prepare_threads()
        assert threading.current_thread().isAlive()
    finally:
        del threading.Thread.isAlive
