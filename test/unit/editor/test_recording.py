"""State logs from the start of a world, without browsers."""
from __future__ import annotations

import json
import os
import re
import resource
import subprocess
import sys

import numpy as np
import pytest
from editor_case import Case, box
from running_simulator import started
from waiting import until

from my_simulations.cli.front_ends import FrontEnds
from my_simulations.description.world import World
from my_simulations.editor.logs.recorder import Recorder, path_of
from my_simulations.editor.logs.state_log import LogReader, LogWriter
from my_simulations.editor.transport.pose_messages import Poses
from my_simulations.errors import CommandError, Severity
from my_simulations.geometry import Pose, Twist
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.lifecycle.server_options import parse

DEADLINE = 60.0


def document(log, number):
    return json.loads(log.text(number))


class Running:
    """A paused world with a box that flies along x at 2 m/s, and what was told of its log."""

    def __init__(self, folder, period=-1.0, steps=None):
        self.issues = []
        self.path = str(folder / "log" / "state.log")
        options = {} if steps is None else {"steps": steps}
        self.sim = started(World(models=[box("a")]), log=self.issues.append, **options)
        self.sim.states.set_model_state("a", Pose((0, 0, 9)), Twist((2.0, 0.0, 0.0)))
        self.recorder = Recorder(self.sim, Resolver.from_environment(), self.path, period,
                                 self.issues.append)

    def run_until(self, seconds):
        self.sim.clock.unpause()
        until(lambda: self.sim.clock.sim_ns >= seconds * 1e9)


@pytest.fixture
def running(tmp_path):
    made = []

    def make(*arguments, **options):
        made.append(Running(tmp_path, *arguments, **options))
        return made[-1]

    yield make
    for one in made:
        one.recorder.stop()
        one.sim.close()


def x_at(log, seconds):
    _, poses = log.seek(seconds)
    return float(poses.values[0][0])


def test_a_log_begins_before_the_first_step_and_ends_with_the_last(running):
    world = running()
    world.run_until(0.5)
    world.sim.clock.pause()
    world.recorder.stop()
    log = LogReader(world.path)
    assert log.begin == 0.0 and x_at(log, 0.0) == 0.0
    assert log.end == pytest.approx(world.sim.clock.sim_ns * 1e-9)
    assert x_at(log, log.end) == pytest.approx(2.0 * log.end, abs=1e-3)
    assert document(log, log.seek(0.0)[0])["models"][0]["name"] == "a"
    log.close()


def test_a_log_that_ends_amid_the_run_shows_what_was_at_its_end(running, monkeypatch):
    world = running()
    world.run_until(0.2)
    old = world.sim.feed.poses()
    monkeypatch.setattr(world.sim.feed, "poses", lambda: old)  # the engine is behind with them
    world.run_until(0.4)
    world.recorder.stop()
    log = LogReader(world.path)
    assert x_at(log, log.end) == pytest.approx(2.0 * log.end, abs=1e-3)
    log.close()


def test_the_period_is_sim_time_between_states(running):
    world = running(0.25)
    world.run_until(1.1)
    world.sim.clock.pause()
    world.recorder.stop()
    log = LogReader(world.path)
    # 0, 0.25, 0.5, 0.75 and 1 s, the end, and until when nothing has moved since.
    assert 5 <= len(log._states) <= 7
    log.close()


def test_models_that_come_and_go_are_in_the_log(running):
    world = running()
    world.run_until(0.2)
    world.sim.models.spawn(box("b"))
    came = world.sim.clock.sim_ns * 1e-9
    world.run_until(came + 0.5)
    world.sim.models.delete("b")
    world.run_until(came + 1.0)
    world.recorder.stop()
    log = LogReader(world.path)
    names = [[model["name"] for model in document(log, log.seek(when)[0])["models"]]
             for when in (came - 0.1, came + 0.4, log.end)]
    assert names == [["a"], ["a", "b"], ["a"]]
    log.close()


def test_what_follows_a_reset_of_time_comes_after_what_was_before(tmp_path):
    writer = LogWriter(str(tmp_path / "log" / "state.log"))
    writer.document(0.0, {})
    states = [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (0.0, 10.0), (0.4, 11.0), (0.0, 20.0),
              (0.3, 21.0)]
    for number, (seconds, x) in enumerate(states):
        writer.poses(Poses(np.array([0]), np.array([[x, 0, 0, 0, 0, 0, 1]], np.float32), number,
                           seconds, seconds))
    writer.close()
    log = LogReader(writer.path)
    assert (log.begin, log.end) == (0.0, pytest.approx(1.7))
    assert [x_at(log, seconds) for seconds in (0.5, 0.99, 1.0, 1.4 - 1e-6, 1.4, 1.7)] == [
        1.0, 1.0, 10.0, 10.0, 20.0, 21.0]
    log.close()


def test_a_log_can_be_read_while_it_grows_and_after_a_kill(running):
    world = running()
    world.run_until(0.1)

    def grown():
        log = LogReader(world.path)
        log.close()
        return log.end > 0.5

    until(grown)


