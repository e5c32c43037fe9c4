"""Files of the package my_simulations where the workspace has a package of that name of its own."""
from __future__ import annotations

from pathlib import Path

import pytest

from my_simulations.cli.roslaunch_underlay import separate_first_path, with_own_files
from my_simulations.resources import package_files
from my_simulations.resources.resolver import Resolver, ResourceNotFoundError

REPOSITORY = Path(__file__).resolve().parents[3]


@pytest.fixture
def users(tmp_path, monkeypatch):
    """A user's package my_simulations that ROS finds, as after tools/run --overlay."""
    package = tmp_path / "src" / "my_simulations"
    (package / "world").mkdir(parents=True)
    (package / "package.xml").write_text(
        "<package><name>my_simulations</name><version>0.0.0</version>"
        "<description/><maintainer email='a@b'>a</maintainer><license>a</license></package>")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    monkeypatch.setenv(package_files.UNDERLAY, str(tmp_path / "underlay"))
    return package


def test_users_package_comes_first_and_ours_behind_it(users):
    assert package_files.package_directories() == [str(users), str(REPOSITORY)]


def test_ours_is_alone_without_an_underlay(users, monkeypatch):
    monkeypatch.delenv(package_files.UNDERLAY)
    assert package_files.package_directories() == [str(REPOSITORY)]


def test_world_that_the_user_makes_counts_at_once(users):
    resolver = Resolver.from_environment()
    assert resolver.resolve("empty_world.world") == \
        str(REPOSITORY / "world" / "empty_world.world")
    mine = users / "world" / "empty_world.world"
    mine.write_text("<sdf/>")
    assert resolver.resolve("empty_world.world") == str(mine)
    mine.unlink()
    assert resolver.resolve("empty_world.world") == \
        str(REPOSITORY / "world" / "empty_world.world")


def test_package_uri_is_looked_for_in_the_users_package_and_then_in_ours(users):
    resolver = Resolver.from_environment()
    uri = "package://my_simulations/urdf/robo.urdf"
    assert resolver.resolve(uri) == str(REPOSITORY / "urdf" / "robo.urdf")
    mine = users / "urdf" / "robo.urdf"
    mine.parent.mkdir()
    mine.write_text("<robot name='mine'/>")
    assert resolver.resolve(uri) == str(mine)
    with pytest.raises(ResourceNotFoundError) as fault:
        resolver.resolve("package://my_simulations/urdf/none.urdf")
    assert fault.value.tried[:2] == [str(users / "urdf" / "none.urdf"),
                                     str(REPOSITORY / "urdf" / "none.urdf")]


def test_file_of_a_package_falls_back_to_ours_for_our_name_alone(users):
    inside = "objects/ball.urdf"
    assert package_files.file_in_package(str(users), "my_simulations", inside) == str(
        REPOSITORY / inside
    )
    assert package_files.file_in_package(str(users), "my_lab", inside) == str(users / inside)
    (users / "objects").mkdir()
    (users / "objects" / "ball.urdf").touch()
    assert package_files.file_in_package(str(users), "my_simulations", inside) == str(
        users / inside
    )


@pytest.mark.parametrize(("text", "path"), [
    ("/urdf/robo.urdf'", "/urdf/robo.urdf"), ('/urdf/robo.urdf" -x', "/urdf/robo.urdf"),
    ("/a.urdf b", "/a.urdf"), ("/a.urdf", "/a.urdf"), ("", "")])
def test_path_behind_find_ends_at_a_blank_or_a_quote(text, path):
    assert separate_first_path(text) == (path, text[len(path):])


def test_launch_file_that_the_user_lacks_is_ours(capsys):
    find = with_own_files(lambda package, name, rospack=None: [])
    assert find("my_simulations", "upload_param.launch") == [
        str(REPOSITORY / "launch" / "upload_param.launch")]
    assert "has no upload_param.launch" in capsys.readouterr().err
    assert find("my_lab", "upload_param.launch") == []
    assert find("my_simulations", "none.launch") == []


def test_launch_file_of_the_user_is_taken_without_a_word(capsys):
    find = with_own_files(lambda package, name, rospack=None: ["/mine"])
    assert find("my_simulations", "upload_param.launch", rospack=None) == ["/mine"]
    assert capsys.readouterr().err == ""
