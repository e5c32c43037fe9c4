"""Saved buildings: names, folders, pictures, and a disk that gives up."""
from __future__ import annotations

import base64
import errno
import io
import os

import pytest
from building_plans import one_wall, two_rooms
from PIL import Image
from reading import codes

from my_simulations.building import building_folder as folders
from my_simulations.building.building_folder import About, load_building, save_building
from my_simulations.building.building_operations import (
    building_list,
    building_load,
    building_save,
    building_sdf,
)
from my_simulations.building.building_plan import FloorImage, Opening, Wall
from my_simulations.building.plan_json import plan_to_json
from my_simulations.errors import CommandError, InputError
from my_simulations.formats.image import pixels
from my_simulations.formats.reading import read_file
from my_simulations.resources.resolver import Resolver


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    return tmp_path


def picture(form="PNG"):
    stream = io.BytesIO()
    Image.new("RGB", (40, 30), (200, 10, 10)).save(stream, form)
    return stream.getvalue()


def data_url(content, kind="png"):
    return f"data:image/{kind};base64," + base64.b64encode(content).decode()


def save(plan=None, name="Two rooms", **options):
    return building_save(plan_to_json(plan or two_rooms()), name, options)


def content(path):
    return {entry: open(os.path.join(path, entry), "rb").read() for entry in os.listdir(path)}


def test_a_saved_building_is_a_model_folder_with_its_plan(home):
    saved = save(description="A house", author="Ada", email="ada@example.org")
    assert saved["path"] == str(home / "building_editor_models" / "Two_rooms")
    assert (saved["name"], saved["uri"], saved["issues"]) == ("Two_rooms", "model://Two_rooms", [])
    config = (home / "building_editor_models/Two_rooms/model.config").read_text()
    for text in ("<name>Two rooms</name>", "<version>1.0</version>", "A house", "Ada",
                 "ada@example.org", '<sdf version="1.7">model.sdf</sdf>'):
        assert text in config
    resolver = Resolver([str(home / "building_editor_models")])
    model, issues = read_file(resolver.model_file("model://Two_rooms"), resolver)
    assert issues == [] and model.name == "Two_rooms" and len(model.links) == 11


def test_a_building_is_opened_as_it_was_drawn():
    save()
    plan = two_rooms()
    assert building_load("Two rooms")["plan"] == plan_to_json(plan)
    assert [entry["name"] for entry in building_list()] == ["Two_rooms"]


def test_what_config_says_of_a_building_is_told_when_it_is_opened():
    save(version="2.1", description="A <house>", author="Ada", email="ada@example.org")
    assert building_load("Two rooms")["about"] == {
        "version": "2.1", "description": "A <house>", "author": "Ada", "email": "ada@example.org"}


@pytest.mark.parametrize("config", [None, b"", b"<model", b"<other/>"])
def test_a_building_with_a_broken_config_is_opened_all_the_same(config):
    path = save()["path"]
    file = os.path.join(path, "model.config")
    os.unlink(file)
    if config is not None:
        with open(file, "wb") as stream:
            stream.write(config)
    loaded = building_load(path)
    assert loaded["about"]["author"] == "" and len(loaded["plan"]["levels"]) == 2


def test_without_its_plan_a_building_is_read_from_its_model():
    path = save()["path"]
    os.unlink(os.path.join(path, folders.PLAN_FILE))
    loaded = building_load(path)
    assert len(loaded["plan"]["levels"][0]["walls"]) == 5


def test_a_broken_plan_gives_way_to_the_model_and_is_mentioned():
    path = save()["path"]
    with open(os.path.join(path, folders.PLAN_FILE), "w") as stream:
        stream.write('{"format": 1, "lev')
    loaded = building_load(path)
    assert codes(loaded["issues"]) == ["plan-not-json"]
    assert len(loaded["plan"]["levels"]) == 2


def test_an_existing_folder_is_kept_unless_it_may_be_replaced():
    path = save()["path"]
    before = content(path)
    with pytest.raises(CommandError, match="already exists"):
        save(one_wall())
    assert content(path) == before
    with open(os.path.join(path, "notes.txt"), "w") as stream:
        stream.write("mine")
    save(one_wall(), overwrite=True)
    assert content(path)["notes.txt"] == b"mine"
    assert content(path)["model.sdf"] != before["model.sdf"]


@pytest.mark.parametrize("name", ["", "   ", "../evil", "a/b", "a\\b", "..", "a..b", ".hidden",
                                  "a\0b", "x" * 200, "tab\there\x07", "a:b"])
def test_a_name_that_would_lead_elsewhere_is_refused(home, name):
    if name == "tab\there\x07" or name.strip():
        match = "name"
    else:
        match = "must not be empty"
    with pytest.raises(CommandError, match=match):
        save(name=name)
    assert not (home / "building_editor_models").exists()


