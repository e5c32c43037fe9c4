"""Editing what is in a world, on an engine without physics."""
from __future__ import annotations

import threading
import time
from dataclasses import replace

import pytest
from reading import world_of
from test_simulator import arm, box, case, close  # noqa: F401

from my_simulations.description.light import Light
from my_simulations.description.model import JointAxis
from my_simulations.description.surroundings import (
    Atmosphere,
    Fog,
    GuiCamera,
    Scene,
    Sky,
    SphericalCoordinates,
    Wind,
)
from my_simulations.description.world import World
from my_simulations.errors import CommandError, errors_of
from my_simulations.formats.reading import read_world
from my_simulations.formats.sdf.writer.entities import write_world
from my_simulations.geometry import STILL, Pose, Twist, quat_from_rpy
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.registry import UnknownEntityError
from my_simulations.simulator.saving import present_world


def again(world, tmp_path):
    path = tmp_path / "again.world"
    path.write_bytes(write_world(world, None))
    found = read_world(str(path), Resolver.from_environment())
    assert not errors_of(found.issues), found.issues
    return found.world


# -- models ----------------------------------------------------------------------------------------


def test_an_edited_model_keeps_its_place_in_the_order(case):
    sim = case(box("a"), box("b"), box("c")).sim
    sim.models.edit("b", replace(sim.models.get("b"), self_collide=True))
    assert sim.models.names() == ["a", "b", "c"]
    assert sim.models.get("b").self_collide


def test_a_renamed_model_is_found_by_its_new_name_only(case):
    sim = case(box("a", ("x",)), box("b")).sim
    sim.states.set_model_state("a", Pose((1, 2, 3)), STILL)
    sim.models.edit("a", replace(sim.models.get("a"), name="z"))
    assert sim.models.names() == ["z", "b"]
    close(sim.states.link_state("z::x")[0], (1, 2, 3))
    close(sim.states.link_state("x")[0], (1, 2, 3))
    with pytest.raises(UnknownEntityError):
        sim.states.link_state("a::x")


def test_a_model_cannot_get_the_name_of_another_model_or_light(case):
    sim = case(box("a"), box("b")).sim
    sim.lights.add(Light("lamp"))
    for taken in ("b", "lamp", ""):
        with pytest.raises(CommandError):
            sim.models.edit("a", replace(sim.models.get("a"), name=taken))
    assert sim.models.names() == ["a", "b"]


def test_an_edit_frees_the_rows_it_no_longer_needs(case):
    sim = case(box("a", ("x", "y"))).sim
    for _ in range(100):
        sim.models.edit("a", replace(sim.models.get("a"), self_collide=True))
    assert sim.models.inventory()[1][0].first_link_row <= 2


def test_an_entity_is_a_new_object_after_an_edit_and_the_same_without(case):
    sim = case(box("a"), box("b")).sim
    revision, before = sim.models.inventory()
    sim.models.edit("a", replace(sim.models.get("a"), self_collide=True))
    newer, after = sim.models.inventory()
    assert newer > revision
    assert after[0] is not before[0]
    assert after[1] is before[1]


def test_a_reset_takes_an_edited_model_to_where_it_was_loaded(case):
    sim = case(box("a", pose=Pose((7, 0, 0)))).sim
    sim.states.set_model_state("a", Pose((1, 2, 3)), STILL)
    sim.models.edit("a", replace(sim.models.get("a"), self_collide=True))
    close(sim.states.model_state("a")[0], (1, 2, 3))
    sim.resets.reset_world()
    close(sim.states.model_state("a")[0], (7, 0, 0))


def test_readers_never_miss_a_model_that_is_being_edited(case, quick_threads):
    sim = case(box("a")).sim
    missed, stop = [], threading.Event()

    def watch():
        while not stop.is_set():
            try:
                sim.states.model_state("a")
            except CommandError as fault:
                missed.append(str(fault))

    watcher = threading.Thread(target=watch)
    watcher.start()
    for n in range(100):
        sim.models.edit("a", replace(sim.models.get("a"), self_collide=bool(n % 2)))
    stop.set()
    watcher.join()
    assert not missed


