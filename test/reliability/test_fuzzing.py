"""Readers and doors get inputs that are nearly right: all faults are told, none is raised."""
from __future__ import annotations

import asyncio
import json
import os
import threading
import time
from collections import Counter
from typing import Any, Callable, Dict

import aiohttp
import pytest
import rospy
import service_requests
import yaml
from building_plans import two_rooms
from editor_case import Browser, Refused, arm, box, cases
from grammars import changed, damaged, json_values, tree_of, words, xml
from heap import memory
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st
from proofs import allowance, per_second, scaled, spent

from my_simulations.appearance.material_script import read_materials
from my_simulations.appearance.textures import TextureFiles
from my_simulations.building.building_operations import building_sdf
from my_simulations.building.plan_json import plan_to_json
from my_simulations.description.light import Light
from my_simulations.description.model import Model
from my_simulations.description.shapes import Mesh
from my_simulations.description.world import World
from my_simulations.editor.transport.http_pages import Pages
from my_simulations.errors import CommandError, InputError
from my_simulations.formats.mesh.loading import load_mesh
from my_simulations.formats.reading import read_any
from my_simulations.formats.sdf import model_tables, sensor_tables, world_tables
from my_simulations.formats.sdf.writer.entities import write_entity, write_world
from my_simulations.formats.urdf import urdf_tables
from my_simulations.objects.object_list import parse_objects
from my_simulations.objects.yaml_source import read_yaml
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.endpoints import make_service_callback

INPUTS = int(os.environ.get("MY_SIMULATIONS_FUZZ_INPUTS") or scaled(60, 20000))
AT_ONCE = 1000
LONGEST_S = 1.0
"""Processor time of one input, in seconds."""

GROWTH = 1.05
ATTRIBUTES = ("name", "type", "version", "xyz", "rpy", "value", "filename", "link", "radius",
              "size", "relative_to", "degrees", "rotation_format", "lower", "upper", "ixx", "scale")

case = pytest.fixture(cases)


def tables(*modules: Any) -> list:
    return [value for module in modules for value in vars(module).values()
            if hasattr(value, "children") and hasattr(value, "of")]


def fuzz(strategy: Any, body: Callable[[Any], None]) -> Dict[str, Any]:
    """Run a body on INPUTS inputs, or as many as are allowed; the figures for the record."""
    worst, count = 0.0, 0

    def run(value: Any) -> None:
        nonlocal worst, count
        began = time.process_time()
        body(value)
        worst = max(worst, time.process_time() - began)
        count += 1

    used, start = allowance(), spent()
    first = time.time_ns()
    while count < INPUTS and used() < 1.0:
        # Short runs repeat the same inputs; long ones restart now and then with another seed.
        left = INPUTS if INPUTS <= AT_ONCE else min(AT_ONCE, INPUTS - count)
        search = settings(max_examples=left, deadline=None, database=None,
                          derandomize=INPUTS <= AT_ONCE, suppress_health_check=list(HealthCheck))(
            given(strategy)(run))
        before = count
        (search if INPUTS <= AT_ONCE else seed(first + count)(search))()
        if count == before or INPUTS <= AT_ONCE:
            break
    assert worst < LONGEST_S
    return {"inputs": count, "per_second": per_second(count, start),
            "slowest_ms": round(1000 * worst)}


def read(text: str) -> None:
    """As the node reads a document, and writes again what it got."""
    try:
        found, _ = read_any(text, Resolver(), "fuzz.sdf")
    except InputError as fault:
        assert fault.issues
        return
    if isinstance(found, World):
        write_world(found, found.state)
    elif isinstance(found, (Model, Light)):
        write_entity(found)


SDF = tree_of(tables(model_tables, world_tables, sensor_tables), {})
URDF = tree_of(tables(urdf_tables), {})


@pytest.mark.parametrize("kind, root, tree", [
    ("SDF", "sdf", {**SDF, "sdf": ["world", "model", "light", "actor"]}),
    ("URDF", "robot", {**URDF, "robot": ["link", "joint", "material", "gazebo", "transmission"]})])
def test_documents(record, kind, root, tree):
    read("<sdf version='1.6'><model name='m'/></sdf>")
    record(f"fuzzing: {kind}", **fuzz(xml(root, tree, ATTRIBUTES), read))