def test_a_place_outside_of_the_allowed_folders_is_refused(tmp_path):
    with pytest.raises(CommandError, match="outside the allowed folders"):
        save(folder="/etc")
    with pytest.raises(CommandError, match="outside the allowed folders"):
        building_load("/etc/passwd")
    with pytest.raises(CommandError, match="outside the allowed folders"):
        building_load("/etc\0/passwd")
    saved = building_save(plan_to_json(two_rooms()), "Far",
                          {"folder": str(tmp_path / "projects" / "one")},
                          roots=[str(tmp_path / "projects")])
    assert saved["path"] == str(tmp_path / "projects" / "one" / "Far")


def test_a_plan_with_errors_is_not_saved(home):
    plan = one_wall(Opening(0, 9.0, 1.0, 0.5, wall=0, along=2.0))
    with pytest.raises(InputError):
        save(plan)
    assert not (home / "building_editor_models").exists()


def test_a_plan_with_crossing_walls_is_saved_and_says_so():
    plan = one_wall()
    plan.levels[0].walls.append(Wall(1, (2.0, -1.0), (2.0, 1.0)))
    assert codes(save(plan)["issues"]) == ["walls-cross"]


def failing_after(count, fault, monkeypatch):
    calls = []
    real = os.fsync

    def fsync(handle):
        calls.append(handle)
        if len(calls) > count:
            raise OSError(fault, os.strerror(fault))
        real(handle)

    monkeypatch.setattr(os, "fsync", fsync)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_full_disk_leaves_what_was_there(count, monkeypatch):
    path = save()["path"]
    before = content(path)
    failing_after(count, errno.ENOSPC, monkeypatch)
    with pytest.raises(CommandError, match="No space left"):
        save(one_wall(), overwrite=True)
    assert content(path) == before


def test_a_full_disk_leaves_no_half_building(home, monkeypatch):
    failing_after(1, errno.ENOSPC, monkeypatch)
    with pytest.raises(CommandError, match="cannot write"):
        save()
    assert building_list() == [] and not (home / "building_editor_models/Two_rooms").exists()


def test_a_place_that_cannot_be_written_is_named(home):
    (home / "building_editor_models").write_text("I am a file")
    with pytest.raises(CommandError, match="cannot write"):
        save()


@pytest.mark.parametrize(("form", "ending", "kind"), [("PNG", ".png", "png"),
                                                      ("JPEG", ".jpg", "jpeg")])
def test_a_floor_plan_is_kept_beside_the_plan(form, ending, kind):
    plan = two_rooms()
    url = data_url(picture(form), kind)
    plan.levels[0].image = FloorImage("my scan", 87.5, url)
    path = save(plan)["path"]
    assert content(path)["floor_plan_1" + ending] == picture(form)
    assert b"base64" not in content(path)[folders.PLAN_FILE]
    image = building_load(path)["plan"]["levels"][0]["image"]
    assert image == {"file": "floor_plan_1" + ending, "resolution": 87.5, "data": url}
    assert save(load_building(path)[0], overwrite=True)["path"] == path


def test_a_small_picture_of_too_many_pixels_is_refused(monkeypatch):
    monkeypatch.setattr(pixels, "MOST_PIXELS", 7)
    plan = two_rooms()
    plan.levels[0].image = FloorImage("scan.png", 100.0, data_url(picture()))
    with pytest.raises(InputError, match="pixels"):
        save(plan)


@pytest.mark.parametrize("data", [
    data_url(b"MZ this is no picture"), data_url(picture()[:60]), data_url(picture("GIF")),
    "data:image/svg+xml;base64,PHN2Zy8+", "data:image/png;base64,%%%", "http://host/a.png"])
def test_a_picture_that_is_none_is_refused(home, data):
    plan = two_rooms()
    plan.levels[0].image = FloorImage("scan.png", 100.0, data)
    with pytest.raises(InputError) as caught:
        save(plan)
    assert codes(caught.value.issues) == ["image-unreadable"]
    assert not (home / "building_editor_models").exists()


def test_a_picture_of_another_folder_is_refused():
    plan = two_rooms()
    plan.levels[0].image = FloorImage("../../secret.png", 100.0)
    with pytest.raises(InputError):
        save(plan)


@pytest.mark.parametrize("replace", [lambda path: None, os.mkfifo])
def test_a_lost_picture_is_mentioned_and_the_plan_opened(replace):
    plan = two_rooms()
    plan.levels[0].image = FloorImage("scan", 100.0, data_url(picture()))
    path = save(plan)["path"]
    os.unlink(os.path.join(path, "floor_plan_1.png"))
    replace(os.path.join(path, "floor_plan_1.png"))
    loaded = building_load(path)
    assert codes(loaded["issues"]) == ["image-unreadable"]
    assert len(loaded["plan"]["levels"][0]["walls"]) == 5


def test_the_sdf_of_a_plan_is_given_without_saving(home):
    model, text, issues = building_sdf(plan_to_json(two_rooms()))
    assert model.static and "Wall_4_Visual_2" in text and issues == []
    assert not (home / "building_editor_models").exists()


def test_what_config_says_is_escaped(home):
    save_building(two_rooms(), str(home / "b" / "x"), About(author="<&>"))
    assert "&lt;&amp;&gt;" in (home / "b/x/model.config").read_text()
