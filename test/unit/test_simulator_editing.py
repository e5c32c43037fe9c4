"""Editing what is in a world, on an engine without physics."""
from __future__ import annotations

import threading
import time
from dataclasses import replace

import pytest
from test_simulator import arm, box, case, close  # noqa: F401

from my_simulations.description.model import JointAxis
from my_simulations.description.world import (
    Atmosphere,
    Fog,
    GuiCamera,
    Light,
    Scene,
    Sky,
    SphericalCoordinates,
    Wind,
    World,
)
from my_simulations.errors import CommandError
from my_simulations.formats.load import read_world
from my_simulations.formats.sdf_write import write_world
from my_simulations.geometry import STILL, Pose, Twist, quat_from_rpy
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.moments import Moment
from my_simulations.simulator.registry import UnknownEntity
from my_simulations.simulator.saving import present_world


def again(world, tmp_path):
    path = tmp_path / "again.world"
    path.write_bytes(write_world(world, None))
    found, issues = read_world(str(path), Resolver.from_environment())
    assert not [issue for issue in issues if issue.severity.name == "ERROR"], issues
    return found


# -- models ----------------------------------------------------------------------------------------


def test_an_edited_model_keeps_its_place_in_the_order(case):
    sim = case(box("a"), box("b"), box("c")).sim
    sim.edit_model("b", replace(sim.model("b"), self_collide=True))
    assert sim.model_names() == ["a", "b", "c"]
    assert sim.model("b").self_collide


def test_a_renamed_model_is_found_by_its_new_name_only(case):
    sim = case(box("a", ("x",)), box("b")).sim
    sim.set_model_state("a", Pose((1, 2, 3)), STILL)
    sim.edit_model("a", replace(sim.model("a"), name="z"))
    assert sim.model_names() == ["z", "b"]
    close(sim.link_state("z::x")[0], (1, 2, 3))
    close(sim.link_state("x")[0], (1, 2, 3))
    with pytest.raises(UnknownEntity):
        sim.link_state("a::x")


def test_a_model_cannot_get_the_name_of_another_model_or_light(case):
    sim = case(box("a"), box("b")).sim
    sim.add_light(Light("lamp"))
    for taken in ("b", "lamp", ""):
        with pytest.raises(CommandError):
            sim.edit_model("a", replace(sim.model("a"), name=taken))
    assert sim.model_names() == ["a", "b"]


def test_an_edit_frees_the_rows_it_no_longer_needs(case):
    sim = case(box("a", ("x", "y"))).sim
    for _ in range(100):
        sim.edit_model("a", replace(sim.model("a"), self_collide=True))
    assert sim.inventory()[1][0].first_link_row <= 2


def test_an_entity_is_a_new_object_after_an_edit_and_the_same_without(case):
    sim = case(box("a"), box("b")).sim
    revision, before = sim.inventory()
    sim.edit_model("a", replace(sim.model("a"), self_collide=True))
    newer, after = sim.inventory()
    assert newer > revision
    assert after[0] is not before[0]
    assert after[1] is before[1]


def test_a_reset_takes_an_edited_model_to_where_it_was_loaded(case):
    sim = case(box("a", pose=Pose((7, 0, 0)))).sim
    sim.set_model_state("a", Pose((1, 2, 3)), STILL)
    sim.edit_model("a", replace(sim.model("a"), self_collide=True))
    close(sim.model_state("a")[0], (1, 2, 3))
    sim.reset_world()
    close(sim.model_state("a")[0], (7, 0, 0))


def test_readers_never_miss_a_model_that_is_being_edited(case):
    sim = case(box("a")).sim
    missed, stop = [], threading.Event()

    def watch():
        while not stop.is_set():
            try:
                sim.model_state("a")
            except CommandError as fault:
                missed.append(str(fault))

    watcher = threading.Thread(target=watch)
    watcher.start()
    for n in range(100):
        sim.edit_model("a", replace(sim.model("a"), self_collide=bool(n % 2)))
    stop.set()
    watcher.join()
    assert not missed


