"""Writing descriptions as SDF, by the reader's own tables."""
from __future__ import annotations

import math
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest
from lxml import etree
from reading import VALID, link_of, model_of, sdf, world_of

from my_simulations.description.compare import differences
from my_simulations.description.light import Light
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Polyline
from my_simulations.description.world import World
from my_simulations.errors import Severity, errors_of
from my_simulations.formats.reading import parse_world, read_entity, read_file, read_world
from my_simulations.formats.sdf import model_tables
from my_simulations.formats.sdf.writer import entities, state_element, surroundings_elements
from my_simulations.formats.sdf.writer.entities import (
    _Writer,
    tables_by_shape,
    write_entity,
    write_world,
)
from my_simulations.formats.xml.tables import Kept, Part, Table
from my_simulations.formats.xml.values import BOOL, FLOAT, FRICTION, INT, LIMIT, POSE, TEXT, VECTOR3
from my_simulations.geometry import Pose, quat_from_rpy, rpy_from_quat
from my_simulations.resources.resolver import Resolver

ROOT = Path(__file__).resolve().parents[3]
WORLDS = sorted(ROOT.glob("world/**/*.world"))
MODELS = [*sorted(ROOT.glob("models/*/model.sdf")), *sorted(ROOT.glob("objects/*.urdf")),
          *sorted(ROOT.glob("objects/*.sdf")), Path(VALID) / "everything.sdf"]
CLOSE = 1e-12


def ids(paths):
    return [f"{path.parent.name}-{path.name}" for path in paths]


def again(model):
    """A model after it was written and read."""
    entity, issues = read_entity(write_entity(model), Resolver())
    assert not errors_of(issues), issues
    return entity


def written(model):
    return etree.fromstring(write_entity(model))


@pytest.mark.parametrize("path", WORLDS, ids=ids(WORLDS))
@pytest.mark.parametrize("full", [True, False], ids=["inlined", "included"])
def test_a_world_that_was_written_reads_as_the_same(path, full):
    resolver = Resolver.from_environment()
    loaded = read_world(str(path), resolver)
    world = loaded.world

    def bare(model):
        return read_file(resolver.model_file(model.uri), resolver)[0]

    text = write_world(world, included=None if full else bare)
    copy, issues = parse_world(text, resolver)
    assert {issue.severity for issue in issues} <= {Severity.NOTE}
    assert differences(world, copy, CLOSE) == []
    assert (b"<include>" in text) is (not full and any(m.uri for m in world.models))
    assert write_world(copy, included=None if full else bare) == text


@pytest.mark.parametrize("path", MODELS, ids=ids(MODELS))
def test_a_model_that_was_written_reads_as_the_same(path):
    resolver = Resolver.from_environment()
    model, _ = read_file(str(path), resolver)
    text = write_entity(model)
    copy, issues = read_entity(text, resolver)
    assert not errors_of(issues)
    assert differences(model, copy, CLOSE) == []
    assert write_entity(copy) == text


def test_every_field_of_a_link_survives():
    """Each value of every table, set to something that is not its default."""
    odd = {BOOL: "true", FLOAT: "0.125", FRICTION: "0.5", INT: "7", LIMIT: "0.25", TEXT: "words",
           VECTOR3: "1 2 3", POSE: "1 2 3 0.1 0.2 0.3"}
    link, issues = link_of(
        "<pose>1 2 3 0.1 0.2 0.3</pose><gravity>false</gravity><kinematic>true</kinematic>"
        "<self_collide>false</self_collide>"
        "<velocity_decay><linear>0.5</linear><angular>0.25</angular></velocity_decay>"
        "<inertial><mass>3</mass><pose>0 0 1 0 0 0</pose><inertia><ixx>2</ixx><iyy>2</iyy>"
        "<izz>2</izz><ixy>0.1</ixy><ixz>0.2</ixz><iyz>0.3</iyz></inertia></inertial>"
        "<collision name='c'><geometry><box><size>1 2 3</size></box></geometry>"
        "<surface>" + surface(odd) + "</surface></collision>", "1.7")
    assert not errors_of(issues)
    copy = again(Model("m", links=[link])).links[0]
    assert differences(link, copy, CLOSE) == []
    assert changed(copy) >= {"pose", "gravity", "kinematic", "self_collide", "linear_decay",
                             "angular_decay", "inertial", "collisions"}
    assert changed(copy.collisions[0].surface) == {
        item.name for item in fields(copy.collisions[0].surface)} - {"extra"}


