"""What a page does to the world: each operation, its undo and redo, and what is refused."""
from __future__ import annotations

import asyncio
from dataclasses import replace

import pytest
from editor_case import Refused, arm, box, cases, sun

from my_simulations.description.compare import differences
from my_simulations.description.model_group import group_of
from my_simulations.engine.timed_forces import JointPid
from my_simulations.formats.reading import parse_world
from my_simulations.formats.sdf.writer.entities import write_world
from my_simulations.geometry import STILL, Pose
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.joint_gains import default_gains

case = pytest.fixture(cases)


def state(sim):
    """Descriptions and poses of everything."""
    return (
        {
            name: (sim.models.get(name), sim.states.model_state(name)[0])
            for name in sim.models.names()
        },
        {light.name: light for light in sim.lights.all()},
        sim.physics.settings,
        sim.physics.gravity,
        {
            name: getattr(sim.world, name)
            for name in (
                "scene",
                "gui_camera",
                "wind",
                "atmosphere",
                "magnetic_field",
                "spherical_coordinates",
                "plugins",
            )
        },
    )


def same(a, b):
    assert list(sorted(a[0])) == list(sorted(b[0]))
    for name in a[0]:
        assert not differences(a[0][name], b[0][name], 1e-12)
    assert not differences(list(a[1:2]), list(b[1:2]))
    assert a[2:] == b[2:]


POSE = [1.0, 2.0, 3.0, 0.0, 0.0, 0.7071067811865476, 0.7071067811865476]