def test_a_joint_is_found_plain_and_scoped_and_edited_in_place(case):
    sim = case(arm("a"), arm("b")).sim
    assert sim.joints.find("hinge")[0] == "a"
    assert sim.joints.find("b::hinge")[0] == "b"
    owner, joint, _ = sim.joints.find("b::hinge")
    sim.joints.edit("b::hinge", replace(joint, axis=JointAxis(damping=3.0)))
    assert sim.models.get("b").joints[0].axis.damping == 3.0
    assert sim.models.get("a").joints[0].axis.damping == 0.0
    assert sim.joints.find("b::hinge")[1].axis.damping == 3.0
    with pytest.raises(UnknownEntityError):
        sim.joints.find("knee")
    sim.models.delete("a")
    assert sim.joints.find("hinge")[0] == "b"
    with pytest.raises(UnknownEntityError):
        sim.joints.find("a::hinge")


def test_holding_an_unknown_model_is_refused_and_holds_nothing(case):
    made = case(box("a"))
    with pytest.raises(UnknownEntityError):
        made.sim.models.pin(["a", "nobody"])
    assert made.engine.backend.held == ()


def test_a_held_model_stays_held_over_an_edit(case):
    made = case(box("a"))
    made.sim.models.pin(["a"])
    made.sim.models.edit("a", replace(made.sim.models.get("a"), name="b"))
    assert made.engine.backend.held == (made.sim.models.inventory()[1][0].model_id,)


# -- lights ----------------------------------------------------------------------------------------


def test_lights_come_go_and_change(case):
    sim = case(box("a", pose=Pose((1, 0, 0), quat_from_rpy(0, 0, 1.0)))).sim
    sim.lights.add(Light("lamp", pose=Pose((0, 0, 2))), "a")
    close(sim.lights.get("lamp").pose, (1, 0, 2), quat_from_rpy(0, 0, 1.0))
    sim.lights.set("lamp", replace(sim.lights.get("lamp"), name="spot", type="spot"))
    assert [light.name for light in sim.lights.all()] == ["spot"]
    assert sim.lights.delete("spot").type == "spot"
    assert sim.lights.all() == []


@pytest.mark.parametrize("light", [
    Light(""), Light("a"), Light("lamp"), Light("new", pose=Pose((float("nan"), 0, 0)))])
def test_a_light_without_a_usable_name_or_pose_is_refused(case, light):
    sim = case(box("a")).sim
    sim.lights.add(Light("lamp"))
    with pytest.raises(CommandError):
        sim.lights.add(light)
    assert [one.name for one in sim.lights.all()] == ["lamp"]


def test_an_unknown_light_is_an_error(case):
    sim = case().sim
    for act in (sim.lights.get, sim.lights.delete, lambda name: sim.lights.set(name, Light(name))):
        with pytest.raises(UnknownEntityError):
            act("nobody")


# -- surroundings ----------------------------------------------------------------------------------

SCENE = Scene((0.1, 0.2, 0.3, 1), (0.4, 0.5, 0.6, 1), False, False, True,
              Sky(time=7.5, cloud_speed=2.0), Fog("linear", (1, 0, 0, 1), 2.0, 30.0, 0.5))
CAMERA = GuiCamera("mine", Pose((1, 2, 3), quat_from_rpy(0, 0.5, 1)), "fps", track="a")


def test_changed_surroundings_are_saved_and_read_again(case, tmp_path):
    sim = case(box("a")).sim
    sim.scene.set_field("scene", SCENE)
    sim.scene.set_field("gui_camera", CAMERA)
    sim.scene.set_field("wind", Wind((1, 2, 3)))
    sim.scene.set_field("atmosphere", Atmosphere(temperature=300.0))
    sim.scene.set_field("magnetic_field", (1e-5, 2e-5, 3e-5))
    sim.scene.set_field("spherical_coordinates",
                        SphericalCoordinates(latitude_deg=48.5, heading_deg=10.0))
    found = again(present_world(sim), tmp_path)
    assert found.scene == SCENE
    close(found.gui_camera.pose, CAMERA.pose.position, CAMERA.pose.orientation)
    assert replace(found.gui_camera, pose=CAMERA.pose) == CAMERA
    assert found.wind == Wind((1, 2, 3))
    assert found.atmosphere == Atmosphere(temperature=300.0)
    assert found.magnetic_field == (1e-5, 2e-5, 3e-5)
    assert found.spherical_coordinates == SphericalCoordinates(latitude_deg=48.5, heading_deg=10.0)