def surface(odd):
    """XML that sets every value of <surface>."""
    root = etree.Element("surface")
    for path, value, default in model_tables.SURFACE.values():
        at = root
        for tag in path.split("/"):
            found = at.find(tag)
            at = etree.SubElement(at, tag) if found is None else found
        text = odd[value.kind]
        at.text = "false" if value.kind is BOOL and default else text
    return "".join(etree.tostring(child, encoding="unicode") for child in root)


def changed(thing):
    """Names of the fields that differ from the default."""
    return {item.name for item in fields(thing)
            if item.name != "name" and getattr(thing, item.name) != default(item)}


def default(item):
    return item.default_factory() if callable(item.default_factory) else item.default


def test_defaults_are_not_written_and_required_elements_are():
    root = written(Model("m", links=[Link("l", collisions=[Collision("c", Box())])],
                         joints=[Joint("j", "revolute", "world", "l", axis=JointAxis())]))
    assert [e.tag for e in root.iter()] == [
        "sdf", "model", "link", "collision", "geometry", "box", "size", "joint", "parent", "child",
        "axis", "xyz"]
    assert root.get("version") == "1.7"
    assert root.find("model/joint").get("type") == "revolute"


def test_the_sun_and_the_physics_name_their_type():
    root = etree.fromstring(write_world(World(lights=[Light("sun")])))
    assert root.find("world/light").get("type") == "point"
    assert root.find("world/physics").get("type") == "ode"
    assert root.findtext("world/physics/max_step_size") == "0.001"
    assert root.findtext("world/gravity") == "0 0 -9.8"


@pytest.mark.parametrize("value", [0.1, 1 / 3, 1e-300, 123456789.123456789, 1e22, 5e-324])
def test_a_number_reads_back_as_the_same_double(value):
    assert again(Model("m", Pose((value, 0, 0)), static=True)).pose.position[0] == value


@pytest.mark.parametrize("rpy", [
    (0.4, 0.0, 0.0), (0.0, 0.0, 1.2), (0.1, math.pi / 2, 0.2), (0.1, -math.pi / 2 + 1e-9, 0.2),
    (0.3, math.pi / 2 - 1e-6, 2.0), (3.14, 1.0, -3.14), (0.0, 1.5707963, 0.0),
])
def test_an_orientation_survives_also_where_roll_and_yaw_are_one(rpy):
    q = quat_from_rpy(*rpy)
    model = again(Model("m", Pose((0, 0, 0), q), static=True))
    assert differences(Pose(orientation=q), Pose(orientation=model.pose.orientation), 2e-9) == []


@pytest.mark.parametrize("rpy", [
    (0.4, 0.1, -0.3), (3.14, 1.0, -3.14), (-2.9, -1.5, 0.7), (1.0, math.pi / 2, -2.0),
    (0.6, -math.pi / 2 + 7e-10, -1.0), (1.9, math.pi / 2 - 9.6e-10, 0.6), (3.0, 1.5707, -3.0),
])
def test_what_was_saved_and_loaded_is_saved_as_the_same_text(rpy):
    model = Model("m", Pose((0, 0, 0), quat_from_rpy(*rpy)), static=True)
    assert write_entity(model) == write_entity(again(model))


@pytest.mark.parametrize("rpy", ["0 0 3.3", "0 0 -3.3", "0.1 -0.2 4", "0 0 3", "0 0 6.2"])
def test_a_waypoint_keeps_the_sense_in_which_its_path_turns_to_it(rpy):
    # 3.3 rad and -2.98 rad are one orientation, but not to the spline through the waypoints.
    def saved(turn):
        text = ("<sdf version='1.6'><world name='w'><actor name='a'><script><trajectory id='0' "
                f"type='walk'><waypoint><time>1</time><pose>1 2 0 {turn}</pose></waypoint>"
                "</trajectory></script></actor></world></sdf>")
        written = etree.fromstring(write_world(parse_world(text, Resolver())[0]))
        return written.findtext(".//waypoint/pose")
    first = saved(rpy)
    assert [float(one) for one in first.split()[3:]] == pytest.approx(
        [float(one) for one in rpy.split()], abs=1e-12)
    assert saved(" ".join(first.split()[3:])) == first


