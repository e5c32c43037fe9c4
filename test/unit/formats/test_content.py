"""The worlds, models, objects and launch files that the package ships."""
from __future__ import annotations

import importlib.util
import itertools
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

import content_reader as reader
import content_solids as solids
import numpy as np
import pytest
import trimesh

from my_simulations.description.shapes import Mesh
from my_simulations.formats.mesh.loading import load_mesh
from my_simulations.objects.object_list import parse_objects
from my_simulations.objects.selection import parse_groups, select
from my_simulations.objects.yaml_source import read_yaml

ROOT = reader.ROOT
WORLDS = sorted(ROOT.glob("world/**/*.world"))
MODELS = sorted(path.parent for path in ROOT.glob("models/*/model.config"))
OBJECTS = sorted(p for p in ROOT.glob("objects/*") if p.suffix in (".urdf", ".xacro"))
OBJECT_SDFS = sorted(ROOT.glob("objects/*.sdf"))
LAUNCHES = sorted(ROOT.glob("launch/*.launch"))
TOUCHING = 1e-6
ROBOT_X = {"shapes": -1.5}
"""Where the lab robot does not start at the origin: its x in metres (doc/lab_sheet.md)."""


def ids(paths):
    return [path.name for path in paths]


def check_inertia(body):
    """A dynamic body's mass properties are those of its collision shapes, evenly filled."""
    assert body.inertial is not None, body.name
    centre, inertia = solids.compound(body.solids, body.inertial.mass)
    np.testing.assert_allclose(np.array(body.inertial.pose.position), centre, atol=1e-4)
    np.testing.assert_allclose(reader.in_frame(body.inertial), inertia, rtol=1e-3,
                               atol=1e-3 * inertia.max())


@pytest.mark.parametrize("world", WORLDS, ids=ids(WORLDS))
def test_dynamic_bodies_of_a_world_have_the_inertia_of_their_shape(world):
    for body in reader.world_bodies(world):
        if not body.static:
            check_inertia(body)


@pytest.mark.parametrize("model", MODELS, ids=ids(MODELS))
def test_a_database_model_is_whole_and_has_the_inertia_of_its_shape(model):
    config = ElementTree.parse(model / "model.config").getroot()
    assert config.findtext("name") and config.findtext("description")
    root = ElementTree.parse(model / config.findtext("sdf")).getroot()
    assert root.tag == "sdf" and root.get("version") == config.find("sdf").get("version")
    (entity,) = root
    assert entity.get("name") == model.name
    if entity.tag == "model":
        for body in reader.model_bodies(entity, reader.sdf_pose(entity), model.name):
            assert body.static or body.inertial is not None
            if not body.static:
                check_inertia(body)


@pytest.mark.parametrize("path", [*OBJECTS, ROOT / "urdf" / "robo.urdf"],
                         ids=ids([*OBJECTS, ROOT / "urdf" / "robo.urdf"]))
def test_every_link_of_a_urdf_has_the_inertia_of_its_shape(path):
    for body in reader.urdf_bodies(path):
        if body.solids:
            check_inertia(body)


@pytest.mark.parametrize("path", OBJECT_SDFS, ids=ids(OBJECT_SDFS))
def test_every_link_of_an_sdf_object_has_the_inertia_of_its_shape(path):
    model = ElementTree.parse(path).getroot().find("model")
    for body in reader.model_bodies(model, reader.sdf_pose(model), path.stem):
        check_inertia(body)


@pytest.mark.parametrize("world", WORLDS, ids=ids(WORLDS))
def test_nothing_in_a_world_interpenetrates(world):
    bodies = reader.world_bodies(world)
    for one, other in itertools.combinations(bodies, 2):
        if one.static and other.static:
            continue
        for a, b in itertools.product(one.solids, other.solids):
            assert solids.overlap_depth(a, b) <= TOUCHING, (one.name, other.name)
    for body in bodies:
        for solid in body.solids:
            assert body.static or solids.bounds(solid)[0][2] >= -TOUCHING, body.name


@pytest.mark.parametrize("world", WORLDS, ids=ids(WORLDS))
def test_the_lab_robot_fits_at_its_place_in_a_world(world):
    place = np.array((ROBOT_X.get(world.stem, 0.0), 0.0, 0.0))
    low, high = place + (-0.2, -0.2, 0.0), place + (0.2, 0.2, 0.3)
    for body in reader.world_bodies(world):
        for solid in body.solids:
            lower, upper = solids.bounds(solid)
            assert (lower >= high).any() or (upper <= low).any(), body.name


def test_the_room_has_static_walls_with_a_door_a_table_and_three_dynamic_shapes():
    bodies = reader.world_bodies(ROOT / "world" / "lab_course.world")
    by_model = {body.name.split("::")[0]: body for body in bodies}
    assert by_model["room"].static and by_model["table"].static
    kinds = {name: by_model[name].solids[0].kind for name in ("box", "sphere", "cylinder")}
    assert kinds == {name: name for name in kinds}
    assert not any(by_model[name].static for name in kinds)
    # A person of 0.6 x 1.9 m walks through the opening in the south wall.
    person = solids.box((0.6, 2.0, 1.9), reader.Pose((0.0, -2.575, 0.95)))
    assert all(solids.overlap_depth(person, s) <= 0 for s in by_model["room"].solids)


