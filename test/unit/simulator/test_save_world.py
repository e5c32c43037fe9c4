"""Saving a running world, and loading it again."""
from __future__ import annotations

import errno
import math
import os
import stat
from dataclasses import replace

import pytest
from box_models import arm, box
from lxml import etree
from plugin_case import kept
from running_simulator import started

from my_simulations.description.compare import differences
from my_simulations.description.flatten import flatten_model
from my_simulations.description.light import Light
from my_simulations.description.model import Joint, JointAxis, PluginSpec
from my_simulations.description.model_group import group_of
from my_simulations.description.unflatten import unflatten_model
from my_simulations.description.world import World
from my_simulations.errors import CommandError, errors_of
from my_simulations.formats.reading import parse_world, read_world
from my_simulations.formats.sdf.state_applied import apply_state
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.resources.package_files import own_directory
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator import safe_file
from my_simulations.simulator.operations import SetGroups
from my_simulations.simulator.saving import (
    check_save_path,
    default_roots,
    present_world,
    save_world,
)

AWAY = Pose((1.25, -2.5, 0.125), quat_from_rpy(0.1, 0.2, 0.3))


def cabinet(name):
    made = box(name)
    drawer = box("drawer", ("front", "back"), pose=Pose((0.3, 0, 0), quat_from_rpy(0, 0, 0.7)))
    drawer.joints.append(Joint("rail", "prismatic", "front", "back", axis=JointAxis()))
    made.models.append(drawer)
    return made


@pytest.fixture
def running():
    yield from kept(lambda *models, world=None: started(
        world or World("lab", models=list(models), lights=[Light("sun")]),
        log=lambda issue: pytest.fail(str(issue))))


def load(path):
    with open(path, "rb") as file:
        world, issues = parse_world(file.read(), Resolver(), path)
    assert not errors_of(issues), issues
    return world


def test_a_world_that_was_saved_loads_with_the_same_poses_and_description(running, tmp_path):
    sim = running(box("crate"), arm("arm"), box("wall", static=True))
    sim.states.set_model_state("crate", AWAY, Twist())
    sim.states.set_model_state("wall", Pose((0, 0, 5.0)), Twist())
    sim.clock.advance(10)
    path = save_world(sim, "saved.world", roots=[str(tmp_path)], state=True)
    world = apply_state(load(path))
    again = running(world=world)
    for name in sim.models.names():
        assert (differences(sim.states.model_state(name)[0], again.states.model_state(name)[0],
                            1e-6) == [])
    assert differences(present_world(sim).models, world.models, 1e-9) == []
    assert world.initial_ns == sim.clock.sim_ns == 10_000_000


def test_saving_twice_gives_the_same_bytes(running, tmp_path):
    sim = running(box("crate"), arm("arm"))
    sim.states.set_model_state("crate", AWAY, Twist())
    paths = [save_world(sim, name, roots=[str(tmp_path)]) for name in ("a.world", "b.world")]
    first, second = (open(path, "rb").read() for path in paths)
    assert first == second


def test_the_final_pose_stands_in_the_model_and_in_the_state(running, tmp_path):
    sim = running(box("crate"))
    sim.states.set_model_state("crate", Pose((3.0, 2.0, 1.0)), Twist())
    path = save_world(sim, "s.sdf", roots=[str(tmp_path)], state=True)
    root = etree.parse(path).getroot()
    assert root.findtext("world/model/pose") == "3 2 1 0 0 0"
    assert root.findtext("world/state/model/pose") == "3 2 1 0 0 0"
    assert root.find("world/state").get("world_name") == "lab"
    assert root.findtext("world/state/light/pose") == "0 0 0 0 0 0"


