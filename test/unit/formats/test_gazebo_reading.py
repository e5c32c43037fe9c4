"""What libsdformat 9, libignition-math 6 and ODE make of files that break the rules."""
from __future__ import annotations

import pytest
from reading import (
    INERTIAL,
    errors,
    link_of,
    model_of,
    robot_joint,
    robot_link,
    robot_of,
    sdf,
    tolerated,
    world_of,
)

from my_simulations.description.flatten import flatten_model
from my_simulations.description.model import Inertial
from my_simulations.description.unflatten import unflatten_model
from my_simulations.formats.reading import read_world
from my_simulations.formats.xml.values import BOOL, COLOR, FLOAT, INT, LIMIT, POSE, VECTOR2, VECTOR3
from my_simulations.geometry import IDENTITY, pose_from_xyzrpy
from my_simulations.resources.resolver import Resolver

LINKS = f'<link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link>'


@pytest.mark.parametrize("kind, text, value", [
    (POSE, "1 2 3 0.1 0.2", pose_from_xyzrpy(1, 2, 3, 0, 0, 0)),
    (POSE, "1 2 3", pose_from_xyzrpy(1, 2, 3, 0, 0, 0)),
    (POSE, "1 2", IDENTITY),
    (POSE, "1 2 3 0 0 0.5 7", pose_from_xyzrpy(1, 2, 3, 0, 0, 0.5)),
    (POSE, "-12.0.0 1 2 0 0 0", pose_from_xyzrpy(-12, 0, 1, 2, 0, 0)),
    (POSE, "6.0000006.000000 0 0 0 0 0", pose_from_xyzrpy(6.0000006, 0, 0, 0, 0, 0)),
    (POSE, "1 2 3 0 0 pi", pose_from_xyzrpy(1, 2, 3, 0, 0, 0)),
    (POSE, "1, 2, 3, 0, 0, 0", IDENTITY),
    (POSE, "1 2 nan 0 0 0.5", IDENTITY),
    (POSE, "0x1 0 0 0 0 0", IDENTITY),
    (VECTOR3, "1 2 3 4", (1, 2, 3)),
    (VECTOR3, "1 2", (0, 0, 0)),
    (VECTOR3, "1-2-3", (1, -2, -3)),
    (VECTOR3, "1e 2 3", (0, 0, 0)),
    (VECTOR2, "1 2 3", (1, 2)),
    (COLOR, "0.1 0.2", (0.1, 0.2, 0, 1)),
    (COLOR, "1,0,0,1", (1, 0, 0, 1)),
    (COLOR, "0.1 0.2 0.3 0.4 0.5", (0.1, 0.2, 0.3, 0.4)),
    (FLOAT, "12.5kg", 12.5),
    (FLOAT, "-12.0.0", -12.0),
    (FLOAT, "0,5", 0.0),
    (FLOAT, "0x10", 16.0),
    (FLOAT, "1e", 1.0),
    (FLOAT, "true", 1.0),
    (LIMIT, "-Infinity rad", float("-inf")),
    (INT, "10.5", 10),
    (INT, "0xffgg", 255),
])
def test_a_text_that_is_not_quite_a_value_is_read_as_gazebo_does(kind, text, value):
    with pytest.raises(ValueError):
        kind.parse(text)
    assert kind.parse_leniently(text) == value


@pytest.mark.parametrize("kind, text", [
    (FLOAT, "heavy"), (FLOAT, ""), (FLOAT, "1e999"), (INT, "x1"), (INT, "99999999999999"),
    (BOOL, "maybe"), (BOOL, "2"),
])
def test_a_text_that_gazebo_refuses_stays_refused(kind, text):
    with pytest.raises(ValueError):
        kind.parse_leniently(text)


def test_a_number_read_in_part_is_told_with_what_was_made_of_it():
    link, issues = link_of("<pose>-12.0.0 1 0 0 0 0</pose>")
    assert link.pose.position == (-12, 0, 1)
    (issue,) = [one for one in issues if one.tolerated]
    assert "'-12 0 1 0 0 0'" in issue.message and issue.line == 1
    assert issue.xpath == "/sdf/model/link/pose"