def test_the_empty_world_is_the_lab_sheets():
    root = ElementTree.parse(ROOT / "world" / "empty_world.world").getroot()
    assert root.get("version") == "1.5"
    (world,) = root
    assert world.get("name") == "default"
    assert [e.findtext("uri") for e in world] == ["model://sun", "model://ground_plane"]


def test_the_plain_robot_is_what_xacro_makes_of_its_source():
    made = ElementTree.canonicalize(
        reader.xacro(ROOT / "urdf" / "robo.urdf.xacro").decode(), strip_text=True)
    plain = ElementTree.canonicalize(
        from_file=str(ROOT / "urdf" / "robo.urdf"), strip_text=True)
    assert plain == made.replace(' xmlns:xacro="http://www.ros.org/wiki/xacro"', "", 1)


def test_the_robot_stands_on_its_wheels_and_caster_when_spawned_at_zero():
    root = reader.urdf_root(ROOT / "urdf" / "robo.urdf")
    places = {"base_footprint": reader.IDENTITY}
    for joint in root.findall("joint"):
        parent = places[joint.find("parent").get("link")]
        places[joint.find("child").get("link")] = reader.compose(parent, reader.origin(joint))
    lowest = {}
    for link in root.findall("link"):
        for collision in link.findall("collision"):
            solid = reader.urdf_solid(collision.find("geometry")[0], reader.compose(
                places[link.get("name")], reader.origin(collision)))
            lowest[link.get("name")] = solids.bounds(solid)[0][2]
    assert lowest.pop("base_link") > 0.02
    assert lowest == pytest.approx(
        {"left_wheel": 0.0, "right_wheel": 0.0, "caster": 0.0}, abs=1e-9)


def test_the_meshes_are_what_their_script_writes():
    script = ROOT / "tools" / "generate" / "make_meshes.py"
    spec = importlib.util.spec_from_file_location("make_meshes", script)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    media = ROOT / "Media" / "models"
    written = {str(p.relative_to(media)): p.read_bytes() for p in media.rglob("*") if p.is_file()}
    made = module.files()
    assert set(written) == set(made)
    for name in made:
        if name.endswith(".dae"):
            assert written[name] == made[name], name


def generated_models():
    """Content by path below models/, from the descriptions in tools/generate/content."""
    folder = str(ROOT / "tools" / "generate")
    sys.path.insert(0, folder)
    try:
        return importlib.import_module("make_models").files()
    finally:
        sys.path.remove(folder)


def words(content):
    """Text between numbers, and the numbers."""
    text = content.decode()
    number = r"(?<![A-Za-z0-9_])-?[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?(?![A-Za-z0-9_])"
    return re.split(number, text), [float(found) for found in re.findall(number, text)]


@pytest.mark.parametrize("name, scale, size", [
    ("jersey_barrier", 1.0, (4.066, 0.812, 1.143)),
    ("speed_limit_sign", 10.0, (0.64, 0.28, 2.36)),
])
def test_a_mesh_that_worlds_saved_by_gazebo_name_has_the_size_that_they_expect(name, scale, size):
    path = ROOT / "models" / name / "meshes" / f"{name}.dae"
    mesh = load_mesh(Mesh(str(path), scale=(scale, scale, scale), path=str(path)))
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), size, atol=2e-3)


def test_the_models_are_what_their_descriptions_make():
    for path, made in generated_models().items():
        (text, numbers), (made_text, made_numbers) = map(
            words, ((ROOT / "models" / path).read_bytes(), made))
        assert text == made_text, path
        rounding = 0.011 if path.endswith(".dae") else 1e-6
        np.testing.assert_allclose(numbers, made_numbers, atol=rounding)


@pytest.mark.parametrize("mesh,size,unit,up_axis", [
    ("my_object.dae", (0.0762, 0.0762, 0.1905), 0.0254, "Y_UP"),
    ("lab_table.dae", (1.4, 0.7, 0.75), 1.0, "Z_UP")])
def test_a_mesh_is_closed_and_stands_upright_in_metres(mesh, size, unit, up_axis):
    path = ROOT / "Media" / "models" / mesh
    asset = ElementTree.parse(path).getroot().find(f"{reader.COLLADA}asset")
    assert float(asset.find(f"{reader.COLLADA}unit").get("meter")) == unit
    assert asset.findtext(f"{reader.COLLADA}up_axis") == up_axis
    data = load_mesh(Mesh(mesh, str(path)))
    made = trimesh.Trimesh(data.vertices, data.triangles, process=False)
    np.testing.assert_allclose(made.extents, size, atol=1e-9)
    assert data.vertices[:, 2].min() == 0.0
    assert made.is_watertight and made.is_winding_consistent and made.volume > 0


