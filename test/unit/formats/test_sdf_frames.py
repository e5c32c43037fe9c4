"""Frames, nested and merged models, and joints that reach into other models."""
import math

import pytest
from reading import INERTIAL, errors, model_of, sdf, tolerated, warnings, world_of

from my_simulations.description.flatten import flatten_model
from my_simulations.description.model import Mimic
from my_simulations.formats.reading import parse_world
from my_simulations.formats.sdf.writer.entities import write_world
from my_simulations.resources.resolver import Resolver


def link(name, pose="0 0 0 0 0 0"):
    return f'<link name="{name}"><pose>{pose}</pose>{INERTIAL}</link>'


def joint(name, parent, child, inside="", kind="revolute"):
    return (f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
            f"{inside}<axis><xyz>0 0 1</xyz></axis></joint>")


@pytest.fixture
def resolver(tmp_path):
    folder = tmp_path / "arm"
    folder.mkdir()
    (folder / "model.sdf").write_text(sdf(
        f'<model name="arm"><pose>9 9 9 0 0 0</pose>{link("base", "0 0 1 0 0 0")}'
        f'{link("tip", "0 0 3 0 0 0")}{joint("turn", "base", "tip")}'
        '<frame name="grip" attached_to="tip"><pose>0 0 0.5 0 0 0</pose></frame></model>', "1.7"))
    return Resolver([str(tmp_path)])


def test_a_joint_may_name_a_frame_and_connects_what_that_travels_with():
    model, issues = model_of(
        link("a") + link("b", "1 0 0 0 0 0")
        + '<frame name="f" attached_to="b"><pose>0 2 0 0 0 0</pose></frame>'
        '<frame name="g" attached_to="f"><pose>0 0 3 0 0 0</pose></frame>'
        + joint("j", "a", "g"), "1.8")
    one = model.joints[0]
    assert (one.parent, one.child) == ("a", "b")
    assert one.pose.position == pytest.approx((0, 2, 3)) and errors(issues) == []


def test_a_frame_of_its_own_is_told():
    _, issues = model_of(link("a") + '<frame name="f" attached_to="g"/><frame name="g"'
                         ' attached_to="f"/>', "1.7")
    assert set(tolerated(issues)) == {"frame-unknown"}


def test_frames_are_kept():
    xml = '<frame name="f" attached_to="a"><pose>0 2 0 0 0 0</pose></frame>'
    model, issues = model_of(link("a") + xml, "1.7")
    assert model.extra == [xml] and issues == []


def test_a_pose_may_be_given_in_a_frame_of_an_included_model(resolver):
    model, issues = model_of(
        "<include><uri>model://arm</uri><name>left</name><pose>1 0 0 0 0 0</pose></include>"
        f'<link name="tool"><pose relative_to="left::grip">0 0 0.25 0 0 0</pose>{INERTIAL}</link>',
        "1.7", resolver)
    assert model.links[0].pose.position == pytest.approx((1, 0, 3.75)) and errors(issues) == []


def test_a_joint_reaches_a_link_of_an_included_model(resolver):
    model, issues = model_of(
        link("post") + "<include><uri>model://arm</uri></include>"
        + joint("mount", "post", "arm::base", "<pose>0 0 0.1 0 0 0</pose>"), "1.7", resolver)
    assert errors(issues) == []
    flat = flatten_model(model)
    assert {link.name for link in flat.links} == {"post", "arm::base", "arm::tip"}
    mount = next(one for one in flat.joints if one.name == "mount")
    assert (mount.child, mount.pose.position) == ("arm::base", (0, 0, 0.1))


def test_a_merged_model_leaves_no_trace_of_itself(resolver):
    model, issues = model_of(
        '<include merge="true"><uri>model://arm</uri><pose>1 0 0 0 0 0</pose></include>'
        + link("tool") + joint("hold", "tip", "tool"), "1.9", resolver)
    assert errors(issues) == []
    assert {one.name: one.pose.position for one in model.links} == {
        "tool": (0, 0, 0), "base": (1, 0, 1), "tip": (1, 0, 3)}
    assert [one.name for one in model.joints] == ["turn", "hold"] or (
        [one.name for one in model.joints] == ["hold", "turn"])
    assert model.models == []


