"""The shell behind tools/run and tools/test: which workspace, what is linked, what is counted."""
from __future__ import annotations

import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]

PACKAGE = "<package format='2'>\n  <!-- old -->\n  <name> {name} </name>\n</package>\n"

CONTROL = ("cob_bringup_sim", "cob_gazebo_objects", "cob_gazebo_worlds", "control_msgs",
           "controller_manager", "controller_manager_msgs", "force_torque_sensor_controller")
PARAMETERS = ("imu_sensor_controller", "joint_state_controller")


@pytest.fixture
def clone(tmp_path):
    """A clone in miniature: the tools, and folders that an overlay touches."""
    return make_clone(tmp_path / "clones" / "simulations")


def make_clone(folder):
    shutil.copytree(REPOSITORY / "tools", folder / "tools")
    for name in ("launch", "world", "urdf", "scripts"):
        (folder / name).mkdir()
        (folder / name / "ours").write_text("ours")
        (folder / name / "both").write_text("ours")
    for name in (*CONTROL, "four_wheel_steering_msgs", "gazebo_msgs", "gazebo_ros",
                 *PARAMETERS, "my_simulations_msgs", "my_simulations_underlay",
                 "teleop_twist_keyboard", "unitree_legged_msgs", "xacro"):
        make_package(folder / "compat" / name, name)
    make_package(folder, "my_simulations")
    return folder


def make_package(folder, name):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(PACKAGE.format(name=name))
    return folder


def shell(clone, script, home, **variables):
    """Run `script` in bash with the library sourced, as tools/run does."""
    command = clone / "tools" / "probe"
    command.write_text(". \"${BASH_SOURCE[0]%/*}/lib/command.sh\"\n"
                       ". \"$CLONE/tools/lib/checks.sh\"\n" + script)
    # A rospack that knows what ROS_PACKAGE_PATH names and nothing else.
    programs = home / "bin"
    programs.mkdir(parents=True, exist_ok=True)
    rospack = programs / "rospack"
    rospack.write_text(
        "#!/bin/bash\nIFS=:\nfor folder in $ROS_PACKAGE_PATH; do\n"
        "  found=$(grep -l \"<name> *$2 *<\" \"$folder\"/{,*/}package.xml 2>/dev/null)\n"
        "  found=${found%%$'\\n'*}\n"
        "  [ -z \"$found\" ] || { echo \"${found%/package.xml}\"; exit 0; }\ndone\nexit 1\n")
    rospack.chmod(0o755)
    environment = {"HOME": str(home), "PATH": f"{programs}:{os.environ['PATH']}", **variables}
    return subprocess.run(["bash", str(command)], env=environment, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=60)


def chosen(clone, home, **variables):
    done = shell(clone, "choose_workspace; echo $WORKSPACE", home, **variables)
    assert done.returncode == 0, done.stderr
    return Path(done.stdout.strip())


def test_workspace_is_the_lab_sheets_for_a_clone_anywhere(clone, tmp_path):
    assert chosen(clone, tmp_path / "home") == tmp_path / "home" / "simulation_ws"


def test_workspace_is_the_one_the_clone_lies_in(tmp_path):
    clone = make_clone(tmp_path / "some_ws" / "src" / "my_simulations")
    assert chosen(clone, tmp_path / "home") == tmp_path / "some_ws"


def test_workspace_is_the_one_the_clone_was_called_through(clone, tmp_path):
    link = tmp_path / "linked_ws" / "src" / "my_simulations"
    link.parent.mkdir(parents=True)
    link.symlink_to(clone)
    assert chosen(link, tmp_path / "home") == tmp_path / "linked_ws"


def test_home_folder_never_becomes_a_workspace(tmp_path):
    home = tmp_path / "home"
    clone = make_clone(home / "src" / "my_simulations")
    assert chosen(clone, home) == home / "simulation_ws"


def test_variable_overrides_the_workspace(tmp_path):
    clone = make_clone(tmp_path / "some_ws" / "src" / "my_simulations")
    named = tmp_path / "named_ws"
    assert chosen(clone, tmp_path / "home", MY_SIMULATIONS_WS=str(named)) == named


@pytest.mark.parametrize("name", ["a blank", "quo'te", 'quo"te', "a$b", "a;b", "a:b", "a\\b",
                                  "a#b"])
def test_workspace_that_catkin_cannot_build_in_is_refused_at_once(clone, tmp_path, name):
    done = shell(clone, "find_workspace", tmp_path / "home", MY_SIMULATIONS_WS=str(tmp_path / name))
    assert done.returncode == 1
    assert "which catkin does not support" in done.stderr
    assert not (tmp_path / name).exists()


def test_clone_in_a_folder_with_a_blank_is_refused_at_once(tmp_path):
    clone = make_clone(tmp_path / "my files" / "simulations")
    done = shell(clone, "find_workspace", tmp_path / "home")
    assert done.returncode == 1
    assert "This clone's path" in done.stderr
    assert not (tmp_path / "home" / "simulation_ws").exists()


