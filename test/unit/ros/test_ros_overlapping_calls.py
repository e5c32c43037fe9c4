"""Calls of two clients at the same time: each takes effect on what it names, or is refused."""
from __future__ import annotations

import threading

import pytest
from gazebo_msgs import srv
from geometry_msgs.msg import Pose as PoseMessage
from running_simulator import running

from my_simulations.description.light import Light
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.commands import FOREVER
from my_simulations.errors import CommandError
from my_simulations.geometry import STILL, Pose
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.services.joint_services import JointServices
from my_simulations.ros.services.model_services import ModelServices
from my_simulations.ros.services.physics_parameters import change_parameters, current_parameters
from my_simulations.ros.services.wrench_services import WrenchServices
from my_simulations.simulator.registry import UnknownEntityError

FAR = Pose((5.0, 5.0, 5.0))
NEAR = Pose((1.0, 0.0, 0.0))


def model(name):
    return Model(name, links=[Link("base", inertial=Inertial()),
                              Link("tip", Pose((1.0, 0.0, 0.0)), Inertial())],
                 joints=[Joint("hinge", "revolute", "base", "tip", axis=JointAxis())])


@pytest.fixture
def sim():
    with running(World(models=[model("a"), model("other")], lights=[Light("sun")])) as made:
        yield made


@pytest.fixture
def meanwhile(sim, monkeypatch):
    """Lets another client do something between a look at the registry and the next command.

    A command that can be posted is sent under the lock of such changes; here as many are posted as
    may wait.
    """
    monkeypatch.setattr(sim._session.supervisor, "post", lambda command: False)

    def then(work):
        call = sim._session.call

        def first(command):
            monkeypatch.setattr(sim._session, "call", call)
            work()
            return call(command)

        monkeypatch.setattr(sim._session, "call", first)

    return then


MOVES = {
    "a link": lambda sim: sim.states.set_link_state("a::base", NEAR, STILL),
    "a model": lambda sim: sim.states.set_model_state("a", NEAR, STILL),
    "a joint": lambda sim: sim.joints.set_positions({"a::hinge": 0.5}),
    "in a frame": lambda sim: sim.states.set_model_state("other", NEAR, STILL, "a::base"),
}


@pytest.mark.parametrize("what", MOVES)
def test_what_was_deleted_meanwhile_is_refused_and_who_has_its_rows_stays(sim, meanwhile, what):
    def work():
        sim.models.delete("a")
        sim.models.spawn(model("victim"), FAR)

    before = sim.states.model_state("other")
    meanwhile(work)
    with pytest.raises(CommandError):
        MOVES[what](sim)
    assert sim.states.model_state("victim")[0].position == FAR.position
    assert sim.joints.states("victim::hinge") == [(0.0, 0.0)]
    assert sim.states.model_state("other") == before


def test_the_error_of_what_was_deleted_meanwhile_is_that_of_an_unknown_name(sim, meanwhile):
    meanwhile(lambda: sim.models.delete("a"))
    with pytest.raises(UnknownEntityError):
        MOVES["a model"](sim)


def test_no_model_is_deleted_between_a_look_at_the_registry_and_a_posted_command(sim, monkeypatch):
    found, deleted = threading.Event(), []
    post = sim._session.supervisor.post

    def late(command):
        deleter.start()
        deleter.join(0.2)  # which it would need to come in between
        deleted.append(not sim.models.has("a"))
        return post(command)

    deleter = threading.Thread(target=lambda: (sim.models.delete("a"), found.set()))
    monkeypatch.setattr(sim._session.supervisor, "post", late)
    sim.states.set_model_state("a", NEAR, STILL)
    assert found.wait(60) and deleted == [False]
    deleter.join()
    assert sim.models.names() == ["other"]


@pytest.mark.parametrize("what", MOVES)
def test_what_was_edited_meanwhile_is_moved(sim, meanwhile, what):
    meanwhile(lambda: sim.models.edit("a", model("a")))
    MOVES[what](sim)
    moved = "other" if what == "in a frame" else "a"
    if what == "a joint":
        assert sim.joints.states("a::hinge")[0][0] == 0.5
    else:
        assert sim.states.model_state(moved)[0].position == pytest.approx(NEAR.position)


def test_joint_properties_that_two_clients_set_are_both_kept(sim, monkeypatch):
    services = JointServices(sim)
    other = srv.SetJointPropertiesRequest(joint_name="a::hinge")
    other.ode_joint_config.damping = [0.7]
    thread = threading.Thread(target=services.set, args=(other, None))
    find = sim.joints.find

    def between(name):
        monkeypatch.setattr(sim.joints, "find", find)
        found = find(name)
        thread.start()
        thread.join(0.5)    # it ends here unless it waits for us
        return found

    monkeypatch.setattr(sim.joints, "find", between)
    request = srv.SetJointPropertiesRequest(joint_name="a::hinge")
    request.ode_joint_config.fmax = [3.0]
    services.set(request, None)
    thread.join()
    axis = find("a::hinge")[1].axis
    assert (axis.damping, axis.friction) == (0.7, 3.0)


def test_efforts_are_cleared_while_another_model_is_deleted(sim, monkeypatch):
    sim.wrenches.apply_effort("a::hinge", 1.0)
    names = sim.models.names

    def deleted():
        found = names()
        sim.models.delete("other")
        return found

    monkeypatch.setattr(sim.models, "names", deleted)
    assert WrenchServices(sim).clear_efforts(srv.JointRequestRequest("hinge"), None) == ""
    assert sim.wrenches.efforts_on("a::hinge") == ()


def test_the_second_of_two_spawns_of_a_name_is_refused_in_gazebos_words(sim, monkeypatch):
    services = ModelServices(sim, Resolver(), lambda issue: None, 0)
    request = srv.SpawnModelRequest(
        model_name="n", initial_pose=PoseMessage(),
        model_xml="<sdf version='1.6'><model name='m'><link name='l'/></model></sdf>")
    has = sim.models.has

    def first(name):
        found = has(name)
        monkeypatch.setattr(sim.models, "has", has)
        services.spawn_sdf(request, None)
        return found

    monkeypatch.setattr(sim.models, "has", first)
    with pytest.raises(CommandError, match="^Failure - entity already exists"):
        services.spawn_sdf(request, None)


def test_an_update_rate_below_zero_is_as_fast_as_possible(sim):
    change_parameters(sim, {"max_update_rate": -1.0})
    assert current_parameters(sim)["max_update_rate"] == 0.0


@pytest.mark.parametrize("start_s, steps", [(0.0, (0, 500)), (1.0, (500, 1000))])
def test_timed_wrenches_keep_their_sim_times_when_the_step_size_changes(sim, start_s, steps):
    sim.wrenches.apply_wrench("a::base", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0),
                              start_ns=round(start_s * 1e9), duration_ns=10 ** 9)
    sim.wrenches.apply_wrench("other::base", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    change_parameters(sim, {"time_step": 0.002})
    engine = sim._session.supervisor.engine
    for forces in (sim.wrenches.pending(0), engine.backend.timed_forces.values()):
        first, second = forces
        assert (first.start, first.stop) == steps
        assert second.stop == FOREVER
    sim.clock.advance(10)
    assert sim.clock.sim_ns == 20_000_000
