"""The set-up in workspaces of catkin tools and catkin_make_isolated, moved ones, and with ROS One.

The ROS One here is Debian's ROS, linked into a folder of the same layout.
"""
from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from free_ports import free_port
from generated_messages import DEVEL, copy_messages

REPOSITORY = Path(__file__).resolve().parents[2]
OWN = DEVEL.parent / ".my_simulations"
"""Where the workspace under test has what it fetched."""
READY = "the world editor is at http"
SECONDS = 900.0

PACKAGE = """<package format="2"><name>my_lab</name><version>0.0.0</version>
<description>a</description>
<maintainer email="a@example.com">a</maintainer><license>a</license>
<buildtool_depend>catkin</buildtool_depend></package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.5)
project(my_lab)
find_package(catkin REQUIRED)
catkin_package()
"""


class Workspace:
    """A person's workspace with a package, which `first` has built, and a terminal."""

    def __init__(self, folder: Path, *first: str) -> None:
        self.folder = folder
        package = folder / "ws" / "src" / "my_lab"
        package.mkdir(parents=True)
        (package / "package.xml").write_text(PACKAGE)
        (package / "CMakeLists.txt").write_text(CMAKE)
        own = folder / "ws" / ".my_simulations"
        own.mkdir()
        for name in ("venv", "node_modules", ".page"):
            (own / name).symlink_to(OWN / name)
        (folder / "bin").mkdir()
        (folder / "bin" / "catkin").symlink_to(Path(sys.prefix) / "bin" / "catkin")
        self.environment = {
            "HOME": str(folder), "PATH": f"{folder}/bin:/usr/sbin:/usr/bin:/sbin:/bin",
            "LANG": "C.UTF-8",
            "MY_SIMULATIONS_WS": str(folder / "ws"), "MY_SIMULATIONS_NO_BROWSER": "1",
            "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}", "ROS_IP": "127.0.0.1",
            **{key: value for key, value in os.environ.items()
               if key.startswith("MY_SIMULATIONS_TEST")}}
        for line in first:
            self.run(line)

    def program(self, name: str, text: str) -> None:
        """A program that comes before the system's."""
        (self.folder / "bin" / name).write_text(f"#!/bin/bash\n{text}\n")
        (self.folder / "bin" / name).chmod(0o755)

    def run(self, line: str) -> str:
        """The output of a command in the workspace; it must succeed."""
        done = subprocess.run(["bash", "-c", line], env=self.environment, cwd=self.folder / "ws",
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=SECONDS, check=False)
        assert done.returncode == 0, f"{line}\n{done.stdout[-4000:]}"
        return done.stdout

    def set_up(self) -> str:
        return self.run(f"{REPOSITORY}/tools/run --set-up-only")

    def simulate(self, devel: str) -> None:
        """Launch the world of the package, and spawn an object of its list."""
        log = self.folder / "launch.log"
        source = f"source {self.folder}/ws/{devel}/setup.bash && "
        with open(log, "w", encoding="utf-8") as output:
            launch = subprocess.Popen(
                ["bash", "-c", source + "exec roslaunch my_simulations my_world.launch"],
                env=self.environment, stdin=subprocess.DEVNULL, stdout=output,
                stderr=subprocess.STDOUT, start_new_session=True)
        try:
            until = time.monotonic() + SECONDS
            while READY not in log.read_text(encoding="utf-8"):
                assert launch.poll() is None and time.monotonic() < until, log.read_text()
                time.sleep(0.05)
            self.run(source + "rosrun gazebo_ros spawn_model -urdf -model ball -z 1 "
                     "-file $(rospack find my_simulations)/objects/ball.urdf")
            names = self.run(source + "rosservice call /gazebo/get_world_properties")
            assert "ball" in names, names
        finally:
            os.killpg(launch.pid, signal.SIGINT)
            launch.wait(60.0)


@pytest.mark.parametrize(("first", "devel"), [
    (["catkin init", "catkin build --no-status"], "devel"),
    # Moved workspaces of it are built in every run.
    pytest.param(["catkin_make_isolated"], "devel_isolated", marks=pytest.mark.long)],
    ids=["catkin_tools", "isolated"])
def test_workspace_is_built_by_its_own_command_and_simulates(tmp_path, first, devel):
    workspace = Workspace(tmp_path, *first)
    of_packages = tmp_path / "ws" / ("devel/.private" if devel == "devel" else devel)
    copy_messages(lambda package: of_packages / package)
    text = workspace.set_up()
    assert f"source {tmp_path}/ws/{devel}/setup.bash" in text
    assert (tmp_path / "ws" / "devel").exists() is (devel == "devel")
    relay = next((tmp_path / "ws" / devel).rglob("lib/my_simulations/spawn_object.py"))
    assert relay.read_text().startswith(f"#!{tmp_path}/ws/.my_simulations/venv/bin/python3\n")
    workspace.simulate(devel)
    assert "Building the workspace ... up to date" in workspace.set_up()


