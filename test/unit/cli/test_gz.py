"""The command gz, as far as it needs no node."""
from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, List, Tuple

import numpy as np
import pytest

from my_simulations.cli import gz_command, gz_queries
from my_simulations.cli.object_client import ToolError
from my_simulations.editor.logs.state_log import LogWriter
from my_simulations.editor.transport.pose_messages import Poses

REPOSITORY = Path(__file__).resolve().parents[3]


def test_no_command_lists_them_all(capsys):
    assert gz_command.main(["gz"]) == gz_command.USAGE
    text = capsys.readouterr().out
    for name in ("log", "model", "physics", "sdf", "stats", "topic", "world"):
        assert f"\n  {name} " in text


def test_unknown_command_is_wrong_usage(capsys):
    assert gz_command.main(["gz", "wrold"]) == gz_command.USAGE
    assert "unknown command 'wrold'" in capsys.readouterr().err


@pytest.mark.parametrize("name", sorted(gz_command.INSTEAD))
def test_command_that_is_not_offered_names_the_substitute(name, capsys):
    assert gz_command.main(["gz", name]) == gz_command.USAGE
    assert gz_command.INSTEAD[name] in capsys.readouterr().err


@pytest.mark.parametrize("option, file, text", [
    ("-k", "world/empty_world.world", "Check complete"),
    ("-p", "objects/ball.urdf", '<model name="ball">'),
    ("-p", "world/empty_world.world", '<model name="ground_plane">')])     # of an include
def test_sdf_checks_and_converts_files(option, file, text, capsys):
    assert gz_command.main(["gz", "sdf", option, str(REPOSITORY / file)]) == gz_command.OK
    out = capsys.readouterr().out
    assert text in out and "<include>" not in out
    assert ("<sdf version=" in out) == (option == "-p")


@pytest.mark.parametrize("words, content, fault", [
    (("sdf", "-k"), "<sdf version='1.6'><model name='m'><link/></model></sdf>", "name"),
    (("log", "-i", "-f"), "no log", "is not a state log")])
def test_a_faulty_file_is_a_failure(words, content, fault, tmp_path, capsys):
    file = tmp_path / "file"
    file.write_text(content)
    assert gz_command.main(["gz", *words, str(file)]) == gz_command.FAILED
    out, err = capsys.readouterr()
    assert "Check complete" not in out and fault in out + err


def test_log_info_tells_the_times(tmp_path, capsys):
    path = tmp_path / "state.log"
    log = LogWriter(str(path))
    log.document(1.0, {})
    for seconds in (1.0, 3.5):
        log.poses(Poses(np.empty(0, np.int64), np.empty((0, 7), np.float32), 0, seconds, 0.0))
    log.close()
    assert gz_command.main(["gz", "log", "-i", "-f", str(path)]) == gz_command.OK
    assert "End: 3.500 s" in capsys.readouterr().out


def test_world_needs_a_master(capsys, monkeypatch):
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:1")
    assert gz_command.main(["gz", "world", "-p", "1"]) == gz_command.FAILED
    assert "no ROS master" in capsys.readouterr().err


class OfferedServices:
    """A running simulator that offers some services; records calls."""

    node = "/gazebo"

    def __init__(self, *names: str) -> None:
        self.names, self.parameters = names, self
        self.calls: List[Tuple[Any, ...]] = []

    def has_service(self, name: str) -> bool:
        return name in self.names

    def call_service(self, service: str, kind: str, timeout: float, **fields: Any) -> None:
        self.calls.append((service, timeout, fields))


def step(running: OfferedServices, steps: int) -> int:
    options = argparse.Namespace(pause=None, reset_all=False, reset_time=False, reset_models=False,
                                 step=False, multi_step=steps)
    return gz_queries.world(options, running)


def test_deadline_of_steps_grows_with_their_number():
    running = OfferedServices("/gazebo/step_world")
    assert step(running, 1) == step(running, 40000) == gz_command.OK
    (_, one, _), (service, many, fields) = running.calls
    assert (service, fields) == ("step_world", {"steps": 40000})
    assert many > 100.0 * one


def test_steps_without_extensions_name_the_launch_argument():
    running = OfferedServices()
    with pytest.raises(ToolError, match="extensions:=true"):
        step(running, 1)
    assert not running.calls
