"""The simulator on an engine without physics."""
from __future__ import annotations

import math
import threading
import time
from dataclasses import replace

import pytest
from box_models import arm, box
from inline_engine import InlineEngine
from kinematic_backend import KinematicBackend
from running_simulator import started

from my_simulations.description.light import Light
from my_simulations.description.model import Model
from my_simulations.description.shapes import Collision, Mesh
from my_simulations.description.world import World
from my_simulations.engine.commands import FOREVER
from my_simulations.engine.timed_forces import TimedWrench
from my_simulations.errors import CommandError, EngineLostError
from my_simulations.geometry import IDENTITY, STILL, Pose, Twist, quat_from_rpy
from my_simulations.simulator.feeds import ROW_WIDTH
from my_simulations.simulator.registry import UnknownEntityError, UnknownFrameError
from my_simulations.simulator.row_layout import RowAllocator


class Case:
    def __init__(self, *models, paused=True):
        self.issues = []
        self.engine = InlineEngine()
        self.sim = started(World(models=list(models)), engine=lambda: self.engine, paused=paused,
                           log=self.issues.append)


@pytest.fixture
def case():
    made = []

    def make(*models, paused=True):
        made.append(Case(*models, paused=paused))
        return made[-1]

    yield make
    for one in made:
        one.sim.close()


def close(pose, position, orientation=(0, 0, 0, 1)):
    assert pose.position == pytest.approx(position, abs=1e-12)
    assert pose.orientation == pytest.approx(orientation, abs=1e-12)


def test_the_worlds_models_are_there_in_order(case):
    sim = case(box("b"), box("a"), box("c")).sim
    assert sim.models.names() == ["b", "a", "c"]


def test_a_model_the_world_names_twice_is_logged_and_the_rest_loaded(case):
    made = case(box("a"), box("a"), box("b"))
    assert made.sim.models.names() == ["a", "b"]
    assert [issue.code for issue in made.issues] == ["model-refused"]


def test_a_spawned_model_is_where_it_was_asked_for(case):
    sim = case().sim
    sim.models.spawn(box("a"), Pose((1, 2, 3), (0, 0, 0, 2)))
    close(sim.states.model_state("a")[0], (1, 2, 3))


def test_a_spawn_pose_may_be_given_in_a_models_frame(case):
    sim = case(box("base", pose=Pose((5, 0, 0), quat_from_rpy(0, 0, math.pi / 2)))).sim
    sim.models.spawn(box("a"), Pose((1, 0, 0)), "base")
    close(sim.states.model_state("a")[0], (5, 1, 0), quat_from_rpy(0, 0, math.pi / 2))


@pytest.mark.parametrize("name", ["", "taken"])
def test_an_empty_or_taken_name_is_refused(case, name):
    sim = case(box("taken")).sim
    with pytest.raises(CommandError):
        sim.models.spawn(box(name))
    assert sim.models.names() == ["taken"]


@pytest.mark.parametrize(("name", "said"), [
    ("x" * 1001, "may have 1000 characters, not 1001: 'xxxxxxxxxxxxxxxxxxxx...'"),
    ("a\nb", "the character U[+]000A at position 2, which is not shown"),
    ("\u202exob", "the character U[+]202E at position 1, which is not shown"),
])
def test_a_name_that_no_list_can_show_is_refused(case, name, said):
    sim = case(box("here")).sim
    with pytest.raises(CommandError, match=said):
        sim.models.spawn(box(name))
    with pytest.raises(CommandError, match=said):
        sim.models.edit("here", replace(sim.models.get("here"), name=name))
    with pytest.raises(CommandError, match=said):
        sim.lights.add(Light(name, "point"))
    assert sim.models.names() == ["here"] and sim.world.lights == []
    sim.models.spawn(box("caf\u00e9 \U0001f916 " + "x" * 990))


def test_a_replaced_model_goes_last_and_is_never_absent(case, quick_threads):
    sim = case(box("a"), box("b")).sim
    absent = []
    stop = threading.Event()

    def watch():
        while not stop.is_set():
            if not sim.models.has("a"):
                absent.append(True)

    watcher = threading.Thread(target=watch)
    watcher.start()
    for n in range(50):
        sim.models.spawn(box("a"), Pose((float(n), 0, 0)), replace=True)
    stop.set()
    watcher.join()
    assert not absent
    assert sim.models.names() == ["b", "a"]
    close(sim.states.model_state("a")[0], (49, 0, 0))


