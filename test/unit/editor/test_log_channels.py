"""What state logs hold besides states, and what of it comes into a replay."""
from __future__ import annotations

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from editor_case import box
from running_simulator import started
from test_replay_page import content, modules  # noqa: F401

import my_simulations
from my_simulations.description.world import World
from my_simulations.editor.logs.log_channels import ContactChannel, TopicChannel
from my_simulations.editor.logs.recorder import Recorder
from my_simulations.editor.logs.replay_page import write_replay
from my_simulations.editor.logs.state_log import CONTACTS, MESSAGE, TOPICS, LogReader, LogWriter
from my_simulations.editor.topics.topic_frame import decode_frame, encode_frame
from my_simulations.editor.transport.pose_messages import Poses
from my_simulations.errors import CommandError, EngineLostError
from my_simulations.geometry import IDENTITY
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.lifecycle.server_options import parse


class Source:
    """Topics of a graph without ROS."""

    def __init__(self, *names):
        self.names, self.calls, self.closed = list(names), {}, []

    def topics(self):
        return [SimpleNamespace(name=name, kind="sensor_msgs/Range", publishers=1, subscribers=0,
                                model="robo", driven=False, link="base", pose=IDENTITY)
                for name in self.names]

    def receive(self, name, kind, call):
        self.calls[name] = call
        return SimpleNamespace(received_bytes=0, close=lambda: self.closed.append(name))


def range_message(distance):
    stamp = SimpleNamespace(to_nsec=lambda: 10 ** 9)
    return SimpleNamespace(range=distance, min_range=0.0, max_range=9.0, field_of_view=0.1,
                           header=SimpleNamespace(frame_id="sonar", stamp=stamp))


@pytest.fixture
def writer(tmp_path):
    return LogWriter(str(tmp_path / "run" / "state.log"))


def state(writer, time):
    pose = np.array([[time, 0, 0, 0, 0, 0, 1]], dtype=np.float32)
    writer.poses(Poses(np.array([1]), pose, 0, time, time))


def finished(writer):
    writer.close()
    return LogReader(writer.path)


def ranges(notes):
    return [decode_frame(data)[0]["view"]["range"] for kind, data in notes if kind == MESSAGE]


def contact(position, force=2.0):
    return SimpleNamespace(position=position, normal=(0.0, 0.0, 1.0), depth=1e-5, force=force)


def test_contacts_are_written_when_they_change(writer):
    found = [("a::link", "b::link", contact((1.0, 2.0, 3.0)))]
    calls = []
    world = SimpleNamespace(states=SimpleNamespace(contacts=lambda: calls.append(1) or found))
    notes = ContactChannel(world)
    for step in range(101):
        if step == 50:
            found.clear()
        state(writer, step / 100.0)
        notes.write(writer, step / 100.0)
    assert len(calls) == 26   # 100 Hz, at least 1/30 s apart
    log = finished(writer)
    times = [(upto, json.loads(data)) for upto in range(101)
             for kind, data in log.records(upto - 1, upto) if kind == CONTACTS]
    assert times[0] == (0, [{"a": "a::link", "b": "b::link", "position": [1.0, 2.0, 3.0],
                             "normal": [0.0, 0.0, 1.0], "depth": 0.0, "force": 2.0}])
    assert [(50 <= upto <= 54, rows) for upto, rows in times[1:]] == [(True, [])]
    assert len(log.times(0.0)) == 101


def test_an_engine_that_starts_again_has_no_contacts(writer):
    def lost():
        raise EngineLostError("lost")

    state(writer, 0.0)
    ContactChannel(SimpleNamespace(states=SimpleNamespace(contacts=lost))).write(writer, 0.0)
    assert list(finished(writer).records(-1, 0)) == []


def test_messages_of_a_topic_are_written_as_pages_show_them(writer):
    source = Source("/sonar", "/other")
    notes = TopicChannel(source, ["/sonar"], lambda: 0.0)
    for step in range(11):
        state(writer, step / 100.0)
        if step:   # the first look subscribes
            source.calls["/sonar"](range_message(float(step) / 2.0))
        notes.write(writer, step / 100.0)
    notes.close()
    assert source.closed == ["/sonar"]
    log = finished(writer)
    found = list(log.records(-1, 10))
    assert ranges(found) == [0.5, 4.0]   # at most 15 a second
    (listed,) = [json.loads(data) for kind, data in found if kind == TOPICS and data != b"[]"]
    assert (listed[0]["name"], listed[0]["model"]) == ("/sonar", "robo")
    head = decode_frame(next(data for kind, data in found if kind == MESSAGE))[0]
    assert (head["topic"], head["frame"], head["stamp"]) == ("/sonar", "sonar", 1.0)