def test_an_infinite_number_is_left_at_its_default():
    link, issues = link_of("<inertial><mass>inf</mass></inertial><velocity_decay><linear>nan"
                           "</linear></velocity_decay>")
    assert (link.inertial.mass, link.linear_decay) == (1, 0)
    assert tolerated(issues) == ["value-not-finite"] * 2 and errors(issues) == []


def test_the_first_of_repeated_elements_counts():
    link, issues = link_of("<pose>1 0 0 0 0 0</pose><pose>2 0 0 0 0 0</pose><inertial><mass>2"
                           "</mass></inertial><inertial><mass>3</mass></inertial>")
    assert (link.pose.position[0], link.inertial.mass) == (1, 2)
    assert tolerated(issues) == ["element-repeated"]


def test_an_inertia_that_no_body_has_becomes_one_about_each_axis():
    link, issues = link_of("<inertial><mass>2</mass><pose>0 0 1 0 0 0</pose><inertia><ixx>1</ixx>"
                           "<iyy>-1</iyy><izz>1</izz></inertia></inertial>")
    assert link.inertial == Inertial(2, pose_from_xyzrpy(0, 0, 1, 0, 0, 0))
    assert tolerated(issues) == ["inertia-not-positive"] and errors(issues) == []


_QUARTER_TURN = "0 0 1.5707963267948966"


@pytest.mark.parametrize("read, code", [
    (lambda: model_of(
        f"<pose>0 0 0 {_QUARTER_TURN}</pose>{LINKS}" '<joint name="j" type="revolute">'
        "<parent>a</parent><child>b</child><axis><xyz>0 0 0</xyz></axis></joint>", "1.7"),
     "joint-axis-zero"),
    (lambda: model_of(
        LINKS + f'<joint name="j" type="prismatic"><pose>0 0 0 {_QUARTER_TURN}</pose>'
        "<parent>a</parent><child>b</child></joint>", "1.7"), "joint-axis-missing"),
    (lambda: robot_of(robot_link("a") + robot_link("b") + robot_joint(
        "j", "a", "b", "continuous", '<axis xyz="0 0 0"/>', rpy=_QUARTER_TURN)),
     "joint-axis-zero"),
], ids=["no length: x of the world", "no axis: x of the child", "of a robot: x of the model"])
def test_a_joint_without_axis_or_with_one_of_no_length_turns_about_x(read, code):
    model, issues = read()
    assert model.joints[0].axis.xyz == pytest.approx((0, -1, 0))
    assert tolerated(issues) == [code] and errors(issues) == []


@pytest.mark.parametrize("joint, code", [
    ('type="hinge"><parent>a</parent><child>b</child>', "joint-type-unknown"),
    ('type="fixed"><parent>a</parent><child>c</child>', "joint-link-unknown"),
    ('type="fixed"><parent>a</parent><child>a</child>', "joint-link-repeated"),
])
def test_a_joint_that_gazebo_cannot_make_is_left_out_alone(joint, code):
    good = '<joint name="g" type="fixed"><parent>a</parent><child>b</child></joint>'
    model, issues = model_of(LINKS + f'<joint name="j" {joint}</joint>' + good)
    assert [one.name for one in model.joints] == ["g"] and len(model.links) == 2
    assert tolerated(issues) == [code] and errors(issues) == []


def test_the_second_of_two_joints_of_one_name_is_left_out():
    joint = '<joint name="j" type="{}"><parent>a</parent><child>b</child></joint>'
    model, issues = model_of(LINKS + joint.format("fixed") + joint.format("ball"))
    assert [one.type for one in model.joints] == ["fixed"]
    assert tolerated(issues) == ["name-repeated"] and errors(issues) == []