def test_a_world_that_stands_still_after_its_steps_is_recorded_to_the_last(running):
    world = running(steps=5)
    world.run_until(0.005)
    world.recorder.stop()
    log = LogReader(world.path)
    assert log.end == pytest.approx(0.005)
    assert x_at(log, log.end) == pytest.approx(0.01, abs=1e-4)
    log.close()


def test_an_empty_world_has_a_log_with_times(running):
    world = running()
    world.sim.models.delete("a")
    world.run_until(0.2)
    world.sim.clock.pause()
    world.recorder.stop()
    log = LogReader(world.path)
    assert log.end == pytest.approx(world.sim.clock.sim_ns * 1e-9)
    assert document(log, log.seek(log.end)[0])["models"] == []
    log.close()


def test_a_full_disk_is_one_error_and_the_world_goes_on(running):
    world = running()
    world.recorder._writer._file.close()
    world.recorder._writer._file = open("/dev/full", "wb", buffering=0)
    world.run_until(0.3)
    until(lambda: world.issues)
    (issue,) = world.issues
    assert issue.severity is Severity.ERROR and "No space left" in issue.message
    now = world.sim.clock.sim_ns
    until(lambda: world.sim.clock.sim_ns > now)
    world.recorder.stop()
    assert world.issues == [issue]
    log = LogReader(world.path)  # the records before the fault are valid
    assert log.begin == 0.0
    log.close()


def test_a_disk_that_is_full_at_the_start_refuses_the_log(tmp_path):
    # A process of its own: the limit holds for all its files.
    program = ("import sys; sys.path[:0] = sys.argv[2:]\n"
               "import pathlib, test_recording as t\n"
               "try: t.Running(pathlib.Path(sys.argv[1]))\n"
               "except t.CommandError as fault: print(fault)\n")
    ended = subprocess.run(
        [sys.executable, "-B", "-c", program, str(tmp_path), os.path.dirname(__file__), *sys.path],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64)),
        stdout=subprocess.PIPE, timeout=60, text=True, check=True)
    assert "state.log cannot be written: File too large" in ended.stdout


def test_no_log_is_overwritten(running):
    world = running()
    with pytest.raises(CommandError, match=r"state\.log cannot be written"):
        Recorder(world.sim, Resolver.from_environment(), world.path, -1.0, print)


def test_a_log_lies_where_gazebo_puts_it(tmp_path):
    logs = tmp_path / "logs"
    usual = path_of("", str(logs))
    assert re.fullmatch(re.escape(str(logs)) + r"/\d{4}-\d\d-\d\dT\d\d\.\d\d\.\d\d/state\.log",
                        usual)
    assert path_of(str(tmp_path / "mine"), str(logs)) == str(tmp_path / "mine" / "state.log")


def test_a_second_log_of_one_place_gets_a_folder_of_its_own(tmp_path):
    mine, logs = tmp_path / "mine", tmp_path / "logs"
    mine.mkdir()
    (mine / "state.log").write_text("the first")
    path = path_of(str(mine), str(logs))
    assert os.path.dirname(os.path.dirname(path)) == str(mine)
    os.makedirs(os.path.dirname(path))
    assert path_of(str(mine), str(logs)) != path


def test_the_editor_lists_and_plays_the_log_that_is_being_recorded(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    made = Case(tmp_path, [box("a")])
    faces = FrontEnds()
    wanted = parse(["-r", "--record_path", str(tmp_path / "else where")]).recording
    recorder = faces.record(made.sim, made.resolver, wanted, made.issues.append)
    usual = faces.record(made.sim, made.resolver, parse(["-r"]).recording, made.issues.append)
    settings = {"port": 0, "config_dir": str(tmp_path / "config"),
                "cache_dir": str(tmp_path / "cache"), "check_outgoing": True}
    made.server.stop()
    made.server = faces.edit(made.sim, made.resolver, settings)
    made.url = made.server.url

    async def play(browser):
        names = {log["name"] for log in (await browser.ask("log_list"))["logs"]}
        assert names == {"else where", os.path.basename(os.path.dirname(usual.path))}
        for name in names:
            assert (await browser.ask("log_open", name=name))["begin"] == 0.0
            await browser.until(lambda: browser.frames[-1][0] == 2 and browser.model("a"))
            await browser.ask("log_close")

    try:
        made.browse(play)
    finally:
        recorder.stop()
        usual.stop()
        made.close()


def test_recording_imports_nothing_that_serves_pages(tmp_path):
    program = ("import sys; sys.path[:0] = sys.argv[1:]\n"
               "from my_simulations.editor.logs.recorder import Recorder, path_of\n"
               "from my_simulations.cli.front_ends import FrontEnds\n"
               "assert not {'aiohttp', 'asyncio', 'numpy', 'trimesh', 'lxml'} & set(sys.modules), "
               "sorted(sys.modules)")
    subprocess.run([sys.executable, "-B", "-c", program, *sys.path], timeout=60, check=True)


def test_a_variable_makes_each_server_record(monkeypatch):
    monkeypatch.setenv("MY_SIMULATIONS_RECORD", "/somewhere")
    found = parse([]).recording
    assert (found.on, found.path) == (True, "/somewhere")
    assert parse(["--record_path", "/elsewhere"]).recording.path == "/elsewhere"
    monkeypatch.setenv("MY_SIMULATIONS_RECORD", "")
    assert not parse([]).recording.on