def test_a_deleted_model_is_gone_and_its_rows_are_used_again(case):
    sim = case().sim
    for _ in range(3):
        sim.models.spawn(box("a"))
        sim.models.delete("a")
        assert not sim.models.has("a")
        with pytest.raises(UnknownEntityError):
            sim.states.model_state("a")
    sim.models.spawn(box("b"))
    assert sim._session.registry.model("b").first_link_row == 0


def test_an_unknown_name_is_answered_with_the_closest(case):
    sim = case(box("cylinder")).sim
    with pytest.raises(UnknownEntityError, match="did you mean cylinder"):
        sim.models.delete("cilinder")


def test_an_unknown_link_or_joint_is_answered_with_the_scoped_name_that_was_meant(case):
    sim = case(box("crate"), arm("robot")).sim
    for name, meant in (("crate", "it is a model, its link is crate::link"),
                        ("robot", "it is a model, its links are robot::"),
                        ("crate::lnik", r"did you mean crate::link\?"),
                        ("carte::link", r"did you mean crate::link\?"),
                        ("lnik", r"did you mean crate::link\?")):
        with pytest.raises(UnknownEntityError, match=meant):
            sim.states.link_state(name)
    for name in ("hnige", "robot::hnige"):
        with pytest.raises(UnknownEntityError, match=r"did you mean robot::hinge\?"):
            sim.joints.find(name)


def test_links_are_found_by_scoped_and_by_plain_name(case):
    sim = case(box("a", ("x", "y")), box("b", ("y", "z"))).sim
    close(sim.states.link_state("b::y")[0], (0, 0, 0))
    close(sim.states.link_state("y")[0], (1, 0, 0))   # the first in the world
    close(sim.states.link_state("z")[0], (1, 0, 0))
    with pytest.raises(UnknownEntityError):
        sim.states.link_state("a::z")


def test_a_plain_name_of_several_models_is_warned_about_once(case):
    made = case(box("a", ("x", "y")), box("b", ("y", "z")), arm("c"), arm("d"))
    sim = made.sim
    for _ in range(3):
        for name in ("a::y", "b::y", "x", "z", "y"):
            sim.states.link_state(name)
        sim.states.model_state("c", "base")
        sim.joints.states("hinge")[0]
        sim.joints.find("hinge")
    assert [str(issue.severity.name) for issue in made.issues] == ["WARNING"] * 3
    links, base, joints = (issue.message for issue in made.issues)
    assert "'a' and 'b' have a link 'y'; using that of 'a'; write 'a::y'" in links
    assert "'c' and 'd' have a link 'base'" in base
    assert "'c' and 'd' have a joint 'hinge'" in joints


def test_scoped_and_single_names_are_not_warned_about(case):
    made = case(arm("a"), arm("b"))
    made.sim.joints.states("b::hinge")[0]
    made.sim.joints.find("a::hinge")
    made.sim.states.link_state("a::tip", "b::tip")
    made.sim.models.delete("a")
    made.sim.joints.states("hinge")[0]
    made.sim.states.link_state("tip")
    assert made.issues == []


def test_relative_states_turn_pose_and_velocity_difference_into_the_frame(case):
    sim = case(box("a"), box("b")).sim
    quarter = quat_from_rpy(0, 0, math.pi / 2)
    sim.states.set_model_state("a", Pose((1, 0, 0), quarter), Twist((0, 1, 0), (0, 0, 1)))
    sim.states.set_model_state("b", Pose((1, 2, 0), quarter), Twist((3, 1, 0), (0, 0, 2)))
    pose, twist = sim.states.model_state("b", "a")
    close(pose, (2, 0, 0))
    assert twist.linear == pytest.approx((0, -3, 0))
    assert twist.angular == pytest.approx((0, 0, 1))


@pytest.mark.parametrize("frame", ["", "world", "map", "/map"])
def test_the_world_frame_has_four_names(case, frame):
    close(case(box("a", pose=Pose((1, 0, 0)))).sim.states.model_state("a", frame)[0], (1, 0, 0))