def test_a_texture_lies_in_the_folder_named_as_its_mesh():
    root = ElementTree.parse(ROOT / "Media" / "models" / "my_object.dae").getroot()
    image = root.findtext(f".//{reader.COLLADA}init_from")
    assert image == "my_object/carton.png"
    data = (ROOT / "Media" / "models" / image).read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n") and data.endswith(b"IEND\xaeB`\x82")


@pytest.mark.parametrize("world", WORLDS, ids=ids(WORLDS))
def test_every_world_has_a_sound_object_list_whose_files_exist(world):
    folder = ROOT / "config" / world.stem
    tree, source, warned = read_yaml(str(folder / "object_locations.yaml"), "/objects")
    listing = parse_objects(tree, source)
    assert warned == [] and listing.issues() == []
    assert "MY_OBJECT" in listing.objects
    for placed in listing.objects.values():
        assert placed.file.package == "my_simulations"
        assert (ROOT / placed.file.path).is_file(), placed.file.path
    tree, source, warned = read_yaml(str(folder / "object_groups.yaml"), "/object_groups")
    groups, faults = parse_groups(tree, source)
    assert groups and warned == [] and faults == []
    assert select(list(groups), listing, groups).issues == []


def placed_solids(placed):
    """The object's collision solids where the list puts it."""
    pose = reader.Pose(placed.position, reader.pose_from_xyzrpy(0, 0, 0, *placed.rpy).orientation)
    path = ROOT / placed.file.path
    if path.suffix == ".sdf":
        model = ElementTree.parse(path).getroot().find("model")
        return [s for b in reader.model_bodies(model, pose, placed.name) for s in b.solids]
    (link,) = reader.urdf_root(path).findall("link")
    return [reader.urdf_solid(c.find("geometry")[0], reader.compose(pose, reader.origin(c)))
            for c in link.findall("collision")]


@pytest.mark.parametrize("world", WORLDS, ids=ids(WORLDS))
def test_the_objects_of_a_list_stand_free_of_each_other_and_of_the_world(world):
    tree, source, _ = read_yaml(
        str(ROOT / "config" / world.stem / "object_locations.yaml"), "/objects")
    listing = parse_objects(tree, source)
    groups = [(b.name, b.solids) for b in reader.world_bodies(world)]
    groups += [(p.name, placed_solids(p)) for p in listing.objects.values()]
    for (one, some), (other, more) in itertools.combinations(groups, 2):
        if "::" in one and "::" in other:
            continue
        for a, b in itertools.product(some, more):
            assert solids.overlap_depth(a, b) <= TOUCHING, (one, other)
    for name, found in groups:
        assert all(solids.bounds(s)[0][2] >= -TOUCHING for s in found), name


@pytest.mark.parametrize("launch", LAUNCHES, ids=ids(LAUNCHES))
def test_a_launch_file_refers_to_files_that_exist(launch):
    text = launch.read_text(encoding="utf-8")
    ElementTree.fromstring(text)
    for inside in re.findall(r"\$\(find my_simulations\)/([\w./-]+)", text):
        assert os.path.exists(ROOT / inside), inside


def test_the_empty_world_and_its_object_list_exist_once():
    for name, same in (("world/worlds/empty.world", "world/empty_world.world"),
                       ("config/empty/object_locations.yaml",
                        "config/empty_world/object_locations.yaml"),
                       ("config/empty/object_groups.yaml",
                        "config/empty_world/object_groups.yaml")):
        assert (ROOT / name).resolve() == (ROOT / same).resolve() != ROOT / name


def test_my_world_has_the_lab_sheets_arguments_and_passes_them_on():
    root = ElementTree.parse(ROOT / "launch" / "my_world.launch").getroot()
    assert {arg.get("name"): arg.get("default") for arg in root.findall("arg")} == {
        "debug": "false", "gui": "true", "pause": "false",
        "world": "$(find my_simulations)/world/empty_world.world", "robot": "true",
        "x": "0", "y": "0", "z": "0"}
    sheet = root.find("include[@file='$(find gazebo_ros)/launch/empty_world.launch']")
    assert {arg.get("name"): arg.get("value") for arg in sheet} == {
        "world_name": "$(arg world)", "debug": "$(arg debug)", "gui": "$(arg gui)",
        "paused": "$(arg pause)", "use_sim_time": "true", "extensions": "true"}
    params = {p.get("name"): p.get("value") or p.get("command") for p in root.findall("param")}
    assert params["robot_description"] == "cat '$(find my_simulations)/urdf/robo.urdf'"
    assert params["gazebo/spawn_robot"] == "$(arg robot)"
    assert [params[f"gazebo/robot_{axis}"] for axis in "xyz"] == [
        "$(arg x)", "$(arg y)", "$(arg z)"]
