"""What catkin_lint and rosdep say of the packages."""
from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGES = [REPOSITORY, *sorted((REPOSITORY / "compat").iterdir())]
PRAGMA = re.compile(r"\s*#catkin_lint: ")


LINT = (sys.executable, os.path.join(os.path.dirname(sys.executable), "catkin_lint"))
ROSDEP = ("/usr/bin/python3", "/usr/bin/rosdep")
"""The distribution's: pip's brings a rospkg that does not find the distribution's packages."""


def run(tmp_path, *words, **variables):
    """Both tools read files of the user's home folder, which is an empty one here."""
    kept = {name: os.environ[name] for name in ("LC_ALL", "PATH") if name in os.environ}
    return subprocess.run(words, cwd=REPOSITORY, text=True, capture_output=True, timeout=120,
                          env={**kept, "HOME": str(tmp_path), **variables})


def test_catkin_lint_finds_neither_errors_nor_warnings(tmp_path):
    done = run(tmp_path, *LINT, "--offline", "-W1", *map(str, PACKAGES))
    assert done.stdout == "", done.stdout
    assert f"checked {len(PACKAGES)} packages and found 0 problems" in done.stderr


@pytest.mark.parametrize("folder", PACKAGES, ids=lambda folder: folder.name)
def test_what_catkin_lint_is_not_to_report_has_a_reason_above_it(folder):
    lines = (folder / "CMakeLists.txt").read_text().splitlines()
    for at, line in enumerate(lines):
        if PRAGMA.match(line):
            above = next(one for one in reversed(lines[:at]) if not PRAGMA.match(one))
            assert above.strip().startswith("# "), f"{folder.name}: {line}"


@pytest.mark.parametrize("system, paths", [("debian:bookworm", ["."]),
                                           ("ubuntu:jammy", [".", "compat"])])
def test_rosdep_resolves_all_dependencies_with_the_rules_of_this_repository(
        tmp_path, system, paths):
    index = tmp_path / "index.yaml"
    index.write_text("%YAML 1.1\n---\ndistributions: {}\ntype: index\nversion: 4\n")
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources" / "10.list").write_text(f"yaml file://{REPOSITORY}/rosdep.yaml\n")
    places = {"ROSDEP_SOURCE_PATH": str(tmp_path / "sources"), "ROS_PYTHON_VERSION": "3",
              "ROSDISTRO_INDEX_URL": f"file://{index}",
              "PIP_BREAK_SYSTEM_PACKAGES": "1"}  # Debian 13's rosdep wants it
    updated = run(tmp_path, *ROSDEP, "update", **places)
    assert updated.returncode == 0, updated.stderr
    done = run(tmp_path, *ROSDEP, "install", "--from-paths", *paths, "--ignore-src",
               "--reinstall", "--simulate", "--os", system, "--rosdistro", "noetic", **places)
    assert done.returncode == 0, done.stderr
    assert "apt-get install rviz" in done.stdout
    assert "pip3 install -U -I pybullet" in done.stdout
