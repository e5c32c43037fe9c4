"""Which world a name means, and which files ship."""
from __future__ import annotations

import os
import subprocess
import sys

import pytest

from my_simulations.errors import InputError
from my_simulations.resources.package_files import own_directory
from my_simulations.resources.resolver import Resolver, ResourceNotFoundError
from my_simulations.resources.world_lookup import (
    SHIPPED,
    advice_on,
    find_world,
    folder_of_users,
    is_shipped,
)
from my_simulations.simulator.world_loading import load_world

SHEETS_NAMES = ("test.world", "my_world.sdf")
"""What the lab sheet tells students to call their own worlds."""


@pytest.fixture
def places(tmp_path, monkeypatch):
    """A home, a folder where the command is typed, and a resource folder; one world in each."""
    folders = [tmp_path / "typed", tmp_path / "home/my_simulations/worlds", tmp_path / "resources"]
    for folder in folders:
        folder.mkdir(parents=True)
        (folder / "w.world").write_text("<sdf/>")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return folders


def test_the_folder_of_the_command_comes_first_then_the_users_worlds_then_resources(places):
    typed, own, resources = places
    resolver = Resolver(resource_paths=[str(resources)])
    for folder in places:
        assert find_world("w.world", resolver, str(typed)) == str(folder / "w.world")
        (folder / "w.world").unlink()
    with pytest.raises(ResourceNotFoundError) as missing:
        find_world("w.world", resolver, str(typed))
    assert missing.value.tried[:2] == [str(typed / "w.world"), str(own / "w.world")]


def test_absolute_names_and_the_home_folder_are_taken_as_they_are(places):
    typed, own, _ = places
    assert find_world(str(own / "w.world"), Resolver(), str(typed)) == str(own / "w.world")
    assert find_world("~/my_simulations/worlds/w.world", Resolver(), "/") == str(own / "w.world")


def test_a_world_that_is_not_found_is_told_with_the_one_it_may_have_meant(places):
    typed, own, _ = places
    (typed / "w.world").unlink()
    assert str(own / "w.world") in advice_on("/elsewhere/w.world", str(typed))
    assert "did you mean lab_course.world?" in advice_on("lab_cuorse.world", str(typed))
    assert "did you mean lab_course.world?" in advice_on("lab_course", str(typed))
    assert "did you mean" not in advice_on("zzz.world", str(typed))
    with pytest.raises(InputError) as refused:
        load_world("lab_cuorse.world", Resolver(), lambda issue: None, caller=str(typed))
    assert "lab_course.world" in refused.value.issues[0].hint
    assert refused.value.issues[0].message == "world file 'lab_cuorse.world' was not found"


def test_an_absolute_name_is_searched_nowhere_else(places):
    typed, _, _ = places
    (typed / "maze.world").write_text("<sdf/>")
    wrong = str(typed / "mase.world")
    os.makedirs(f"{typed}/models{typed}")
    (typed / "models" / wrong.lstrip("/")).write_text("<sdf/>")
    with pytest.raises(ResourceNotFoundError) as missing:
        find_world(wrong, Resolver([str(typed / "models")]), str(typed))
    assert missing.value.tried == [wrong]
    assert str(missing.value) == f"{wrong!r} was not found"
    assert advice_on(wrong, "/") == f"did you mean {typed / 'maze.world'}?"


def test_folders_and_pipes_are_named_and_never_suggested(places):
    typed, _, _ = places
    folder, pipe = typed / "rooms.world", typed / "pipe.world"
    folder.mkdir()
    os.mkfifo(pipe)
    for path, reason in ((folder, "this is a folder"), (pipe, "this is a device or a pipe")):
        with pytest.raises(InputError) as refused:
            load_world(str(path), Resolver(), lambda issue: None, caller=str(typed))
        assert reason in refused.value.issues[0].message
        assert str(path) not in refused.value.issues[0].hint


@pytest.mark.parametrize(("name", "text", "parts"), [
    ("arm.urdf", "<robot name='arm'/>", ("spawn_model -urdf -file ", "-model arm")),
    ("box.sdf", "<sdf version='1.6'><model name='box'/></sdf>",
     ("spawn_model -sdf -file ", "-model box")),
    ("lab.launch", "<launch/>", ("run roslaunch ",)),
])
def test_another_kind_of_file_is_answered_with_its_command(tmp_path, name, text, parts):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError) as refused:
        load_world(str(tmp_path / name), Resolver(), lambda issue: None)
    for part in (*parts, str(tmp_path / name)):
        assert part in refused.value.issues[0].hint