def test_the_second_of_two_links_of_one_name_is_kept_under_another():
    model, issues = model_of(
        '<link name="l"/><link name="l"><pose>1 0 0 0 0 0</pose></link><link name="l_1"/>'
        '<link name="c"/><joint name="j" type="fixed"><parent>l</parent><child>c</child></joint>')
    assert [(one.name, one.pose.position[0]) for one in model.links] == [
        ("l", 0), ("l_2", 1), ("l_1", 0), ("c", 0)]
    assert model.joints[0].parent == "l"
    assert tolerated(issues) == ["name-repeated"] and errors(issues) == []


def test_the_second_of_two_nested_models_of_one_name_is_kept_under_another():
    inner = '<model name="n"><link name="l"/></model>'
    model, issues = model_of(inner + inner)
    assert [one.name for one in model.models] == ["n", "n_1"]
    assert tolerated(issues) == ["name-repeated"] and errors(issues) == []


def test_a_link_called_world_is_what_joints_of_its_model_mean():
    model, issues = model_of('<link name="world"/><link name="a"/><joint name="j" type="fixed">'
                             "<parent>world</parent><child>a</child></joint>")
    assert [one.name for one in model.links] == ["world_1", "a"]
    assert (model.joints[0].parent, model.joints[0].child) == ("world_1", "a")
    assert tolerated(issues) == ["name-reserved"] and errors(issues) == []


def test_a_model_without_links_is_loaded_empty():
    world, issues = world_of('<model name="m"/>')
    assert [model.name for model in world.models] == ["m"] and errors(issues) == []


def test_a_pose_in_an_unknown_frame_is_taken_as_it_is_written():
    model, issues = model_of('<link name="a"><pose relative_to="gone">1 0 0 0 0 0</pose></link>'
                             + '<link name="b"/><joint name="j" type="fixed"><pose relative_to='
                             '"none">0 2 0 0 0 0</pose><parent>a</parent><child>b</child></joint>',
                             "1.7")
    assert model.links[0].pose.position == (1, 0, 0)
    assert model.joints[0].pose.position == (0, 2, 0)
    assert set(tolerated(issues)) == {"frame-unknown"} and errors(issues) == []


@pytest.mark.parametrize("scale, kept", [("1 1 0", (1, 1, 1e-3)), ("2 0 0", (2, 1e-3, 1e-3))])
def test_a_mesh_scaled_flat_keeps_a_thickness(tmp_path, scale, kept):
    (tmp_path / "m.stl").write_text("solid m\nendsolid m\n")
    uri = tmp_path / "m.stl"
    link, issues = link_of(f'<collision name="c"><geometry><mesh><uri>{uri}</uri><scale>{scale}'
                           "</scale></mesh></geometry></collision>")
    assert link.collisions[0].geometry.scale == kept
    assert tolerated(issues) == ["scale-zero"] and errors(issues) == []


def test_a_mesh_scaled_to_a_point_is_left_out(tmp_path):
    (tmp_path / "m.stl").write_text("solid m\nendsolid m\n")
    uri = tmp_path / "m.stl"
    link, issues = link_of(f'<collision name="c"><geometry><mesh><uri>{uri}</uri><scale>0 0 0'
                           "</scale></mesh></geometry></collision>")
    assert link.collisions == [] and tolerated(issues) == ["bad-shape"] and errors(issues) == []


def shelf(tmp_path, **models):
    for name, inside in models.items():
        folder = tmp_path / name
        folder.mkdir()
        (folder / "model.config").write_text(
            f'<model><name>{name}</name><sdf version="1.7">model.sdf</sdf></model>')
        (folder / "model.sdf").write_text(sdf(f'<model name="{name}">{inside}</model>', "1.7"))
    return Resolver([str(tmp_path)])


def include(name, inside=""):
    return f"<include><uri>model://{name}</uri>{inside}</include>"


LINK = '<link name="l"/>'


