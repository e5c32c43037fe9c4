"""The table of test/corpus/run_worlds.py: moving models, falling models, files that do not load."""
from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

CUBE = """<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry>
</collision></link>"""
WORLD = f"""<sdf version="1.6"><world name="w">
<physics type="ode"><real_time_update_rate>4000</real_time_update_rate></physics>
<model name="ground"><static>true</static><link name="l"><collision name="c"><geometry>
<box><size>6 6 0.02</size></box></geometry></collision></link></model>
<model name="lies"><pose>0 0 0.51 0 0 0</pose>{CUBE}</model>
<model name="falls"><pose>4 0 -2 0 0 0</pose>{CUBE}</model>
<model name="floats"><pose>8 0 2 0 0 0</pose><link name="l"><gravity>0</gravity></link></model>
</world></sdf>"""


def test_a_world_that_is_run_tells_what_moved_and_fell(tmp_path):
    (tmp_path / "one.world").write_text(WORLD)
    (tmp_path / "two.world").write_text("<sdf version='1.6'><world")
    done = subprocess.run(
        [sys.executable, str(ROOT / "test/corpus/run_worlds.py"), "--cold", f"some={tmp_path}"],
        capture_output=True, text=True, timeout=240)
    assert "fell" in done.stdout, (done.returncode, done.stdout[-500:], done.stderr[-2000:])
    lines = done.stdout.splitlines()
    counts = dict(zip(lines[-2].split(), lines[-1].split()[1:]))
    wanted = {"worlds": "2", "runs": "1", "refused": "1", "late": "0", "crashes": "0",
              "moved": "1", "fell": "1"}
    assert {name: counts[name] for name in wanted} == wanted, done.stdout
    assert any(line.startswith("    fell to") and line.endswith(" falls") for line in lines)
    assert "refused: " in done.stdout and "two.world:1" in done.stdout
    assert done.returncode == 1