def test_what_the_tables_do_not_know_of_a_scene_is_kept(case, tmp_path):
    sim = case().sim
    read, _ = world_of(
        "<scene><ambient>1 1 1 1</ambient><mood>grim</mood>"
        "<sky><time>3</time><material>stars</material></sky></scene>"
        "<gui fullscreen='1'><plugin name='p' filename='libp.so'/></gui>")
    sim._session.world = replace(sim.world, scene=read.scene, gui=read.gui)
    sim.scene.set_field("scene", SCENE)
    sim.scene.set_field("gui_camera", CAMERA)
    text = write_world(sim.world).decode()
    assert "<mood>grim</mood>" in text and "stars" in text
    assert text.count("<ambient>") == 2 - 1
    assert "libp.so" in text and 'fullscreen="true"' in text
    found = again(sim.world, tmp_path).scene
    assert replace(found, extra=[], sky=replace(found.sky, extra=[])) == SCENE


def test_sky_and_camera_can_be_taken_away(case, tmp_path):
    sim = case().sim
    sim.scene.set_field("scene", SCENE)
    sim.scene.set_field("gui_camera", CAMERA)
    sim.scene.set_field("scene", replace(SCENE, sky=None, fog=None))
    sim.scene.set_field("gui_camera", None)
    found = again(sim.world, tmp_path)
    assert (found.scene.sky, found.scene.fog, found.gui_camera) == (None, None, None)


# -- the whole world -------------------------------------------------------------------------------


@pytest.mark.parametrize("paused", [True, False])
def test_another_world_takes_the_place_of_the_whole(case, paused):
    sim = case(box("a"), box("b"), paused=paused).sim
    sim.models.pin(["a"])
    sim.load_world(World(models=[box("c", pose=Pose((4, 0, 0)))], lights=[Light("lamp")],
                         gravity=(0, 0, -1.6)))
    assert sim.models.names() == ["c"]
    assert [light.name for light in sim.lights.all()] == ["lamp"]
    assert sim.physics.gravity == (0, 0, -1.6)
    assert sim.clock.paused is paused
    close(sim.states.model_state("c")[0], (4, 0, 0))
    sim.resets.reset_simulation()
    assert sim.models.names() == ["c"]


def test_faulty_models_of_the_other_world_are_logged_and_the_rest_loaded(case):
    made = case(box("a"))
    made.sim.load_world(World(models=[box("c"), box("c"), box("d")]))
    assert made.sim.models.names() == ["c", "d"]
    assert [issue.code for issue in made.issues] == ["model-refused"]


def test_resetting_time_keeps_poses_and_velocities(case):
    sim = case(box("a")).sim
    sim.states.set_model_state("a", Pose((1, 0, 0)), Twist((1, 0, 0), (0, 0, 0)))
    sim.clock.advance(10)
    before = sim.states.model_state("a")
    sim.resets.reset_time()
    assert sim.clock.sim_ns == 0
    assert sim.states.model_state("a") == before


def test_a_world_at_rest_is_saved_with_the_time_of_the_saving(case):
    sim = case(box("a"), paused=False).sim
    wait_until(lambda: sim.clock.step >= 50, 10.0)
    before = sim.clock.step
    assert present_world(sim).state.iterations >= before


def test_putting_a_moment_back_starts_no_time_that_lockstep_holds(case):
    sim = case(box("a"), paused=False).sim
    sim.clock.set_manual_stepping(True)
    moment = sim.states.capture()
    sim.states.restore(moment)
    stands = sim.clock.step
    with pytest.raises(AssertionError):
        wait_until(lambda: sim.clock.step != stands, 0.3)
    sim.clock.set_manual_stepping(False)
    wait_until(lambda: sim.clock.step != stands, 10.0)


def wait_until(true, seconds):
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.005)