def test_a_joint_is_found_plain_and_scoped_and_edited_in_place(case):
    sim = case(arm("a"), arm("b")).sim
    assert sim.find_joint("hinge")[0] == "a"
    assert sim.find_joint("b::hinge")[0] == "b"
    owner, joint, _ = sim.find_joint("b::hinge")
    sim.edit_joint("b::hinge", replace(joint, axis=JointAxis(damping=3.0)))
    assert sim.model("b").joints[0].axis.damping == 3.0
    assert sim.model("a").joints[0].axis.damping == 0.0
    with pytest.raises(UnknownEntity):
        sim.find_joint("knee")


def test_holding_an_unknown_model_is_refused_and_holds_nothing(case):
    made = case(box("a"))
    with pytest.raises(UnknownEntity):
        made.sim.hold(["a", "nobody"])
    assert made.engine.backend.held == ()


def test_a_held_model_stays_held_over_an_edit(case):
    made = case(box("a"))
    made.sim.hold(["a"])
    made.sim.edit_model("a", replace(made.sim.model("a"), name="b"))
    assert made.engine.backend.held == (made.sim.inventory()[1][0].model_id,)


# -- lights ----------------------------------------------------------------------------------------


def test_lights_come_go_and_change(case):
    sim = case(box("a", pose=Pose((1, 0, 0), quat_from_rpy(0, 0, 1.0)))).sim
    sim.add_light(Light("lamp", pose=Pose((0, 0, 2))), "a")
    close(sim.light("lamp").pose, (1, 0, 2), quat_from_rpy(0, 0, 1.0))
    sim.set_light("lamp", replace(sim.light("lamp"), name="spot", type="spot"))
    assert [light.name for light in sim.lights()] == ["spot"]
    assert sim.delete_light("spot").type == "spot"
    assert sim.lights() == []


@pytest.mark.parametrize("light", [
    Light(""), Light("a"), Light("lamp"), Light("new", pose=Pose((float("nan"), 0, 0)))])
def test_a_light_without_a_usable_name_or_pose_is_refused(case, light):
    sim = case(box("a")).sim
    sim.add_light(Light("lamp"))
    with pytest.raises(CommandError):
        sim.add_light(light)
    assert [one.name for one in sim.lights()] == ["lamp"]


def test_an_unknown_light_is_an_error(case):
    sim = case().sim
    for act in (sim.light, sim.delete_light, lambda name: sim.set_light(name, Light(name))):
        with pytest.raises(UnknownEntity):
            act("nobody")


# -- surroundings ----------------------------------------------------------------------------------

SCENE = Scene((0.1, 0.2, 0.3, 1), (0.4, 0.5, 0.6, 1), False, False, True,
              Sky(time=7.5, cloud_speed=2.0), Fog("linear", (1, 0, 0, 1), 2.0, 30.0, 0.5))
CAMERA = GuiCamera("mine", Pose((1, 2, 3), quat_from_rpy(0, 0.5, 1)), "fps", track="a")


def test_changed_surroundings_are_saved_and_read_again(case, tmp_path):
    sim = case(box("a")).sim
    sim.set_scene(SCENE)
    sim.set_gui_camera(CAMERA)
    sim.set_wind(Wind((1, 2, 3)))
    sim.set_atmosphere(Atmosphere(temperature=300.0))
    sim.set_magnetic_field((1e-5, 2e-5, 3e-5))
    sim.set_spherical_coordinates(SphericalCoordinates(latitude_deg=48.5, heading_deg=10.0))
    found = again(present_world(sim), tmp_path)
    assert found.scene == SCENE
    close(found.gui_camera.pose, CAMERA.pose.position, CAMERA.pose.orientation)
    assert replace(found.gui_camera, pose=CAMERA.pose) == CAMERA
    assert found.wind == Wind((1, 2, 3))
    assert found.atmosphere == Atmosphere(temperature=300.0)
    assert found.magnetic_field == (1e-5, 2e-5, 3e-5)
    assert found.spherical_coordinates == SphericalCoordinates(latitude_deg=48.5,
                                                               heading_deg=10.0)


