"""A recorded run as one file: opened from the disk, without a server."""
from __future__ import annotations

import contextlib
import math
import os
import struct
import zlib
from pathlib import Path

import pytest
from support import wait_for

import my_simulations
from my_simulations.cli.replay_command import main
from my_simulations.editor.logs.state_log import MESSAGE, LogReader
from my_simulations.editor.logs.world_record import LogRecord
from my_simulations.errors import CommandError
from my_simulations.python_api import open_world

ROBOT = Path(__file__).resolve().parents[2] / "urdf" / "robo.urdf"
OBJ = """mtllib stone.mtl
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
vt 0 0
vt 1 0
vt 0 1
usemtl stone
f 1/1 3/3 2/2
f 1/1 2/2 4/3
f 1/1 4/3 3/2
f 2/1 3/2 4/3
"""
SDF = """<sdf version="1.6"><model name="stone"><static>true</static><pose>2 0 0 0 0 0</pose>
<link name="link"><visual name="visual"><geometry><mesh><uri>model://stone/meshes/stone.obj</uri>
</mesh></geometry></visual></link></model></sdf>"""
BALL = """<sdf version="1.6"><model name="ball"><pose>0 0 3 0 0 0</pose><link name="link">
<collision name="c"><geometry><sphere><radius>0.2</radius></sphere></geometry></collision>
<visual name="v"><geometry><sphere><radius>0.2</radius></sphere></geometry></visual>
</link></model></sdf>"""
FALL = 3.0 - 9.8 * 0.5 ** 2 / 2.0
"""Height of the ball after 0.5 s, m."""


def png():
    """A picture of one red pixel."""
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(b"\0\xff\0\0")) + chunk(b"IEND", b""))


@pytest.fixture
def page_file(tmp_path, monkeypatch):
    """The replay of a second in which a ball falls beside a textured mesh."""
    meshes = tmp_path / "models" / "stone" / "meshes"
    meshes.mkdir(parents=True)
    (meshes / "stone.obj").write_text(OBJ)
    (meshes / "stone.mtl").write_text("newmtl stone\nmap_Kd red stone.png\n")
    (meshes / "red stone.png").write_bytes(png())
    (meshes.parent / "model.sdf").write_text(SDF)
    (meshes.parent / "model.config").write_text(
        "<model><name>stone</name><sdf>model.sdf</sdf></model>")
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "models"))
    log = tmp_path / "run" / "state.log"
    with open_world("worlds/empty.world") as world:
        world.spawn(str(meshes.parent / "model.sdf"), "stone")
        world.spawn(BALL, "ball")
        record = LogRecord(str(log))
        for _ in range(100):
            record.record_state(world)
            world.step(10)
        record.record_state(world)
        record.close()
    file = tmp_path / "away" / "run.html"
    assert main(["replay", str(log.parent), "-o", str(file)]) == 0
    (meshes / "stone.obj").unlink()
    return file


def test_the_time_bar_moves_a_model_and_nothing_is_loaded_from_elsewhere(browser, page_file):
    replay = browser.open(page_file.as_uri(), wait=False, offline=True)
    requests = []
    replay.page.on("request", lambda request: requests.append(request.url))
    replay.wait_for_world()
    replay.until("editor.view.waiting === 0", "mesh and texture")
    assert set(replay.names()) == {"ground_plane", "stone", "ball"}
    height = "editor.store.worldPose('ball')[2]"
    assert replay.get(height) == pytest.approx(3.0, abs=1e-3)
    replay.page.get_by_label("Log time").evaluate(
        "(slider) => { slider.value = '0.5'; slider.dispatchEvent(new Event('input')); }")
    wait_for(lambda: replay.get(height) == pytest.approx(FALL, abs=0.01), "the ball at 0.5 s")
    low, high = (replay.get(f"editor.view.bounds('stone').{end}") for end in ("min", "max"))
    assert low == pytest.approx([2.0, 0.0, 0.0]) and high == pytest.approx([3.0, 1.0, 1.0])
    replay.button("Play the log").click()
    replay.until("editor.store.log.time === editor.store.log.end", "the end of the recording")
    assert not [url for url in requests if not url.startswith(("blob:", "data:"))
                and url != replay.page.url]
    assert replay.get("editor.store.issues") == []
    assert replay.faults == []
    replay.close()