EDITS = {
    "insert a shape": {"kind": "insert", "shape": "cylinder", "pose": POSE},
    "insert scaled": {"kind": "insert", "shape": "box", "scale": [2, 1, 1]},
    "insert from the library": {"kind": "insert", "uri": "model://table", "pose": POSE},
    "insert text": {"kind": "insert", "sdf": "<sdf version='1.7'><model name='t'><static>1</static>"
                                             "<link name='l'/></model></sdf>"},
    "insert a light": {"kind": "insert_light", "light": {"type": "spot", "pose": POSE}},
    "delete several": {"kind": "delete", "names": ["a", "arm", "sun"]},
    "move": {"kind": "move", "poses": {"a": POSE, "sun": POSE, "arm": POSE}, "label": "align"},
    "scale": {"kind": "scale", "name": "a", "scale": [2.0, 1.0, 3.0]},
    "rename a model": {"kind": "rename", "name": "a", "to": "crate"},
    "rename a light": {"kind": "rename", "name": "sun", "to": "moon"},
    "set a mass": {"kind": "set", "target": "a::link", "path": "inertial.mass", "value": 5.0},
    "set a size": {"kind": "set", "target": "a::link::collision", "path": "geometry.size",
                   "value": [1, 2, 3]},
    "set a shape": {"kind": "set", "target": "a::link::visual", "path": "geometry",
                    "value": {"type": "sphere", "radius": 2}},
    "set friction": {"kind": "set", "target": "a::link::collision", "path": "surface.mu",
                     "value": 0.1},
    "set a colour": {"kind": "set", "target": "a::link::visual", "path": "material.diffuse",
                     "value": [1, 0, 0, 1]},
    "set a material": {"kind": "set", "target": "a::link::visual", "path": "material.name",
                       "value": "Gazebo/Red"},
    "set static": {"kind": "set", "target": "a", "path": "static", "value": True},
    "set wind on": {"kind": "set", "target": "a", "path": "enable_wind", "value": True},
    "set a pose": {"kind": "set", "target": "a", "path": "pose", "value": POSE},
    "set a light": {"kind": "set", "target": "sun", "path": "range", "value": 3},
    "set a limit": {"kind": "set", "target": "arm::hinge", "path": "axis.upper", "value": 0.5},
    "set an axis": {"kind": "set", "target": "arm::hinge", "path": "axis.xyz",
                    "value": [1, 0, 0]},
    "set gravity": {"kind": "set", "target": "", "path": "gravity", "value": [0, 0, -1.6]},
    "set the solver": {"kind": "set", "target": "", "path": "physics.ode.iters", "value": 20},
    "set fog": {"kind": "set", "target": "", "path": "scene.fog.density", "value": 0.1},
    "set the sky": {"kind": "set", "target": "", "path": "scene.sky", "value": {"time": 8}},
    "set the camera": {"kind": "set", "target": "", "path": "gui_camera.pose", "value": POSE},
    "set the wind": {"kind": "set", "target": "", "path": "wind.linear_velocity",
                     "value": [1, 0, 0]},
    "drive a joint": {"kind": "joint", "joint": "arm::hinge", "mode": "force", "value": 2.0},
    "drive a joint to": {"kind": "joint", "joint": "arm::hinge", "mode": "position", "value": 0.3},
    "turn a joint": {"kind": "joint", "joint": "arm::hinge", "mode": "velocity", "value": 1.0,
                     "gains": {"p": 9}},
    "begin a model": {"kind": "add_link", "shape": "capsule", "pose": POSE},
    "add a link": {"kind": "add_link", "model": "arm", "shape": "cylinder", "pose": POSE},
    "add an outline": {"kind": "add_link", "model": "arm", "polyline": {
        "loops": [[[0, 0], [1, 0], [1, 1]], [[0.6, 0.2], [0.8, 0.2], [0.8, 0.4]]], "height": 0.1}},
    "add a collision": {"kind": "add_shape", "link": "a::link", "part": "collision",
                        "shape": "cone"},
    "copy a link": {"kind": "copy_link", "link": "arm::tip", "pose": POSE},
    "rename a link": {"kind": "rename_link", "link": "arm::tip", "to": "hand"},
    "add a joint": {"kind": "add_joint", "model": "arm", "joint": {
        "type": "fixed", "parent": "world", "child": "base"}},
    "edit a joint": {"kind": "edit_joint", "joint": "arm::hinge", "values": {
        "name": "slider", "type": "prismatic", "pose": POSE}},
    "nest a model": {"kind": "add_model", "model": "arm", "uri": "model://table", "pose": POSE},
    "set plugins": {"kind": "set_plugins", "model": "arm",
                    "text": "<plugin name='p' filename='libnone.so'><rate>5</rate></plugin>"},
    "set plugins of the world": {"kind": "set_plugins", "model": "",
                                 "text": "<plugin name='p' filename='libnone.so'/>"},
    "add a sensor": {"kind": "add_sensor", "link": "arm::tip", "sensor": "camera"},
    "remove a link": {"kind": "remove_part", "target": "arm::tip"},
    "remove a joint": {"kind": "remove_part", "target": "arm::hinge"},
    "remove a visual": {"kind": "remove_part", "target": "a::link::visual:visual"},
    "compute inertia": {"kind": "compute_inertial", "target": "a::link", "density": 500},
    "group models": {"kind": "set_group", "names": ["a", "arm"]},
    "group a light": {"kind": "set_group", "names": ["a", "sun"]},
    "reset poses": {"kind": "reset", "what": "poses"},
    "reset the world": {"kind": "reset", "what": "world"},
    "several as one": {"kind": "group", "label": "Two things", "ops": [
        {"kind": "insert", "shape": "box"}, {"kind": "rename", "name": "unit_box", "to": "b"}]},
}


@pytest.mark.parametrize("op", EDITS.values(), ids=[name.replace(" ", "_") for name in EDITS])
def test_an_edit_is_one_step_that_can_be_undone_and_done_again(case, op):
    made = case(box("a"), arm("arm"), lights=[sun()])
    made.sim.states.set_model_state("a", Pose((0.0, 5.0, 0.5)), STILL)

    async def edit(browser):
        before = state(made.sim), made.sim.joints.states("arm::hinge")
        await browser.ask("edit", op=op)
        after = state(made.sim)
        labels = browser.last("history")["undo"]
        assert len(labels) == 1 and labels[0]
        assert browser.last("history")["dirty"]
        await browser.ask("undo")
        same(state(made.sim), before[0])
        assert made.sim.joints.states("arm::hinge") == before[1]
        assert browser.last("history")["undo"] == []
        assert not browser.last("history")["dirty"]
        await browser.ask("redo")
        same(state(made.sim), after)
        # What the page was told is what a page that comes now is told.
        await browser.until(lambda: {one["name"] for one in browser.document["models"]}
                            == set(made.sim.models.names()))

    made.browse(edit)