def test_workspace_with_umlauts_is_taken(clone, tmp_path):
    named = tmp_path / "größer.v1-2_3"
    done = shell(clone, "find_workspace", tmp_path / "home", MY_SIMULATIONS_WS=str(named))
    assert done.returncode == 0, done.stderr


def test_package_of_the_same_name_stops_the_set_up_and_nothing_changes(clone, tmp_path):
    home = tmp_path / "home"
    make_package(home / "simulation_ws" / "src" / "my_simulations", "my_simulations")
    before = sorted(home.joinpath("simulation_ws").rglob("*"))
    done = shell(clone, "find_workspace", home)
    assert done.returncode == 1
    assert "--overlay" in done.stderr
    assert "MY_SIMULATIONS_WS=" in done.stderr
    assert "Nothing was changed" in done.stderr
    assert sorted(home.joinpath("simulation_ws").rglob("*")) == before


def test_package_of_the_same_name_in_a_folder_of_another_name_is_noticed(clone, tmp_path):
    home = tmp_path / "home"
    make_package(home / "simulation_ws" / "src" / "lab" / "sheet", "my_simulations")
    assert shell(clone, "find_workspace", home).returncode == 1


def test_own_link_is_no_foreign_package(clone, tmp_path):
    source = tmp_path / "home" / "simulation_ws" / "src"
    source.mkdir(parents=True)
    (source / "my_simulations").symlink_to(clone)
    done = shell(clone, "find_workspace; echo [$FOREIGN]", tmp_path / "home")
    assert done.returncode == 0, done.stderr
    assert "[]" in done.stdout


def test_packages_inside_a_package_are_not_the_workspaces(clone, tmp_path):
    source = tmp_path / "src"
    source.mkdir()
    (source / "my_simulations").symlink_to(clone)
    done = shell(clone, f"package_folders {source}", tmp_path / "home")
    assert done.stdout.split() == [str(source / "my_simulations")]


OVERLAID = "OVERLAY=1\nfind_workspace\nprepare_workspace"


def users_package(home):
    """A package my_simulations that a user made, in the workspace of `home`."""
    return make_package(home / "simulation_ws" / "src" / "my_simulations", "my_simulations")


def test_overlay_puts_ours_beside_the_users_package_and_touches_neither(clone, tmp_path):
    home = tmp_path / "home"
    foreign = users_package(home)
    before = sorted(clone.rglob("*"))
    done = shell(clone, OVERLAID, home)
    assert done.returncode == 0, done.stderr
    source = home / "simulation_ws" / "src"
    assert sorted(path.name for path in source.iterdir()) == [
        *CONTROL, "gazebo_msgs", "gazebo_ros", *PARAMETERS, "my_simulations",
        "my_simulations_msgs", "my_simulations_underlay", "teleop_twist_keyboard", "xacro"]
    assert (source / "my_simulations_underlay").resolve() == \
        clone / "compat" / "my_simulations_underlay"
    assert [path.name for path in foreign.iterdir()] == ["package.xml"]
    assert sorted(path for path in clone.rglob("*") if path.name != "probe") == before


def test_overlay_is_remembered(clone, tmp_path):
    home = tmp_path / "home"
    users_package(home)
    assert shell(clone, OVERLAID, home).returncode == 0
    done = shell(clone, "find_workspace\nprepare_workspace", home)
    assert done.returncode == 0, done.stderr


def test_overlay_of_an_earlier_version_goes_on_and_its_folder_goes(clone, tmp_path):
    home = tmp_path / "home"
    users_package(home)
    old = home / "simulation_ws" / ".my_simulations" / "overlay"
    old.mkdir(parents=True)
    done = shell(clone, "find_workspace\nprepare_workspace", home)
    assert done.returncode == 0, done.stderr
    assert not old.exists()
    assert (home / "simulation_ws" / "src" / "my_simulations_underlay").is_symlink()


def test_overlay_ends_with_the_users_package(clone, tmp_path):
    home = tmp_path / "home"
    foreign = users_package(home)
    assert shell(clone, OVERLAID, home).returncode == 0
    devel = home / "simulation_ws" / "devel"
    (devel / "bin").mkdir(parents=True)
    (devel / "bin" / "roslaunch").touch()
    shutil.rmtree(foreign)
    done = shell(clone, "find_workspace\nprepare_workspace", home)
    assert done.returncode == 0, done.stderr
    source = home / "simulation_ws" / "src"
    assert (source / "my_simulations").resolve() == clone
    assert not (source / "my_simulations_underlay").is_symlink()
    assert not (devel / "bin" / "roslaunch").exists()


def test_what_an_earlier_build_left_of_ours_goes_when_the_users_package_comes(clone, tmp_path):
    home = tmp_path / "home"
    users_package(home)
    left = home / "simulation_ws" / "devel" / "lib" / "my_simulations"
    left.mkdir(parents=True)
    assert shell(clone, OVERLAID, home).returncode == 0
    assert not left.exists()