def test_axes_are_saved_as_the_same_text_again():
    axis = (2.52817657e-06, -9.1567471e-07, 0.9999999999963835)
    arm = Model("m", links=[Link("a"), Link("b")],
                joints=[Joint("j", "revolute", "a", "b", axis=JointAxis(axis))])
    assert write_entity(again(arm)) == write_entity(again(again(arm)))
    assert again(arm) == again(again(arm))


def test_a_joint_may_be_called_as_a_link_which_sdf_1_7_forbids():
    arm = Model("m", links=[Link("a"), Link("b")], joints=[
        Joint("b", "revolute", "a", "b", Pose((1, 0, 0)), JointAxis((0.0, 1.0, 0.0)))])
    assert again(arm) == arm
    assert written(arm).get("version") == "1.6"
    assert written(Model("m", models=[arm])).get("version") == "1.6"
    assert etree.fromstring(write_world(World(models=[arm]))).get("version") == "1.6"


@pytest.mark.parametrize("path", sorted(ROOT.glob("world/**/*.world")), ids=lambda p: p.name)
def test_each_thing_of_a_world_can_be_copied_as_text_and_pasted(path):
    loaded = read_world(str(path), Resolver.from_environment())
    world = loaded.world
    for thing in (*world.models, *world.lights):
        text = write_entity(thing)
        copy, issues = read_entity(text.decode(), Resolver.from_environment())
        assert not errors_of(issues) and type(copy) is type(thing)
        assert differences(thing, copy, CLOSE) == []
        assert write_entity(copy) == text


def test_plain_angles_stay_plain():
    text = written(Model("m", Pose((0, 0, 0), quat_from_rpy(0, 0, 0.4)), static=True))
    assert text.findtext("model/pose") == "0 0 0 0 0 0.4"


def test_roll_pitch_yaw_keep_their_digits_near_a_pitch_of_90_degrees():
    pitch = math.pi / 2 - 1e-7
    assert rpy_from_quat(quat_from_rpy(0.0, pitch, 0.0))[1] == pytest.approx(pitch, abs=1e-14)


def test_what_was_kept_goes_back_to_where_it_stood():
    model, _ = model_of("""<static>1</static><link name="l">
        <sensor name="s" type="camera"><camera><image><width>64</width></image></camera></sensor>
        <collision name="c"><geometry><box><size>1 1 1</size></box></geometry><surface>
          <friction><ode><mu>0.5</mu></ode><bullet><friction>0.3</friction></bullet>
          </friction><soft_contact><dart><damping>3</damping></dart></soft_contact></surface>
        </collision>
        <visual name="v"><geometry><box><size>1 1 1</size></box></geometry><material>
          <diffuse>1 0 0 1</diffuse><lighting>true</lighting></material></visual></link>
      <plugin name="p" filename="libp.so"><speed>3</speed></plugin>""", "1.7")
    root = written(model)
    collision = root.find("model/link/collision/surface")
    assert collision.findtext("friction/ode/mu") == "0.5"
    assert collision.findtext("friction/bullet/friction") == "0.3"
    assert len(collision.findall("friction")) == 1
    assert collision.findtext("soft_contact/dart/damping") == "3"
    (material,) = root.findall("model/link/visual/material")
    assert material.findtext("lighting") == "true"
    assert material.findtext("diffuse") == "1 0 0 1"
    assert root.findtext("model/link/sensor/camera/image/width") == "64"
    assert root.find("model/plugin").get("filename") == "libp.so"
    assert root.findtext("model/plugin/speed") == "3"


def test_presets_of_physics_stay_beside_the_one_in_use():
    world, _ = world_of("""<physics name="slow" type="ode"><max_step_size>0.01</max_step_size>
        </physics><physics name="fast" type="ode" default="1"><ode><solver><type>world</type>
        <iters>70</iters></solver></ode></physics>""", "1.7")
    root = etree.fromstring(write_world(world))
    physics = {p.get("name"): p for p in root.findall("world/physics")}
    assert sorted(physics) == ["fast", "slow"]
    assert physics["fast"].findtext("ode/solver/iters") == "70"
    assert physics["fast"].findtext("ode/solver/type") == "world"
    copy, _ = parse_world(write_world(world), Resolver())
    assert copy.physics.name == "fast"


