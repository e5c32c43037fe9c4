"""What the model editor makes: links, joints, inertia, nested models, plugins, saved folders."""
from __future__ import annotations

import math
import os

import pytest
from editor_case import Refused, arm, box, cases

from my_simulations.description.shapes import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Mesh,
    Plane,
    Sphere,
)
from my_simulations.editor.editing.part_inertia import inertial_of
from my_simulations.errors import CommandError
from my_simulations.formats.reading import read_file
from my_simulations.formats.sdf.writer.entities import write_world
from my_simulations.geometry import STILL, Pose
from my_simulations.resources.resolver import Resolver

case = pytest.fixture(cases)


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def at(x, y, z):
    return [x, y, z, 0, 0, 0, 1]


def test_the_first_link_begins_a_model_on_the_ground_below_it(case):
    async def build(browser):
        reply = await browser.edit("add_link", shape="box", pose=at(1, 2, 0.5))
        assert reply["name"] == "untitled::link_0"
        await browser.until(lambda: browser.model("untitled"))
        model = browser.model("untitled")
        assert model["pose"][:3] == [1, 2, 0]
        assert model["links"][0]["pose"][:3] == [0, 0, 0.5]
        assert model["links"][0]["inertial"]["ixx"] == pytest.approx(1 / 6)

    case().browse(build)


def test_further_links_lie_where_they_were_put_in_the_world(case):
    made = case(arm("arm"))
    made.sim.states.set_model_state("arm", Pose((5.0, 0.0, 0.0)), STILL)

    async def build(browser):
        reply = await browser.edit("add_link", model="arm", shape="sphere", pose=at(6, 1, 2))
        assert reply["name"] == "arm::link_0"
        link = made.sim.models.get("arm").links[-1]
        assert link.pose.position == pytest.approx((1, 1, 2))
        assert link.collisions[0].geometry == Sphere(0.5)

    made.browse(build)


@pytest.mark.parametrize("kind, axes", [("revolute", 1), ("prismatic", 1), ("screw", 1),
                                        ("revolute2", 2), ("universal", 2), ("ball", 0),
                                        ("fixed", 0)])
def test_joints_have_the_axes_of_their_type(case, kind, axes):
    made = case(arm("arm"))

    async def build(browser):
        await browser.edit("remove_part", target="arm::hinge")
        reply = await browser.edit("add_joint", model="arm",
                                   joint={"type": kind, "parent": "base", "child": "tip"})
        assert reply["name"] == "arm::tip_joint"
        [joint] = made.sim.models.get("arm").joints
        assert [joint.axis is not None, joint.axis2 is not None] == [axes > 0, axes > 1]
        await browser.edit("edit_joint", joint="arm::tip_joint", values={"type": "fixed"})
        [joint] = made.sim.models.get("arm").joints
        assert joint.axis is None and joint.axis2 is None

    made.browse(build)


def test_a_gearbox_takes_the_link_in_which_both_ends_turn_as_reference(case):
    made = case(arm("arm"))

    async def build(browser):
        await browser.edit("add_link", model="arm", shape="box", pose=at(0, 0, 2))
        await browser.edit("add_joint", model="arm", joint={
            "type": "revolute", "parent": "base", "child": "link_0"})
        await browser.edit("add_joint", model="arm", joint={
            "type": "gearbox", "parent": "tip", "child": "link_0"})
        gearbox = made.sim.models.get("arm").joints[-1]
        assert gearbox.gearbox_reference == "base"

    made.browse(build)


def test_what_refers_to_a_renamed_link_follows(case):
    made = case(arm("arm"))

    async def build(browser):
        await browser.edit("rename_link", link="arm::tip", to="hand")
        assert made.sim.models.get("arm").joints[0].child == "hand"

    made.browse(build)


