"""The shell behind tools/run and tools/test: which workspace, what is linked, what is counted."""
from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]

PACKAGE = "<package format='2'>\n  <!-- old -->\n  <name> {name} </name>\n</package>\n"


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
    for name in ("gazebo_msgs", "gazebo_ros", "my_simulations_msgs", "xacro"):
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
        "  for place in \"$folder\" \"$folder\"/*; do\n"
        "    grep -q \"<name> *$2 *<\" \"$place/package.xml\" 2>/dev/null || continue\n"
        "    echo \"$place\"; exit 0\n  done\ndone\nexit 1\n")
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
    named = tmp_path / "named ws"
    assert chosen(clone, tmp_path / "home", MY_SIMULATIONS_WS=str(named)) == named


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


OVERLAID = "OVERLAY=1\nfind_workspace\nprepare_workspace\necho done $BUILD_WORKSPACE"


def test_overlay_shows_foreign_files_before_ours_and_touches_neither(clone, tmp_path):
    home = tmp_path / "home"
    workspace = home / "simulation_ws"
    foreign = make_package(workspace / "src" / "my_simulations", "my_simulations")
    (foreign / "launch").mkdir()
    (foreign / "launch" / "both").write_text("theirs")
    (foreign / "launch" / "theirs").write_text("theirs")
    done = shell(clone, OVERLAID, home)
    assert done.returncode == 0, done.stderr
    package = workspace / ".my_simulations" / "overlay" / "src" / "my_simulations"
    shown = {path.name: path.read_text() for path in (package / "launch").iterdir()}
    assert shown == {"ours": "ours", "both": "theirs", "theirs": "theirs"}
    assert (package / "world" / "both").read_text() == "ours"
    assert (package / "package.xml").resolve() == clone / "package.xml"
    assert (clone / "launch" / "both").read_text() == "ours"
    assert (foreign / "launch" / "both").read_text() == "theirs"
    assert sorted(path.name for path in (workspace / "src").iterdir()) == ["my_simulations"]


def test_overlay_is_remembered_and_follows_removed_files(clone, tmp_path):
    home = tmp_path / "home"
    foreign = make_package(home / "simulation_ws" / "src" / "my_simulations", "my_simulations")
    (foreign / "urdf").mkdir()
    (foreign / "urdf" / "both").write_text("theirs")
    assert shell(clone, OVERLAID, home).returncode == 0
    (foreign / "urdf" / "both").unlink()
    done = shell(clone, "find_workspace\nprepare_workspace", home)
    assert done.returncode == 0, done.stderr
    package = home / "simulation_ws" / ".my_simulations" / "overlay" / "src" / "my_simulations"
    assert (package / "urdf" / "both").read_text() == "ours"


def test_overlay_without_a_package_to_lay_over_is_refused(clone, tmp_path):
    done = shell(clone, "OVERLAY=1; find_workspace", tmp_path / "home")
    assert done.returncode == 1
    assert "nothing to overlay" in done.stderr


def linked(clone, home, script="", **variables):
    done = shell(clone, f"{script}\nfind_workspace\nprepare_workspace", home, **variables)
    assert done.returncode == 0, done.stderr
    return sorted(path.name for path in (home / "simulation_ws" / "src").iterdir())


def test_companions_are_linked_where_nothing_is_installed(clone, tmp_path):
    assert linked(clone, tmp_path / "home") == ["gazebo_msgs", "gazebo_ros", "my_simulations",
                                                "my_simulations_msgs", "xacro"]


def test_real_packages_are_preferred_to_the_companions(clone, tmp_path):
    share = tmp_path / "share"
    for name in ("gazebo_msgs", "gazebo_ros"):
        make_package(share / name, name)
    found = linked(clone, tmp_path / "home", ROS_PACKAGE_PATH=str(share))
    assert found == ["my_simulations", "my_simulations_msgs", "xacro"]


def test_real_package_in_the_workspace_is_preferred_too(clone, tmp_path):
    home = tmp_path / "home"
    make_package(home / "simulation_ws" / "src" / "gazebo" / "gazebo_msgs", "gazebo_msgs")
    assert linked(clone, home) == ["gazebo", "gazebo_ros", "my_simulations",
                                    "my_simulations_msgs", "xacro"]


@pytest.mark.parametrize("how", ["option", "variable"])
def test_real_gazebo_ros_can_be_overridden(clone, tmp_path, how):
    share = tmp_path / "share"
    for name in ("gazebo_msgs", "gazebo_ros"):
        make_package(share / name, name)
    script = "common_option --use-companions" if how == "option" else ""
    more = {"MY_SIMULATIONS_OVERRIDE_GAZEBO_ROS": "1"} if how == "variable" else {}
    found = linked(clone, tmp_path / "home", script, ROS_PACKAGE_PATH=str(share), **more)
    assert found == ["gazebo_ros", "my_simulations", "my_simulations_msgs", "xacro"]


def test_companion_goes_with_its_build_once_a_real_one_is_installed(clone, tmp_path):
    home = tmp_path / "home"
    linked(clone, home)
    built = home / "simulation_ws" / "devel" / "lib" / "python3" / "dist-packages" / "gazebo_msgs"
    built.mkdir(parents=True)
    make_package(tmp_path / "share" / "gazebo_msgs", "gazebo_msgs")
    found = linked(clone, home, ROS_PACKAGE_PATH=str(tmp_path / "share"))
    assert found == ["gazebo_ros", "my_simulations", "my_simulations_msgs", "xacro"]
    assert not built.exists()


def test_failed_part_of_a_step_says_which_why_and_what_to_do(clone, tmp_path):
    script = ("LOGS=$HOME/logs; STEPS=1; begin 'Fetching things'\n"
              "logged fetch 'Try it by daylight.' bash -c 'echo the disk is full; exit 7'")
    done = shell(clone, script, tmp_path / "home")
    assert done.returncode == 1
    assert "[1/1] Fetching things" in done.stdout
    for text in ("Fetching things", "'fetch' ended with status 7", "the disk is full",
                 "Try it by daylight.", "logs/fetch.log"):
        assert text in done.stderr
    assert "the disk is full" in (tmp_path / "home" / "logs" / "fetch.log").read_text()


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


PAGE = ("LOGS=$HOME/logs; STEPS=2; BUILD_WORKSPACE=$HOME/ws\nprepare_page\n")


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