@pytest.mark.parametrize("request_and_fields", (
    ("edit", {"op": {"kind": "compute_inertial", "target": "a::link", "density": 500}}),
    ("undo", {}), ("redo", {})), ids=lambda one: one[0])
def test_the_change_of_the_world_comes_before_the_history_and_the_reply(case, request_and_fields):
    made = case(box("a"))
    kind, fields = request_and_fields

    async def edit(browser):
        if kind != "edit":
            await browser.edit("rename", name="a", to="b")
        if kind == "redo":
            await browser.ask("undo")
        browser.pushes.clear()
        await browser.ask(kind, **fields)
        told = [push["type"] for push in browser.pushes if push["type"] in ("change", "history")]
        assert told == ["change", "history"]

    made.browse(edit)


REFUSED = {
    "unknown_model": {"kind": "delete", "names": ["a", "nix"]},
    "nothing_to_delete": {"kind": "delete", "names": []},
    "taken_name": {"kind": "rename", "name": "a", "to": "arm"},
    "empty_name": {"kind": "rename", "name": "a", "to": " "},
    "scoped_name": {"kind": "rename", "name": "a", "to": "x::y"},
    "joint_to_nowhere": {"kind": "add_joint", "model": "arm", "joint": {
        "type": "fixed", "parent": "nix", "child": "tip"}},
    "joint_to_itself": {"kind": "add_joint", "model": "arm", "joint": {
        "type": "revolute", "parent": "tip", "child": "tip"}},
    "gearbox_without_a_third_link": {"kind": "add_joint", "model": "arm", "joint": {
        "type": "gearbox", "parent": "base", "child": "tip"}},
    "taken_link_name": {"kind": "rename_link", "link": "arm::tip", "to": "hinge"},
    "only_link": {"kind": "remove_part", "target": "a::link"},
    "unknown_part": {"kind": "remove_part", "target": "arm::nix"},
    "mesh_that_is_not_there": {"kind": "add_link", "uri": "model://nix/meshes/nix.dae"},
    "shape_and_mesh": {"kind": "add_link", "uri": "model://a/b.dae", "shape": "box"},
    "plugins_with_links": {"kind": "set_plugins", "model": "a", "text": "<link name='x'/>"},
    "plugins_that_are_no_xml": {"kind": "set_plugins", "model": "a", "text": "<plugin"},
    "inertia_of_nothing": {"kind": "compute_inertial", "target": "a::link", "density": 0},
    "unknown_uri": {"kind": "insert", "uri": "model://no_such_model_anywhere"},
    "two_sources": {"kind": "insert", "shape": "box", "uri": "model://table"},
    "text_that_is_no_sdf": {"kind": "insert", "sdf": "<nix/>"},
    "scale_of_zero": {"kind": "scale", "name": "a", "scale": [0, 1, 1]},
    "scale_of_links": {"kind": "scale", "name": "arm", "scale": [2, 1, 1]},
    "mass_of_zero": {"kind": "set", "target": "a::link", "path": "inertial.mass", "value": 0},
    "mass_as_text": {"kind": "set", "target": "a::link", "path": "inertial.mass", "value": "1"},
    "size_of_zero": {"kind": "set", "target": "a::link::collision", "path": "geometry.size",
                     "value": [0, 1, 1]},
    "unknown_property": {"kind": "set", "target": "a", "path": "colour", "value": 1},
    "hidden_property": {"kind": "set", "target": "a", "path": "extra", "value": []},
    "private_property": {"kind": "set", "target": "a", "path": "__class__", "value": 1},
    "links_as_a_property": {"kind": "set", "target": "a", "path": "links", "value": []},
    "path_of_a_file": {"kind": "set", "target": "a::link::visual", "path": "geometry",
                       "value": {"type": "mesh", "uri": "model://no_such_model/x.dae"}},
    "unknown_shape": {"kind": "set", "target": "a::link::visual", "path": "geometry",
                      "value": {"type": "torus"}},
    "axis_without_direction": {"kind": "set", "target": "arm::hinge", "path": "axis.xyz",
                               "value": [0, 0, 0]},
    "step_size_of_zero": {"kind": "set", "target": "", "path": "physics.max_step_size",
                          "value": 0},
    "unknown_operation": {"kind": "explode"},
    "more_fields": {"kind": "delete", "names": ["a"], "now": True},
    "steps_of_zero": {"kind": "wrench", "link": "a::link", "force": [1, 0, 0],
                      "torque": [0, 0, 0], "steps": 0 - 1},
    "unknown_joint": {"kind": "joint", "joint": "a::hinge", "mode": "force", "value": 1},
    "empty_group": {"kind": "group", "ops": []},
    "group_with_a_bad_end": {"kind": "group", "ops": [
        {"kind": "insert", "shape": "box"}, {"kind": "delete", "names": ["a"]},
        {"kind": "delete", "names": ["nix"]}]},
}


