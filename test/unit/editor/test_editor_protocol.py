"""The protocol file, and the check against it."""
from __future__ import annotations

import json
import re
from dataclasses import fields

import numpy as np
import pytest
from building_plans import two_rooms
from editor_case import Case

from my_simulations.building import building_plan as plan
from my_simulations.building.building_folder import About
from my_simulations.building.plan_json import plan_to_json
from my_simulations.description import actor, light, model, shapes, surroundings, world
from my_simulations.editor.scene.plain_json import HIDDEN
from my_simulations.editor.scene.scene_json import NAMES, Documents
from my_simulations.editor.topics.topic_frame import TOPIC
from my_simulations.editor.transport.http_pages import Pages
from my_simulations.editor.transport.pose_messages import (
    HEAD,
    HEAD_BYTES,
    LIVE,
    LOG,
    RECORD,
    RECORD_BYTES,
    Poses,
    SentPoses,
    record_type,
)
from my_simulations.editor.transport.protocol import OPERATION, Protocol, ProtocolError
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
    known = plain | set(data["types"]) | {OPERATION}
    for part in ("types", "operations", "requests", "notices", "pushes"):
        for expression in expressions(data[part]):
            if "'" in expression:
                assert re.fullmatch(r"'[\w-]+'(\|'[\w-]+')*\??", expression), expression
                continue
            for one in expression.split("|"):
                names = re.findall(r"[A-Za-z]\w*", re.sub(r"^some ", "", one))
                assert len(names) == 1 and names[0] in known, expression


def test_no_declared_type_is_idle(data):
    used = " ".join(expressions({key: data[key] for key in (
        "types", "operations", "requests", "notices", "pushes")}))
    used += " " + data["frames"]["topic_head"]
    assert [name for name in data["types"] if not re.search(rf"\b{name}\b", used)] == []


def test_every_request_of_the_protocol_is_handled_and_no_other(protocol, tmp_path):
    case = Case(tmp_path)
    try:
        routes = set(case.server._editor.routes)
        assert routes == set(protocol.requests) | set(protocol.notices)
    finally:
        case.close()


@pytest.mark.parametrize(
    "kind, described",
    [
        ("Inertial", model.Inertial),
        ("Surface", shapes.Surface),
        ("Axis", model.JointAxis),
        ("Mimic", model.Mimic),
        ("Joint", model.Joint),
        ("Plugin", model.PluginSpec),
        ("Physics", world.Physics),
        ("OdePhysics", world.OdePhysics),
        ("Scene", surroundings.Scene),
        ("Sky", surroundings.Sky),
        ("Fog", surroundings.Fog),
        ("Wind", surroundings.Wind),
        ("GuiCamera", surroundings.GuiCamera),
        ("Atmosphere", surroundings.Atmosphere),
        ("SphericalCoordinates", surroundings.SphericalCoordinates),
        ("Road", surroundings.Road),
        ("Waypoint", actor.Waypoint),
        ("Trajectory", actor.Trajectory),
        ("Plan", plan.Plan),
        ("Level", plan.Level),
        ("Wall", plan.Wall),
        ("Opening", plan.Opening),
        ("Stairs", plan.Stairs),
        ("Floor", plan.Floor),
        ("FloorImage", plan.FloorImage),
        ("Roof", plan.Roof),
        ("BuildingAbout", About),
    ],
)
def test_the_protocol_names_all_fields_of_the_description(data, kind, described):
    more = {"Plan": {"format"}, "Joint": {"sensors"}}.get(kind, set())
    assert set(data["types"][kind]) == more | {field.name for field in fields(described)
                                               if field.compare and field.name not in HIDDEN}


@pytest.mark.parametrize("kind, described, more", [
    ("Model", model.Model, {"enable_wind", "uri", "scalable", "group"}),
    ("Light", light.Light, {"group"}), ("Link", model.Link, {"id"}),
    ("Visual", shapes.Visual, {"layer", "picture_size"}),
    ("Collision", shapes.Collision, set()), ("Actor", actor.Actor, {"geometry"}),
    ("Animation", actor.Animation, {"geometry"}), ("World", world.World, set())])
def test_the_protocol_has_no_field_that_the_description_lacks(data, kind, described, more):
    assert set(data["types"][kind]) - more <= {field.name for field in fields(described)}


def test_the_world_of_the_description_follows_the_protocol(protocol):
    fog = surroundings.Scene(sky=surroundings.Sky(), fog=surroundings.Fog())
    full = world.World(
        scene=fog,
        gui_camera=surroundings.GuiCamera(),
        roads=[surroundings.Road("road")],
        spherical_coordinates=surroundings.SphericalCoordinates(),
        actors=[actor.Actor("walker", animations=[actor.Animation("walk")])],
    )
    for one in (world.World(), full):
        document = Documents(Resolver()).world(one, one.physics, one.gravity, [])
        protocol.types.check(document, "World", "world")


