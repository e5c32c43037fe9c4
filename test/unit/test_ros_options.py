import pytest

from my_simulations.ros.options import parse


def test_launch_file_arguments_are_understood():
    options = parse(["-u", "--verbose", "-e", "bullet", "worlds/room.world", "__name:=gazebo",
                     "__log:=/tmp/x.log"])
    assert (options.world, options.paused, options.verbose) == ("worlds/room.world", True, True)
    assert options.notices == []


def test_blanks_in_the_world_path_survive():
    assert parse(["/my worlds/a room.world"]).world == "/my worlds/a room.world"


def test_without_a_world_it_is_the_empty_one():
    assert parse([]).world == "worlds/empty.world"


def test_remappings_may_stand_anywhere():
    assert parse(["_spawn_robot:=true", "-u", "a:=b", "my.world"]).world == "my.world"


def test_unknown_options_are_refused_with_the_usage(capsys):
    with pytest.raises(SystemExit) as refused:
        parse(["--no-such-thing"])
    assert refused.value.code == 2
    assert "usage: gzserver" in capsys.readouterr().err


def test_other_engines_are_accepted_with_one_line():
    (notice,) = parse(["-e", "ode"]).notices
    assert "ode" in notice and "Bullet" in notice


def test_an_engine_nobody_knows_is_refused():
    with pytest.raises(SystemExit) as refused:
        parse(["-e", "havok"])
    assert refused.value.code == 2


def test_plugins_are_named_in_one_line():
    (notice,) = parse(["-s", "liba.so", "-s", "libb.so"]).notices
    assert "liba.so" in notice and "libb.so" in notice


def test_a_second_world_is_refused():
    with pytest.raises(SystemExit) as refused:
        parse(["a.world", "b.world"])
    assert refused.value.code == 2


@pytest.mark.parametrize("flag", ["--help", "--version"])
def test_help_and_version_end_well(flag):
    with pytest.raises(SystemExit) as ended:
        parse([flag])
    assert ended.value.code == 0