def test_clone_in_the_same_workspace_as_the_users_package_is_refused(tmp_path):
    home = tmp_path / "home"
    clone = make_clone(home / "simulation_ws" / "src" / "the_clone")
    users_package(home)
    done = shell(clone, OVERLAID, home, MY_SIMULATIONS_WS=str(home / "simulation_ws"))
    assert done.returncode == 1
    assert f"mv {clone}" in done.stderr


def test_folder_that_is_no_package_is_not_overlaid(clone, tmp_path):
    home = tmp_path / "home"
    (home / "simulation_ws" / "src" / "my_simulations" / "launch").mkdir(parents=True)
    done = shell(clone, OVERLAID, home)
    assert done.returncode == 1
    assert "catkin_create_pkg my_simulations" in done.stderr


def test_users_python_module_of_our_name_is_refused(clone, tmp_path):
    home = tmp_path / "home"
    module = users_package(home) / "src" / "my_simulations" / "__init__.py"
    module.parent.mkdir(parents=True)
    module.touch()
    done = shell(clone, OVERLAID, home)
    assert done.returncode == 1
    assert "Python module my_simulations" in done.stderr


def test_overlay_without_a_package_to_lay_over_is_refused(clone, tmp_path):
    done = shell(clone, "OVERLAY=1; find_workspace", tmp_path / "home")
    assert done.returncode == 1
    assert "nothing to overlay" in done.stderr


def linked(clone, home, script="", **variables):
    done = shell(clone, f"{script}\nfind_workspace\nprepare_workspace", home, **variables)
    assert done.returncode == 0, done.stderr
    return sorted(path.name for path in (home / "simulation_ws" / "src").iterdir())


def test_companions_are_linked_where_nothing_is_installed(clone, tmp_path):
    assert linked(clone, tmp_path / "home") == [
        *CONTROL, "gazebo_msgs", "gazebo_ros", *PARAMETERS, "my_simulations",
        "my_simulations_msgs", "teleop_twist_keyboard", "xacro"]


def test_messages_of_few_robots_are_linked_where_a_package_speaks_of_them(clone, tmp_path):
    home = tmp_path / "home"
    package = make_package(home / "simulation_ws" / "src" / "dog", "dog")
    (package / "config").mkdir()
    (package / "config" / "legs.yaml").write_text(
        "hip: {type: unitree_legged_control/UnitreeJointController}\n")
    found = linked(clone, home)
    assert "unitree_legged_msgs" in found
    assert "four_wheel_steering_msgs" not in found
    (package / "config" / "legs.yaml").unlink()
    assert "unitree_legged_msgs" not in linked(clone, home)


def test_tests_have_the_messages_of_all_robots(clone, tmp_path):
    found = linked(clone, tmp_path / "home", "ALL_COMPANIONS=1")
    assert {"four_wheel_steering_msgs", "unitree_legged_msgs"} <= set(found)


def test_real_packages_are_preferred_to_the_companions(clone, tmp_path):
    share = tmp_path / "share"
    for name in ("gazebo_msgs", "gazebo_ros"):
        make_package(share / name, name)
    found = linked(clone, tmp_path / "home", ROS_PACKAGE_PATH=str(share))
    assert found == [*CONTROL, *PARAMETERS, "my_simulations", "my_simulations_msgs",
                     "teleop_twist_keyboard", "xacro"]


def test_real_package_in_the_workspace_is_preferred_too(clone, tmp_path):
    home = tmp_path / "home"
    make_package(home / "simulation_ws" / "src" / "gazebo" / "gazebo_msgs", "gazebo_msgs")
    assert linked(clone, home) == [
        *CONTROL, "gazebo", "gazebo_ros", *PARAMETERS, "my_simulations",
        "my_simulations_msgs", "teleop_twist_keyboard", "xacro"]


@pytest.mark.parametrize("how", ["option", "variable"])
def test_real_gazebo_ros_can_be_overridden(clone, tmp_path, how):
    share = tmp_path / "share"
    for name in ("gazebo_msgs", "gazebo_ros"):
        make_package(share / name, name)
    script = "common_option --use-companions" if how == "option" else ""
    more = {"MY_SIMULATIONS_OVERRIDE_GAZEBO_ROS": "1"} if how == "variable" else {}
    found = linked(clone, tmp_path / "home", script, ROS_PACKAGE_PATH=str(share), **more)
    assert found == [*CONTROL, "gazebo_ros", *PARAMETERS, "my_simulations",
                     "my_simulations_msgs", "teleop_twist_keyboard", "xacro"]


def test_companion_goes_with_its_build_once_a_real_one_is_installed(clone, tmp_path):
    home = tmp_path / "home"
    linked(clone, home)
    built = home / "simulation_ws" / "devel" / "lib" / "python3" / "dist-packages" / "gazebo_msgs"
    built.mkdir(parents=True)
    make_package(tmp_path / "share" / "gazebo_msgs", "gazebo_msgs")
    found = linked(clone, home, ROS_PACKAGE_PATH=str(tmp_path / "share"))
    assert found == [*CONTROL, "gazebo_ros", *PARAMETERS, "my_simulations",
                     "my_simulations_msgs", "teleop_twist_keyboard", "xacro"]
    assert not built.exists()