def test_a_saved_world_starts_at_time_0_and_at_rest(running, tmp_path):
    sim = running(box("crate"), arm("arm"))
    sim.states.set_model_state("crate", AWAY, Twist((1.0, 0.0, 0.0)))
    sim.joints.set_positions({"hinge": 0.5})
    sim.clock.advance(10)
    path = save_world(sim, "s.sdf", roots=[str(tmp_path)])
    again = running(world=apply_state(load(path)))
    assert again.clock.sim_ns == 0 and again.clock.step == 0
    assert again.states.model_state("crate")[1] == Twist()
    # Only what its own <pose> does not tell stands in the state: a pose can be changed by hand.
    state = etree.parse(path).getroot().find("world/state")
    assert [model.get("name") for model in state.findall("model")] == ["arm"]
    assert state.findtext("sim_time") == "0 0"
    assert state.findtext("model/joint/angle") == "0.5"


def test_a_world_whose_poses_tell_all_is_saved_without_a_state(running, tmp_path):
    sim = running(box("crate"), arm("arm"))
    sim.clock.advance(10)
    path = save_world(sim, "s.sdf", roots=[str(tmp_path)])
    assert etree.parse(path).getroot().find("world/state") is None


def test_what_the_launch_file_spawned_is_saved_on_request_only(running, tmp_path):
    sim = running(box("crate"))
    sim.models.spawn(arm("robo"), launched=True)
    sim.models.edit("robo", replace(sim.models.get("robo"), name="robo_2"))
    sim.models.delete("crate")
    back = sim.models.delete("robo_2")
    sim.models.spawn(arm("robo_2"), deleted=back)
    assert sim.models.launched() == ["robo_2"]
    names = [[model.name for model in load(save_world(
        sim, f"{launched}.sdf", roots=[str(tmp_path)], launched=launched)).models]
        for launched in (False, True)]
    assert names == [[], ["robo_2"]]


def test_a_save_goes_beside_the_users_world_and_never_into_a_file_that_ships(
        running, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    mine = tmp_path / "mine.world"
    mine.write_text("<sdf/>")
    shipped = os.path.join(own_directory(), "world", "lab_course.world")
    assert default_roots(str(mine))[0] == str(tmp_path)
    for world in (shipped, "", str(tmp_path / "gone.world")):
        assert default_roots(world)[0] == str(tmp_path / "home/my_simulations/worlds")
    assert str(tmp_path / "typed_here") in default_roots(caller=str(tmp_path / "typed_here"))
    before = open(shipped, "rb").read()
    with pytest.raises(CommandError, match="ships with my_simulations"):
        save_world(running(box("a")), shipped, roots=default_roots(), overwrite=True)
    assert open(shipped, "rb").read() == before


def test_joint_positions_are_saved(running, tmp_path):
    sim = running(arm("arm"))
    sim.joints.set_positions({"hinge": 0.5})
    root = etree.parse(save_world(sim, "s.sdf", roots=[str(tmp_path)])).getroot()
    angle = root.find("world/state/model/joint/angle")
    assert (angle.get("axis"), angle.text) == ("0", "0.5")


def test_models_that_came_later_are_saved_and_those_that_went_are_not(running, tmp_path):
    sim = running(box("early"))
    sim.models.spawn(box("late"), Pose((0, 0, 9.0)))
    sim.models.delete("early")
    world = load(save_world(sim, "s.sdf", roots=[str(tmp_path)]))
    assert [model.name for model in world.models] == ["late"]


def test_nested_models_come_back_nested(running, tmp_path):
    sim = running(cabinet("cabinet"))
    sim.models.spawn(flatten_model(cabinet("spare")), Pose((4.0, 0, 0)))
    world = load(save_world(sim, "s.sdf", roots=[str(tmp_path)]))
    assert differences(world.models[0], cabinet("cabinet"), 1e-12) == []
    assert [link.name for link in flatten_model(world.models[1]).links] == [
        "link", "drawer::front", "drawer::back"]
    assert differences(flatten_model(world.models[1]).joints,
                       flatten_model(cabinet("spare")).joints) == []


@pytest.mark.parametrize("later", [False, True])
def test_nested_models_keep_what_is_theirs_when_they_come_later_and_when_renamed(
        running, tmp_path, later):
    whole = cabinet("cabinet")
    whole.models[0].plugins.append(PluginSpec("p", "libp.so", '<plugin name="p" filename="l"/>'))
    sim = running() if later else running(whole)
    if later:
        sim.models.spawn(whole, AWAY)
    sim.models.edit("cabinet", replace(sim.models.get("cabinet"), name="cupboard"))
    copy = load(save_world(sim, "w.world", roots=[str(tmp_path)])).models[0]
    assert copy.name == "cupboard" and copy.models[0].plugins[0].name == "p"
    assert differences(copy.models[0].pose, whole.models[0].pose, 1e-12) == []


def test_joints_between_models_and_moved_lights_are_saved(running, tmp_path):
    tie = Joint("tie", "ball", "a::link", "b::link", Pose((0, 0, 0.5)))
    sim = running(world=World("lab", models=[box("a"), box("b"), box("c")], joints=[
        tie, replace(tie, name="gone", parent="c::link")], lights=[Light("sun")]))
    sim.lights.set("sun", Light("sun", pose=AWAY))
    sim.models.delete("c")
    copy = load(save_world(sim, "w.world", roots=[str(tmp_path)]))
    assert copy.joints == [tie]
    assert differences(copy.lights[0].pose, AWAY, 1e-12) == []


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2, math.pi / 2 - 1e-9, 1.5707963])
def test_a_state_near_a_pitch_of_90_degrees_comes_back(running, tmp_path, pitch):
    sim = running(arm("arm"))
    pose = Pose((1, 2, 3), quat_from_rpy(0.7, pitch, -2.0))
    sim.states.set_model_state("arm", pose, Twist())
    path = save_world(sim, "w.world", roots=[str(tmp_path)])
    again = running(world=apply_state(load(path)))
    assert differences(present_world(again).models[0].pose, pose, 1e-8) == []
    assert differences(load(path).models[0].pose, pose, 1e-8) == []