def test_messages_keep_their_time_while_nothing_moves(writer):
    source = Source("/sonar")
    notes = TopicChannel(source, ["/sonar"], lambda: 0.0)
    writer.document(0.0, {"name": "w", "models": []})
    pose = np.array([[0, 0, 0, 0, 0, 0, 1]], dtype=np.float32)
    for step in range(4):
        time = 0.2 * step
        writer.poses(Poses(np.array([1]), pose, 0, time, time))
        if step:
            source.calls["/sonar"](range_message(float(step)))
        notes.write(writer, time)
    log = finished(writer)
    assert log.times(0.0) == pytest.approx([0.0, 0.2, 0.4, 0.6])
    assert [ranges(log.records(at - 1, at)) for at in range(4)] == [[], [1.0], [2.0], [3.0]]


def test_messages_beyond_a_size_are_left_out(writer):
    source = Source("/sonar")
    notes = TopicChannel(source, ["/sonar"], lambda: 0.0, most_bytes=400)
    for step in range(10):
        state(writer, step)
        if step:
            source.calls["/sonar"](range_message(float(step)))
        notes.write(writer, step)
    assert ranges(finished(writer).records(-1, 9)) == [1.0, 2.0]


def test_a_recorder_subscribes_to_the_topics_of_its_options(tmp_path):
    source, issues = Source("/sonar"), []
    sim = started(World(models=[box("a")]), log=issues.append)
    recorder = Recorder(sim, Resolver([]), str(tmp_path / "state.log"), 0.001, issues.append,
                        source, ("/sonar",))
    source.calls["/sonar"](range_message(3.0))
    recorder.stop()
    sim.close()
    assert (issues, source.closed) == ([], ["/sonar"])
    assert ranges(LogReader(recorder.path).records(-1, 99)) == [3.0]


def test_topics_are_named_by_option_or_variable(monkeypatch):
    assert parse(["-r", "--record_topics", "scan,/odom"]).recording.topics == ("/scan", "/odom")
    monkeypatch.setenv("MY_SIMULATIONS_RECORD_TOPICS", "/scan /odom")
    assert parse(["-r"]).recording.topics == ("/scan", "/odom")
    assert parse([]).recording.topics == ("/scan", "/odom")


def test_a_replay_has_the_end_of_a_log_with_its_notes(modules, tmp_path, writer):
    writer.document(0.0, {"name": "w", "file": "", "models": []})
    scan = {"type": "scan", "count": 2}
    for step in range(101):
        time = step / 100.0
        state(writer, time)
        writer.add_record(CONTACTS, time, json.dumps([step]).encode())
        payload = np.array([1.0 / 3.0, math.nan], dtype="<f4").tobytes()
        writer.add_record(MESSAGE, time, encode_frame({"topic": "/scan", "frame": "", "stamp": time,
                                             "view": scan}, payload))
    writer.close()
    assert my_simulations.replay(str(tmp_path / "run"), str(tmp_path / "run.html"), rate=20.0,
                                 last=0.5) == []
    (tmp_path / "thin.log").write_bytes(content(tmp_path / "run.html")[1])
    thin = LogReader(str(tmp_path / "thin.log"))
    assert thin.times(0.0) == pytest.approx([0.5 + step / 20.0 for step in range(11)])
    notes = list(thin.records(-1, 10))
    assert [json.loads(data)[0] for kind, data in notes if kind == CONTACTS] == list(
        range(50, 101, 5))
    frames = [decode_frame(data) for kind, data in notes if kind == MESSAGE]
    assert [head["stamp"] for head, _ in frames] == pytest.approx([0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
    near, none = np.frombuffer(frames[0][1], dtype="<f4")
    assert near == round(1024 / 3) / 1024 and math.isnan(none)


def test_a_time_that_is_not_positive_is_refused(modules, tmp_path, writer):
    writer.document(0.0, {"name": "w", "file": "", "models": []})
    state(writer, 0.0)
    writer.close()
    with pytest.raises(CommandError, match="above 0"):
        write_replay(writer.path, str(tmp_path / "x.html"), Resolver([]), last=0.0)