def test_failed_part_of_a_step_says_which_why_and_what_to_do(clone, tmp_path):
    script = ("LOGS=$HOME/logs; STEPS=1; begin 'Fetching things'\n"
              "logged fetch 'Try it by daylight.' bash -c 'echo the disk is full; exit 7'")
    done = shell(clone, script, tmp_path / "home")
    assert done.returncode == 1
    assert "[1/1] Fetching things" in done.stdout
    for text in ("Fetching things", "'fetch' failed with status 7", "the disk is full",
                 "Try it by daylight.", "logs/fetch.log"):
        assert text in done.stderr
    assert "the disk is full" in (tmp_path / "home" / "logs" / "fetch.log").read_text()


def test_part_that_takes_long_shows_its_progress_without_a_terminal(clone, tmp_path):
    script = ("LOGS=$HOME/logs; STEPS=1; begin 'Fetching things'\n"
              "logged fetch '' echo line one\nfinish")
    assert "line one" not in shell(clone, script, tmp_path / "home").stdout
    done = shell(clone, "PROGRESS_SECONDS=0\n" + script, tmp_path / "home")
    # A line of its own, and the end of the step begins another one.
    assert re.fullmatch(r"\[1/1\] Fetching things \.\.\. \n    line one\n\(\d+ s\)\n", done.stdout)


@pytest.mark.parametrize(("words", "advice"), [
    (["--gui"], "tools/run -- --gui"), (["gui=false"], "Write gui:=false"),
    (["lab.world"], "tools/run world:=lab.world"),
    (["gui:=false", "--set-up"], "no option --set-up")])
def test_wrong_word_is_refused_before_anything_is_set_up(clone, tmp_path, words, advice):
    home = tmp_path / "home"
    done = subprocess.run(["tools/run", *words], cwd=clone, text=True, capture_output=True,
                          check=False, timeout=60,
                          env={"HOME": str(home), "PATH": os.environ["PATH"]})
    assert done.returncode == 1
    assert advice in done.stderr and done.stdout == ""
    assert not home.exists()


@pytest.mark.parametrize("name", ["run", "test"])
def test_command_that_another_shell_starts_goes_on_in_bash(clone, tmp_path, name):
    done = subprocess.run(["dash", f"tools/{name}", "--help"], cwd=clone, text=True,
                          capture_output=True, timeout=60, check=False,
                          env={"HOME": str(tmp_path), "PATH": os.environ["PATH"]})
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"Usage: tools/{name}") and done.stderr == ""


def test_missing_system_packages_without_root_are_named(clone, tmp_path):
    programs = tmp_path / "home" / "bin"
    programs.mkdir(parents=True)
    for name, text in (("id", "echo 1000"), ("dpkg-query", "echo 'installed cmake'; exit 1")):
        (programs / name).write_text(f"#!/bin/bash\n{text}\n")
        (programs / name).chmod(0o755)
    script = ("ROS_PREFIX=/nowhere; STEPS=9\n"
              "command() { [ \"$2\" != sudo ] && builtin command \"$@\"; }\n"
              "install_system_packages")
    done = shell(clone, script, tmp_path / "home")
    assert done.returncode == 1
    assert "neither root nor sudo" in done.stderr
    advice = done.stderr.split("apt-get install", 1)[1].split()
    assert "catkin" in advice and "python3-venv" in advice
    assert "cmake" not in advice


def fake(home, name, text):
    """A program `name` that a shell of `home` finds before the real one."""
    program = home / "bin" / name
    program.parent.mkdir(parents=True, exist_ok=True)
    program.write_text(f"#!/bin/bash\n{text}\n")
    program.chmod(0o755)


PACKAGES = ("ROS_PREFIX=/nowhere; STEPS=9; WORKSPACE=$HOME/ws; OWN=$HOME/ws; LOGS=$HOME/logs\n"
            "mkdir -p $OWN/src; rospack() { :; }\ninstall_system_packages\n")


@pytest.fixture
def all_but_common(tmp_path):
    """A home of root's on a machine that has what we need, but nothing of what others may want."""
    home = tmp_path / "home"
    common = (REPOSITORY / "tools" / "apt-packages-common.txt").read_text()
    names = "|".join(line for line in common.splitlines() if line and line[0] != "#")
    fake(home, "id", "echo 0")
    fake(home, "dpkg-query", "shift 2; for name; do case $name in " + names + ") ;; "
         "*) echo installed $name ;; esac; done")
    fake(home, "apt-get", "echo \"$@\" >>$HOME/calls; [ ! -e $HOME/offline ]")
    return home


def test_packages_that_others_ask_for_are_installed(clone, all_but_common):
    done = shell(clone, PACKAGES, all_but_common)
    assert done.returncode == 0, done.stderr
    assert "for other packages installed" in done.stdout
    update, install = (all_but_common / "calls").read_text().splitlines()
    assert update == "-q update"
    assert "librostest-dev" in install and "libroscpp-dev" in install
    assert "catkin" not in install.split()