def test_one_thing_at_a_time_drives_a_joint_and_undo_gives_the_one_before(case):
    made = case(arm("arm"))
    model = made.sim.models.get("arm")
    suited = default_gains(model, model.joints[0], True, 0.001)
    asked = [("force", 2.0, {}), ("position", 0.3, {"gains": {"p": 50, "i": 0, "d": 4}}),
             ("velocity", -1.0, {}), ("force", 0.0, {})]
    wanted = [(2.0,), (JointPid(0.3, False, 50.0, 0.0, 4.0),),
              (JointPid(-1.0, True, **suited),), ()]

    async def drive(browser):
        for (mode, value, more), expected in zip(asked, wanted):
            await browser.edit("joint", joint="arm::hinge", mode=mode, value=value, **more)
            assert made.sim.wrenches.efforts_on("arm::hinge") == expected
        for expected in reversed([(), *wanted[:-1]]):
            await browser.ask("undo")
            assert made.sim.wrenches.efforts_on("arm::hinge") == expected
        for gains in ({"p": -1}, {"d": 1e99}, {"q": 1}):
            with pytest.raises(Refused):
                await browser.edit("joint", joint="arm::hinge", mode="position", value=1,
                                   gains=gains)
        assert made.sim.wrenches.efforts_on("arm::hinge") == ()

    made.browse(drive)


@pytest.mark.parametrize("op", REFUSED.values(), ids=REFUSED)
def test_a_bad_edit_is_refused_with_a_reason_and_changes_nothing(case, op):
    made = case(box("a"), arm("arm"), lights=[sun()])

    async def edit(browser):
        before = state(made.sim)
        with pytest.raises(Refused) as refused:
            await browser.ask("edit", op=op)
        assert str(refused.value)
        same(state(made.sim), before)
        assert browser.last("history")["undo"] == []

    made.browse(edit)


def test_a_rename_is_undone_where_a_light_has_the_name_of_before(case):
    made = case(box("sun"), lights=[sun()])

    async def rename(browser):
        before = state(made.sim)
        await browser.edit("rename", name="sun", to="crate")
        assert made.sim.models.names() == ["crate"]
        await browser.ask("undo")
        same(state(made.sim), before)
        await browser.ask("redo")
        assert made.sim.models.names() == ["crate"] and made.sim.lights.all() == [sun()]

    made.browse(rename)


def test_names_are_made_unique_as_gazebo_makes_them(case):
    async def insert(browser):
        names = [(await browser.edit("insert", shape="box"))["name"] for _ in range(3)]
        assert names == ["unit_box", "unit_box_0", "unit_box_1"]
        light = {"type": "point"}
        assert [(await browser.edit("insert_light", light=light))["name"] for _ in range(2)] == [
            "user_point_light_0", "user_point_light_1"]

    case().browse(insert)


