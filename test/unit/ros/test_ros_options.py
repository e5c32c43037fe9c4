import pytest

from my_simulations.ros.lifecycle.server_options import Recording, parse


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


@pytest.mark.parametrize("engine", ["ode", "havok"])
def test_other_engines_are_accepted_with_one_line(engine):
    (notice,) = parse(["-e", engine]).notices
    assert engine in notice and "Bullet" in notice


def test_plugins_are_named_in_one_line():
    (notice,) = parse(["-s", "liba.so", "-s", "libb.so"]).notices
    assert "liba.so" in notice and "libb.so" in notice


def test_words_after_the_world_are_for_plugins_and_named_in_one_line():
    options = parse(["a.world", "--seed", "3", "b", "c"])
    (notice,) = options.notices
    assert (options.world, options.seed) == ("a.world", 3)
    assert "b c" in notice


def test_every_option_of_a_state_log_is_understood():
    recording = parse(["-r", "--record_path", "/tmp/logs", "--record_period", "0.5",
                       "--record_encoding", "txt", "--record_filter", "box*",
                       "--record_resources"]).recording
    assert recording == Recording(True, "txt", "/tmp/logs", 0.5, "box*", True)
    assert not parse(["--record_path", "/tmp/logs"]).recording.on


def test_a_state_log_alone_needs_no_word():
    assert parse(["-r", "--record_path", "/tmp/logs", "--record_period", "0.5"]).notices == []


def test_what_changes_nothing_in_a_state_log_is_said_in_one_line():
    (notice,) = parse(["-r", "--record_encoding", "bz2", "--record_filter", "box*",
                       "--record_resources"]).notices
    assert notice == ("ignoring options: --record_encoding, --record_filter, --record_resources")


def test_words_on_a_state_log_that_nobody_asked_for_are_said_in_one_line():
    (notice,) = parse(["--record_path", "/tmp/logs", "--record_period", "0"]).notices
    assert notice == "ignoring options, which need --record: --record_path, --record_period"


def test_steps_seed_and_physics_preset_are_numbers_and_a_name():
    options = parse(["--iters", "500", "--seed", "7.0", "-o", "fast"])
    assert (options.iterations, options.seed, options.profile) == (500, 7, "fast")


@pytest.mark.parametrize("words", [
    ["--iters", "0"], ["--iters", "-1"], ["--iters", "many"], ["--seed", "0.5"], ["--seed", "x"],
    ["--record_encoding", "rar"], ["--record_period", "often"], ["--record_period", "nan"],
    ["-p", "old.log"], ["-e"]])
def test_bad_values_are_refused_with_the_usage(words, capsys):
    with pytest.raises(SystemExit) as refused:
        parse(words)
    assert refused.value.code == 2
    said = capsys.readouterr().err
    assert "usage: gzserver" in said and words[0] in said


@pytest.mark.parametrize("words", [["--lockstep"], ["--minimal_comms"], ["-g", "x.so"],
                                   ["--gui-client-plugin", "x.so"]])
def test_what_changes_nothing_here_is_accepted(words):
    assert parse(words).world == "worlds/empty.world"


@pytest.mark.parametrize("flag", ["--help", "--version"])
def test_help_and_version_end_well(flag):
    with pytest.raises(SystemExit) as ended:
        parse([flag])
    assert ended.value.code == 0