@pytest.mark.parametrize("inside, static", [
    (include("rock"), True),
    (include("rock") + "<static>false</static>", True),
    ("<static>false</static>" + include("rock"), False),
    (LINK + include("rock"), True),
    (include("ball") + include("rock"), True),
    (include("loose") + include("rock"), False),
    (include("ball", "<static>1</static>"), True),
    (include("rock", "<static>0</static>"), False),
    (include("cave"), True),
    (include("ball"), False),
    ('<model name="n"><static>true</static><link name="l"/></model>' + LINK, False),
])
def test_a_model_is_static_when_the_first_word_of_it_or_its_includes_says_so(
        tmp_path, inside, static):
    resolver = shelf(tmp_path, rock="<static>1</static>" + LINK, ball=LINK,
                     loose="<static>false</static>" + LINK, cave=include("rock"))
    model, issues = model_of(inside, "1.7", resolver)
    assert model.static is static and errors(issues) == []
    assert ("include-flag" in [issue.code for issue in issues]) is (
        static != ("<static>true" in inside and "<model" not in inside))
    assert all(one.static is model.static for one in model.models if one.name != "n")


def test_the_static_of_an_include_reaches_through_the_includes_below(tmp_path):
    resolver = shelf(tmp_path, rock="<static>1</static>" + LINK, cave=include("rock"))
    world, issues = world_of(include("cave", "<static>false</static>")
                             + include("cave", "<name>cold</name>"), "1.7", resolver)
    assert [model.static for model in world.models] == [False, True]
    model, _ = model_of(include("cave", "<static>0</static>"), "1.7", resolver)
    assert model.static is False and errors(issues) == []


def test_other_flags_of_an_include_count_for_the_whole_as_well(tmp_path):
    resolver = shelf(tmp_path, hand="<self_collide>1</self_collide><allow_auto_disable>0"
                                    "</allow_auto_disable><enable_wind>1</enable_wind>" + LINK)
    model, _ = model_of(include("hand") + LINK, "1.7", resolver)
    assert model.self_collide and not model.allow_auto_disable and model.enable_wind
    own = "<self_collide>0</self_collide><enable_wind>0</enable_wind>"
    model, issues = model_of(own + include("hand"), "1.7", resolver)
    assert not model.self_collide and not model.allow_auto_disable and not model.enable_wind
    assert [one.code for one in issues] == ["include-flag"] and issues[0].line == 1


def test_the_first_link_of_a_model_may_be_that_of_an_include(tmp_path):
    resolver = shelf(tmp_path, base='<link name="plate"/>')
    model, _ = model_of(include("base") + LINK, "1.7", resolver)
    assert model.canonical_link == "base::plate"
    model, _ = model_of(LINK + include("base"), "1.7", resolver)
    assert model.canonical_link == ""


def test_a_static_model_in_one_that_moves_stands_and_is_saved_as_it_was():
    model, _ = model_of(f'<link name="a">{INERTIAL}</link><model name="n"><static>true</static>'
                        '<link name="l"/></model>')
    flat = flatten_model(model)
    assert [(link.name, link.kinematic) for link in flat.links] == [("a", False), ("n::l", True)]
    again = unflatten_model(flat)
    assert not again.models[0].links[0].kinematic and again.models[0].static


def test_an_empty_pose_of_an_include_replaces_that_of_the_model(tmp_path):
    resolver = shelf(tmp_path, rock="<pose>1 2 3 0 0 0</pose>" + LINK)
    world, issues = world_of(include("rock", "<pose/>") + include("rock", "<name>b</name>"), "1.7",
                             resolver)
    assert [model.pose.position for model in world.models] == [(0, 0, 0), (1, 2, 3)]
    assert errors(issues) == []