def test_a_unit_shape_has_gazebos_size_and_inertia(case):
    made = case()

    async def insert(browser):
        for shape in ("box", "sphere", "cylinder"):
            await browser.edit("insert", shape=shape)
        moments = {name: made.sim.models.get(f"unit_{name}").links[0].inertial for name in (
            "box", "sphere", "cylinder")}
        assert moments["box"].ixx == pytest.approx(1 / 6)
        assert moments["sphere"].izz == pytest.approx(0.1)
        assert moments["cylinder"].ixx == pytest.approx(0.1458, abs=1e-4)
        assert moments["cylinder"].izz == pytest.approx(0.125)
        assert made.sim.states.model_state("unit_box")[0].position == (0.0, 0.0, 0.5)
        await browser.until(lambda: browser.model("unit_box"))
        material = browser.model("unit_box")["links"][0]["visuals"][0]["material"]
        assert material["diffuse"] == material["ambient"] == [0.93, 0.62, 0.33, 1.0]

    made.browse(insert)


def test_a_scale_writes_real_sizes_and_keeps_the_mass(case):
    made = case(box("a"))

    async def scale(browser):
        await browser.edit("scale", name="a", scale=[2, 3, 4])
        link = made.sim.models.get("a").links[0]
        assert link.collisions[0].geometry.size == (2, 3, 4) == link.visuals[0].geometry.size
        assert link.inertial.mass == 1.0
        assert link.inertial.ixx == pytest.approx((9 + 16) / 12)
        assert link.inertial.iyy == pytest.approx((4 + 16) / 12)
        await browser.edit("scale", name="a", scale=[0.5, 1, 1])
        assert made.sim.models.get("a").links[0].collisions[0].geometry.size == (1, 3, 4)

    made.browse(scale)


def test_what_is_copied_can_be_pasted_together_with_its_places(case):
    made = case(box("a", (1.0, 0.0, 0.5)), box("b", (3.0, 0.0, 0.5)), lights=[sun()])

    async def paste(browser):
        text = (await browser.ask("copy", names=["a", "b"]))["text"]
        assert (await browser.edit("paste", text=text))["names"] == ["a_clone", "b_clone"]
        assert made.sim.states.model_state("a_clone")[0].position == (1.0, 0.0, 0.5)
        names = (await browser.edit("paste", text=text, poses=[[0, 7, 0.5, 0, 0, 0, 1]]))["names"]
        assert names == ["a_clone_0", "b_clone_0"]
        assert made.sim.states.model_state("b_clone_0")[0].position == pytest.approx((0, 7, 0.5))
        assert made.sim.states.model_state("a_clone_0")[0].position == pytest.approx((-2, 7, 0.5))
        light = (await browser.ask("copy", names=["sun"]))["text"]
        assert (await browser.edit("paste", text=light))["name"] == "sun_clone"
        for names in ([], ["nix"]):
            with pytest.raises(Refused):
                await browser.ask("copy", names=names)

    made.browse(paste)


def test_copies_at_several_poses_are_one_step_with_names_and_groups_of_their_own(case):
    made = case(box("a", (1.0, 0.0, 0.5)), box("b", (3.0, 0.0, 0.5)))

    async def paste(browser):
        await browser.edit("set_group", names=["a", "b"], group="pair")
        text = (await browser.ask("copy", names=["a", "b"]))["text"]
        done = await browser.edit("paste", text=text, poses=[
            [0, y, 0.5, 0, 0, 0, 1] for y in (5, 9)])
        assert done["names"] == ["a_clone", "b_clone", "a_clone_0", "b_clone_0"]
        places = [made.sim.states.model_state(name)[0].position[:2] for name in done["names"]]
        assert places == [pytest.approx(place) for place in ((-2, 5), (0, 5), (-2, 9), (0, 9))]
        groups = [group_of(made.sim.models.get(name)) for name in done["names"]]
        assert groups[0] == groups[1] != groups[2] == groups[3] and "pair" not in groups
        with pytest.raises(Refused, match="at most 5000"):
            await browser.edit("paste", text=text, poses=[[0, 0, 1, 0, 0, 0, 1]] * 2501)
        await browser.ask("undo")
        assert made.sim.models.names() == ["a", "b"]

    made.browse(paste)


