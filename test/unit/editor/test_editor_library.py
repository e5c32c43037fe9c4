"""The model library, what is watched, and state logs."""
from __future__ import annotations

import asyncio
import http.server
import io
import json
import os
import tarfile
import threading

import pytest
from building_plans import two_rooms
from editor_case import Browser, Refused, arm, box, cases

from my_simulations.building.plan_json import plan_to_json
from my_simulations.editor.logs.state_log import MAGIC, LogReader, LogWriter
from my_simulations.engine.ring import DEMAND_NS, POSE_DEMAND_NS
from my_simulations.errors import CommandError
from my_simulations.geometry import Pose, Twist
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.joint_gains import default_gains

SDF = ("<sdf version='1.7'><model name='{}'><link name='l'><visual name='v'><geometry>"
       "<box><size>1 1 1</size></box></geometry></visual></link></model></sdf>")


@pytest.fixture
def case(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("GAZEBO_MODEL_PATH", raising=False)
    yield from cases(tmp_path)


def model_folder(parent, name, title=""):
    folder = parent / name
    folder.mkdir(parents=True)
    (folder / "model.config").write_text(
        f"<model><name>{title or name}</name><sdf version='1.7'>model.sdf</sdf>"
        "<description>A &amp; B\n  words</description></model>")
    (folder / "model.sdf").write_text(SDF.format(name))
    return folder


def location(found, kind):
    return next((one for one in found["locations"] if one["kind"] == kind), None)


def test_models_are_listed_by_location_with_their_titles(case, tmp_path, monkeypatch):
    model_folder(tmp_path / "paths", "thing", "A thing")
    (tmp_path / "paths" / "empty").mkdir()
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "paths"))
    made = case()

    async def look(browser):
        found = await browser.ask("library")
        assert [one["kind"] for one in found["locations"]] == ["built-in", "home", "environment"]
        assert "table" in [one["name"] for one in location(found, "built-in")["models"]]
        [thing] = location(found, "environment")["models"]
        assert (thing["uri"], thing["title"], thing["description"]) == (
            "model://thing", "A thing", "A & B words")
        assert thing["thumb"].startswith("/thumb/")
        document = await browser.ask("library_get", uri=thing["uri"])
        assert document["model"]["links"][0]["visuals"][0]["geometry"]["size"] == [1, 1, 1]
        for uri in ("model://nix", "/etc/passwd", "http://example.org/x"):
            with pytest.raises(Refused):
                await browser.ask("library_get", uri=uri)

    made.browse(look)


def test_a_pipe_without_a_writer_does_not_stop_the_list(case, tmp_path, monkeypatch):
    (tmp_path / "paths" / "piped").mkdir(parents=True)
    os.mkfifo(tmp_path / "paths" / "piped" / "model.config")
    model_folder(tmp_path / "paths", "thing", "A thing")
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "paths"))
    made = case()

    async def look(browser):
        found = location(await browser.ask("library"), "environment")
        assert "A thing" in [one["title"] for one in found["models"]]

    made.browse(look)