def test_unflattening_undoes_flattening():
    model = cabinet("c")
    model.models[0].models.append(box("inner", pose=Pose((0.1, 0.2, 0.3))))
    assert differences(unflatten_model(flatten_model(model)), model) == []
    bare = replace(flatten_model(model), guide=None)
    assert differences(flatten_model(unflatten_model(bare)), flatten_model(model), 1e-15) == []


def test_a_file_is_replaced_only_when_asked(running, tmp_path):
    sim = running(box("crate"))
    path = save_world(sim, "s.sdf", roots=[str(tmp_path)])
    before = open(path, "rb").read()
    sim.states.set_model_state("crate", AWAY, Twist())
    with pytest.raises(CommandError, match="already exists"):
        save_world(sim, "s.sdf", roots=[str(tmp_path)])
    assert open(path, "rb").read() == before
    save_world(sim, "s.sdf", roots=[str(tmp_path)], overwrite=True)
    assert open(path, "rb").read() != before
    assert os.listdir(tmp_path) == ["s.sdf"]


@pytest.mark.parametrize("path", [
    "../outside.world", "/etc/outside.world", "link/x.world", "file_link.world", "a.txt", "a", "",
    ".world/..",
])
def test_a_path_outside_of_the_roots_is_refused(path, tmp_path):
    root = tmp_path / "root"
    (tmp_path / "elsewhere").mkdir()
    root.mkdir()
    (root / "link").symlink_to(tmp_path / "elsewhere")
    (root / "file_link.world").symlink_to(tmp_path / "elsewhere" / "x.world")
    with pytest.raises(CommandError):
        check_save_path(path, [str(root)])


@pytest.mark.parametrize("character", ["\n", "\x1b", "\x85", "\u2028", "\u202e", "\u2066"])
def test_a_file_name_with_a_character_that_is_not_shown_is_refused(character, tmp_path):
    with pytest.raises(CommandError, match=f"U\\+{ord(character):04X} at position 2"):
        check_save_path(f"a{character}b.world", [str(tmp_path)])
    assert check_save_path("\u0645\u06cc\u200c\u062f.world", [str(tmp_path)])  # a joiner is no such


def test_a_path_below_any_root_is_allowed(tmp_path):
    roots = [str(tmp_path / "a"), str(tmp_path / "b")]
    assert check_save_path("in/x.world", roots) == str(tmp_path / "a/in/x.world")
    assert check_save_path(str(tmp_path / "b/x.SDF"), roots) == str(tmp_path / "b/x.SDF")
    with pytest.raises(CommandError):
        check_save_path(str(tmp_path / "bb/x.sdf"), roots)