def test_packages_that_others_ask_for_may_be_missing_and_are_asked_for_once(clone, all_but_common):
    (all_but_common / "offline").touch()
    for calls in (1, 1):
        done = shell(clone, PACKAGES, all_but_common)
        assert done.returncode == 0, done.stderr
        assert len((all_but_common / "calls").read_text().splitlines()) == calls
    assert "all there" in done.stdout


def test_packages_that_others_ask_for_can_be_left_out(clone, all_but_common):
    done = shell(clone, "common_option --no-common-packages\n" + PACKAGES, all_but_common)
    assert done.returncode == 0, done.stderr
    assert not (all_but_common / "calls").exists()


PYTHON_SCRIPT = "#!/usr/bin/env python\nprint(1)\n"


@pytest.mark.parametrize(("text", "said"), [
    (PYTHON_SCRIPT, True), ("#! /usr/bin/python\n", True), ("#!/usr/bin/env python3\n", False)])
def test_scripts_of_python_without_a_number_are_told_of(clone, all_but_common, text, said):
    script = all_but_common / "ws" / "src" / "robot" / "node.py"
    script.parent.mkdir(parents=True)
    script.write_text(text)
    script.chmod(0o755)
    hidden = ("command() { [ \"$2\" != python ] && builtin command \"$@\"; }\n"
              "COMMON_PACKAGES=0\n")
    done = shell(clone, hidden + PACKAGES, all_but_common)
    assert done.returncode == 0, done.stderr
    assert ("python-is-python3" in done.stdout) is said


def test_python_is_installed_when_asked_for(clone, all_but_common):
    fake(all_but_common, "dpkg-query", "shift 2; for name; do [ $name = python-is-python3 ] || "
         "echo installed $name; done")
    done = shell(clone, "common_option --python\n" + PACKAGES, all_but_common)
    assert done.returncode == 0, done.stderr
    assert "install python-is-python3" in (all_but_common / "calls").read_text()


@pytest.mark.parametrize(("resolves", "variables", "address"), [
    (False, {}, "127.0.0.1"), (True, {}, ""), (False, {"ROS_IP": "10.0.0.1"}, "10.0.0.1"),
    (False, {"ROS_HOSTNAME": "robot"}, "")])
def test_name_that_does_not_resolve_is_replaced_by_the_loopback_address(
        clone, tmp_path, resolves, variables, address):
    home = tmp_path / "home"
    fake(home, "getent", "exit 0" if resolves else "[ $2 = localhost ]")
    fake(home, "uname", "echo lonely")
    for _again in range(2):
        done = shell(clone, "OWN=$HOME; use_loopback\necho \"[${ROS_IP:-}]\"", home, **variables)
        assert done.returncode == 0, done.stderr
        said = "lonely, does not resolve" in done.stdout
        assert said is (not resolves and not variables)
        assert (home / "loopback").exists() is said
        assert done.stdout.splitlines()[-1] == f"[{address}]"


def test_localhost_that_does_not_resolve_is_named_to_who_may_not_add_it(clone, tmp_path):
    home = tmp_path / "home"
    fake(home, "getent", "exit 2")
    fake(home, "id", "echo 1000")
    script = ("OWN=$HOME\n"
              "command() { [ \"$2\" != sudo ] && builtin command \"$@\"; }\nuse_loopback")
    done = shell(clone, script, home)
    assert done.returncode == 1
    assert "echo '127.0.0.1 localhost' >>/etc/hosts" in done.stderr


def test_loopback_address_goes_once_the_name_resolves(clone, tmp_path):
    home = tmp_path / "home"
    fake(home, "getent", "exit 0")
    (home / "loopback").touch()
    done = shell(clone, "OWN=$HOME; use_loopback\necho \"[${ROS_IP:-}]\"", home, ROS_IP="127.0.0.1")
    assert done.stdout.splitlines() == ["[]"]
    assert not (home / "loopback").exists()


COUNTED = "LOGS=$HOME; LOG=$HOME/log; : >$LOG; STEPS=9; begin part\n{}\necho; echo $PASSED $FAILED"


@pytest.mark.parametrize(("judged", "counts"), [
    ("judge name 5 0 0", "5 0"),
    ("judge name 5 2 1", "3 2"),
    ("judge name 5 0 139", "5 1"),
    ("judge name 0 0 124", "0 1"),
    ("judge name 5 0 0; judge name 3 3 1", "5 3"),
])
def test_counts_add_up_and_a_crash_counts_as_a_failure(clone, tmp_path, judged, counts):
    done = shell(clone, COUNTED.format(judged), tmp_path / "home")
    assert done.stdout.splitlines()[-1] == counts, done.stderr