def test_a_copied_link_has_all_but_the_name_and_the_place(case):
    made = case(arm("arm"))

    async def build(browser):
        for place in (at(0, 0, 2), at(0, 0, 3)):
            reply = await browser.edit("copy_link", link="arm::tip", pose=place)
        assert reply["name"] == "arm::tip_clone_0"
        links = made.sim.models.get("arm").links
        assert [link.name for link in links] == ["base", "tip", "tip_clone", "tip_clone_0"]
        assert links[3].pose.position[2] == 3.0
        assert links[3].collisions == links[1].collisions and links[3].inertial == links[1].inertial

    made.browse(build)


def test_joints_go_with_their_link(case):
    made = case(arm("arm"))

    async def build(browser):
        await browser.edit("remove_part", target="arm::tip")
        model = made.sim.models.get("arm")
        assert [link.name for link in model.links] == ["base"] and not model.joints

    made.browse(build)


def test_a_nested_model_keeps_its_names_below_its_own(case):
    made = case(box("a"))

    async def build(browser):
        await browser.edit("add_model", model="a", uri="model://table", pose=at(2, 0, 0))
        await browser.edit("add_model", model="a", uri="model://table", pose=at(4, 0, 0))
        names = [link.name for link in made.sim.models.get("a").links]
        assert names == ["link", "table::link", "table_0::link"]
        await browser.edit("remove_part", target="a::table")
        assert [link.name for link in made.sim.models.get("a").links] == ["link", "table_0::link"]

    made.browse(build)


def test_plugins_are_stored_as_they_were_written(case):
    made = case(box("a"))
    text = ('<plugin name="one" filename="libone.so"><rate>5</rate></plugin>\n'
            '<plugin name="two" filename="libtwo.so"/>')

    async def build(browser):
        await browser.edit("set_plugins", model="a", text=text)
        plugins = made.sim.models.get("a").plugins
        assert [(one.name, one.filename) for one in plugins] == [
            ("one", "libone.so"), ("two", "libtwo.so")]
        assert "<rate>5</rate>" in plugins[0].xml
        with pytest.raises(Refused, match="'one'"):
            await browser.edit("set_plugins", model="a", text=text.replace("two", "one"))
        await browser.edit("set_plugins", model="a", text="")
        assert made.sim.models.get("a").plugins == []

    made.browse(build)


def test_plugins_of_the_world_come_as_a_change_of_it_alone_and_are_saved(case):
    made = case(box("a"))

    async def build(browser):
        browser.pushes.clear()
        await browser.edit("set_plugins", model="", text='<plugin name="w" filename="libw.so">'
                                                         '<force>2</force></plugin>')
        assert browser.last("world") is None
        assert [one["name"] for one in browser.last("change")["world"]["plugins"]] == ["w"]
        assert list(browser.last("change")) == ["type", "revision", "world"]
        assert [one.filename for one in made.sim.world.plugins] == ["libw.so"]
        assert "<force>2</force>" in write_world(made.sim.world).decode()
        with pytest.raises(Refused, match="<plugin> elements only"):
            await browser.edit("set_plugins", model="", text="<light name='l'/>")

    made.browse(build)


SOLIDS = [
    (Box((1.0, 2.0, 3.0)), 6.0, (13 / 12 * 6, 10 / 12 * 6, 5 / 12 * 6)),
    (Sphere(0.5), math.pi / 6, (math.pi / 60,) * 3),
    (Ellipsoid((0.5, 0.5, 0.5)), math.pi / 6, (math.pi / 60,) * 3),
    (Cylinder(1.0, 2.0), 2 * math.pi, (7 / 12 * 2 * math.pi, 7 / 12 * 2 * math.pi, math.pi)),
]


@pytest.mark.parametrize("shape, volume, moments", SOLIDS)
def test_solids_have_the_inertia_of_the_formulas(shape, volume, moments):
    found = inertial_of([Collision("c", shape)], density=1.0)
    assert found.mass == pytest.approx(volume)
    assert (found.ixx, found.iyy, found.izz) == pytest.approx(moments)