def test_the_models_of_a_file_keep_their_names_and_its_faults_name_it(case):
    made = case(box("a"))

    async def drop(browser):
        text = (await browser.ask("copy", names=["a"]))["text"]
        await browser.edit("delete", names=["a"])
        for name in ("a", "a_0"):
            assert (await browser.edit("paste", text=text, source="own.world"))["name"] == name
        bad = "<sdf version='1.7'>\n<model name='b'>\n<link name='l'><inertial><mass>x</mass>" \
              "</inertial></link></model></sdf>"
        asked = [("preview", {"sdf": bad, "source": "C:\\there\\bad.sdf"}),
                 ("edit", {"op": {"kind": "insert", "sdf": bad, "source": "there/bad.sdf"}}),
                 ("edit", {"op": {"kind": "paste", "text": bad, "source": "bad.sdf"}})]
        for kind, fields in asked:
            with pytest.raises(Refused) as refused:
                await browser.ask(kind, **fields)
            assert (refused.value.issues[0]["file"], refused.value.issues[0]["line"]) == \
                ("bad.sdf", 3)

    made.browse(drop)


def test_a_model_that_is_put_inside_of_another_is_warned_about(case):
    made = case(box("shelf", (0.0, 0.0, 0.5)), box("desk", (3.0, 0.0, 0.5)))

    async def move(browser):
        def warned():
            return [push["issue"]["message"] for push in browser.pushes if push["type"] == "issue"]

        await browser.edit("move", poses={"desk": [1.5, 0, 0.5, 0, 0, 0, 1]})
        await browser.edit("insert", shape="box", pose=[-2, 0, 0.5, 0, 0, 0, 1])
        assert warned() == []
        await browser.edit("move", poses={"desk": [0.7, 0, 0.5, 0, 0, 0, 1]})
        await browser.until(lambda: any("300 mm or more inside" in one for one in warned()))
        await browser.edit("insert", shape="box", name="c", pose=[-0.9, 0, 0.5, 0, 0, 0, 1])
        await browser.until(lambda: any("'c::link'" in one for one in warned()))

    made.browse(move)


def test_faults_of_a_text_without_a_file_name_what_was_inserted(case):
    made = case()
    bad = "<sdf version='1.7'>\n<model name='b c'>\n<link name='l'><inertial><mass>x</mass>" \
          "</inertial></link></model></sdf>"

    async def insert(browser):
        with pytest.raises(Refused) as refused:
            await browser.edit("insert", sdf=bad)
        assert refused.value.issues[0]["file"] == "<inserted model b c>"

    made.browse(insert)


def test_a_model_with_nested_ones_is_copied_with_them(case):
    outer = box("outer")
    outer.models.append(box("inner", (0.0, 0.0, 2.0)))
    made = case(outer)

    async def paste(browser):
        text = (await browser.ask("copy", names=["outer"]))["text"]
        await browser.edit("paste", text=text, poses=[[5, 0, 0.5, 0, 0, 0, 1]])
        links = made.sim.models.get("outer_clone").links
        assert [link.name for link in links] == ["link", "inner::link"]
        assert made.sim.states.link_state("outer_clone::inner::link")[0].position == (5.0, 0.0, 2.5)

    made.browse(paste)


def test_history_goes_back_and_forth_to_a_chosen_step(case):
    made = case()

    async def walk(browser):
        for _ in range(4):
            await browser.edit("insert", shape="box")
        assert (await browser.ask("undo", to=2))["label"] == "Insert unit_box_0"
        assert made.sim.models.names() == ["unit_box"]
        assert (await browser.ask("redo", to=1))["label"] == "Insert unit_box_1"
        assert made.sim.models.names() == ["unit_box", "unit_box_0", "unit_box_1"]
        await browser.edit("insert", shape="sphere")
        assert browser.last("history")["redo"] == []
        with pytest.raises(Refused):
            await browser.ask("redo")
        with pytest.raises(Refused):
            await browser.ask("undo", to=99)

    made.browse(walk)