DAE = """<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"
 version="1.4.1"><asset><unit meter="{0}"/><up_axis>Z_UP</up_axis></asset><library_geometries>
<geometry id="g"><mesh><source id="p"><float_array id="f" count="{1}">{2}</float_array>
<technique_common><accessor source="#f" count="{3}" stride="{4}"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<{5} count="{6}"><input semantic="VERTEX" source="#v" offset="{7}"/><vcount>{8}</vcount><p>{9}</p>
</{5}></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node id="n"><matrix>{10}</matrix>
<instance_geometry url="#{11}"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""

counts = st.sampled_from(("0", "1", "3", "4", "9", "12", "-1", "2147483647", "2147483648", "1e9",
                          ""))
numbers = st.lists(st.sampled_from(("0", "1", "-1", "0.5", "nan", "inf", "1e30", "x")),
                   max_size=14).map(" ".join)
indices = st.lists(st.sampled_from(("0", "1", "2", "3", "-1", "4", "2147483648", "x", "")),
                   max_size=14).map(" ".join)
MATRIX = st.sampled_from(("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "1 0 0 0", "0 " * 16, "nan " * 16, ""))


@st.composite
def collada(draw: Any) -> str:
    kind = draw(st.sampled_from(("triangles", "polylist", "polygons", "trifans", "lines", "x")))
    text = DAE.format(
        draw(st.sampled_from(("1", "0.0254", "0", "-1", "nan", "x"))), draw(counts), draw(numbers),
        draw(counts), draw(counts), kind, draw(counts), draw(counts), draw(indices), draw(indices),
        draw(MATRIX), draw(st.sampled_from(("g", "n", "", "s"))))
    return str(draw(damaged(text)))


def test_meshes(record, tmp_path):
    path = tmp_path / "m.dae"
    number = iter(range(1 << 40))

    def load(text: str) -> None:
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        try:
            data = load_mesh(Mesh(f"m{next(number)}", str(path)))
        except InputError as fault:
            assert fault.issues
            return
        assert len(data.triangles) and data.triangles.max() < len(data.vertices)

    load("")
    record("fuzzing: DAE", **fuzz(collada(), load))


KEYS = ("model", "model_type", "position", "orientation", "name", "children", "moving", "velocity",
        "points", "static", "box", "MY_OBJECT", "<<")


@st.composite
def object_list(draw: Any) -> str:
    values = st.recursive(st.one_of(words, st.floats(), st.integers(), st.none(), st.booleans(),
                                    st.lists(st.floats(), max_size=4)),
                          lambda inside: st.dictionaries(st.sampled_from(KEYS), inside, max_size=5),
                          max_leaves=10)
    tree = draw(st.dictionaries(st.one_of(st.sampled_from(KEYS), words),
                                st.dictionaries(st.sampled_from(KEYS), values, max_size=6),
                                max_size=4))
    return str(draw(damaged(yaml.safe_dump(tree, allow_unicode=True))))


def test_object_lists(record, tmp_path):
    path = tmp_path / "objects.yaml"

    def load(text: str) -> None:
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        try:
            tree, source, _ = read_yaml(str(path), "/objects")
            parse_objects(tree, source)
        except InputError as fault:
            assert fault.first.file == str(path)

    load("a: {model: box}")
    record("fuzzing: object lists", **fuzz(object_list(), load))


def test_building_plans(record):
    plan = json.loads(json.dumps(plan_to_json(two_rooms())))

    def build(tree: Any) -> None:
        try:
            building_sdf(tree)
        except (InputError, CommandError) as fault:
            assert str(fault)

    build(plan)
    record("fuzzing: building plans", **fuzz(changed(plan), build))


SCRIPT_WORDS = ("material", "technique", "pass", "texture_unit", "{", "}", "\n", "\n", ":", "//",
                "/*", "*/", '"', '"a b.png"', "ambient", "diffuse", "scale", "alpha_rejection",
                "greater", "scene_blend", "alpha_blend", "lighting", "off", "1", "0.5", "nan",
                "1e999", "texture", "a.png", "\0")


def test_material_scripts(record, tmp_path):
    files = TextureFiles(Resolver([str(tmp_path)]))

    def read_script(text: str) -> None:
        for material in read_materials(text).values():
            files.texture(material.texture, [str(tmp_path)])
            json.dumps(vars(material), allow_nan=False)

    read_script("material A { technique { pass { texture_unit { texture a.png } } } }")
    known = st.sampled_from(SCRIPT_WORDS)
    pieces = st.lists(st.one_of(known, known, words), max_size=60)
    # A word many times over shows what takes a square of the length.
    scripts = st.tuples(pieces, st.sampled_from((1, 1, 1, 1, 1, 1, 1, 300))).map(
        lambda drawn: " ".join(drawn[0] * drawn[1]))
    record("fuzzing: material scripts", **fuzz(scripts, read_script))


class Line:
    """A browser in a thread, for a test without a loop."""

    def __init__(self, url: str) -> None:
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()
        self.browser = self.run(self._open(url))

    async def _open(self, url: str) -> Browser:
        self.session = aiohttp.ClientSession()
        return await Browser.open(self.session, url)

    def run(self, work: Any) -> Any:
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(60)

    def close(self) -> None:
        self.run(self.session.close())
        self.loop.call_soon_threadsafe(self.loop.stop)


ELSEWHERE = ("hello", "open", "new", "save", "autosave", "library", "log_", "building_save", "step")
"""Requests that write files, replace the world or take long by nature have tests of their own."""


def typed(protocol: Dict[str, Any], expected: str, depth: int = 0) -> Any:
    """Values of a type of the protocol, now and then others."""
    expected = expected.rstrip("?")
    some = st.sampled_from(("a", "b", "a::link", "b::hinge", "a::link::visual", "pose", "links.0"))
    plain = {"string": st.integers(0, 4).flatmap(lambda n: words if n == 4 else some),
             "boolean": st.booleans(),
             "number": st.floats(allow_nan=False, allow_infinity=False),
             "integer": st.integers(-2**40, 2**40)}
    fitting = plain.get(expected, json_values)
    if depth > 4:
        return json_values
    if expected.startswith("'"):
        fitting = st.sampled_from(expected.replace("'", "").split("|"))
    elif expected == "Operation":
        fitting = st.sampled_from(sorted(protocol["operations"])).flatmap(
            lambda kind: fields_of(protocol, protocol["operations"][kind], depth + 1).map(
                lambda fields: {"kind": kind, **fields}))
    elif expected.endswith("]"):
        head, _, length = expected[:-1].rpartition("[")
        size = int(length or 2)
        fitting = st.lists(typed(protocol, head, depth + 1), min_size=size, max_size=size)
    elif expected.startswith("{"):
        fitting = st.dictionaries(some, typed(protocol, expected[1:-1], depth + 1), max_size=3)
    elif expected.startswith("some ") or expected in protocol["types"]:
        found = protocol["types"][expected.rpartition(" ")[2]]
        fitting = (typed(protocol, found, depth + 1) if isinstance(found, str)
                   else fields_of(protocol, found, depth + 1))
    return st.integers(0, 19).flatmap(lambda n: json_values if n == 19 else fitting)


def fields_of(protocol: Dict[str, Any], fields: Dict[str, str], depth: int) -> Any:
    """Objects with these fields, of which those that may be missing are at times."""
    kinds = {name: typed(protocol, kind, depth) for name, kind in fields.items()}
    needed = {name for name, kind in fields.items() if not kind.endswith("?")}
    return st.fixed_dictionaries(
        {name: kind for name, kind in kinds.items() if name in needed},
        optional={name: kind for name, kind in kinds.items() if name not in needed})


def test_messages_of_the_editor(record, case):
    made = case(box("a"), arm("b"))
    with open(os.path.join(Pages.own_folder(), "protocol.json"), encoding="utf-8") as stream:
        protocol = json.load(stream)
    requests = [kind for kind in sorted(protocol["requests"]) if not kind.startswith(ELSEWHERE)]
    messages = st.sampled_from([*requests, *["edit"] * 8]).flatmap(
        lambda kind: fields_of(protocol, protocol["requests"][kind]["fields"], 0).map(
            lambda fields: (kind, fields)))
    line = Line(made.url)
    answered = Counter()

    def ask(message: Any) -> None:
        kind, fields = message
        try:
            line.run(line.browser.ask(kind, **fields))
            answered["accepted"] += 1
        except Refused as refused:
            assert "server failed" not in str(refused), refused
            answered["refused"] += 1

    try:
        figures = fuzz(messages, ask)
        line.run(line.browser.edit("insert", shape="box", name="the last"))
        assert made.sim.models.has("the last")
    finally:
        line.close()
    record("fuzzing: editor messages", **figures, **answered)


def test_service_requests(record):
    rospy.rostime.set_rostime_initialized(True)  # for log lines, which have a time
    simulator, endpoints = service_requests.start(box("a"), arm("b"))
    answered = Counter()

    def call(made: Any) -> None:
        endpoint, request = made
        try:
            answer = make_service_callback(endpoint)(request)
            assert "internal error" not in getattr(answer, "status_message", "")
            answered["accepted" if getattr(answer, "success", True) else "refused"] += 1
        except rospy.ServiceException as fault:
            assert "internal error" not in str(fault)
            answered["refused"] += 1

    try:
        figures = fuzz(service_requests.requests(endpoints), call)
        simulator.models.spawn(box("the last"))
    finally:
        simulator.close()
    record("fuzzing: service requests", **figures, **answered)


def test_memory_does_not_grow(record):
    def rounds(count: int) -> None:
        for n in range(count):
            read(f"<sdf version='1.6'><model name='m{n}'><link name='l'><a{n}/></link></model>"
                 "</sdf>")
            read(f"<robot name='r{n}'><link name='l'/>")

    rounds(scaled(300, 5000))
    before = memory()
    rounds(scaled(1000, 100000))
    after = memory()
    assert after < GROWTH * before
    record("memory while reading", growth_percent=round(100 * (after / before - 1), 2))