def test_the_root_of_the_file_system_is_no_place_for_worlds(monkeypatch):
    monkeypatch.chdir("/")
    assert "/" not in default_roots()


@pytest.mark.parametrize("call", ["fsync", "replace", "fchmod"])
def test_a_full_disk_leaves_the_old_file_and_nothing_else(call, tmp_path, monkeypatch):
    path = tmp_path / "s.world"
    path.write_bytes(b"old")

    def full(*_args):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(safe_file.os, call, full)
    with pytest.raises(CommandError, match="No space left"):
        safe_file.write_atomically(str(path), b"new", True)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["s.world"]


def test_a_folder_that_cannot_be_is_reported(tmp_path):
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(CommandError, match="cannot write"):
        safe_file.write_atomically(str(tmp_path / "file" / "s.world"), b"new", True)


def test_a_replaced_file_keeps_its_mode(tmp_path):
    path = tmp_path / "s.world"
    path.write_bytes(b"old")
    path.chmod(0o640)
    safe_file.write_atomically(str(path), b"new", True)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_an_unchanged_include_is_one_again(running, tmp_path):
    text = ('<sdf version="1.7"><world name="w"><include><uri>model://box</uri><name>b</name>'
            "</include></world></sdf>")
    (tmp_path / "in.world").write_text(text)
    resolver = Resolver.from_environment()
    loaded = read_world(str(tmp_path / "in.world"), resolver)
    world = loaded.world
    sim = running(world=world)
    sim.states.set_model_state("b", Pose((7.0, 0, 0)), Twist())
    path = save_world(sim, "out.world", roots=[str(tmp_path)], resolver=resolver, inline=False)
    include = etree.parse(path).getroot().find("world/include")
    assert include.findtext("uri") == "model://box"
    assert include.findtext("pose") == "7 0 0 0 0 0"


def test_groups_of_the_editor_survive_in_models_and_includes(running, tmp_path):
    text = ('<sdf version="1.7"><world name="w"><include><uri>model://box</uri><name>b</name>'
            "</include></world></sdf>")
    (tmp_path / "in.world").write_text(text)
    resolver = Resolver.from_environment()
    sim = running(world=read_world(str(tmp_path / "in.world"), resolver).world)
    sim.models.spawn(box("a"))
    SetGroups({"a": "a & b", "b": "a & b"}).apply(sim)
    path = save_world(sim, "out.world", roots=[str(tmp_path)], resolver=resolver, inline=False)
    assert etree.parse(path).getroot().find("world/include") is not None
    loaded = read_world(path, resolver)
    assert not loaded.issues
    assert {one.name: group_of(one) for one in loaded.world.models} == {"a": "a & b", "b": "a & b"}


def test_a_world_file_is_not_replaced_by_what_could_be_loaded_of_it(running, tmp_path):
    file = tmp_path / "w.world"
    file.write_text("more than was loaded")
    sim = running(world=World("lab", models=[box("a")], file=str(file), losses=["no model 'b'"]))
    with pytest.raises(CommandError, match="no model 'b'; save under another name"):
        save_world(sim, str(file), roots=[str(tmp_path)], overwrite=True)
    assert file.read_text() == "more than was loaded"
    save_world(sim, str(tmp_path / "other.world"), roots=[str(tmp_path)])
    save_world(sim, str(file), roots=[str(tmp_path)], overwrite=True, despite_losses=True)
    assert [model.name for model in load(str(file)).models] == ["a"]


def test_a_file_is_saved_in_a_folder_that_cannot_be_forced_to_the_disk(tmp_path, monkeypatch):
    force = os.fsync

    def forced(handle):
        if stat.S_ISDIR(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        force(handle)

    monkeypatch.setattr(os, "fsync", forced)
    safe_file.write_atomically(str(tmp_path / "file"), b"content", overwrite=False)
    assert (tmp_path / "file").read_bytes() == b"content"