def test_a_step_that_cannot_be_undone_any_more_is_told_and_forgotten(case):
    made = case()

    async def lose(browser):
        await browser.edit("insert", shape="box")
        await browser.edit("insert", shape="sphere")
        made.sim.models.delete("unit_sphere")
        with pytest.raises(Refused, match="unit_sphere"):
            await browser.ask("undo")
        assert (await browser.ask("undo"))["label"] == "Insert unit_box"

    made.browse(lose)


def test_a_force_is_undone_with_what_it_did(case):
    made = case(box("a"), paused=False)

    async def push(browser):
        before = made.sim.states.model_state("a")[0]
        await browser.edit("wrench", link="a::link", force=[10, 0, 0], torque=[0, 0, 0], steps=5,
                           point=[0, 0, 0.5])
        [load] = made.engine.backend.timed_forces.values()
        assert load.stop - load.start == 5
        assert load.force == (10, 0, 0) and load.point == pytest.approx((0, 0, 0.5))
        made.sim.states.set_model_state("a", Pose((8, 0, 0)), STILL)
        await browser.ask("undo")
        assert made.sim.states.model_state("a")[0] == before

    made.browse(push)


def test_names_shared_by_a_collision_and_a_visual_can_be_told_apart(case):
    model = box("a")
    model.links[0].visuals[0].name = "collision"
    made = case(model)

    async def colour(browser):
        await browser.edit("set", target="a::link::visual:collision", path="pose",
                           value=[0, 0, 1, 0, 0, 0, 1])
        link = made.sim.models.get("a").links[0]
        assert link.visuals[0].pose.position == (0, 0, 1)
        assert link.collisions[0].pose.position == (0, 0, 0)
        await browser.edit("set", target="a::link::collision", path="transparency", value=0.5)
        assert made.sim.models.get("a").links[0].visuals[0].transparency == 0.5

    made.browse(colour)


def test_edits_of_one_browser_are_carried_out_in_their_order(case):
    made = case()

    async def many(browser):
        await asyncio.gather(*(browser.edit("insert", shape="box") for _ in range(30)))
        assert made.sim.models.names() == ["unit_box"] + [f"unit_box_{n}" for n in range(29)]

    made.browse(many)


def test_the_model_is_meant_where_a_light_has_its_name(case):
    made = case(box("lamp"), lights=[replace(sun(), name="lamp")])
    light = made.sim.lights.get("lamp")

    async def edit(browser):
        await browser.edit("set", target="lamp", path="pose", value=[1, 2, 3, 0, 0, 0, 1])
        assert made.sim.states.model_state("lamp")[0].position == (1.0, 2.0, 3.0)
        await browser.edit("delete", names=["lamp"])
        assert (made.sim.models.names(), made.sim.lights.all()) == ([], [light])
        await browser.edit("delete", names=["lamp"])  # now the light is
        assert not made.sim.lights.all()
        await browser.ask("undo", to=1)
        assert (made.sim.models.names(), made.sim.lights.all()) == (["lamp"], [light])
        await browser.edit("rename", name="lamp", to="post")
        assert (made.sim.models.names(), made.sim.lights.all()) == (["post"], [light])

    made.browse(edit)