def test_summary_of_rostest_is_read_with_its_colours(clone, tmp_path):
    log = ("SUMMARY\\n\\033[1;31m * RESULT: FAIL\\033[0m\\n * TESTS: 8\\n * ERRORS: 0\\n"
           "\\033[1;31m * FAILURES: 3 [a, b, c]\\033[0m\\n")
    script = (f"LOG=$HOME/log; printf '{log}' >$LOG\n"
              "echo $(summary TESTS) $(summary ERRORS) $(summary FAILURES)")
    assert shell(clone, script, tmp_path / "home").stdout.split() == ["8", "0", "3"]


def test_check_that_takes_too_long_is_ended_with_all_it_started(clone, tmp_path):
    script = ("LOGS=$HOME; STEPS=1; begin slow; status=0\n"
              "attempt slow 1 bash -c 'setsid sleep 600 & sleep 600' || status=$?\n"
              "echo; echo status $status left $(marked | wc -l)")
    done = shell(clone, script, tmp_path / "home")
    assert done.stdout.splitlines()[-1] == "status 124 left 0", done.stdout + done.stderr
    assert "not done after 1 s" in (tmp_path / "home" / "slow.log").read_text()


def test_modules_are_compiled_before_a_user_who_may_not_write_needs_them(clone, tmp_path):
    module = clone / "src" / "module.py"
    module.parent.mkdir(exist_ok=True)
    module.write_text("NUMBER = 1\n")
    made = Path(importlib.util.cache_from_source(str(module)))
    script = ". \"$CLONE/tools/lib/setup.sh\"; compile_sources; echo done"
    done = shell(clone, script, tmp_path / "home", VENV=sys.prefix, PYTHONDONTWRITEBYTECODE="1")
    assert done.stdout.endswith("done\n") and made.exists(), done.stderr


def test_processor_time_of_programs_that_lost_their_parent_is_counted(clone, tmp_path):
    busy = "import time; end = time.process_time() + 0.6\nwhile time.process_time() < end: pass"
    (tmp_path / "busy.py").write_text(busy)
    # On a busy machine, 0.6 s of processor time take longer than the usual patience.
    adopt = clone / "tools" / "lib" / "adopt.py"
    adopt.write_text(adopt.read_text().replace("PATIENCE_S = 2.0", "PATIENCE_S = 60.0"))
    script = (f". \"$CLONE/tools/lib/lanes.sh\"; LOGS=$HOME; STEPS=1\n"
              f"orphan() {{ begin orphan; attempt orphan 50 bash -c "
              f"'setsid {sys.executable} {tmp_path}/busy.py & exit 0'; judge orphan 0 0 0; }}\n"
              "PROCESSOR_TIME=0; queue orphan; run_queue; echo; echo $PROCESSOR_MS")
    done = shell(clone, script, tmp_path / "home")
    assert int(done.stdout.splitlines()[-1]) > 570, done.stdout + done.stderr


ENDS_AT_ONCE = """
import os, sys
sys.path.insert(0, "tools/lib")
import adopt
class EndsAtOnce:
    def __init__(self, start):
        self.start = start
    def __call__(self, *words, **options):
        number = self.start(*words, **options)
        os.waitid(os.P_PID, number, os.WEXITED | os.WNOWAIT)
        return number
for name in ("posix_spawnp", "fork", "posix_spawn"):
    setattr(os, name, EndsAtOnce(getattr(os, name)))
import _posixsubprocess, subprocess
subprocess._fork_exec = EndsAtOnce(_posixsubprocess.fork_exec)
sys.exit(adopt.main(["bash", "-c", "setsid sleep 3 & exit 7"]))
"""


def test_a_program_that_ends_before_it_is_waited_for_is_not_waited_for_again():
    done = subprocess.run([sys.executable, "-c", ENDS_AT_ONCE], cwd=REPOSITORY, timeout=300)
    assert done.returncode == 7


PAGE = ("LOGS=$HOME/logs; STEPS=2; WORKSPACE=$HOME/ws\nprepare_page\n")


@pytest.fixture
def page_home(clone, tmp_path):
    """A home with an npm that only notes how it was called, and a clone with a page."""
    (clone / "web").mkdir()
    (clone / "web" / "package.json").write_text("{}")
    (clone / "web" / "package-lock.json").write_text("{}")
    home = tmp_path / "home"
    (home / "bin").mkdir(parents=True)
    npm = home / "bin" / "npm"
    npm.write_text("#!/bin/bash\necho \"$@\" >>$HOME/calls\n[ ! -e $HOME/offline ]\n")
    npm.chmod(0o755)
    return home


def test_page_packages_are_fetched_into_the_workspace_once(clone, page_home):
    for expected in ("installed", "all there"):
        done = shell(clone, PAGE, page_home)
        assert done.returncode == 0, done.stderr
        assert expected in done.stdout
    calls = (page_home / "calls").read_text().splitlines()
    assert len(calls) == 1
    assert calls[0].startswith(f"ci --prefix {page_home}/ws/.my_simulations ")


