"""Documents whose models exceed the limits are refused with file and line, without their meshes."""
from __future__ import annotations

import struct

import pytest

from my_simulations.description import advice, cost_budget
from my_simulations.description.cost_budget import MODEL_BUDGET, Cost
from my_simulations.errors import InputError, errors_of
from my_simulations.formats import reading
from my_simulations.formats.mesh.loading import collision_meshes
from my_simulations.formats.reading import parse_document, read_entity, read_world_text
from my_simulations.formats.sdf import include, model
from my_simulations.formats.sdf import world as sdf_world
from my_simulations.formats.sdf.link import LinkReader
from my_simulations.formats.urdf import robot
from my_simulations.resources.resolver import Resolver

BOX = "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>"


def errors(text, resolver=None):
    try:
        _, issues = read_entity(text, resolver or Resolver(), "a.sdf")
    except InputError as fault:
        issues = fault.issues
    return errors_of(issues)


@pytest.mark.parametrize("links", ["<link name='l{}'/>" * (MODEL_BUDGET.links + 1),
                                   f"<link name='l{{}}'>{BOX}</link>" * 500])
def test_too_many_links_or_pairs_are_refused_with_the_line_of_the_model(links):
    count = links.count("{}")
    text = ("<sdf version='1.7'>\n<model name='m'>" + links.format(*range(count))
            + "</model></sdf>")
    (issue,) = errors(text)
    assert (issue.code, issue.file, issue.line) == ("model-too-large", "a.sdf", 2)
    assert issue.xpath == "/sdf/model"