def test_copies_of_a_group_are_a_group_of_their_own(case):
    made = case(box("a"), box("b"), box("c"))

    def groups():
        return {name: group_of(made.sim.models.get(name)) for name in made.sim.models.names()}

    async def edit(browser):
        entity = made.sim.models.entity("a")
        grouped = await browser.ask("edit", op={"kind": "set_group", "names": ["a", "b"]})
        assert grouped["name"] == "group"
        assert made.sim.models.entity("a").model_id == entity.model_id  # not built again
        named = {"kind": "set_group", "names": ["a", "b"], "group": "a < b"}
        await browser.ask("edit", op=named)
        assert browser.last("history")["undo"][0] == "Rename group group to a < b"
        text = (await browser.ask("copy", names=["a", "b"]))["text"]
        await browser.ask("edit", op={"kind": "paste", "text": text})
        text = (await browser.ask("copy", names=["b"]))["text"]
        await browser.ask("edit", op={"kind": "paste", "text": text, "name": "alone"})
        assert groups() == {"a": "a < b", "b": "a < b", "c": "", "a_clone": "a < b_0",
                            "b_clone": "a < b_0", "alone": ""}
        await browser.until(lambda: [one["group"] for one in browser.document["models"]]
                            == list(groups().values()))
        await browser.ask("edit", op={"kind": "set_group", "names": ["a", "b"], "group": ""})
        assert groups()["a"] == groups()["b"] == ""

    made.browse(edit)


def test_a_light_is_a_member_of_a_group_copied_with_it_and_saved(case):
    made = case(box("a"), lights=[sun()])

    async def edit(browser):
        await browser.ask("edit", op={"kind": "set_group", "names": ["a", "sun"]})
        assert browser.light("sun")["group"] == browser.model("a")["group"] == "group"
        text = (await browser.ask("copy", names=["a", "sun"]))["text"]
        await browser.ask("edit", op={"kind": "paste", "text": text})
        assert {name: group_of(made.sim.lights.get(name)) for name in ("sun", "sun_clone")} == {
            "sun": "group", "sun_clone": "group_0"}
        assert group_of(made.sim.models.get("a_clone")) == "group_0"
        world, issues = parse_world(write_world(made.sim.world).decode(), Resolver(), "x.world")
        assert not issues and [group_of(light) for light in world.lights] == ["group", "group_0"]
        with pytest.raises(Refused, match="nix"):
            await browser.ask("edit", op={"kind": "set_group", "names": ["sun", "nix"]})

    made.browse(edit)


def test_a_parameter_of_a_sensor_is_set_in_its_xml_and_its_description(case):
    made = case(arm("arm"))

    def laser():
        return made.sim.models.link("arm::tip").sensors[0]

    async def edit(browser):
        for name in ("laser", "laser_0"):
            await browser.ask("edit", op={"kind": "add_sensor", "link": "arm::tip",
                                          "sensor": "laser"})
            assert made.sim.models.link("arm::tip").sensors[-1].name == name
        target = "arm::tip::sensor:laser"
        for path, value in (("ray/range/max", 3.5), ("ray/scan/vertical/samples", 4),
                            ("ray/noise/@type", "gaussian"), ("pose", [0, 0, 1, 0, 0, 0, 1]),
                            ("plugin:laser/topicName", "a & b")):
            await browser.ask("edit", op={"kind": "set", "target": target, "path": path,
                                          "value": value})
        assert (laser().ray.max_range, laser().ray.vertical.samples, laser().ray.noise.type) == (
            3.5, 4, "gaussian")
        assert laser().pose == Pose((0.0, 0.0, 1.0))
        assert "<topicName>a &amp; b</topicName>" in laser().plugins[0].xml
        label = "Set samples of arm::tip::laser to 4"
        assert label in browser.last("history")["undo"]
        text = (await browser.ask("copy", names=["arm"]))["text"]
        assert "<max>3.5</max>" in text and '<noise type="gaussian"/>' in text
        await browser.until(lambda: any(
            one == {"path": "ray/range/max", "kind": "number", "value": 3.5}
            for sensor in browser.document["models"][0]["links"][1]["sensors"][:1]
            for one in sensor["parameters"]))
        for path, value in (("ray/range/max", "far"), ("ray/none", 1), ("plugin:other/x", "y"),
                            ("ray/scan/horizontal/samples", 1.5)):
            with pytest.raises(Refused):
                await browser.ask("edit", op={"kind": "set", "target": target, "path": path,
                                              "value": value})
        await browser.ask("edit", op={"kind": "remove_part", "target": target})
        assert [one.name for one in made.sim.models.link("arm::tip").sensors] == ["laser_0"]

    made.browse(edit)