@pytest.mark.parametrize("scope", ["", "inner::", "m::inner::"])
def test_a_joint_may_call_its_links_by_longer_names(scope):
    model, issues = model_of('<model name="inner">' + link("a") + link("b")
                             + joint("j", f"{scope}a", f"{scope}b") + "</model>")
    assert errors(issues) == []
    assert [(one.parent, one.child) for one in model.models[0].joints] == [("a", "b")]


def test_a_nested_models_joint_finds_a_link_of_the_outer_model():
    model, issues = model_of(
        link("base") + '<model name="inner"><pose>1 0 0 0 0 0</pose>' + link("a", "0 1 0 0 0 0")
        + joint("j", "base", "a", "<pose>0 0 2 0 0 0</pose>") + "</model>")
    assert errors(issues) == [] and model.models[0].joints == []
    one = model.joints[0]
    assert (one.name, one.parent, one.child) == ("inner::j", "base", "inner::a")
    assert one.pose.position == (0, 0, 2)


def test_a_joint_between_models_of_a_world_is_kept_by_the_world():
    world, issues = world_of(
        f'<model name="a">{link("l")}</model><model name="b">{link("l")}'
        + joint("j", "a::l", "l") + "</model>")
    assert [model.joints for model in world.models] == [[], []]
    assert [(one.name, one.parent, one.child) for one in world.joints] == [
        ("b::j", "a::l", "b::l")]
    assert world.models[1].extra == []
    assert errors(issues) == [] and warnings(issues) == []


def test_a_joint_of_the_world_is_kept_by_it():
    world, issues = world_of(
        f'<model name="a">{link("l")}</model><model name="b">{link("l")}</model>'
        + joint("j", "a::l", "b::l"), "1.10")
    assert [(one.name, one.parent, one.child) for one in world.joints] == [("j", "a::l", "b::l")]
    assert errors(issues) == [] and world.extra == []
    _, issues = world_of(f'<model name="a">{link("l")}</model>' + joint("j", "a::l", "c::l"),
                         "1.10")
    assert tolerated(issues) == ["joint-link-unknown"]


TURNED = "0 0 1.5707963267948966"


def two_models(joints, inside="", version="1.7"):
    """Models `a` and `b`, `b` at x = 5 and turned by a quarter, its link at y = 1."""
    world, issues = world_of(
        f'<model name="a"><pose>1 0 0 0 0 0</pose>{link("l")}</model>'
        f'<model name="b"><pose>5 0 0 {TURNED}</pose>{link("l", "0 1 0 0 0 0")}{inside}</model>'
        + joints, version)
    assert errors(issues) == []
    return world


@pytest.mark.parametrize("xyz, version, expected", [
    ('<xyz>1 0 0</xyz>', "1.7", (1, 0, 0)),
    ('<xyz expressed_in="__model__">1 0 0</xyz>', "1.7", (1, 0, 0)),
    ('<xyz expressed_in="a::l">2 0 0</xyz>', "1.7", (0, -1, 0)),
    ('<xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>', "1.6", (1, 0, 0)),
])
def test_the_axis_of_a_joint_between_models_is_brought_to_its_child(xyz, version, expected):
    world = two_models("", '<joint name="j" type="revolute"><parent>a::l</parent><child>l</child>'
                       f"<axis>{xyz}</axis></joint>", version)
    (one,) = world.joints
    assert one.axis.xyz == pytest.approx(expected)


@pytest.mark.parametrize("ends, at, position, axis", [
    (("a::l", "b::l"), "0 0 2 0 0 0", (0, 0, 2), (1, 0, 0)),
    (("a::l", "b::l"), '" relative_to="world">0 0 2 0 0 0', (0, 4, 2), (1, 0, 0)),
    (("b::l", "world"), "0 0 2 0 0 0", (0, 4, 2), (-1, 0, 0)),
])
def test_a_joint_of_the_world_stands_in_the_frame_of_its_child(ends, at, position, axis):
    pose = f'<pose{at[1:]}</pose>' if at[0] == '"' else f"<pose>{at}</pose>"
    world = two_models(f'<joint name="j" type="revolute"><parent>{ends[0]}</parent>'
                       f"<child>{ends[1]}</child>{pose}<axis><xyz>1 0 0</xyz></axis></joint>")
    (one,) = world.joints
    assert one.child == "b::l"
    assert one.pose.position == pytest.approx(position, abs=1e-9)
    assert one.axis.xyz == pytest.approx(axis)


