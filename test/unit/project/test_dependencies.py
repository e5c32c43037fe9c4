"""package.xml, rosdep.yaml, the lists of apt and pip's requirements name the same dependencies."""
from __future__ import annotations

import ast
import importlib.util
import re
import sys
import sysconfig
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import yaml

REPOSITORY = Path(__file__).resolve().parents[3]
COMPANIONS = sorted((REPOSITORY / "compat").iterdir())
RULES = yaml.safe_load((REPOSITORY / "rosdep.yaml").read_text())
STANDARD = sysconfig.get_paths()["stdlib"]

PYTHON = {
    "aiohttp": "python3-aiohttp", "embreex": "python3-embreex-pip",
    "glcontext": "python3-glcontext-pip", "lxml": "python3-lxml",
    "moderngl": "python3-moderngl-pip", "numpy": "python3-numpy", "PIL": "python3-pil",
    "pybullet": "python3-pybullet-pip", "rospkg": "python3-rospkg", "scipy": "python3-scipy",
    "setuptools": "python3-setuptools", "shapely": "python3-shapely",
    "trimesh": "python3-trimesh-pip", "yaml": "python3-yaml"}
"""Modules whose keys of rosdep have other names."""

OPTIONAL = {"distributed", "gymnasium"}
"""Extras of setup.py that no ROS program needs; they say so where they are missing."""

INDIRECT = {"numpy", "scipy"}
"""Of requirements.txt: versions that others need, and what the system has in other versions."""

NOT_SET_UP = {"robot_state_publisher", "rviz"}
"""For view_robot.launch; tools/run does not install a desktop program."""


def dependencies(folder, kind="*"):
    root = ET.parse(folder / "package.xml").getroot()
    return {one.text for one in root.findall(kind) if one.tag.endswith("depend")}


def lines_of(name):
    return [line for line in (REPOSITORY / name).read_text().splitlines()
            if line and not line.startswith("#")]


def imported(folder):
    found = set()
    for path in folder.rglob("*"):
        if path.suffix not in ("", ".py") or not path.is_file() or path.name == "CMakeLists.txt":
            continue
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".py" or text.startswith("#!/usr/bin/env python3"):
            for node in ast.walk(ast.parse(text)):
                if isinstance(node, ast.Import):
                    found |= {alias.name.partition(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and not node.level:
                    found.add(node.module.partition(".")[0])
    return {name for name in found if not is_standard(name)}


def is_standard(name):
    spec = None if name in sys.builtin_module_names else importlib.util.find_spec(name)
    origin = (spec.origin or "") if spec else ""
    return name in sys.builtin_module_names or origin in ("built-in", "frozen") or (
        origin.startswith(STANDARD) and "-packages" not in origin)


def undeclared(folder, places):
    named = set().union(*(imported(folder / place) for place in places))
    own = {folder.name, "my_simulations", "my_simulations_underlay"}
    return {PYTHON.get(name, name) for name in named - own - OPTIONAL} - dependencies(folder)


def test_package_xml_names_all_that_is_imported():
    assert undeclared(REPOSITORY, ["src", "scripts"]) == set()
    for folder in COMPANIONS:
        # Called, not depended on: my_simulations depends on these packages.
        assert undeclared(folder, ["."]) - {"catkin_pkg"} == set(), folder.name


def test_package_xml_names_all_packages_that_launch_files_use():
    for folder in (REPOSITORY, *COMPANIONS):
        used = set()
        for path in (folder / "launch").glob("*.launch*"):
            text = path.read_text()
            used |= set(re.findall(r'pkg="(\w+)"|\$\(find (\w+)\)', text))
        used = {name for pair in used for name in pair if name}
        assert used - {folder.name, "my_simulations"} <= dependencies(folder), folder.name


def test_programs_that_the_sources_start_are_declared():
    started = set()
    for path in (REPOSITORY / "src").rglob("*.py"):
        started |= set(re.findall(r'which\("(\w+)"\)|execvp\("(\w+)"', path.read_text()))
    started = {name for pair in started for name in pair if name}
    assert {"roslaunch", "rostest", "rostopic", "xacro"} <= started
    assert {name for name in started if name.startswith("ros") or name == "xacro"} <= dependencies(
        REPOSITORY)


def test_rosdep_has_a_rule_for_all_dependencies_and_no_other():
    named = set().union(*(dependencies(folder) for folder in (REPOSITORY, *COMPANIONS)))
    assert named - {"my_simulations"} == set(RULES)  # which companions find beside themselves


@pytest.mark.parametrize("key", sorted(RULES))
def test_a_rule_is_that_of_the_set_up(key):
    assert set(RULES[key]) == {"debian", "ubuntu"}
    assert RULES[key]["debian"] == RULES[key]["ubuntu"]
    rule = RULES[key]["debian"]
    if isinstance(rule, dict):
        (name,) = rule["pip"]["packages"]
        assert name in {line.partition("==")[0] for line in lines_of("requirements.txt")}
        return
    installed = set()
    for path in (REPOSITORY / "tools").glob("apt-packages*.txt"):
        if path.stem != "apt-packages-noetic":
            installed |= set(lines_of(path))
    if key in {folder.name for folder in COMPANIONS}:
        assert rule == []
    elif key.startswith("python3-"):
        assert rule == [key]
    else:
        name = key.replace("_", "-")
        names = {f"python3-{name}", f"ros-{name}", f"lib{name}-dev", name}
        common = set(lines_of("tools/apt-packages-common.txt")) - {"ros-robot-state-publisher"}
        assert rule == sorted(names & (installed - common) | ({key} & {"rviz"}))


def test_pip_installs_only_what_package_xml_names():
    named = {RULES[key]["debian"]["pip"]["packages"][0] for key in dependencies(REPOSITORY)
             if isinstance(RULES[key]["debian"], dict)}
    assert {line.partition("==")[0] for line in lines_of("requirements.txt")} - INDIRECT == named


def test_noetic_has_the_same_packages_of_ros():
    keys = {key for key in dependencies(REPOSITORY, "exec_depend")
            if isinstance(RULES[key]["debian"], list) and RULES[key]["debian"]
            and not key.startswith("python3-")} - NOT_SET_UP
    assert {"ros-noetic-" + key.replace("_", "-") for key in keys} <= set(
        lines_of("tools/apt-packages-noetic.txt"))


@pytest.mark.parametrize("folder", [REPOSITORY, *COMPANIONS], ids=lambda folder: folder.name)
def test_a_manifest_has_author_maintainer_and_licence(folder):
    root = ET.parse(folder / "package.xml").getroot()
    assert root.get("format") == "3"
    assert root.findtext("author") and root.find("maintainer").get("email")
    assert root.findtext("license") == "Apache-2.0"
    if folder == REPOSITORY or not folder.name.startswith("my_simulations_"):
        address = root.find("url")
        assert address.get("type") == "website"
        assert address.text.startswith("https://") or (folder / address.text).is_file()