def test_a_namespace_whose_name_is_no_uri_stops_no_save():
    text = ("<sdf version='1.6'><model name='m'><link name='l'/>"
            "<x:a xmlns:x='http://www.ros.or3 0.39'>1</x:a>"
            "<y:b xmlns:y='http://good'>2</y:b></model></sdf>")
    model, _ = read_entity(text, Resolver())
    written = write_entity(model)
    again, _ = read_entity(written, Resolver())
    assert b"0.39" in written and written.count(b"http://good") == 1
    assert write_entity(again) == written


def test_an_undeclared_prefix_is_declared_once():
    text = '<scene><ignition:name>a</ignition:name><ambient>1 1 1 1</ambient></scene>'
    world, _ = parse_world(sdf(f'<world name="w">{text}</world>', "1.7"), Resolver())
    written_once = write_world(world)
    assert written_once.count(b"xmlns:ignition") == 1
    etree.fromstring(written_once)
    copy, _ = parse_world(written_once, Resolver())
    assert write_world(copy) == written_once


def test_names_and_texts_are_escaped():
    model = Model('a<b>&"c" é', static=True)
    assert again(model).name == model.name


def test_an_include_that_was_changed_is_written_in_full():
    world, _ = world_of('<include><uri>model://box</uri><name>mine</name></include>', "1.7",
                        Resolver.from_environment())
    bare = read_file(str(ROOT / "models/box/model.sdf"), Resolver())[0]
    include = etree.fromstring(write_world(world, included=lambda model: bare)).find(
        "world/include")
    assert include.findtext("uri") == "model://box" and include.findtext("name") == "mine"
    world.models[0].links[0].inertial = Inertial(99.0)
    root = etree.fromstring(write_world(world, included=lambda model: bare))
    assert root.find("world/include") is None
    assert root.findtext("world/model/link/inertial/mass") == "99"


def test_a_relative_mesh_becomes_a_path_and_a_model_uri_stays(tmp_path):
    (tmp_path / "part.stl").write_bytes((Path(VALID) / "cube.stl").read_bytes())
    box = "<geometry><mesh><uri>{}</uri></mesh></geometry>"
    uris = ("part.stl", f"model://{tmp_path.name}/part.stl")
    inside = "".join(f'<visual name="{n}">{box.format(uri)}</visual>'
                     for n, uri in enumerate(uris))
    path = tmp_path / "m.sdf"
    path.write_text(sdf(f'<model name="m"><static>1</static><link name="l">{inside}</link>'
                        "</model>", "1.7"))
    model, _ = read_file(str(path), Resolver([str(tmp_path.parent)]))
    found = [e.text for e in written(model).iter("uri")]
    assert found == [str(tmp_path / "part.stl"), uris[1]]


def test_a_gripper_is_read_with_its_line_and_written_once(tmp_path):
    path = tmp_path / "m.sdf"
    path.write_text(sdf("<model name='m'><link name='l'/>\n<gripper name='g'>"
                        "<palm_link>l</palm_link></gripper></model>", "1.7"))
    model, issues = read_file(str(path), Resolver([]))
    (gripper,) = model.plugins
    assert (gripper.name, gripper.line, issues) == ("g", 2, []) and not model.extra
    assert [one.findtext("palm_link") for one in written(model).iter("gripper")] == ["l"]


def test_every_part_of_a_table_has_a_writer():
    """What the reader has a reader for, the writer writes."""
    known = {name for name in dir(_Writer) if not name.startswith("_")} | {
        name.rpartition("write_")[2] for module in (surroundings_elements, entities,
                                                    state_element)
        for name in dir(module)}
    aside = {"include", "geometry", "xyz", "axis2", "plugin", "gripper",
             "population", "placement_frame", "screw_thread_pitch"}  # expanded or converted
    for table in tables():
        parts = {tag for tag, entry in table.children.items()
                 if isinstance(entry, Part) and not entry.kept}
        assert parts <= known | aside, table.name


def test_every_shape_has_a_writer():
    from typing import get_args

    from my_simulations.description.shapes import Geometry

    described = set(get_args(Geometry)) - {Polyline}
    assert set(tables_by_shape()) <= described | {Polyline}


def tables():
    return [value for value in vars(model_tables).values() if isinstance(value, Table)]


def test_the_tables_have_kept_elements_and_dataclasses():
    assert any(isinstance(e, Kept) for t in tables() for e in t.children.values())
    assert all(is_dataclass(t.of) for t in tables())