@pytest.mark.parametrize("shape, make", [
    (Capsule(0.3, 1.2), lambda made: made.capsule(height=1.2, radius=0.3, count=[64, 64])),
    (Cone(0.4, 0.9), lambda made: made.cone(radius=0.4, height=0.9, sections=128)),
])
def test_capsules_and_cones_have_the_inertia_of_their_triangles(shape, make, tmp_path):
    import trimesh

    mesh = make(trimesh.creation)
    mesh.apply_translation(-mesh.bounds.mean(axis=0))  # as SDF: half-way up
    path = tmp_path / "solid.stl"
    path.write_bytes(mesh.export(file_type="stl"))
    exact = inertial_of([Collision("c", shape)], density=1.0)
    faceted = inertial_of([Collision("c", Mesh(uri="solid.stl", path=str(path)))], density=1.0)
    for one in ("mass", "ixx", "iyy", "izz"):
        assert getattr(exact, one) == pytest.approx(getattr(faceted, one), rel=0.01)
    assert exact.pose.position == pytest.approx(faceted.pose.position, abs=1e-3)


def test_several_shapes_count_together():
    two = [Collision("a", Box((1.0, 1.0, 1.0)), Pose((0.0, 0.0, 1.0))),
           Collision("b", Box((1.0, 1.0, 1.0)), Pose((0.0, 0.0, -1.0))), Collision("c", Plane())]
    found = inertial_of(two, mass=2.0)
    assert found.mass == pytest.approx(2.0)
    assert found.pose.position == pytest.approx((0, 0, 0))
    assert found.ixx == pytest.approx(2 * (1 / 6 + 1.0))
    assert found.izz == pytest.approx(2 / 6)


def test_what_has_no_volume_has_no_inertia():
    with pytest.raises(CommandError, match="no collision"):
        inertial_of([Collision("c", Plane())])


def test_a_saved_model_is_read_back_as_it_was_built(case, home):
    made = case()

    async def build(browser):
        await browser.edit("add_link", shape="box", pose=at(3, 1, 0.5))
        await browser.edit("add_link", model="untitled", shape="cylinder", pose=at(3, 2, 0.5))
        await browser.edit("add_joint", model="untitled",
                           joint={"type": "revolute", "parent": "link_0", "child": "link_1"})
        reply = await browser.ask("save_model", model="untitled", name="cart",
                                  about={"version": "2.0", "author": "A. Person", "email": "",
                                         "description": "A <cart> & more"})
        assert reply["uri"] == "model://cart"
        with pytest.raises(Refused) as refused:
            await browser.ask("save_model", model="untitled", name="cart")
        assert refused.value.code == "exists"
        await browser.ask("save_model", model="untitled", name="cart", overwrite=True)

    made.browse(build)
    folder = home / ".gazebo" / "models" / "cart"
    assert sorted(os.listdir(folder)) == ["model.config", "model.sdf"]
    model, issues = read_file(str(folder / "model.sdf"), Resolver.from_environment())
    assert issues == []
    assert model.name == "cart"
    assert model.pose.position == (0.0, 0.0, 0.0)
    built = made.sim.models.get("untitled")
    assert (model.links, model.joints) == (built.links, built.joints)


def test_a_saved_model_with_a_mesh_finds_it_from_anywhere(case, home):
    import trimesh

    meshes = home / ".gazebo" / "models" / "ball" / "meshes"
    meshes.mkdir(parents=True)
    (meshes / "ball.stl").write_bytes(trimesh.creation.icosphere().export(file_type="stl"))
    made = case()

    async def build(browser):
        await browser.edit("add_link", uri="model://ball/meshes/ball.stl", pose=at(0, 0, 1))
        await browser.ask("save_model", model="untitled", name="ball", overwrite=True)

    made.browse(build)
    assert (meshes / "ball.stl").is_file()
    text = (home / ".gazebo" / "models" / "ball" / "model.sdf").read_text()
    assert "model://ball/meshes/ball.stl" in text and str(home) not in text


@pytest.mark.parametrize("name", ["", "../up", "a/b", ".hidden"])
def test_names_that_are_no_folder_names_are_refused(case, name):
    async def save(browser):
        with pytest.raises(Refused):
            await browser.ask("save_model", model="a", name=name)

    case(box("a")).browse(save)
