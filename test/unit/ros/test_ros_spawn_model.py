import argparse
import io
import sys

import pytest

from my_simulations.cli import gz_command, gz_queries, spawn_model
from my_simulations.ros.lifecycle.start_profile import StartProfile


def parsed(*words):
    return spawn_model.parser().parse_args(words)


@pytest.mark.parametrize("text, value", [("-1e-5", -1e-5), ("-2.", -2.0), ("-.5E1", -5.0),
                                         ("-0.25", -0.25), ("1e3", 1000.0)])
def test_every_spelling_of_a_number_is_accepted(text, value):
    assert parsed("-urdf", "-param", "p", "-model", "m", "-x", text).x == value


def test_unique_prefixes_are_accepted():
    assert parsed("-ur", "-para", "p", "-mod", "m").model == "m"


@pytest.mark.parametrize("words", [
    ["-param", "p", "-model", "m"],
    ["-urdf", "-sdf", "-param", "p", "-model", "m"],
    ["-urdf", "-model", "m"],
    ["-urdf", "-param", "p", "-file", "f", "-model", "m"],
    ["-urdf", "-param", "p"],
    ["-urdf", "-param", "p", "-model", "m", "-x", "north"],
    ["-urdf", "-param", "p", "-model", "m", "-timeout", "0"],
])
def test_a_wrong_command_line_is_status_2(words):
    with pytest.raises(SystemExit) as refused:
        parsed(*words)
    assert refused.value.code == 2


def test_joint_positions_in_every_spelling_and_the_last_of_a_joint():
    options = parsed("-urdf", "-param", "p", "-model", "m", "-J", "j", "-1e-2", "-J", "k", "2.",
                     "-J", "j", "-.5")
    assert spawn_model.joint_positions(options) == {"j": -0.5, "k": 2.0}


@pytest.mark.parametrize("position", ["high", "nan", "inf"])
def test_a_joint_position_that_is_no_number_is_status_2(position, capsys):
    with pytest.raises(SystemExit) as refused:
        spawn_model.main(["spawn_model", "-urdf", "-param", "p", "-model", "m", "-J", "j",
                          position])
    assert refused.value.code == 2
    assert "-J" in capsys.readouterr().err


def test_the_option_names_of_older_distributions_are_accepted():
    options = parsed("-gazebo", "-param", "p", "-model", "m", "-namespace", "robot")
    assert (options.sdf, options.urdf, options.robot_namespace) == (True, False, "robot")


def test_a_missing_file_is_status_1_before_ros_is_asked(tmp_path, capsys):
    missing = str(tmp_path / "none.urdf")
    assert spawn_model.main(["spawn_model", "-urdf", "-file", missing, "-model", "m"]) == 1
    assert missing in capsys.readouterr().err


def test_an_empty_file_is_status_1(tmp_path, capsys):
    empty = tmp_path / "empty.urdf"
    empty.write_text("\n")
    assert spawn_model.main(["spawn_model", "-urdf", "-file", str(empty), "-model", "m"]) == 1
    assert "is empty" in capsys.readouterr().err


@pytest.mark.parametrize("source", ["-file", "-param", "-database"])
def test_an_empty_name_of_a_description_is_status_2(source, capsys):
    with pytest.raises(SystemExit) as refused:
        spawn_model.main(["spawn_model", "-urdf", source, "", "-model", "m"])
    assert refused.value.code == 2
    assert f"argument {source}: is empty" in capsys.readouterr().err


LATIN = '<?xml version="1.0" encoding="ISO-8859-1"?><robot name="Gerät"/>'.encode("latin-1")


def test_a_file_or_standard_input_is_read_in_its_declared_encoding(tmp_path, monkeypatch):
    file = tmp_path / "latin.urdf"
    file.write_bytes(LATIN)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(LATIN), encoding="ascii"))
    for words in (["-file", str(file)], ["-stdin"]):
        text = spawn_model._document(parsed("-urdf", *words, "-model", "m"))
        assert text == '<?xml version="1.0"?><robot name="Gerät"/>'


def test_a_description_in_another_encoding_is_status_1(tmp_path, monkeypatch, capsys):
    raw = LATIN.replace(b' encoding="ISO-8859-1"', b"")
    file = tmp_path / "latin.urdf"
    file.write_bytes(raw)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(raw), encoding="ascii"))
    for words, where in ((["-file", str(file)], str(file)), (["-stdin"], "standard input")):
        assert spawn_model.main(["spawn_model", "-urdf", *words, "-model", "m"]) == 1
        assert f"spawn_model: {where}: error: this is not utf-8 text" in capsys.readouterr().err


def test_gz_reads_standard_input_and_files_in_their_declared_encoding(tmp_path, monkeypatch):
    file, given = tmp_path / "latin.urdf", []
    file.write_bytes(LATIN)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(LATIN), encoding="ascii"))
    simulator = argparse.Namespace(spawn=lambda name, text, *more: given.append(text))
    for words in (["-f", str(file)], ["-s"]):
        gz_queries._spawn(gz_command._model().parse_args(["-m", "m", *words]),
                          argparse.Namespace(simulator=simulator))
    assert given == ['<?xml version="1.0"?><robot name="Gerät"/>'] * 2


def test_package_meshes_become_model_meshes():
    found = spawn_model._package_to_model("<robot><mesh filename='package://a/b.dae'/></robot>")
    assert 'filename="model://a/b.dae"' in found


def test_a_start_profile_lists_its_phases_in_order(monkeypatch):
    monkeypatch.setenv("MY_SIMULATIONS_PROFILE", "1")
    profile = StartProfile()
    profile.mark("first")
    profile.mark("second")
    first, second = profile.lines()
    assert first.endswith("first") and second.endswith("second")


def test_without_the_variable_nothing_is_measured(monkeypatch):
    monkeypatch.delenv("MY_SIMULATIONS_PROFILE", raising=False)
    profile = StartProfile()
    profile.mark("first")
    assert profile.lines() == []