def test_what_the_fuel_caches_hold_is_listed_and_inserted(case, tmp_path):
    folder = tmp_path / "home/.ignition/fuel/fuel.gazebosim.org/acme/models/desk lamp"
    model_folder(folder, "2", "Desk Lamp")
    (folder / "2" / "thumbnails").mkdir()
    (folder / "2" / "thumbnails" / "1.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    made = case(resolver=Resolver.from_environment())

    async def look(browser):
        found = location(await browser.ask("library"), "fuel")
        assert found["title"] == "Fuel" and found["problem"] is None
        [lamp] = found["models"]
        assert lamp["uri"] == "https://fuel.gazebosim.org/1.0/acme/models/desk%20lamp"
        assert (lamp["title"], lamp["description"]) == ("Desk Lamp", "A & B words")
        assert lamp["thumb"].startswith("/resource/")
        document = await browser.ask("library_get", uri=lamp["uri"])
        assert document["model"]["name"] == "2"
        await browser.edit("insert", uri=lamp["uri"])
        with pytest.raises(Refused, match="no address of a model"):
            await browser.ask("library_get", uri="https://fuel.gazebosim.org/x")

    made.browse(look)


def test_a_folder_can_be_added_and_is_known_the_next_time(case, tmp_path):
    model_folder(tmp_path / "mine", "thing")
    made = case(resolver=Resolver())

    async def add(browser):
        found = await browser.ask("library_add", path=str(tmp_path / "mine"))
        assert [one["name"] for one in location(found, "added")["models"]] == ["thing"]
        assert (await browser.edit("insert", uri="model://thing"))["name"] == "thing"
        for path in ("/", "/etc", str(tmp_path / "nix"), ""):
            with pytest.raises(Refused):
                await browser.ask("library_add", path=path)

    made.browse(add)

    async def again(browser):
        found = await browser.ask("library")
        assert [one["name"] for one in location(found, "added")["models"]] == ["thing"]
        found = await browser.ask("library_remove", path=str(tmp_path / "mine"))
        assert location(found, "added") is None

    case(resolver=Resolver()).browse(again)


def test_new_models_show_up_by_themselves(case, tmp_path):
    home = tmp_path / "home" / ".gazebo" / "models"
    model_folder(home, "first")
    made = case()

    async def wait(browser):
        found = await browser.ask("library")
        assert [one["name"] for one in location(found, "home")["models"]] == ["first"]
        await browser.until(lambda: browser.last("library"))
        model_folder(home, "second")
        await browser.until(lambda: len(location(browser.last("library"), "home")["models"]) == 2)

    made.browse(wait)


@pytest.fixture
def database():
    """A model database on a port of its own: one model, `far`."""
    archive = io.BytesIO()
    with tarfile.open(fileobj=archive, mode="w:gz") as tar:
        for name, text in (("model.config", "<model><name>Far</name><sdf>model.sdf</sdf></model>"),
                           ("model.sdf", SDF.format("far"))):
            info = tarfile.TarInfo(f"far/{name}")
            info.size = len(text)
            tar.addfile(info, io.BytesIO(text.encode()))
    files = {"/database.config": b"<database><models><uri>file://far</uri></models></database>",
             "/far/model.tar.gz": archive.getvalue()}

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            data = files.get(self.path)
            self.send_response(200 if data else 404)
            self.send_header("Content-Length", str(len(data or b"")))
            self.end_headers()
            self.wfile.write(data or b"")

        def log_message(self, *_arguments):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()


def test_a_remote_model_is_downloaded_when_it_is_chosen(case, tmp_path, database, monkeypatch):
    monkeypatch.setenv("GAZEBO_MODEL_DATABASE_URI", database)
    made = case()

    async def choose(browser):
        await browser.ask("library")
        await browser.until(lambda: browser.last("library")
                            and location(browser.last("library"), "remote")["models"])
        [far] = location(browser.last("library"), "remote")["models"]
        assert (await browser.ask("library_get", uri=far["uri"]))["model"]["name"] == "far"
        await browser.until(lambda: browser.last("download"))
        assert (tmp_path / "home" / ".gazebo" / "models" / "far" / "model.sdf").is_file()
        assert (await browser.edit("insert", uri=far["uri"]))["name"] == "far"

    made.browse(choose)


def test_a_database_that_cannot_be_reached_is_told_and_holds_nobody_up(case, monkeypatch):
    monkeypatch.setenv("GAZEBO_MODEL_DATABASE_URI", "http://127.0.0.1:9/none")
    made = case()

    async def look(browser):
        await browser.ask("library")
        await browser.until(lambda: browser.last("library"))
        remote = location(browser.last("library"), "remote")
        assert remote["models"] == [] and "127.0.0.1:9" in remote["problem"]

    made.browse(look)


# -- watches --------------------------------------------------------------------------------------

def test_plots_joints_and_contacts_are_sent_while_they_are_watched(case):
    made = case(box("a"), arm("arm"), paused=False)
    made.sim.states.set_model_state("a", Pose((0, 0, 9)), Twist((2.0, 0.0, 0.0)))

    def last(browser, topic):
        return next((push for push in reversed(browser.pushes)
                     if push["type"] == "watch" and push["topic"] == topic), None)

    async def watch(browser):
        topics = ["plot:a.x", "plot:a::link.vx", "plot:sim_time", "plot:real_time_factor",
                  "plot:arm::hinge.position", "joints:arm", "plot:nix.x", "joints:nix",
                  "plot:iterations", "plot:a.yaw"]
        await browser.ask("watch", topics=topics)
        await browser.until(lambda: all(last(browser, topic) for topic in topics))
        assert last(browser, "plot:a::link.vx")["value"] == 2.0
        assert last(browser, "plot:arm::hinge.position")["value"] == 0.0
        model = made.sim.models.get("arm")
        suited = {mode: default_gains(model, model.joints[0], mode == "velocity", 0.001)
                  for mode in ("position", "velocity")}
        assert last(browser, "joints:arm")["joints"] == [
            {"name": "hinge", "axis": 0, "position": 0.0, "rate": 0.0, "default_gains": suited}]
        assert last(browser, "plot:nix.x")["problem"] and last(browser, "joints:nix")["problem"]
        await browser.edit("joint", joint="arm::hinge", mode="position", value=0.5)
        await browser.until(lambda: last(browser, "joints:arm")["joints"][0].get("drive") == {
            "mode": "position", "value": 0.5, "gains": suited["position"]})
        await browser.edit("joint", joint="arm::hinge", mode="force", value=3)
        await browser.until(lambda: last(browser, "joints:arm")["joints"][0].get("drive") == {
            "mode": "force", "value": 3.0})
        await browser.ask("undo")
        await browser.ask("undo")
        await browser.until(lambda: "drive" not in last(browser, "joints:arm")["joints"][0])
        first = last(browser, "plot:a.x")
        await browser.until(lambda: last(browser, "plot:a.x")["value"] > first["value"])
        assert last(browser, "plot:a.x")["time"] > first["time"]
        await browser.ask("watch", topics=[])
        await browser.ask("folders")
        count = len(browser.pushes)
        await browser.until(lambda: browser.last("stats") is not None)
        assert not [push for push in browser.pushes[count:] if push["type"] == "watch"]
        for topic in ("nix", "plot:a.colour", "joints:", "plot:"):
            with pytest.raises(Refused):
                await browser.ask("watch", topics=[topic])

    made.browse(watch)


def test_the_engine_reads_whole_states_for_pages_only_while_something_is_watched(case):
    made = case(box("a"), paused=False)
    words = made.sim._session.ring.words

    async def until(states, poses):
        for _ in range(1000):
            if (words[DEMAND_NS] > 0, words[POSE_DEMAND_NS] > 0) == (states, poses):
                return
            await asyncio.sleep(0.01)
        raise AssertionError(f"states {words[DEMAND_NS]}, poses {words[POSE_DEMAND_NS]}")

    async def look(browser):
        await until(False, True)
        await browser.ask("watch", topics=["plot:a.vx"])
        await until(True, True)
        await browser.ask("watch", topics=[])
        await until(False, True)
        await browser.ask("watch", topics=["plot:a.vx"])
        await until(True, True)
        await browser.socket.close()
        await until(False, False)

    made.browse(look)


def test_time_is_plotted_and_recorded_also_while_nothing_moves(case):
    made = case(box("a"), paused=False)

    async def rest(browser):
        await browser.ask("log_start", name="rest")
        await browser.ask("watch", topics=["plot:sim_time"])
        await browser.until(lambda: browser.last("watch"))
        first = browser.last("watch")["value"]
        await browser.until(lambda: browser.last("watch")["value"] > first + 0.3)
        assert browser.last("watch")["time"] == browser.last("watch")["value"]
        await browser.ask("log_stop")
        found = await browser.ask("log_open", name="rest")
        assert found["end"] - found["begin"] > 0.3

    made.browse(rest)


# -- logs -----------------------------------------------------------------------------------------

def record(made, name="flight"):
    """A log in which `a` flies along x and a box comes in the middle; its path."""
    made.sim.states.set_model_state("a", Pose((0, 0, 9)), Twist((2.0, 0.0, 0.0)))

    async def fly(browser):
        assert (await browser.ask("log_start", name=name))["name"] == name
        start = browser.link_pose("a")[0] if browser.poses else 0.0
        await browser.until(lambda: browser.poses and browser.link_pose("a")[0] > start + 0.8)
        await browser.edit("insert", shape="box")
        await browser.until(lambda: browser.model("unit_box"))
        await browser.until(lambda: browser.link_pose("a")[0] > start + 1.8)
        with pytest.raises(Refused) as refused:
            await browser.ask("log_start")
        assert refused.value.code == "recording"
        assert (await browser.ask("log_stop"))["name"] == name
        assert browser.last("log")["state"] == "idle"

    made.browse(fly)
    return made.folder / "data" / "log" / name / "state.log"


def test_a_log_ends_where_steps_made_at_once_have_led(case):
    made = case(box("a"))
    made.sim.states.set_model_state("a", Pose((0, 0, 9)), Twist((2.0, 0.0, 0.0)))

    async def leap(browser):
        await browser.ask("log_start", name="leap")
        await browser.ask("step", steps=600)
        await browser.ask("log_stop")
        found = await browser.ask("log_open", name="leap")
        await browser.ask("log_seek", time=found["end"])
        await browser.until(lambda: browser.frames[-1][0] == 2
                            and browser.link_pose("a")[0] == pytest.approx(1.2, abs=1e-6))

    made.browse(leap)


def test_a_page_that_comes_while_a_log_is_recorded_is_told_and_one_that_comes_back_sees_the_world(
        case):
    made = case(box("a"))

    async def come(first):
        assert first.last("log")["state"] == "idle"
        await first.ask("log_start", name="shared")
        second = await Browser.open(first.session, made.url)
        assert second.last("log")["state"] == "recording" and second.last("log")["name"] == "shared"
        assert (await second.ask("log_stop"))["name"] == "shared"

    made.browse(come)


def test_a_log_is_recorded_listed_and_played_to_one_browser(case):
    made = case(box("a"), paused=False)
    record(made)

    async def play(browser):
        [log] = (await browser.ask("log_list"))["logs"]
        assert log["name"] == "flight" and log["bytes"] > 0
        found = await browser.ask("log_open", name="flight")
        assert found["end"] > found["begin"]
        await browser.until(lambda: browser.frames[-1][0] == 2)
        assert not browser.model("unit_box")
        await browser.ask("log_seek", time=found["end"])
        await browser.until(lambda: browser.model("unit_box") and browser.link_pose("a"))
        last, end = browser.link_pose("a")[0], browser.frames[-1][2]
        await browser.ask("log_seek", time=found["begin"])
        await browser.until(lambda: not browser.model("unit_box") and browser.link_pose("a"))
        first, begin = browser.link_pose("a")[0], browser.frames[-1][2]
        assert last - first == pytest.approx(2.0 * (end - begin), abs=0.01) and last - first > 1.0
        await browser.ask("log_play", rate=20.0)
        await browser.until(lambda: browser.last("log")["state"] == "open"
                            and browser.last("log")["time"] == found["end"])
        await browser.ask("log_close")
        await browser.until(lambda: browser.frames[-1][0] == 1)
        assert browser.model("unit_box")
        for request in ("log_seek", "log_play", "log_close"):
            with pytest.raises(Refused):
                await browser.ask(request, **{"log_seek": {"time": 0}, "log_play": {"rate": 1},
                                              "log_close": {}}[request])

    made.browse(play)


def test_who_looks_at_a_log_does_not_edit_the_world_unseen(case):
    made = case(box("a"))

    async def look(browser):
        await browser.edit("insert", shape="box")
        await browser.ask("log_start", name="still")
        await browser.ask("step", steps=100)
        await browser.ask("log_stop")
        await browser.ask("log_open", name="still")
        pose = [7, 0, 1, 0, 0, 0, 1]
        for kind, fields in {"edit": {"op": {"kind": "delete", "names": ["a"]}}, "undo": {},
                             "redo": {}}.items():
            with pytest.raises(Refused) as refused:
                await browser.ask(kind, **fields)
            assert refused.value.code == "replay"
        await browser.notify("drag", names=["a"], poses=[pose])
        await browser.ask("drag_end")
        other = await Browser.open(browser.session, made.url)
        assert other.model("a") and other.model("unit_box")
        assert other.link_pose("a") != pose[:3]
        await browser.ask("log_close")
        await browser.edit("delete", names=["a"])

    made.browse(look)


def test_a_full_disk_is_told_when_a_log_is_written(tmp_path):
    writer = LogWriter(str(tmp_path / "x.log"))
    writer._file.close()
    writer._file = open("/dev/full", "wb")
    with pytest.raises(CommandError, match="x.log"):
        writer.document(0.0, {"models": ["x" * 100] * 1000})
        writer.close()


@pytest.mark.parametrize("name", ["my run (2)", "a@b#c", "x" * 100])
def test_a_log_whose_folder_was_renamed_is_listed_and_opened(case, name):
    made = case(box("a"))

    async def rename(browser):
        await browser.ask("log_start", name="old")
        await browser.ask("step", steps=10)
        await browser.ask("log_stop")
        folder = made.folder / "data" / "log"
        (folder / "old").rename(folder / name)
        (found,) = (await browser.ask("log_list"))["logs"]
        assert (await browser.ask("log_open", name=found["name"]))["name"] == name
        with pytest.raises(Refused):
            await browser.ask("log_start", name=name)

    made.browse(rename)


def test_no_log_takes_the_place_of_another(case):
    made = case()
    (made.folder / "data" / "log" / "old").mkdir(parents=True)
    (made.folder / "data" / "log" / "old" / "state.log").write_text("precious")

    async def start(browser):
        with pytest.raises(Refused) as refused:
            await browser.ask("log_start", name="old")
        assert refused.value.code == "exists"

    made.browse(start)


def test_a_log_that_was_cut_off_is_good_up_to_there(case, tmp_path):
    made = case(box("a"), paused=False)
    path = record(made)
    whole = LogReader(str(path))
    cut = tmp_path / "cut.log"
    cut.write_bytes(path.read_bytes()[:-7])
    part = LogReader(str(cut))
    assert part.begin == whole.begin and part.end <= whole.end
    number, poses = part.seek(part.end)
    assert json.loads(part.text(number))["models"] and len(poses.ids)
    for reader in (whole, part):
        reader.close()


@pytest.mark.parametrize("data", [b"", b"nonsense", MAGIC, MAGIC + b"\xff" * 40])
def test_what_is_no_log_is_refused(tmp_path, data):
    path = tmp_path / "x.log"
    path.write_bytes(data)
    with pytest.raises(CommandError):
        LogReader(str(path))


@pytest.mark.parametrize("name", ["../x", "", ".hidden", "a/b", "none"])
def test_no_log_is_opened_elsewhere(case, name):
    async def open_it(browser):
        with pytest.raises(Refused):
            await browser.ask("log_open", name=name)

    case().browse(open_it)


# -- buildings ------------------------------------------------------------------------------------

def test_a_building_is_saved_into_the_library_and_loaded_again(case):
    made = case()
    plan = plan_to_json(two_rooms())

    async def build(browser):
        shown = await browser.ask("building_sdf", plan=plan)
        assert shown["model"]["static"] and "Wall_0" in shown["sdf"]
        saved = await browser.ask("building_save", plan=plan, name="Hut")
        assert (await browser.edit("insert", uri=saved["uri"]))["name"] == "Hut"
        assert "Hut" in [one["name"] for one in await browser.ask("building_list")]
        assert len((await browser.ask("building_load", name="Hut"))["plan"]["levels"]) == 2

    made.browse(build)


def test_a_template_becomes_a_model_that_can_be_inserted(case):
    made = case()

    async def build(browser):
        listed = (await browser.ask("templates"))["templates"]
        assert {"differential_drive", "four_wheels", "arm"} <= {one["name"] for one in listed}
        found = await browser.ask("template", name="differential_drive",
                                  values={"name": "truck", "mass": 4})
        assert found["model"]["name"] == "truck"
        assert found["model"]["links"][0]["inertial"]["mass"] == 4.0
        assert (await browser.edit("insert", sdf=found["sdf"]))["name"] == "truck"
        with pytest.raises(Refused, match="Body mass must be"):
            await browser.ask("template", name="differential_drive", values={"mass": -4})
        with pytest.raises(Refused, match="unknown template"):
            await browser.ask("template", name="boat", values={})

    made.browse(build)
