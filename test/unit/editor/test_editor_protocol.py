"""The protocol file, and the check against it."""
from __future__ import annotations

import json
import re
from dataclasses import fields

import numpy as np
import pytest
from editor_case import Case

from my_simulations.description import model, shapes, world
from my_simulations.editor.scene.plain_json import HIDDEN
from my_simulations.editor.scene.scene_json import NAMES, Documents
from my_simulations.editor.transport.http_pages import Pages
from my_simulations.editor.transport.pose_messages import LIVE, LOG, Poses, SentPoses, record_type
from my_simulations.editor.transport.protocol import Protocol, ProtocolError
from my_simulations.resources.resolver import Resolver

PATH = Pages.own_folder() + "/protocol.json"


@pytest.fixture(scope="module")
def data():
    with open(PATH, encoding="utf-8") as stream:
        return json.load(stream)


@pytest.fixture(scope="module")
def protocol():
    return Protocol.from_folder(Pages.own_folder())


def expressions(node):
    """Every type expression of a part of the file."""
    if isinstance(node, str):
        yield node
    elif isinstance(node, dict):
        for value in node.values():
            yield from expressions(value)


def test_every_type_that_is_named_exists(data):
    plain = {"string", "number", "integer", "boolean", "object", "any"}
    known = plain | set(data["types"])
    for part in ("types", "operations", "requests", "notices", "pushes"):
        for expression in expressions(data[part]):
            if "'" in expression:
                assert re.fullmatch(r"'[\w-]+'(\|'[\w-]+')*\??", expression), expression
                continue
            names = re.findall(r"[A-Za-z]\w*", expression)
            assert len(names) == 1 and names[0] in known, expression


def test_no_declared_type_is_idle(data):
    used = " ".join(expressions({key: data[key] for key in (
        "types", "operations", "requests", "notices", "pushes")}))
    assert [name for name in data["types"] if not re.search(rf"\b{name}\b", used)] == []


def test_every_request_of_the_protocol_is_handled_and_no_other(protocol, tmp_path):
    case = Case(tmp_path)
    try:
        routes = set(case.server._editor.routes)
        assert routes == set(protocol.requests) | {"drag", "drag_end"}
    finally:
        case.close()


@pytest.mark.parametrize("kind, described", [
    ("Light", world.Light), ("Inertial", model.Inertial), ("Surface", shapes.Surface),
    ("Axis", model.JointAxis), ("Joint", model.Joint), ("Plugin", model.PluginSpec)])
def test_the_protocol_names_all_fields_of_the_description(data, kind, described):
    assert set(data["types"][kind]) == {field.name for field in fields(described)
                                        if field.name not in HIDDEN}


def test_every_shape_of_the_description_can_be_told(data, protocol):
    literals = data["types"]["Geometry"]["type"].replace("'", "").split("|")
    assert set(literals) == {*NAMES.values(), "empty"}
    documents = Documents(Resolver())
    for shape in (*NAMES, shapes.Empty):
        protocol._check(documents.geometry(shape()), "Geometry", "geometry", 0)


def test_the_frames_layout_is_that_of_the_file(data):
    frames = data["frames"]
    sizes = {"u32": 4, "u64": 8, "f64": 8, "f32": 4}
    assert sum(sizes[kind] for _, kind in frames["head"]) == frames["head_bytes"]
    assert sum(sizes[kind] for _, kind in frames["record"]) == frames["record_bytes"]
    assert record_type().itemsize == frames["record_bytes"]
    assert frames["kinds"] == {"poses": LIVE, "log": LOG}


@pytest.mark.parametrize("value, expected", [
    (1, "string"), ("x", "number"), (float("nan"), "number"), (True, "number"), (1.5, "integer"),
    (True, "integer"), (1, "boolean"), ([], "object"), ([1, 2], "vec3"), ([1, 2, "x"], "vec3"),
    ("x", "vec3"), ({"a": [1]}, "{vec3}"), ([], "{vec3}"), ("x", "'a'|'b'"), (None, "string"),
    ({"url": None, "pattern": None, "scale": [1, 1], "more": 1}, "Texture"),
    ({"url": None, "pattern": None}, "Texture"), ([[1]], "string[]")])
def test_what_does_not_fit_a_type_is_refused_with_its_place(protocol, value, expected):
    with pytest.raises(ProtocolError, match="place"):
        protocol._check(value, expected, "place", 0)


@pytest.mark.parametrize("value, expected", [
    (1, "number"), (1.5, "number"), (None, "string?"), ("a", "'a'|'b'"), ([1, 2, 3], "vec3"),
    ({"a": [0] * 7}, "{pose}"), ([], "string[]"), ({}, "object"), ([{}], "any"),
    ({"url": None, "pattern": "wood", "scale": [1, 1]}, "Texture?")])
def test_what_fits_a_type_passes(protocol, value, expected):
    protocol._check(value, expected, "place", 0)


def test_a_frame_holds_what_moved_since_the_last_one():
    def poses(values):
        table = np.array(values, dtype=np.float32)
        return Poses(np.arange(len(table)) * 2, table, 5, 1.0, 2.0)

    still = [[0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 1]]
    sent = SentPoses()
    first = sent.frame(LIVE, 7, poses(still))
    assert len(first) == 40 + 2 * 32
    assert sent.frame(LIVE, 7, poses(still)) == b""
    trembling = [still[0], [1 + 5e-6, 0, 0, 0, 0, 0, 1]]
    assert sent.frame(LIVE, 7, poses(trembling)) == b""
    moved = sent.frame(LIVE, 7, poses([still[0], [1.1, 0, 0, 0, 0, 0, 1]]))
    assert len(moved) == 40 + 32
    [record] = np.frombuffer(moved[40:], dtype=record_type())
    assert record["id"] == 2 and record["pose"][0] == np.float32(1.1)
    sent.forget([0])
    assert len(sent.frame(LIVE, 7, poses([still[0], [1.1, 0, 0, 0, 0, 0, 1]]))) == 40 + 32