def test_a_plan_follows_the_protocol(protocol):
    two_levels = two_rooms()
    two_levels.roof = plan.Roof()
    protocol.types.check(plan_to_json(two_levels), "Plan", "plan")


def test_what_a_handler_checks_by_itself_only_has_to_be_an_object(protocol):
    message = {"type": "building_sdf", "id": 1, "plan": {"format": 1}}
    protocol.check_message(message)
    with pytest.raises(ProtocolError, match="building_sdf.plan"):
        protocol.check_message({**message, "plan": []})
    with pytest.raises(ProtocolError, match="plan: missing field 'name'"):
        protocol.types.check({"format": 1}, "Plan", "plan")


@pytest.mark.parametrize("op, told", [
    ({}, "string `kind`"), ({"kind": "fly"}, "unknown operation 'fly'"),
    ({"kind": "delete"}, "missing field 'names'"),
    ({"kind": "delete", "names": [1]}, r"delete.names\[0\]: expected a string"),
    ({"kind": "insert_light", "light": {"glow": 1}}, "unknown field 'glow'")])
def test_a_wrong_operation_is_refused_with_its_place(protocol, op, told):
    with pytest.raises(ProtocolError, match=told):
        protocol.check_operation(op)


def test_every_shape_of_the_description_can_be_told(data, protocol):
    literals = [data["types"][name]["type"].strip("'")
                for name in data["types"]["Geometry"].split("|")]
    assert sorted(literals) == sorted([*NAMES.values(), "empty"])
    documents = Documents(Resolver())
    for shape in (*NAMES, shapes.Empty):
        protocol.types.check(documents.geometry(shape()), "Geometry", "geometry")


def test_the_frames_layout_is_that_of_the_file(data):
    frames = data["frames"]
    sizes = {"u32": 4, "u64": 8, "f64": 8, "f32": 4}
    assert sum(sizes[kind] for _, kind in frames["head"]) == frames["head_bytes"] == HEAD_BYTES
    assert sum(sizes[kind] for _, kind in frames["record"]) == frames["record_bytes"]
    assert [list(field) for field in HEAD] == frames["head"]
    assert [list(field) for field in RECORD] == frames["record"]
    assert RECORD_BYTES == frames["record_bytes"]
    assert record_type().itemsize == frames["record_bytes"]
    assert frames["kinds"] == {"poses": LIVE, "log": LOG, "topic": TOPIC}


@pytest.mark.parametrize("value, expected", [
    (1, "string"), ("x", "number"), (float("nan"), "number"), (True, "number"), (1.5, "integer"),
    (10 ** 400, "number"), (10 ** 400, "integer"),
    (True, "integer"), (1, "boolean"), ([], "object"), ([1, 2], "vec3"), ([1, 2, "x"], "vec3"),
    ("x", "vec3"), ({"a": [1]}, "{vec3}"), ([], "{vec3}"), ("x", "'a'|'b'"), (None, "string"),
    ({"url": None, "pattern": None, "scale": [1, 1], "more": 1}, "Texture"),
    ({"url": None, "pattern": None}, "Texture"), ([[1]], "string[]"),
    ({"scale": [1, 1], "more": 1}, "some Texture"), ({"url": 1}, "some Texture"),
    ({"type": "box", "size": [1, 1]}, "Geometry"), ({"type": "egg"}, "Geometry"),
    ({"type": "sphere", "size": [1, 1, 1]}, "Geometry")])
def test_what_does_not_fit_a_type_is_refused_with_its_place(protocol, value, expected):
    with pytest.raises(ProtocolError, match="place"):
        protocol.types.check(value, expected, "place")


def test_a_notice_with_a_number_may_be_answered(protocol):
    protocol.check_reply("presence", None)


@pytest.mark.parametrize("value, expected", [
    (1, "number"), (1.5, "number"), (None, "string?"), ("a", "'a'|'b'"), ([1, 2, 3], "vec3"),
    ({"a": [0] * 7}, "{pose}"), ([], "string[]"), ({}, "object"), ([{}], "any"),
    ({"url": None, "pattern": "wood", "scale": [1, 1]}, "Texture?"), ({}, "some Texture"),
    ({"type": "box", "size": [1, 1, 1]}, "Geometry"), ({"type": "empty"}, "Geometry")])
def test_what_fits_a_type_passes(protocol, value, expected):
    protocol.types.check(value, expected, "place")


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
