"""Files that were dropped on the page become model folders, or nothing at all."""
from __future__ import annotations

import base64
import math
import os

import pytest
import trimesh
from editor_case import Refused, cases

case = pytest.fixture(cases)

SDF = b"""<sdf version="1.6"><model name="crate"><link name="link">
  <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>
</link></model></sdf>"""


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def sent(**files):
    return [{"path": path.replace("__", "/").replace("_dot_", "."),
             "data": base64.b64encode(data).decode()} for path, data in files.items()]


def ball(radius=0.1):
    return trimesh.creation.icosphere(subdivisions=4, radius=radius).export(file_type="stl")


def models(home):
    folder = home / ".gazebo" / "models"
    return sorted(os.listdir(folder)) if folder.exists() else []


def test_a_mesh_becomes_a_body_with_mass_and_inertia_of_its_volume(case, home):
    async def drop(browser):
        reply = await browser.ask("import_model", name="ball", density=2000.0,
                                  files=sent(ball_dot_stl=ball()))
        assert reply["uri"] == "model://ball"
        await browser.edit("insert", uri=reply["uri"], pose=[1, 2, 0.1, 0, 0, 0, 1])
        await browser.until(lambda: browser.model("ball"))
        inertial = browser.model("ball")["links"][0]["inertial"]
        mass = 2000.0 * 4.0 / 3.0 * math.pi * 0.1 ** 3
        assert inertial["mass"] == pytest.approx(mass, rel=0.01)
        assert inertial["ixx"] == pytest.approx(0.4 * mass * 0.01, rel=0.01)

    case().browse(drop)
    assert models(home) == ["ball"]
    text = (home / ".gazebo" / "models" / "ball" / "model.sdf").read_text()
    assert "model://ball/meshes/ball.stl" in text and ".import-" not in text


def test_an_open_mesh_is_imported_with_a_warning(case):
    half = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    half.update_faces(half.triangles_center[:, 2] > 0)

    async def drop(browser):
        await browser.ask("import_model", name="bowl",
                          files=sent(bowl_dot_stl=half.export(file_type="stl")))
        await browser.until(lambda: any(
            push["type"] == "issue" and push["issue"]["code"] == "mesh-open"
            for push in browser.pushes))

    case().browse(drop)


def test_a_model_folder_is_stored_as_it_is_and_replaced_only_on_request(case, home):
    async def drop(browser):
        files = sent(crate__model_dot_sdf=SDF, crate__notes_dot_txt=b"mine")
        await browser.ask("import_model", name="crate", files=files)
        with pytest.raises(Refused) as refused:
            await browser.ask("import_model", name="crate", files=files)
        assert refused.value.code == "exists"
        await browser.ask("import_model", name="crate", overwrite=True,
                          files=sent(crate__model_dot_sdf=SDF))

    case().browse(drop)
    assert sorted(os.listdir(home / ".gazebo" / "models" / "crate")) == [
        "model.config", "model.sdf"]


def test_the_files_that_a_new_model_names_by_its_own_name_are_found(case, home):
    mesh = b"<mesh><uri>model://urn/meshes/urn.stl</uri></mesh>"

    async def drop(browser):
        await browser.ask("import_model", name="urn", files=sent(
            urn__model_dot_sdf=SDF.replace(b"<box><size>1 1 1</size></box>", mesh),
            urn__meshes__urn_dot_stl=ball()))
        await browser.edit("insert", uri="model://urn", pose=[0, 0, 1, 0, 0, 0, 1])
        await browser.until(lambda: browser.model("crate") or browser.model("urn"))
        assert [push["issue"]["message"] for push in browser.pushes
                if push["type"] == "issue" and "not found" in push["issue"]["message"]] == []

    case().browse(drop)
    assert models(home) == ["urn"]


def test_a_faulty_model_is_refused_with_file_and_line_and_leaves_nothing(case, home):
    async def drop(browser):
        with pytest.raises(Refused) as refused:
            await browser.ask("import_model", name="bad", files=sent(
                bad__model_dot_sdf=SDF.replace(b"<collision", b"<inertial><mass>-1</mass>"
                                               b"</inertial><collision")))
        issue = refused.value.issues[0]
        assert issue["file"].endswith("models/bad/model.sdf") and issue["line"] > 0

    case().browse(drop)
    assert models(home) == []


