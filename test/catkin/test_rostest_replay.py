"""A plain rostest of a user's package leaves a replay if it fails, and nothing else."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from replay_content import replay_content

from my_simulations.cli.rostest_replay import has_failed

TEST = """<launch>
  <param name="there" value="1"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="gui" value="false"/>
  </include>
  <test test-name="{name}" pkg="rostest" type="publishtest" time-limit="120">
    <rosparam>
      topics: [{{name: {topic}, timeout: {seconds}, negative: false}}]
    </rosparam>
  </test>
</launch>
"""


def run(tmp_path, name, topic, seconds):
    package = tmp_path / "their_package"
    package.mkdir(exist_ok=True)
    (package / "package.xml").write_text(
        "<package format='2'><name>their_package</name><version>1.0.0</version>"
        "<description>d</description><maintainer email='a@b.org'>m</maintainer>"
        "<license>x</license></package>")
    (package / f"{name}.test").write_text(TEST.format(name=name, topic=topic, seconds=seconds))
    temporary = tmp_path / "tmp"
    temporary.mkdir(exist_ok=True)
    done = subprocess.run(
        ["rostest", "--results-base-dir", str(tmp_path / "results"), f"--pkgdir={package}",
         "--package=their_package", str(package / f"{name}.test")],
        env={**os.environ, "PATH": os.pathsep.join([os.path.dirname(sys.executable),
                                                    os.environ["PATH"]]),
             "MY_SIMULATIONS_RECORD_TOPICS": "/gazebo/link_states",
             "TMPDIR": str(temporary), "ROS_HOME": str(tmp_path / "home"),
             "ROS_PACKAGE_PATH": f"{package}{os.pathsep}{os.environ['ROS_PACKAGE_PATH']}"},
        capture_output=True, text=True, timeout=600)
    assert not list(temporary.glob("my_simulations_rostest_*"))
    files = {path.name: path for path in Path(tmp_path / "results").rglob("*") if path.is_file()}
    return done, files


def test_a_failed_rostest_leaves_a_replay_beside_its_results(tmp_path):
    done, files = run(tmp_path, "fails", "/nothing", 3)
    assert done.returncode != 0
    assert has_failed(str(files["rosunit-fails.xml"])), done.stdout
    page = files["rosunit-fails.html"]
    _, messages = replay_content(page, tmp_path / "state.log")
    assert "ground_plane::link" in messages["/gazebo/link_states"][-1]["text"]


def test_a_rostest_that_passes_leaves_none(tmp_path):
    done, files = run(tmp_path, "passes", "/gazebo/model_states", 60)
    assert not has_failed(str(files["rosunit-passes.xml"])), done.stdout + done.stderr
    assert [name for name in files if name.endswith(".html")] == []


def test_a_test_without_results_has_failed(tmp_path):
    assert has_failed(str(tmp_path / "missing.xml"))
    (tmp_path / "half.xml").write_text("<testsuite")
    assert has_failed(str(tmp_path / "half.xml"))
    (tmp_path / "error.xml").write_text('<testsuite failures="0" errors="1"/>')
    assert has_failed(str(tmp_path / "error.xml"))
    (tmp_path / "good.xml").write_text('<testsuite failures="0" errors="0"/>')
    assert not has_failed(str(tmp_path / "good.xml"))