def test_a_minute_in_the_lab_room_takes_less_than_five_megabytes(browser, tmp_path):
    log = tmp_path / "run" / "state.log"
    with open_world("worlds/lab_room.world") as world:
        world.spawn(str(ROBOT), "robo")
        with contextlib.closing(LogRecord(str(log))) as record:
            start, steps = world.time, round(1.0 / 30.0 / world.step_size)
            while world.time < start + 60.0:
                record.record_state(world)
                world.publish("/cmd_vel", {"linear": {"x": 0.2 * math.cos(world.time)},
                                           "angular": {"z": math.sin(world.time)}})
                world.step(steps)
    page = tmp_path / "run.html"
    assert my_simulations.replay(str(log.parent), str(page)) == []
    assert page.stat().st_size < 5e6
    replay = browser.open(page.as_uri(), offline=True)
    replay.until("editor.view.waiting === 0", "the meshes")
    assert {"robo", "ground_plane"} < set(replay.names()) and len(replay.names()) > 10
    length = replay.get("editor.store.log.end - editor.store.log.begin")
    assert length == pytest.approx(60.0, abs=0.1)
    assert replay.faults == []
    replay.close()


def test_the_camera_turns_and_an_edit_is_refused(browser, page_file):
    replay = browser.open(page_file.as_uri())
    before = replay.get("editor.view.camera")
    replay.page.get_by_role("button", name="Top", exact=True).dispatch_event("click")
    replay.until(f"editor.view.camera.pitch < {before['pitch']} - 0.5", "the view from above")
    replay.get("editor.actions.remove(['ball'])")
    replay.until("editor.store.issues.length === 1", "the note that nothing can be changed")
    assert "recording" in replay.get("editor.store.issues[0].message")
    assert "ball" in replay.names()
    replay.close()


def recorded(path, topic):
    """Number of messages of a topic in a log that is being written; 0 if it does not exist yet."""
    try:
        log = LogReader(str(path))
    except CommandError:
        return 0
    try:
        name = f'"topic":"{topic}"'.encode()
        return sum(kind == MESSAGE and name in content
                   for kind, content in log.records(-1, len(log.times(0.0))))
    finally:
        log.close()


def check_plot(replay, variable):
    """A plot shows its curve; numbers are added and removed, and a click moves the time."""
    plot = replay.page.locator("#plot")
    canvas = plot.get_by_role("img", name="Plot")
    keys = plot.locator(".plot-key")
    assert keys.all_inner_texts() == [variable]
    assert canvas.evaluate(COLORS) > 0, "the curve"
    plot.get_by_label("Plot a number of a topic").select_option("/scan.nearest")
    assert keys.all_inner_texts() == [variable, "/scan.nearest"]
    box = canvas.bounding_box()
    replay.page.mouse.click(box["x"] + 63, box["y"] + box["height"] / 2.0)
    replay.until("editor.store.log.time < editor.store.log.begin + 0.5", "the beginning")
    for name in (variable, "/scan.nearest"):
        plot.get_by_role("button", name=f"Remove {name}").click()
    wait_for(lambda: not canvas.is_visible(), "a page without a plot")


COLORS = """(canvas) => {
  const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let at = 0; at < data.length; at += 4) count += data[at] > 180 && data[at + 2] < 90;
  return count;
}"""
"""Number of pixels in the orange of the first curve."""


def test_contacts_and_chosen_topics_are_shown_by_switches(browser, launch, tmp_path, monkeypatch):
    folder = tmp_path / "recorded"
    monkeypatch.setenv("MY_SIMULATIONS_RECORD", str(folder))
    monkeypatch.setenv("MY_SIMULATIONS_RECORD_TOPICS", "/scan /odom")
    node = launch(os.path.join(os.path.dirname(os.path.abspath(__file__)), "robot.world"),
                  "paused:=false")
    log = folder / "state.log"
    wait_for(lambda: min(recorded(log, "/scan"), recorded(log, "/odom")) > 5, "messages")
    node.close()
    page = tmp_path / "run.html"
    speed = "/odom.twist.twist.linear.x"
    assert my_simulations.replay(str(folder), str(page), plot=[speed, "/missing.x"]) == []
    replay = browser.open(page.as_uri())
    replay.until("editor.topics.list.map(({name}) => name).sort().join() === '/odom,/scan'",
                 "the list of topics")
    replay.page.get_by_label("Log time").evaluate(
        "(slider) => { slider.value = slider.max; slider.dispatchEvent(new Event('input')); }")
    replay.until("editor.view.drawnTopics.includes('/scan')", "the laser's fan")
    replay.until("editor.view.drawnTopics.includes('/odom')", "the path of the odometry")
    assert replay.get("editor.view.contactMarks") == 0
    replay.page.get_by_label("Contacts").check()
    replay.until("editor.view.contactMarks > 0", "the contacts of the wheels")
    replay.page.get_by_label("/scan").uncheck()
    replay.until("editor.view.drawnTopics.join() === '/odom'", "the odometry alone")
    check_plot(replay, speed)
    assert replay.faults == []
    replay.close()