def test_the_worlds_that_ship_are_listed_and_none_has_a_name_of_the_lab_sheet():
    world = os.path.join(own_directory(), "world")
    tracked = subprocess.run(["git", "ls-files", "."], cwd=world, capture_output=True, text=True,
                             check=False)
    if tracked.returncode == 0:  # else the package was installed without its history
        assert sorted(tracked.stdout.split()) == sorted(SHIPPED)
    for name in SHIPPED:
        assert os.path.isfile(os.path.join(world, name)), name
        assert os.path.basename(name) not in SHEETS_NAMES


def test_all_worlds_and_models_of_the_package_are_shipped():
    tracked = subprocess.run(["git", "ls-files", "*.world", "*.sdf"], cwd=own_directory(),
                             capture_output=True, text=True, check=False)
    if tracked.returncode == 0:  # else the package was installed without its history
        files = [os.path.join(own_directory(), name) for name in tracked.stdout.split()]
        assert len(files) > len(SHIPPED)
        assert [file for file in files if os.path.exists(file) and not is_shipped(file)] == []


def test_a_students_file_in_the_packages_folder_is_the_students(tmp_path, monkeypatch):
    package = tmp_path / "package"
    (package / "world").mkdir(parents=True)
    monkeypatch.setattr("my_simulations.resources.world_lookup.own_directory", lambda: str(package))
    for name in ("lab_room.world", "test.world"):
        (package / "world" / name).write_text("<sdf/>")
    (tmp_path / "theirs.world").write_text("<sdf/>")
    os.symlink(tmp_path / "theirs.world", package / "world" / "empty_world.world")
    for name in ("models/table/model.sdf", "worlds/test.world", "my_world.sdf"):
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text("<sdf/>")
    assert is_shipped(str(package / "world/lab_room.world"))
    assert is_shipped(str(package / "models/table/model.sdf"))
    assert not is_shipped(str(package / "world/test.world"))
    assert not is_shipped(str(package / "world/empty_world.world"))
    assert not is_shipped(str(package / "world/lab_course.world"))
    assert not is_shipped(str(package / "worlds/test.world"))   # `users_folder` of some clones
    assert not is_shipped(str(package / "my_world.sdf"))        # where `tools/run` was typed
    assert folder_of_users(str(package / "my_world.sdf")) == str(package)
    assert folder_of_users(str(package / "world/test.world")) == str(package / "world")
    assert folder_of_users(str(package / "world/empty_world.world")) == str(tmp_path)
    assert folder_of_users(str(package / "world/lab_room.world")) == ""


PROBE = ("import sys; from my_simulations.ros.lifecycle.launch_info import Launch; "
         "one = Launch.of(sys.argv); print(one.pid, one.folder, one.is_alive)")


def started_by(name, tmp_path, *words):
    """What a process knows that a program called `name`, in `typed`, starts in another folder."""
    typed, home = tmp_path / "typed", tmp_path / "ros_home"
    for folder in (typed, home):
        folder.mkdir(exist_ok=True)
    program = tmp_path / name
    program.write_text("import subprocess, sys\nsubprocess.run([sys.executable, '-c', "
                       f"{PROBE!r}, *sys.argv[1:]], cwd={str(home)!r})\n")
    return subprocess.run([sys.executable, str(program), *words], cwd=typed, check=True,
                          capture_output=True, text=True).stdout.split()


def test_a_node_of_a_launch_knows_the_folder_in_which_roslaunch_was_typed(tmp_path):
    for name in ("roslaunch", "rostest"):
        pid, folder, alive = started_by(name, tmp_path, "__log:=/tmp/x.log")
        assert (int(pid) > 0, folder, alive) == (True, str(tmp_path / "typed"), "True")


def test_what_is_started_by_hand_has_its_own_folder(tmp_path):
    assert started_by("bash", tmp_path) == ["0", str(tmp_path / "ros_home"), "True"]