def test_page_packages_are_fetched_again_for_another_lock_file(clone, page_home):
    shell(clone, PAGE, page_home)
    (clone / "web" / "package-lock.json").write_text('{"lockfileVersion": 3}')
    assert "installed" in shell(clone, PAGE, page_home).stdout
    assert len((page_home / "calls").read_text().splitlines()) == 2


def test_page_packages_that_do_not_come_stop_the_set_up_and_are_asked_for_again(clone, page_home):
    (page_home / "offline").touch()
    done = shell(clone, PAGE, page_home)
    assert done.returncode == 1
    assert "Is there a network?" in done.stderr
    (page_home / "offline").unlink()
    assert "installed" in shell(clone, PAGE, page_home).stdout


NPM = """#!/bin/bash
echo "$@" >>$HOME/calls
[ ! -e $HOME/offline ] || exit 1
case $3 in
  */page_bundler)
    [ ! -e $HOME/no_bundler ] || exit 1
    # npm 7 fetches the programs of other systems, too.
    for system in aix-ppc64 $(node -p 'process.platform + "-" + process.arch'); do
      mkdir -p $3/node_modules/@esbuild/$system/bin
      printf '#!/bin/bash\n%s\n%s\n%s && %s && %s\n' \
        '[[ $* != *--outbase* ]] || exit 0' '[[ $1 != */replay/* ]] || exec cp $1 replay.js' \
        '[[ $0 != *aix* ]]' 'mkdir bundle && cp $1 bundle/' 'echo made >>$HOME/calls' \
        >$3/node_modules/@esbuild/$system/bin/esbuild
      chmod +x $3/node_modules/@esbuild/$system/bin/esbuild
    done ;;
  *) mkdir -p $3/node_modules/three && echo 1 >$3/node_modules/three/package.json ;;
esac
"""
PACKED = "ws/.my_simulations/node_modules/my_simulations_page/bundle/main.ts"
PACKED_REPLAY = "ws/.my_simulations/node_modules/my_simulations_page/replay.js"


@pytest.fixture
def packed_home(clone, page_home):
    """As `page_home`, with a page of one module and what packs it."""
    (page_home / "bin" / "npm").write_text(NPM)
    (clone / "web" / "js" / "replay").mkdir(parents=True)
    (clone / "web" / "js" / "main.ts").write_text("one();")
    (clone / "web" / "js" / "replay" / "main.ts").write_text("play();")
    return page_home


def test_modules_of_the_page_are_packed_once_and_again_after_an_edit(clone, packed_home):
    for text, expected, made in (("one();", "installed", 1), ("one();", "all there", 1),
                                 ("other();", "all there", 2)):
        (clone / "web" / "js" / "main.ts").write_text(text)
        done = shell(clone, PAGE, packed_home)
        assert done.returncode == 0 and f"{expected} (" in done.stdout, done.stderr
        assert (packed_home / PACKED).read_text() == text
        assert (packed_home / PACKED_REPLAY).read_text() == "play();"
        calls = (packed_home / "calls").read_text().splitlines()
        assert calls.count("made") == made and len(calls) == made + 2


@pytest.mark.parametrize("fault", ["no_bundler", "bundle"])
def test_a_page_that_cannot_be_built_is_told_of(clone, packed_home, fault):
    (packed_home / fault).touch()
    if fault == "bundle":     # esbuild itself fails
        (packed_home / "bin" / "npm").write_text(NPM.replace("mkdir bundle", "false"))
    for expected in ("installed, its modules not built: see ", "all there, its modules not "):
        done = shell(clone, PAGE, packed_home)
        assert done.returncode == 0 and expected in done.stdout, done.stdout + done.stderr
        assert not (packed_home / PACKED).exists()
    calls = (packed_home / "calls").read_text().splitlines()
    assert sum("page_bundler" in line for line in calls) == 1     # it is not asked for each time


PIP = """
for word; do
  case $last in --find-links) wheels=$word ;; -d) out=$word ;; esac
  last=$word
done
echo "$@" >>$HOME/calls
case "$*" in
  --version) echo Python 3.99 ;;
  *"pip install"*requirements.txt*)
    [ ! -e $HOME/offline ] ||
      { echo "Temporary failure in name resolution: No matching distribution found"; exit 1; }
    [ -n "$(ls $wheels/*.whl 2>/dev/null)" ] ||
      { echo "ERROR: No matching distribution found for pybullet==3.2.7"; exit 1; } ;;
  *"pip download"*)
    mkdir -p $HOME/source/pybullet-3.2.7
    echo "EGL_CXX_FLAGS += '-DBT_USE_EGL '" >$HOME/source/pybullet-3.2.7/setup.py
    echo 'sources = ["a.c"]' >>$HOME/source/pybullet-3.2.7/setup.py
    tar -czf $out/pybullet-3.2.7.tar.gz -C $HOME/source pybullet-3.2.7 ;;
  *bdist_wheel*)
    grep -q BT_USE_EGL setup.py && exit 3
    echo "gcc -c a.c -o a.o"
    [ ! -e $HOME/broken ] || { echo "Python.h: No such file or directory"; exit 1; }
    mkdir -p $out; touch $out/pybullet.whl ;;
esac
"""