def test_what_the_tables_do_not_know_of_a_scene_is_kept(case, tmp_path):
    sim = case().sim
    sim.world = replace(sim.world, scene=Scene(ambient=(1, 1, 1, 1)), extra=[
        "<scene><ambient>1 1 1 1</ambient><mood>grim</mood>"
        "<sky><time>3</time><material>stars</material></sky></scene>",
        "<gui fullscreen='1'><plugin name='p' filename='libp.so'/></gui>"])
    sim.set_scene(SCENE)
    sim.set_gui_camera(CAMERA)
    text = "".join(sim.world.extra)
    assert "<mood>grim</mood>" in text and "stars" in text
    assert text.count("<ambient>") == 2 - 1
    assert "libp.so" in text and 'fullscreen="1"' in text
    assert again(sim.world, tmp_path).scene == SCENE


def test_sky_and_camera_can_be_taken_away(case, tmp_path):
    sim = case().sim
    sim.set_scene(SCENE)
    sim.set_gui_camera(CAMERA)
    sim.set_scene(replace(SCENE, sky=None, fog=None))
    sim.set_gui_camera(None)
    found = again(sim.world, tmp_path)
    assert (found.scene.sky, found.scene.fog, found.gui_camera) == (None, None, None)


# -- the whole world -------------------------------------------------------------------------------


@pytest.mark.parametrize("paused", [True, False])
def test_another_world_takes_the_place_of_the_whole(case, paused):
    sim = case(box("a"), box("b"), paused=paused).sim
    sim.hold(["a"])
    sim.load_world(World(models=[box("c", pose=Pose((4, 0, 0)))], lights=[Light("lamp")],
                         gravity=(0, 0, -1.6)))
    assert sim.model_names() == ["c"]
    assert [light.name for light in sim.lights()] == ["lamp"]
    assert sim.gravity == (0, 0, -1.6)
    assert sim.paused is paused
    close(sim.model_state("c")[0], (4, 0, 0))
    sim.reset_simulation()
    assert sim.model_names() == ["c"]


def test_faulty_models_of_the_other_world_are_logged_and_the_rest_loaded(case):
    made = case(box("a"))
    made.sim.load_world(World(models=[box("c"), box("c"), box("d")]))
    assert made.sim.model_names() == ["c", "d"]
    assert [issue.code for issue in made.issues] == ["model-refused"]


def test_resetting_time_keeps_poses_and_velocities(case):
    sim = case(box("a")).sim
    sim.set_model_state("a", Pose((1, 0, 0)), Twist((1, 0, 0), (0, 0, 0)))
    sim.advance(10)
    before = sim.model_state("a")
    sim.reset_time()
    assert sim.sim_ns() == 0
    assert sim.model_state("a") == before


def test_a_world_at_rest_is_saved_with_the_time_of_the_saving(case):
    sim = case(box("a"), paused=False).sim
    wait_until(lambda: sim.step() >= 50, 10.0)
    before = sim.step()
    assert present_world(sim).state.iterations >= before


def test_putting_a_moment_back_starts_no_time_that_lockstep_holds(case):
    sim = case(box("a"), paused=False).sim
    sim.set_lockstep(True)
    moment = Moment.of(*sim.look(), sim.ring.clock())
    sim.put_back(moment)
    stands = sim.step()
    with pytest.raises(AssertionError):
        wait_until(lambda: sim.step() != stands, 0.3)
    sim.set_lockstep(False)
    wait_until(lambda: sim.step() != stands, 10.0)


def wait_until(true, seconds):
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.005)
