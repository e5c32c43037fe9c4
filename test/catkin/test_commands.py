"""What a shell that sourced the workspace finds: commands, packages, launch files."""
from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
import yaml
from rospkg import RosPack

REPOSITORY = Path(__file__).resolve().parents[2]
ROBOT = REPOSITORY / "urdf" / "robo.urdf.xacro"

COMMANDS = ["xacro", "xacro.py", "$(find xacro)/xacro", "$(find xacro)/xacro.py"]
EACH = """import json, sys
import roslaunch
for words in json.load(sys.stdin):
    sys.argv = ["roslaunch", *words]   # where arguments for the launch file are looked for
    roslaunch.main(sys.argv)
    print("--")
"""


def _run(*words, **variables):
    return subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=300, env={**os.environ, **variables})


def _roslaunch_each(*calls):
    """What roslaunch prints for each list of words, all in one Python: its start takes a second."""
    done = subprocess.run(["/usr/bin/python3", "-c", EACH], input=json.dumps(calls),
                          capture_output=True, text=True, timeout=600, env=dict(os.environ))
    assert done.returncode == 0, done.stderr
    return done.stdout.split("--\n")[:-1]


def test_xacro_works_in_a_launch_file_by_every_name(tmp_path):
    launch = tmp_path / "robot.launch"
    params = "".join(f"""<param name="text{n}" command="{command} '{ROBOT}'"/>"""
                     for n, command in enumerate(COMMANDS))
    launch.write_text(f"<launch>{params}</launch>")
    done = _run("roslaunch", "--dump-params", str(launch))
    assert done.returncode == 0, done.stderr
    found = [robot for name, robot in yaml.safe_load(done.stdout).items()
             if name.startswith("/text")]
    assert len(found) == len(COMMANDS) and all("<link name=" in robot for robot in found)


def test_xacro_by_path_works_where_python3_is_another_one(tmp_path):
    decoy = tmp_path / "python3"
    decoy.write_text("#!/bin/sh\nexec /usr/bin/python3 -S \"$@\"\n")
    decoy.chmod(0o755)
    found = Path(RosPack().get_path("xacro")) / "xacro"
    done = _run(str(found), str(ROBOT), PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert done.returncode == 0, done.stderr
    assert "<link name=" in done.stdout


def test_rosrun_offers_a_python_that_opens_worlds():
    program = ("import my_simulations as m\n"
               "with m.open_world('empty_world.world') as world: print(world.names)")
    done = _run("rosrun", "my_simulations", "python", "-c", program)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "['ground_plane']"


def test_rosrun_finds_xacro():
    done = _run("rosrun", "xacro", "xacro", str(ROBOT))
    assert done.returncode == 0, done.stderr
    assert "<link name=" in done.stdout


def test_xacro_fails_with_a_status_on_a_missing_file():
    assert _run("xacro", "/nowhere.urdf.xacro").returncode != 0


def test_every_world_launch_file_forwards_every_argument():
    launches = sorted(path.name for path in
                      (REPOSITORY / "compat/gazebo_ros/launch").glob("*.launch"))
    assert len(launches) > 5
    told = _roslaunch_each(*(
        ["--args", "/gazebo", "gazebo_ros", launch, "paused:=true", "recording:=true",
         "verbose:=true", "physics:=bullet", "extra_gazebo_args:=--seed 7",
         "gui:=false"] for launch in launches))
    assert len(told) == len(launches)
    for launch, text in zip(launches, told):
        words = text.split()
        assert words[0].endswith("/gzserver"), launch
        assert words[1:8] == ["-u", "-r", "--verbose", "-e", "bullet", "--seed", "7"], launch
        assert words[8].startswith("worlds/") and words[8].endswith(".world"), launch


@pytest.mark.parametrize("name, robot", [
    ("exercises", "true"), ("lab_course", "false"), ("lab_room", "false")])
def test_a_launch_file_named_after_a_world_takes_the_arguments_of_world_launch(name, robot):
    launch = f"{name}.launch"
    args = _run("roslaunch", "--args", "/gazebo", "my_simulations", launch, "pause:=true")
    assert args.stdout.split()[1] == "-u", args.stderr
    assert args.stdout.split()[2].endswith(f"/world/{name}.world")
    params = _run("roslaunch", "--dump-params", "my_simulations", launch, "gui:=false", "x:=2.0")
    assert f"/gazebo/spawn_robot: {robot}" in params.stdout, params.stderr
    assert "/gazebo/gui: false" in params.stdout and "/gazebo/robot_x: 2.0" in params.stdout


def test_launch_file_sets_the_parameters_of_its_arguments():
    done = _run("roslaunch", "--dump-params", "gazebo_ros", "empty_world.launch",
                "use_clock_frequency:=true", "pub_clock_frequency:=50", "enable_ros_network:=false",
                "use_sim_time:=false")
    assert done.returncode == 0, done.stderr
    assert "/gazebo/pub_clock_frequency: 50" in done.stdout
    assert "/gazebo/enable_ros_network: false" in done.stdout
    assert "/use_sim_time: false" in done.stdout


def test_launch_file_accepts_numbers_of_other_types_as_gazebos_does():
    done = _run("roslaunch", "--dump-params", "gazebo_ros", "empty_world.launch",
                "use_clock_frequency:=true", "pub_clock_frequency:=62.5", "use_sim_time:=0.1")
    assert done.returncode == 0, done.stderr
    assert "/gazebo/pub_clock_frequency: 62.5" in done.stdout
    assert "/use_sim_time: 0.1" in done.stdout


def test_debug_starts_the_server_through_its_own_script():
    done = _run("roslaunch", "--args", "/gazebo", "gazebo_ros", "empty_world.launch", "debug:=true")
    assert done.stdout.split()[0].endswith("/debug")


def test_gui_argument_decides_about_the_client_node():
    without = _run("roslaunch", "--nodes", "gazebo_ros", "empty_world.launch", "gui:=false")
    both = _run("roslaunch", "--nodes", "gazebo_ros", "empty_world.launch")
    assert without.stdout.split() == ["/gazebo"]
    assert sorted(both.stdout.split()) == ["/gazebo", "/gazebo_gui"]


@pytest.mark.parametrize("shell", ["bash", "sh"])
def test_own_commands_stay_behind_real_ones(shell, tmp_path):
    real = tmp_path / "gzserver"
    real.write_text("#!/bin/sh\n")
    real.chmod(0o755)
    prefix = os.environ["CMAKE_PREFIX_PATH"].split(":")[0]
    script = f". {prefix}/setup.{shell}; . {prefix}/setup.{shell}; command -v gzserver; " \
             "command -v gzclient; echo $PATH"
    done = _run(shell, "-c", f"_CATKIN_SETUP_DIR={prefix}; {script}",
                PATH=f"{tmp_path}:/usr/local/bin:/usr/bin:/bin")
    gzserver, gzclient, path = done.stdout.split()
    assert gzserver == str(real)
    assert gzclient.endswith("/lib/gazebo_ros_commands/gzclient")
    assert path.count("/gazebo_ros_commands") == 1


@pytest.mark.parametrize("command", ["gazebo", "gz", "gzserver", "gzclient", "spawn_model"])
def test_every_command_is_found_by_its_name_alone(command):
    done = _run(command, "--help")
    assert done.returncode == 0, done.stderr
    assert f"usage: {command}" in done.stdout
