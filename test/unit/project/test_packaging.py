"""The files that tell catkin, roslaunch and pip about the packages."""
from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]
LAUNCH = REPOSITORY / "compat" / "gazebo_ros" / "launch"

ARGUMENTS = {
    "paused": "false", "use_sim_time": "true", "extra_gazebo_args": "", "gui": "true",
    "recording": "false", "headless": "false", "debug": "false", "physics": "ode",
    "verbose": "false", "output": "screen", "world_name": "worlds/empty.world",
    "respawn_gazebo": "false", "use_clock_frequency": "false", "pub_clock_frequency": "100",
    "enable_ros_network": "true", "server_required": "false", "gui_required": "false",
}
"""Arguments of gazebo_ros' empty_world.launch, with their defaults."""

OURS = {"extensions": "$(eval gui or manual_stepping or lockstep == True)",
        "manual_stepping": "false", "lockstep": "", "editor_port": "11346",
        "editor_host": "127.0.0.1", "editor_token": "true"}
"""What Gazebo's has not."""


def _arguments(path):
    return [arg for arg in ET.parse(path).getroot().findall("arg") if "default" in arg.attrib]


def test_empty_world_launch_has_gazebos_arguments_and_defaults_and_ours():
    arguments = _arguments(LAUNCH / "empty_world.launch")
    found = {arg.get("name"): arg.get("default") for arg in arguments}
    assert found == {**ARGUMENTS, **OURS}


def test_no_engine_is_named_to_the_server_unless_somebody_asks_for_one():
    root = ET.parse(LAUNCH / "empty_world.launch").getroot()
    (flag,) = (arg.get("value") for arg in root.findall("arg") if arg.get("name") == "physics_flag")
    words = flag[len("$(eval "):-1]
    assert eval(words, {"physics": ARGUMENTS["physics"]}) == ""
    assert eval(words, {"physics": "dart"}) == "-e dart"
    (node,) = (node for node in root.findall("node") if node.get("name") == "gazebo")
    assert "$(arg physics_flag)" in node.get("args") and "-e " not in node.get("args")


@pytest.mark.parametrize("name, declared", [
    ("elevator", "paused use_sim_time extra_gazebo_args gui recording headless debug physics "
                 "verbose world_name"),
    ("range", "paused use_sim_time extra_gazebo_args gui debug physics verbose world"),
    ("mud", ""), ("rubble", ""), ("shapes", ""), ("willowgarage", "")])
def test_a_world_launch_file_may_be_included_with_the_arguments_of_gazebos(name, declared):
    arguments = _arguments(LAUNCH / f"{name}_world.launch")
    assert set(declared.split()) <= {arg.get("name") for arg in arguments}


@pytest.mark.parametrize("path", sorted(LAUNCH.glob("*.launch")), ids=lambda path: path.name)
def test_world_that_a_launch_file_names_is_shipped(path):
    (world,) = (arg.get("value") or arg.get("default") for arg in ET.parse(path).getroot().iter(
        "arg") if arg.get("name") == "world_name")
    world = world.replace("$(arg world)", "gazebo_ros_range")
    assert (REPOSITORY / "world" / world).is_file()


PACKAGES = [REPOSITORY, *sorted((REPOSITORY / "compat").iterdir())]


@pytest.mark.parametrize("folder", PACKAGES, ids=lambda folder: folder.name)
def test_package_and_project_have_one_name_and_licence(folder):
    package = ET.parse(folder / "package.xml").getroot()
    project = re.search(r"project\((\w+)\)", (folder / "CMakeLists.txt").read_text()).group(1)
    assert package.findtext("name") == project
    assert package.findtext("license") == "Apache-2.0"


def test_every_launched_program_is_executable_and_started_by_python3():
    programs = [*(REPOSITORY / "scripts").iterdir(),
                *(REPOSITORY / "compat" / "gazebo_ros" / "scripts").iterdir(),
                REPOSITORY / "compat" / "xacro" / "xacro",
                REPOSITORY / "compat" / "xacro" / "xacro.py"]
    for program in programs:
        if program.name == "__pycache__":
            continue
        assert program.read_text().startswith("#!/usr/bin/env python3\n"), program
        assert program.stat().st_mode & 0o111, program


def test_both_names_of_xacro_are_the_same_program():
    folder = REPOSITORY / "compat" / "xacro"
    assert (folder / "xacro").read_text() == (folder / "xacro.py").read_text()


@pytest.mark.parametrize("name", ["requirements.txt", "requirements-test.txt",
                                  "requirements-oldest.txt", "requirements-release.txt"])
def test_pip_requirements_are_pinned(name):
    lines = [line for line in (REPOSITORY / name).read_text().splitlines()
             if line and not line.startswith("#")]
    assert lines
    python, machine = r"python_version [<>=]+ \"3\.\d+\"", r" and platform_machine == \"\w+\""
    for line in lines:
        assert re.match(rf"[\w-]+==[\w.]+(; {python}({machine})?)?$", line), line


@pytest.mark.parametrize("path", sorted(
    path for path in (REPOSITORY / "compat").glob("*/CMakeLists.txt")
    if "\ngenerate_messages(" in path.read_text()), ids=lambda path: path.parent.name)
def test_definitions_of_messages_are_not_checked_in_each_catkin_make(path):
    before, _ = path.read_text().split("\ngenerate_messages(")
    assert "set(GENMSG_CHECK_DEPS_SCRIPT -I -S -c pass)" in before.split("find_package")[-1]


def test_every_top_level_folder_of_data_is_installed():
    text = (REPOSITORY / "CMakeLists.txt").read_text()
    installed = re.search(r"foreach\(folder ([^)]*)\)", text).group(1).split()
    data = {"Media", "config", "examples", "launch", "models", "objects", "urdf", "world"}
    assert set(installed) == data
    assert all((REPOSITORY / folder).is_dir() for folder in data)


def test_no_test_is_executable_since_completion_of_rosrun_lists_all_that_are():
    files = [path for path in (REPOSITORY / "test").rglob("*") if path.is_file()]
    assert files and not [path for path in files if path.stat().st_mode & 0o111]


OPTIONAL = {"hector_uav_msgs", "kobuki_msgs", "mav_msgs", "pal_control_msgs", "pedsim_msgs",
            "pr2_msgs", "prius_msgs"}
"""Packages of robots: their messages are used where their robot's packages are."""


def test_all_messages_that_the_sources_use_are_installed_without_the_common_packages():
    used = set()
    for path in (REPOSITORY / "src").rglob("*.py"):
        text = path.read_text()
        used |= set(re.findall(r"^\s*(?:from|import) (\w+_(?:msgs|srvs))\b", text, re.MULTILINE))
        if path.relative_to(REPOSITORY / "src" / "my_simulations").parts[0] in ("plugins", "ros"):
            used |= set(re.findall(r"\"(\w+_(?:msgs|srvs))/\w+\"", text))
    used -= OPTIONAL | {folder.name for folder in PACKAGES}
    assert {"nav_msgs", "sensor_msgs", "tf2_msgs"} <= used
    package = ET.parse(REPOSITORY / "package.xml").getroot()
    assert used <= {one.text for one in package.findall("exec_depend")}
    for name, prefix in (("ros", "python3-"), ("noetic", "ros-noetic-")):
        installed = (REPOSITORY / "tools" / f"apt-packages-{name}.txt").read_text().splitlines()
        assert {prefix + one.replace("_", "-") for one in used} <= set(installed), name