@pytest.mark.parametrize("place", ["{}", "<world name='w'>{}</world>"])
@pytest.mark.parametrize("depth", [1, 40])
def test_too_many_nested_models_are_refused_before_they_are_read(monkeypatch, depth, place):
    read = []
    monkeypatch.setattr(LinkReader, "read_all", lambda *_: read.append(1) or [])
    inner = "<model name='i'>" * depth + "<link name='l'/>" + "</model>" * depth
    text = ("<sdf version='1.7'>\n" + place.format(
        "<model name='m'><link name='l'/>" + inner * (MODEL_BUDGET.links // depth + 1)
        + "</model>") + "</sdf>")
    issues = (errors_of(read_world_text(text, Resolver(), "a.sdf").issues) if "world" in text
              else errors(text))
    assert [(one.code, one.file, one.line) for one in issues] == [("model-too-large", "a.sdf", 2)]
    assert len(read) == 1


def test_nested_models_of_a_document_are_limited(monkeypatch):
    monkeypatch.setattr(model, "MOST_NESTED_OF_ALL", 5)
    one = "<model name='{}'>" + "<model name='i'><link name='l'/></model>" * 2 + "</model>\n"
    loaded = read_world_text("<sdf version='1.7'><world name='w'>\n"
                             + "".join(one.format(name) for name in "abcd") + "</world></sdf>",
                             Resolver(), "a.sdf")
    assert [one.name for one in loaded.world.models] == ["a", "b"]
    assert [(one.code, one.line) for one in errors_of(loaded.issues)] == [
        ("model-too-large", 4), ("model-too-large", 5)]


def test_a_robot_is_limited_too():
    shapes = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
    mass = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>"
    text = (f"<robot name='r'>\n<link name='l'>{mass}{shapes * (MODEL_BUDGET.shapes + 1)}</link>"
            "</robot>")
    assert "model-too-large" in [issue.code for issue in errors(text)]


def test_only_the_model_that_is_too_large_is_left_out_of_a_world():
    large = "".join(f"<link name='l{n}'/>" for n in range(MODEL_BUDGET.links + 1))
    loaded = read_world_text(
        f"<sdf version='1.7'><world name='w'><model name='a'>{large}</model>"
        "<model name='b'><link name='l'/></model></world></sdf>", Resolver())
    assert [model.name for model in loaded.world.models] == ["b"]
    assert [issue.code for issue in errors_of(loaded.issues)] == ["model-too-large"]


def test_models_after_the_limit_of_the_world_are_not_read(monkeypatch):
    monkeypatch.setattr(cost_budget, "WORLD_BUDGET", Cost(links=3, shapes=99, triangles=99))
    models = "\n".join(f"<model name='m{n}'><link name='l'/></model>" for n in range(9))
    loaded = read_world_text(f"<sdf version='1.7'><world name='w'>\n{models}"
                             "<light name='sun' type='point'/></world></sdf>", Resolver())
    assert [model.name for model in loaded.world.models] == ["m0", "m1", "m2"]
    assert [light.name for light in loaded.world.lights] == ["sun"]
    (issue,) = errors_of(loaded.issues)
    assert (issue.code, issue.line) == ("world-too-large", 5)


@pytest.mark.parametrize("faulty", ["<model name='m0'><link name='l'/></model>",
                                    "<model name='e'><link/></model>"])
def test_models_after_many_unusable_ones_are_not_read(monkeypatch, faulty):
    monkeypatch.setattr(sdf_world, "MOST_UNUSABLE", 3)
    good = "<model name='{}'><link name='l'/></model>"
    loaded = read_world_text(
        f"<sdf version='1.7'><world name='w'>{good.format('m0')}{faulty * 3}{good.format('m1')}\n"
        f"{faulty}{good.format('m2')}</world></sdf>", Resolver())
    assert [model.name for model in loaded.world.models] == ["m0", "m1"]
    found = [issue for issue in errors_of(loaded.issues) if issue.code == "world-too-large"]
    assert [issue.line for issue in found] == [2]


def test_a_robot_of_very_many_links_is_refused_before_they_are_read(monkeypatch):
    monkeypatch.setattr(robot, "MOST_LINKS", 3)
    monkeypatch.setattr(robot, "read_body", None)
    links = "\n".join(f"<link name='l{n}'/>" for n in range(4))
    (issue,) = errors(f"<robot name='r'>{links}</robot>")
    assert (issue.code, issue.line) == ("model-too-large", 4)


def test_the_search_for_overlaps_is_bounded(monkeypatch):
    monkeypatch.setattr(advice, "MOST_OVERLAPS", 5)
    models = "".join(f"<model name='m{n}'><link name='l'>{BOX}</link></model>" for n in range(30))
    text = f"<sdf version='1.7'><world name='w'>{models}</world></sdf>"
    found = read_world_text(text, Resolver(), advice_limit=None).issues
    # Of the first body, with each of the others; later ones are not compared.
    inside = [issue.message for issue in found if issue.code == "starts-inside"]
    assert len(inside) == 29 and "starts 1 m or more inside" in inside[0], inside[0]
    monkeypatch.setattr(advice, "MOST_COMPARED", 0)
    found = read_world_text(text, Resolver(), advice_limit=None).issues
    assert "starts-inside" not in [issue.code for issue in found]


def stl(path, count):
    path.write_bytes(bytes(80) + struct.pack("<I", count)
                     + struct.pack("<12fH", *[0] * 3, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0) * count)
    return (f"<link name='{path.stem}'>\n<collision name='c'><geometry><mesh><uri>{path}</uri>"
            "</mesh></geometry></collision></link>")


def test_triangles_are_limited_over_all_meshes_and_the_rest_is_not_loaded(tmp_path, monkeypatch):
    monkeypatch.setattr(cost_budget, "MODEL_BUDGET", Cost(99, 99, triangles=10))
    loaded = []
    from my_simulations.formats.mesh import loading
    load = loading.load_solid
    monkeypatch.setattr(loading, "load_solid",
                        lambda solid: loaded.append(solid.path) or load(solid))
    inner = "".join(f"<model name='m{n}'>{stl(tmp_path / f'f{n}.stl', 6)}</model>"
                    for n in range(4))
    document = parse_document(f"<sdf version='1.7'><model name='a'><static>1</static>{inner}"
                              "</model></sdf>", Resolver(), "a.sdf")
    model, _ = document.read_entity()
    _, issues = collision_meshes(model, document.written("a"))
    assert [path[-6:] for path in loaded] == ["f0.stl", "f1.stl"]
    (issue,) = errors_of(issues)
    assert (issue.code, issue.file, issue.line) == ("model-too-large", "a.sdf", 3)
    assert issue.xpath == "/sdf/model/model[2]/link/collision"


def folders(tmp_path, depth):
    for n in range(depth):
        (tmp_path / f"n{n}").mkdir()
        inner = "".join(f"<include><uri>model://n{n + 1}</uri><name>i{k}</name></include>"
                        for k in range(2)) if n + 1 < depth else "<link name='l'/>"
        (tmp_path / f"n{n}" / "model.config").write_text(
            f"<model><name>n{n}</name><sdf version='1.7'>model.sdf</sdf></model>")
        (tmp_path / f"n{n}" / "model.sdf").write_text(
            f"<sdf version='1.7'><model name='n{n}'>{inner}</model></sdf>")
    return Resolver(model_paths=[str(tmp_path)])


def test_includes_that_multiply_end_at_the_limit_of_one_model(tmp_path, monkeypatch):
    monkeypatch.setattr(include, "_MOST", 20)
    followed = []
    root = include._root
    monkeypatch.setattr(include, "_root", lambda *a: followed.append(a[0]) or root(*a))
    (issue,) = errors("<sdf version='1.7'><include><uri>model://n0</uri></include></sdf>",
                      folders(tmp_path, 7))
    assert issue.code == "include-many" and len(followed) == 20


def test_includes_of_each_model_count_separately(tmp_path, monkeypatch):
    monkeypatch.setattr(include, "_MOST", 8)
    resolver = folders(tmp_path, 3)
    each = "<include><uri>model://n0</uri><name>i{0}</name></include>"
    own = "<model name='m{0}'>" + each + "</model>"
    loaded = reading.read_world_text(
        "<sdf version='1.7'><world name='w'>"
        + "".join((each + own).format(n) for n in range(5)) + "</world></sdf>", resolver)
    assert len(loaded.world.models) == 10 and not errors_of(loaded.issues)