def test_models_and_meshes_in_the_home_folder_of_another_machine_are_replaced(tmp_path):
    """`file:///home/NAME/.gazebo/models/X` stands in many files, and X is often here, too."""
    resolver = shelf(tmp_path, rock=LINK)
    (tmp_path / "rock" / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    home = "/home/other/.gazebo/models/rock"
    shape = f"<geometry><mesh><uri>file://{home}/a.obj</uri></mesh></geometry>"
    link = (f'<link name="l"><collision name="c">{shape}</collision>'
            f'<visual name="v">{shape}</visual></link>')
    world, issues = world_of(f"<include><uri>{home}</uri></include>"
                             f'<model name="m">{link}</model>', "1.7", resolver)
    assert [model.name for model in world.models] == ["rock", "m"]
    found = world.models[1].links[0]
    for part in (found.collisions[0], found.visuals[0]):
        assert part.geometry.path == str(tmp_path / "rock" / "a.obj")
    assert tolerated(issues) == ["home-path"] * 3 and errors(issues) == []
    assert "model://rock is used" in issues[0].message and "model://rock/a.obj" in issues[1].hint


def test_a_missing_include_leaves_out_itself_alone():
    model, issues = model_of(LINK + include("nowhere"), "1.7")
    assert [link.name for link in model.links] == ["l"] and model.models == []
    assert tolerated(issues) == ["model-not-found"] and errors(issues) == []


def test_of_two_joints_with_one_child_the_last_by_name_counts():
    robot, issues = robot_of(
        "".join(map(robot_link, "abc")) + robot_joint("z", "a", "c", "continuous")
        + robot_joint("y", "b", "c", "continuous") + robot_joint("x", "a", "b", "continuous"))
    assert sorted((one.name, one.parent, one.child) for one in robot.joints) == [
        ("x", "a", "b"), ("z", "a", "c")]
    assert tolerated(issues) == ["link-two-parents"] and errors(issues) == []


def test_a_robot_without_mass_is_an_empty_model():
    robot, issues = robot_of('<link name="a"/>')
    assert robot.links == [] and tolerated(issues) == ["link-missing"] and errors(issues) == []


def test_a_kinematic_link_needs_no_mass():
    link, issues = link_of("<kinematic>1</kinematic><inertial><mass>0</mass></inertial>")
    assert link.inertial.mass == 0 and errors(issues) == [] and tolerated(issues) == []


def test_an_include_without_uri_in_a_model_is_left_out_alone():
    model, issues = model_of(LINK + "<include/>", "1.7")
    assert len(model.links) == 1
    assert tolerated(issues) == ["include-uri-missing"] and errors(issues) == []


def test_a_population_may_include_its_model(tmp_path):
    resolver = shelf(tmp_path, tree=LINK)
    world, issues = world_of(
        '<population name="p"><include><static>true</static><name>oak</name><uri>model://tree</uri>'
        "</include><box><size>1 1 1</size></box><model_count>2</model_count><distribution><type>"
        "random</type></distribution></population>", "1.7", resolver)
    assert [(model.name, model.static) for model in world.models] == [
        ("oak_clone_0", True), ("oak_clone_1", True)]
    assert errors(issues) == []


def test_models_beside_a_world_need_no_model_path(tmp_path):
    """Many repositories have `models` beside `worlds` and say in their README to export a path."""
    rock = tmp_path / "course" / "models" / "rock"
    rock.parent.mkdir(parents=True)
    shelf(rock.parent, rock=LINK)
    (rock / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "course" / "package.xml").write_text("<package/>")
    world = tmp_path / "course" / "worlds" / "a.world"
    world.parent.mkdir()
    world.write_text(
        '<sdf version="1.6"><world name="w"><include><uri>model://rock</uri></include>'
        '<model name="m"><link name="l"><visual name="v"><geometry><mesh>'
        "<uri>model://rock/a.obj</uri></mesh></geometry></visual></link></model></world></sdf>")
    loaded = read_world(str(world), Resolver())
    assert [model.name for model in loaded.world.models] == ["rock", "m"]
    assert loaded.world.models[1].links[0].visuals[0].geometry.path == str(rock / "a.obj")
    (told,) = [issue for issue in loaded.issues if issue.code == "model-folder-unlisted"]
    assert (told.file, told.line) == (str(world), 1) and "GAZEBO_MODEL_PATH=" in told.hint
    assert errors(loaded.issues) == []