def test_the_axis_of_a_joint_of_an_old_world_is_in_world_coordinates():
    (one,) = two_models('<joint name="j" type="revolute"><parent>a::l</parent><child>b::l</child>'
                        "<axis><xyz>1 0 0</xyz></axis></joint>", version="1.2").joints
    assert one.axis.xyz == pytest.approx((0, -1, 0))


def test_joints_between_models_are_written_as_the_worlds_own():
    world = two_models(joint("k", "world", "a::l"), joint("j", "a::l", "l"))
    copy, issues = parse_world(write_world(world), Resolver())
    assert errors(issues) == [] and copy.joints == world.joints
    assert {one.name for one in copy.joints} == {"k", "b::j"}


def test_a_joint_to_no_link_of_the_world_is_left_out_and_its_model_stays():
    world, issues = world_of(f'<model name="b">{link("l")}' + joint("j", "a::l", "l") + "</model>")
    assert [model.name for model in world.models] == ["b"] and world.models[0].joints == []
    assert world.joints == [] and tolerated(issues) == ["joint-link-unknown"]


def test_the_placement_frame_stands_where_the_pose_says(resolver):
    inside = link("a", "0 0 1 0 0 0") + link("b", "0 0 3 0 0 1.5707963267948966")
    world, issues = world_of(f'<model name="m" placement_frame="b"><pose>5 0 0 0 0 0</pose>{inside}'
                             "</model><include><uri>model://arm</uri><pose>0 0 7 0 0 0</pose>"
                             "<placement_frame>grip</placement_frame></include>", "1.8", resolver)
    assert errors(issues) == []
    first, second = world.models
    assert first.pose.position == pytest.approx((5, 0, -3))
    assert second.pose.position == pytest.approx((0, 0, 3.5))


def test_models_may_stand_in_frames_of_the_world():
    world, issues = world_of(
        '<frame name="table"><pose>0 0 1 0 0 0</pose></frame>'
        f'<model name="a"><pose relative_to="table">1 0 0 0 0 0</pose>{link("l", "0 3 0 0 0 0")}'
        f'</model><frame name="edge" attached_to="a::l"/>'
        f'<model name="b"><pose relative_to="edge">0 0 1 0 0 0</pose>{link("l")}</model>', "1.7")
    assert errors(issues) == []
    assert [model.pose.position for model in world.models] == [(1, 0, 1), (1, 3, 2)]
    assert len(world.extra) == 2


def test_a_terrain_stands_still(tmp_path):
    image = tmp_path / "grey.png"
    image.write_bytes(b"")
    model, issues = model_of(
        f'<link name="l"><collision name="c"><geometry><heightmap><uri>{image}</uri></heightmap>'
        "</geometry></collision></link>")
    assert model.static and warnings(issues) == ["static-forced"]


def test_the_fields_of_rarer_joints_are_read():
    def read(kind, inside, axes="<axis/><axis2><xyz>0 1 0</xyz></axis2>"):
        model, issues = model_of(
            link("a") + link("b") + f'<joint name="j" type="{kind}"><parent>a</parent><child>b'
            f"</child>{inside}{axes}</joint>", "1.10")
        assert errors(issues) == []
        return model.joints[0]

    assert read("screw", "<thread_pitch>-50</thread_pitch>").thread_pitch == -50
    assert read("screw", "<screw_thread_pitch>0.01</screw_thread_pitch>").thread_pitch == (
        pytest.approx(-200 * math.pi))
    gearbox = read("gearbox", "<gearbox_ratio>3</gearbox_ratio>"
                   "<gearbox_reference_body>a</gearbox_reference_body>")
    assert (gearbox.gearbox_ratio, gearbox.gearbox_reference) == (3, "a")
    assert read("revolute2", "").axis2.xyz == (0, 1, 0)
    bare = read("universal", "", "")
    assert (bare.axis.xyz, bare.axis2.xyz) == ((1, 0, 0), (0, 1, 0))
    follower = read("revolute", "", '<axis><mimic joint="k"><multiplier>2</multiplier><offset>1'
                    "</offset><reference>0.25</reference></mimic></axis>")
    assert follower.axis.mimic == Mimic("k", 2.0, 0.5)