def test_links_and_collisions_are_frames_and_tf_names_are_not(case):
    sim = case(box("a", ("x", "y")), box("b")).sim
    close(sim.states.model_state("b", "a::y")[0], (-1, 0, 0))
    close(sim.states.model_state("b", "a::y::c")[0], (-1, 0, -2))
    for unknown in ("/world", "base_link", "a::nothing"):
        with pytest.raises(UnknownFrameError):
            sim.states.model_state("b", unknown)


def test_an_entity_called_world_shadows_the_literal(case):
    sim = case(box("world", pose=Pose((1, 0, 0))), box("b")).sim
    close(sim.states.model_state("b", "world")[0], (-1, 0, 0))


def test_a_model_moves_relative_to_its_own_link(case):
    sim = case(box("a", ("x", "y"))).sim
    for _ in range(3):
        sim.states.set_model_state("a", Pose((0.1, 0, 0)), STILL, "a::x")
    close(sim.states.model_state("a")[0], (0.3, 0, 0))
    close(sim.states.link_state("a::y")[0], (1.3, 0, 0))


@pytest.mark.parametrize("bad", [Pose((math.nan, 0, 0)), Pose((0, 0, 0), (0, 0, math.inf, 1))])
def test_numbers_that_are_none_are_refused_and_nothing_moves(case, bad):
    sim = case(box("a", pose=Pose((1, 0, 0)))).sim
    for setter in (sim.states.set_model_state, sim.states.set_link_state):
        with pytest.raises(CommandError, match="NaN"):
            setter("a" if setter == sim.states.set_model_state else "a::link", bad, STILL)
    with pytest.raises(CommandError, match="NaN"):
        sim.states.set_model_state("a", IDENTITY, Twist((math.nan, 0, 0)))
    close(sim.states.model_state("a")[0], (1, 0, 0))


def test_a_zero_quaternion_is_identity(case):
    sim = case(box("a")).sim
    sim.states.set_model_state("a", Pose((1, 0, 0), (0, 0, 0, 0)), STILL)
    close(sim.states.model_state("a")[0], (1, 0, 0))


def test_a_model_without_links_is_listed_and_can_be_moved(case):
    sim = case(Model("world_urdf", pose=Pose((1, 0, 0))), box("b")).sim
    assert sim.models.names() == ["world_urdf", "b"]
    sim.states.set_model_state("world_urdf", Pose((2, 0, 0)), STILL)
    close(sim.states.model_state("world_urdf")[0], (2, 0, 0))
    close(sim.states.model_state("b", "world_urdf")[0], (-2, 0, 0))
    sim.models.delete("world_urdf")


def test_states_are_parallel_lists_in_load_order(case):
    sim = case(box("a", ("x", "y")), Model("empty"), box("b")).sim
    layout, sequence, rows = sim.feed.states()
    assert layout.model_names == ["a", "empty", "b"]
    assert layout.link_names == ["a::x", "a::y", "b::link"]
    assert len(layout.model_places) == len(layout.link_places) == 3
    assert len(rows) == 3 * 8 * ROW_WIDTH
    sim.states.set_model_state("b", Pose((1, 0, 0)), STILL)
    sim.states.await_posted()
    again, later, _ = sim.feed.states()
    assert again is layout and later > sequence


def test_reset_world_keeps_time_and_joints(case):
    sim = case(arm("a"), paused=True).sim
    sim.joints.set_positions({"hinge": 0.7})
    sim.states.set_model_state("a", Pose((3, 0, 0)), Twist((1, 0, 0)))
    sim.clock.advance(10)
    sim.resets.reset_world()
    close(sim.states.model_state("a")[0], (0, 0, 0))
    assert sim.states.model_state("a")[1] == STILL
    assert sim.joints.states("a::hinge")[0][0] == 0.7
    assert sim.clock.sim_ns == 10_000_000


def test_reset_simulation_restores_joints_and_time_and_keeps_what_was_spawned(case):
    sim = case(arm("a"), box("gone")).sim
    sim.models.spawn(box("late"), Pose((4, 0, 0)))
    sim.models.delete("gone")
    sim.joints.set_positions({"hinge": 0.7})
    sim.states.set_model_state("late", Pose((9, 9, 9)), STILL)
    sim.wrenches.add([TimedWrench(0, 0, 0, FOREVER)])
    sim.clock.advance(10)
    sim.resets.reset_simulation()
    assert sim.models.names() == ["a", "late"]
    assert sim.joints.states("hinge")[0] == (0.0, 0.0)
    close(sim.states.model_state("late")[0], (4, 0, 0))
    assert (sim.clock.sim_ns, sim.clock.step) == (0, 0)
    assert not sim.wrenches.ids


