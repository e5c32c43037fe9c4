"""A recorded run as one file: what the file contains."""
from __future__ import annotations

import base64
import gzip
import json
import re

import numpy as np
import pytest
from editor_case import box
from running_simulator import started

from my_simulations.cli.replay_command import main
from my_simulations.description.shapes import Heightmap, Mesh, Polyline
from my_simulations.description.world import World
from my_simulations.editor.logs.recorder import Recorder
from my_simulations.editor.logs.replay_page import write_replay
from my_simulations.editor.logs.state_log import LogReader, LogWriter
from my_simulations.editor.transport.page_bundle import FOLDER, sources_of
from my_simulations.editor.transport.page_files import PageFiles
from my_simulations.editor.transport.pose_messages import Poses
from my_simulations.errors import CommandError
from my_simulations.resources.resolver import Resolver

LETTERS = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))


@pytest.fixture
def modules(tmp_path, monkeypatch):
    """The folder of what npm has fetched, with a packed program."""
    folder = tmp_path / "node_modules"
    (folder / "three").mkdir(parents=True)
    (folder / "three" / "package.json").write_text("{}")
    (folder / FOLDER).mkdir()
    (folder / FOLDER / "replay.js").write_text("start();")
    (folder / FOLDER / "sources").write_text(sources_of(PageFiles.own_folder(), str(folder)))
    monkeypatch.setenv("MY_SIMULATIONS_NODE_MODULES", str(folder))
    return folder


def shaped(name, geometry):
    model = box(name)
    model.links[0].visuals[0].geometry = geometry
    return model


def recorded(folder, models):
    """The log of the first state of a world."""
    issues = []
    sim = started(World(models=models), log=issues.append)
    recorder = Recorder(sim, Resolver([str(folder)]), str(folder / "run" / "state.log"), 0.001,
                        issues.append)
    recorder.stop()
    sim.close()
    assert issues == []
    return recorder.path


def flight(folder):
    """The log of a second in which a link flies along x at 2 m/s, in 101 states."""
    writer = LogWriter(str(folder / "run" / "state.log"))
    writer.document(0.0, {"name": "w", "file": "/home/me/w.world", "models": [
        {"name": "a", "links": [{"id": 1, "collisions": [1]}]}]})
    for step in range(101):
        time = step / 100.0
        pose = np.array([[2.0 * time, 1.0 / 3.0, 9.0, 0.0, 0.0, 0.0, 1.0]], dtype=np.float32)
        writer.poses(Poses(np.array([1]), pose, step, time, time))
    writer.close()
    return writer.path


def content(page):
    """The head, the log and the files of a page."""
    text = page.read_text(encoding="utf-8")
    packed = re.search(r'id="data">([^<]*)<', text).group(1)
    data = gzip.decompress(base64.b64decode(packed))
    size = int.from_bytes(data[:4], "little")
    head = json.loads(data[4:4 + size])
    rest = data[4 + size:]
    files = {name: rest[at:at + length] for name, (at, length, _) in head["files"].items()}
    at, length = head["log"]
    return head, rest[at:at + length], files


def test_the_log_is_thinned_and_keeps_first_and_last_state(modules, tmp_path):
    log = flight(tmp_path)
    page = tmp_path / "run.html"
    assert write_replay(log, str(page), Resolver([]), states_hz=10.0) == []
    head, data, files = content(page)
    assert (head["name"], files) == ("run", {})
    (tmp_path / "thin.log").write_bytes(data)
    thin = LogReader(str(tmp_path / "thin.log"))
    assert thin.times(0.0) == pytest.approx([step / 10.0 for step in range(11)])
    document = json.loads(thin.text(thin.seek(0.5)[0]))
    assert (document["file"], document["models"][0]["links"][0]["collisions"]) == ("w.world", [])
    for time in thin.times(0.0):
        assert thin.seek(time)[1].values[0] == pytest.approx(
            [2.0 * time, 1.0 / 3.0, 9.0, 0.0, 0.0, 0.0, 1.0], abs=1e-4)


def test_meshes_pictures_and_generated_shapes_are_inside(modules, tmp_path):
    meshes = tmp_path / "thing" / "meshes"
    meshes.mkdir(parents=True)
    (meshes / "thing.obj").write_text("mtllib ../thing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "thing" / "thing.mtl").write_text("newmtl m\nmap_Kd lost.png\nmap_Kd s t.png\n")
    (tmp_path / "thing" / "s t.png").write_bytes(b"\x89PNG picture")
    path = meshes / "thing.obj"
    log = recorded(tmp_path, [
        shaped("mesh", Mesh(f"file://{path}", str(path))),
        shaped("letter", Polyline([[*map(tuple, LETTERS)]], 0.5)),
        shaped("land", Heightmap(uri="file:///nowhere/land.png"))])
    page = tmp_path / "run.html"
    missing = write_replay(log, str(page), Resolver([str(tmp_path)]))
    files = content(page)[2]
    by_name = {name.rpartition("/")[2]: data for name, data in files.items()}
    assert by_name.pop("s t.png") == b"\x89PNG picture"
    assert by_name.pop("thing.obj").startswith(b"mtllib")
    assert by_name.pop("thing.mtl").startswith(b"newmtl")
    (solid,) = by_name.values()
    assert int.from_bytes(solid[80:84], "little") == 8   # triangles of a prism
    assert sorted(name.rpartition("/")[2].rpartition(".")[2] for name in missing) == ["png", "stl"]


def test_a_file_that_is_not_a_log_or_a_program_that_is_not_packed_is_named(
        modules, tmp_path, capsys):
    (tmp_path / "no.log").write_text("text")
    assert main(["replay", str(tmp_path / "no.log"), "-o", str(tmp_path / "x.html")]) == 1
    assert "not a state log" in capsys.readouterr().err
    log = recorded(tmp_path, [box("a")])
    with pytest.raises(CommandError, match="above 0"):
        write_replay(log, str(tmp_path / "x.html"), Resolver([]), states_hz=0.0)
    (modules / FOLDER / "sources").write_text("of other modules")
    assert main(["replay", str(tmp_path / "run"), "-o", str(tmp_path / "x.html")]) == 1
    assert "tools/run --set-up-only" in capsys.readouterr().err
    assert not (tmp_path / "x.html").exists()