def ros_one(folder: Path, workspace: Workspace) -> Path:
    """A prefix `one` with the set-up files that catkin installs, and links to the system's ROS."""
    prefix = folder / "opt" / "ros" / "one"
    workspace.run(f"mkdir -p {folder}/empty/src && catkin_make -C {folder}/empty install "
                  f"-DCMAKE_INSTALL_PREFIX={prefix} -DPYTHON_EXECUTABLE=/usr/bin/python3")
    packages = [path.parent.name for path in Path("/usr/share").glob("*/package.xml")]
    packages.append("roslib")  # Debian has only its Python module
    modules = Path("lib/python3/dist-packages")
    linked = [Path("share") / name for name in packages]
    linked += [part / name for name in packages for part in (Path("lib"), Path("include"), modules)]
    linked += [path.relative_to("/usr") for path in Path("/usr/bin").iterdir()
               if path.name.startswith(("ros", "catkin"))]
    for path in linked:
        place = prefix / path
        if (Path("/usr") / path).exists() and not place.exists():
            place.parent.mkdir(parents=True, exist_ok=True)
            place.symlink_to(Path("/usr") / path)
    hooks = prefix / "etc" / "catkin" / "profile.d"
    hooks.mkdir(parents=True, exist_ok=True)
    for hook in Path("/etc/catkin/profile.d").iterdir():
        (hooks / hook.name).symlink_to(hook)
    (hooks / "1.ros_distro.sh").unlink()
    (hooks / "1.ros_distro.sh").write_text("export ROS_DISTRO=one\n")
    return prefix


def test_ros_one_is_used_and_nothing_of_debians_ros_is_asked_for(tmp_path):
    workspace = Workspace(tmp_path)
    prefix = ros_one(tmp_path, workspace)
    copy_messages(lambda _package: tmp_path / "ws" / "devel")
    workspace.environment.update(MY_SIMULATIONS_ROS_PREFIX=str(prefix), PREFIX=str(prefix))
    # dpkg has the packages of ROS One, and none of Debian's with ROS.
    workspace.program("dpkg-query", r"""shift 2
printf '%s\n' "$@" >>$HOME/asked
for name; do
  of=${name#ros-one-} of=${of//-/_}
  case $name in
    ros-one-*) [ -z "$(ls -d $PREFIX/{bin,share,lib/python3/dist-packages}/$of)" ] ||
      echo installed $name ;;
    *) /usr/bin/dpkg-query -W -f='${db:Status-Status} ${Package}\n' $name ;;
  esac
done 2>/dev/null""")
    text = workspace.set_up()
    assert "System packages ... all there" in text
    asked = (tmp_path / "asked").read_text().split()
    assert "ros-one-rospy" in asked and not {"python3-rospy", "catkin"} & set(asked)
    assert str(prefix / "share" / "catkin" / "cmake") in (
        tmp_path / "ws" / "build" / "CMakeCache.txt").read_text()
    assert workspace.run("source devel/setup.bash && echo $ROS_DISTRO $(rospack find rospy)") == (
        f"one {prefix}/share/rospy\n")
    workspace.simulate("devel")


BUILD = """for part in causes progress workspace system build; do . $CLONE/tools/lib/$part.sh; done
set -euo pipefail; COMMAND=tools/run STEPS=2 OWN=$WORKSPACE/.my_simulations
LOGS=$OWN/log VENV=$OWN/venv; source_setup() { :; }; compile_sources() { :; }
choose_builder; build_workspace; build_workspace
"""
"""The part of the set-up that builds: the whole adds this project's packages."""


@pytest.mark.parametrize(("first", "devel"), [
    ("catkin_make", "devel"), ("catkin init && catkin build --no-status", "devel"),
    ("catkin_make_isolated", "devel_isolated")], ids=["catkin_make", "catkin_tools", "isolated"])
def test_moved_workspace_is_built_again_by_the_same_command(tmp_path, first, devel):
    (tmp_path / "old").mkdir()
    workspace = Workspace(tmp_path / "old", first)
    (tmp_path / "old").rename(tmp_path / "new")
    workspace.folder = tmp_path / "new"
    workspace.environment.update(
        HOME=str(tmp_path / "new"), MY_SIMULATIONS_WS=str(tmp_path / "new" / "ws"),
        PATH=f"{tmp_path}/new/bin:/usr/sbin:/usr/bin:/sbin:/bin")
    text = workspace.run(f"CLONE={REPOSITORY} WORKSPACE=$MY_SIMULATIONS_WS\n{BUILD}")
    assert "this workspace was moved" in text and "up to date" in text
    assert str(tmp_path / "old") not in (tmp_path / "new" / "ws" / devel / "setup.sh").read_text()
    assert workspace.run(f"source {devel}/setup.bash && rospack find my_lab").strip() == (
        f"{tmp_path}/new/ws/src/my_lab")


def test_catkin_make_before_the_set_up_names_it(tmp_path):
    workspace = Workspace(tmp_path)
    (tmp_path / "ws" / "src" / "my_simulations").symlink_to(REPOSITORY)
    text = " ".join(workspace.run("catkin_make").split())
    assert "my_simulations needs gazebo_msgs, gazebo_ros, my_simulations_msgs, xacro" in text
    assert f"{tmp_path}/ws/src/my_simulations/tools/run --set-up-only" in text