@pytest.fixture
def bare_index(tmp_path):
    """A home with a Python for which the package index has no wheel of PyBullet."""
    home = tmp_path / "home"
    fake(home, "fake_python", PIP)
    fake(home, "id", "echo 0")
    fake(home, "dpkg-query", "shift 2; for name; do echo installed $name; done")
    (home / "ws" / "venv" / "bin").mkdir(parents=True)
    (home / "ws" / "venv" / "bin" / "python3").symlink_to(home / "bin" / "fake_python")
    return home


INSTALL = ("STEPS=9; OWN=$HOME/ws; LOGS=$HOME/logs; VENV=$OWN/venv; PYTHON=$HOME/bin/fake_python\n"
           "COMMAND=tools/run; begin 'Python packages'\n"
           "rm -f $VENV/.requirements; prepare_python $CLONE/requirements.txt\n")


def wheels_compiled(home):
    return (home / "calls").read_text().count("bdist_wheel")


def with_requirements(clone):
    (clone / "requirements.txt").write_text("pybullet==3.2.7\n")
    return clone


def test_pybullet_without_a_wheel_is_compiled_once_for_all_workspaces(clone, bare_index):
    for _workspace in range(2):
        done = shell(with_requirements(clone), INSTALL, bare_index)
        assert done.returncode == 0, done.stderr
        assert wheels_compiled(bare_index) == 1
        assert "minutes" in done.stdout or _workspace
    assert (bare_index / ".cache/my_simulations/wheels/pybullet.whl").exists()
    assert "compiling 1 of about 1, about 0 min left: a.c" in (
        bare_index / "logs/pybullet-compile.log").read_text()


def test_commands_that_a_setup_py_only_logs_are_printed(clone, tmp_path):
    home = tmp_path / "home"
    home.mkdir()
    (home / "setup.py").write_text("import logging, sys\n"
                                   "logging.getLogger('d').info('gcc -c %s', sys.argv[1])\n")
    done = shell(clone, f"cd $HOME; {sys.executable} -c \"$RUN_SETUP_PY\" setup.py a.c", home)
    assert done.stdout == "gcc -c a.c\n", done.stderr


def test_compilation_that_fails_is_told_with_the_compilers_words(clone, bare_index):
    (bare_index / "broken").touch()
    done = shell(with_requirements(clone), INSTALL, bare_index)
    assert done.returncode == 1
    assert "Python.h: No such file" in done.stderr and "pybullet-compile" in done.stderr


def test_missing_network_does_not_start_a_compiler(clone, bare_index):
    (bare_index / "offline").touch()
    done = shell(with_requirements(clone), INSTALL, bare_index)
    assert done.returncode == 1
    assert "The network does not answer" in done.stderr
    assert wheels_compiled(bare_index) == 0


def test_source_of_pybullet_is_the_version_that_is_required():
    pinned = [line.split()[0] for line in (REPOSITORY / "tools/lib/pybullet-source.txt")
              .read_text().splitlines() if line.startswith("pybullet")]
    assert pinned == [line for line in (REPOSITORY / "requirements.txt").read_text().splitlines()
                      if line.startswith("pybullet")]


@pytest.mark.parametrize(("line", "advice"), [
    ("OSError: [Errno 28] No space left on device", "The disk is full"),
    ("E: dpkg was interrupted, you must manually run 'dpkg --configure -a'", "dpkg --configure -a"),
    ("E: Could not get lock /var/lib/dpkg/lock-frontend", "Another package manager"),
    ("SSLError(SSLCertVerificationError(1, '[SSL: CERTIFICATE_VERIFY_FAILED]", "PIP_CERT"),
    ("npm ERR! code SELF_SIGNED_CERT_IN_CHAIN", "NODE_EXTRA_CA_CERTS"),
    ("npm ERR! code EAI_AGAIN", "does not answer"),
    ("OSError('Tunnel connection failed: 407 Proxy Authentication Required')", "proxy refuses"),
    ("pybullet.c:9:10: fatal error: Python.h: No such file or directory", "python3-dev"),
    ("error: command 'x86_64-linux-gnu-gcc' failed: No such file or directory", "build-essential"),
    ("c++: fatal error: Killed signal terminated program cc1plus", "memory is too small"),
    ("no such option: --require-hashes", "too old"),
    ("E: Unable to locate package catkin", "universe"),
    ("something that nobody has seen", "Try it by daylight.")])
def test_failure_is_explained_by_what_the_log_holds(clone, tmp_path, line, advice):
    script = "LOGS=$HOME/logs; begin X\nlogged part 'Try it by daylight.' bash -c 'cat; exit 1'\n"
    text = shlex.quote(line)
    done = shell(clone, script.replace("'cat; exit 1'", shlex.quote(f"echo {text}; exit 1")),
                 tmp_path / "home")
    assert done.returncode == 1
    advices = [row for row in done.stderr.splitlines() if row.startswith("  -> ")]
    assert advice in advices[0]
