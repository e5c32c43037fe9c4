"""Negative numbers on the command lines of all programs."""
from __future__ import annotations

import pytest

from my_simulations.cli import gz_command, move_object, spawn_model
from my_simulations.ros.arguments import Parser
from my_simulations.ros.lifecycle import server_options

NEGATIVE = [("-1e-3", -1e-3), ("-1E+2", -100.0), ("-2.", -2.0), ("-.5e1", -5.0), ("-0.25", -0.25),
            ("-3", -3.0), ("-1e-999999999", 0.0)]


@pytest.mark.parametrize(("text", "value"), NEGATIVE)
def test_options_take_negative_numbers_in_every_spelling(text, value):
    circle = ["-m", "circle", "-n", "b", "-c", "[0,0]", "-r", "2"]
    assert move_object.parser().parse_args([*circle, "-z", text]).height == value
    spawned = ["-urdf", "-param", "p", "-model", "m", "-x", text]
    assert spawn_model.parser().parse_args(spawned).x == value
    assert gz_command._model().parse_args(["-m", "cyl", "-x", text]).x == value
    assert server_options.parser().parse_args(["--record_period", text]).record_period == value


def test_a_list_that_begins_with_a_negative_number_is_a_value():
    assert gz_command._physics().parse_args(["-g", "-1,0,-9.8"]).gravity == "-1,0,-9.8"


@pytest.mark.parametrize("word", ["-1x", "-e3", "-1e", "--1", "-"])
def test_what_is_no_negative_number_is_none(word, capsys):
    made = Parser()
    made.add_argument("-x", type=float)
    with pytest.raises(SystemExit):
        made.parse_args(["-x", word])
    assert "-x" in capsys.readouterr().err