@pytest.mark.parametrize(("name", "files"), [
    ("../up", sent(a_dot_stl=b"x")), ("a", []), ("a", sent(a_dot_exe=b"x")),
    ("a", [{"path": "../../x.stl", "data": ""}]), ("a", [{"path": "a.stl", "data": "%"}]),
    ("a", sent(a_dot_stl=b"x", b_dot_stl=b"x")), ("a", sent(a_dot_stl=b"no mesh")),
])
def test_what_is_no_model_is_refused(case, home, name, files):
    async def drop(browser):
        with pytest.raises(Refused):
            await browser.ask("import_model", name=name, files=files)

    case().browse(drop)
    assert models(home) == []


def test_a_link_in_the_place_of_a_model_is_replaced_and_what_it_names_stays(case, home, tmp_path):
    elsewhere = tmp_path / "workspace" / "crate"
    elsewhere.mkdir(parents=True)
    (elsewhere / "kept.txt").write_text("mine")
    (home / ".gazebo" / "models").mkdir(parents=True)
    (home / ".gazebo" / "models" / "crate").symlink_to(elsewhere)
    files = sent(crate__model_dot_sdf=SDF)

    async def drop(browser):
        await browser.ask("import_model", name="crate", files=files, overwrite=True)

    case().browse(drop)
    assert sorted(os.listdir(home / ".gazebo" / "models" / "crate")) == ["model.config",
                                                                         "model.sdf"]
    assert (elsewhere / "kept.txt").read_text() == "mine"


def test_a_model_that_cannot_be_replaced_stays_as_it_was(case, home, monkeypatch):
    async def drop(browser):
        await browser.ask("import_model", name="crate",
                          files=sent(crate__model_dot_sdf=SDF, crate__notes_dot_txt=b"mine"))
        rename = os.rename

        def full(source, target):
            if target == str(home / ".gazebo" / "models" / "crate") and "former" not in source:
                raise OSError(28, "No space left on device", target)
            rename(source, target)

        monkeypatch.setattr(os, "rename", full)
        with pytest.raises(Refused) as refused:
            await browser.ask("import_model", name="crate", overwrite=True,
                              files=sent(crate__model_dot_sdf=SDF))
        assert "cannot be written: [Errno 28]" in str(refused.value)
        monkeypatch.undo()

    case().browse(drop)
    assert models(home) == ["crate"]
    assert (home / ".gazebo" / "models" / "crate" / "notes.txt").read_text() == "mine"


def test_under_another_name_a_model_takes_its_own_meshes(case, home):
    sdf = SDF.replace(b"<box><size>1 1 1</size></box>",
                      b"<mesh><uri>model://crate/meshes/a.stl</uri></mesh>")

    async def drop(browser):
        for name, radius in (("crate", 0.1), ("copy", 0.3)):
            await browser.ask("import_model", name=name, files=sent(crate__model_dot_sdf=sdf,
                                         crate__meshes__a_dot_stl=ball(radius)))
        await browser.edit("insert", uri="model://copy", pose=[1, 2, 0.1, 0, 0, 0, 1])

    made = case()
    made.browse(drop)
    (model,) = [made.sim.models.get(name) for name in made.sim.models.names()]
    mesh = model.links[0].collisions[0].geometry
    assert mesh.path == str(home / ".gazebo" / "models" / "copy" / "meshes" / "a.stl")


@pytest.mark.parametrize("files, told", [
    (sent(a__model_dot_sdf=SDF, b__model_dot_sdf=SDF, a__model_dot_config=b"<model/>"),
     "one model folder at a time; there are a, b"),
    (sent(a__model_dot_config=b"<model/>", b__model_dot_urdf=b"<robot/>"),
     "there is no model.config at its top"),
])
def test_several_folders_at_once_are_refused(case, home, files, told):
    async def drop(browser):
        with pytest.raises(Refused) as refused:
            await browser.ask("import_model", name="two", files=files)
        assert told in str(refused.value)

    case().browse(drop)
    assert models(home) == []