def test_a_dead_engine_is_replaced_and_everything_is_as_in_the_last_snapshot(case):
    made = case(arm("a"), box("b"))
    sim = made.sim
    sim.states.set_model_state("b", Pose((1, 2, 3), quat_from_rpy(0, 0, 1)), Twist((4, 5, 6), (7, 8,
                                                                                               9)))
    sim.joints.set_positions({"hinge": 0.5})
    [kept] = sim.wrenches.add([TimedWrench(0, 0, 0, FOREVER)])
    sim.wrenches.add([TimedWrench(0, 0, 0, 5)])   # over by the time of the crash
    sim.clock.advance(10)
    before = (sim.states.model_state("b"), sim.joints.states("hinge")[0], sim.clock.sim_ns,
              sim.clock.step)
    first = made.engine.backend
    made.engine.kill()
    sim.clock.advance(0)
    assert made.engine.backend is not first
    assert (
        sim.states.model_state("b"),
        sim.joints.states("hinge")[0],
        sim.clock.sim_ns,
        sim.clock.step,
    ) == before
    assert list(made.engine.backend.timed_forces) == [kept]
    assert [issue.code for issue in made.issues] == ["engine-died"]


def test_a_restarted_world_runs_on_unless_it_was_paused(case):
    made = case(box("a"), paused=False)
    made.engine.kill()
    made.sim.states.set_model_state("a", IDENTITY, STILL)
    at = made.sim.clock.step
    deadline = time.monotonic() + 60
    while made.sim.clock.step == at:
        assert time.monotonic() < deadline


def test_the_command_that_killed_the_engine_fails_and_others_are_sent_again(case):
    made = case(box("a"))
    blown = threading.Event()
    original = KinematicBackend.step

    def blow_up(self, first, count):
        if not blown.is_set() and self.models:
            blown.set()
            threading.Thread(target=made.engine.kill).start()
            # It is told to end before it answers the advance.
            deadline = time.monotonic() + 60
            while made.engine._alive or made.engine._channel.commands.empty():
                assert time.monotonic() < deadline
                time.sleep(0.001)
        original(self, first, count)

    KinematicBackend.step = blow_up
    try:
        with pytest.raises(EngineLostError, match="killed"):
            made.sim.clock.advance(5)
    finally:
        KinematicBackend.step = original
    made.sim.states.set_model_state("a", Pose((1, 0, 0)), STILL)
    close(made.sim.states.model_state("a")[0], (1, 0, 0))


def test_many_threads_may_spawn_move_and_delete_at_once(case):
    sim = case(paused=False).sim
    faults = []

    def work(number):
        try:
            for turn in range(20):
                name = f"m{number}_{turn}"
                sim.models.spawn(box(name), Pose((number, turn, 0)))
                sim.states.set_model_state(name, Pose((number, turn, 1)), STILL)
                close(sim.states.model_state(name)[0], (number, turn, 1))
                sim.models.delete(name)
        except Exception as fault:
            faults.append(fault)

    threads = [threading.Thread(target=work, args=(n,)) for n in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not faults
    assert sim.models.names() == []


def test_rows_are_handed_out_first_fit_and_merge_when_freed():
    rows = RowAllocator(10)
    assert [rows.allocate(4), rows.allocate(4), rows.allocate(4)] == [0, 4, None]
    rows.free(0, 4)
    rows.free(4, 4)
    assert rows.allocate(10) == 0


def test_a_collision_without_its_mesh_stays_in_the_description_and_out_of_the_engine(case):
    made = case()
    model = box("a")
    model.links[0].collisions.append(Collision("lost", Mesh("model://gone/lost.dae")))
    made.sim.models.spawn(model)
    assert [c.name for c in made.sim.models.get("a").links[0].collisions] == ["c", "lost"]
    [loaded] = made.engine.backend.models.values()
    assert [c.name for c in loaded[0].links[0].collisions] == ["c"]
