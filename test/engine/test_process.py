"""The engine in its own process: crashes, restarts, repeats."""
from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from conftest import arm, ball, box, ground
from plugin_case import kept
from running_simulator import running, started
from waiting import until

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.saved_state import InitialState
from my_simulations.description.shapes import Collision, Mesh, MeshData, Surface, mesh_key
from my_simulations.description.world import Physics, World
from my_simulations.engine.api import EngineDiedError
from my_simulations.engine.commands import FOREVER, LoadModel, Ping, Restart
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.engine.timed_forces import JointPid, TimedWrench
from my_simulations.engine.wrench_laws import VelocityForce
from my_simulations.errors import CommandError, EngineLostError
from my_simulations.geometry import STILL, ZERO3, Pose, Twist
from my_simulations.simulator.history import History
from my_simulations.simulator.inter_model_joints import InterModelJoints
from my_simulations.simulator.operations import RemoveModel
from my_simulations.simulator.simulator import Simulator


@pytest.fixture
def start():
    def begin(*models, paused=True, physics=None, joints=()):
        issues = []
        sim = started(World(models=[ground(), *models], physics=physics or Physics(),
                            joints=list(joints)),
                      engine=ProcessEngine, paused=paused, log=issues.append)
        sim.issues = issues
        return sim

    yield from kept(begin)


def kill(sim: Simulator) -> int:
    pid = sim.engine_pid
    os.kill(pid, signal.SIGKILL)
    until(lambda: sim.engine_pid != pid and sim._session.supervisor._ready.is_set(),
          "no new engine came")
    return pid


def whole_state(sim: Simulator):
    return memoryview(sim.feed.states()[2]).cast("d").tolist()


def test_a_killed_engine_comes_back_with_poses_twists_joints_time_and_loads(start):
    pendulum = arm("revolute", JointAxis((0, 1, 0)))
    sim = start(box(), ball(), pendulum)
    sim.states.set_model_state("ball", Pose((3, 0, 5)), Twist((1, 2, 3), (4, 5, 6)))
    sim.wrenches.add([TimedWrench(0, sim._session.registry.link("box::link")[0].first_link_row, 0,
                                  400, force=(0, 0, 30.0))])
    sim.clock.advance(300)
    before, joints = whole_state(sim), sim.joints.states("hinge")[0]
    clock = sim.clock.sim_ns, sim.clock.step
    kill(sim)
    assert whole_state(sim) == pytest.approx(before, abs=1e-9)
    assert sim.joints.states("hinge")[0] == pytest.approx(joints, abs=1e-12)
    assert joints[1] > 1.0
    assert (sim.clock.sim_ns, sim.clock.step) == clock
    assert sim.issues and "SIGKILL" in sim.issues[0].message
    # The load acts for its 100 pending steps only.
    speed = sim.states.model_state("box")[1].linear[2]
    sim.clock.advance(100)
    assert sim.states.model_state("box")[1].linear[2] - speed == pytest.approx(0.1 * (30 - 9.8),
                                                                               rel=1e-6)
    sim.clock.advance(100)
    assert sim.states.model_state("box")[1].linear[2] - speed == pytest.approx(
        0.1 * (30 - 9.8) - 0.98, rel=1e-6)


def test_a_running_world_goes_on_after_a_crash_and_reads_never_fail(start):
    sim = start(ball(), paused=False)
    sim.states.set_model_state("ball", Pose((0, 0, 5000)), STILL)
    pid = sim.engine_pid
    os.kill(pid, signal.SIGKILL)
    at, deadline = sim.clock.step, time.monotonic() + 60
    while sim.engine_pid == pid or sim.clock.step <= at + 50:
        assert 0.4 < sim.states.model_state("ball")[0].position[2] <= 5000.0
        assert time.monotonic() < deadline
    assert sim.states.model_state("ball")[1].linear[2] < -0.01


def test_a_command_at_which_somebody_kills_the_engine_is_carried_out_by_the_next(start):
    sim = start(box(), paused=False)
    os.kill(sim.engine_pid, signal.SIGSTOP)   # it cannot answer any more
    pid = sim.engine_pid
    threading.Timer(0.3, os.kill, (pid, signal.SIGKILL)).start()
    sim.states.set_model_state("box", Pose((5, 0, 0.5)), STILL)
    assert sim.states.model_state("box")[0].position[0] == pytest.approx(5.0, abs=0.1)
    assert sim.engine_pid != pid


def killing(monkeypatch, times, name="killer"):
    """Have an engine die whenever it is told of a model of that name, so many times."""
    submit, died = ProcessEngine.submit, []

    def sent(self, command):
        parts = getattr(command, "commands", (command,))
        hit = any(isinstance(part, LoadModel) and part.model.name == name for part in parts)
        if hit and len(died) < times:
            died.append(self.pid)
            os.kill(self.pid, signal.SIGSTOP)  # so that it dies before it answers
            answer = submit(self, command)
            os.kill(self.pid, signal.SIGKILL)
            return answer
        return submit(self, command)

    monkeypatch.setattr(ProcessEngine, "submit", sent)
    return died


def names_of(count):
    return [f"box_{n}" for n in range(count)]


def test_a_load_loses_nothing_when_the_engine_dies_in_it(start, monkeypatch):
    names = names_of(30)
    names[17] = "killer"
    died = killing(monkeypatch, 1)
    sim = start(*[box(name) for name in names])
    assert sim.models.names() == ["ground", *names] and len(died) == 1
    assert sim.models.losses == [] and sim.clock.paused
    assert [issue.code for issue in sim.issues] == ["engine-died"]


def test_a_model_that_kills_every_engine_is_left_out_by_name_and_the_rest_is_loaded(
        start, monkeypatch):
    names = names_of(12)
    names[5] = names[9] = "killer"
    died = killing(monkeypatch, 99)
    sim = start(*[box(name) for name in names[:9]], paused=False)
    assert sim.models.names() == ["ground", *names[:5], *names[6:9]]
    assert len(died) == 4   # two with the other models of its group, two alone
    (loss,) = sim.models.losses
    assert "skipped model 'killer'" in loss and "2 times" in loss
    assert [issue.message for issue in sim.issues if issue.code == "model-refused"] == [loss]
    for _ in range(4):   # nor is it the world that is to blame
        with pytest.raises(EngineLostError):
            sim.models.spawn(box("killer"))
    assert not sim.clock.paused
    at, deadline = sim.clock.step, time.monotonic() + 60
    while sim.clock.step <= at:
        assert time.monotonic() < deadline


def test_a_reset_in_which_the_engine_dies_is_made_all_the_same(start):
    sim = start(box())
    sim.wrenches.apply_wrench("box::link", (0, 0, 30.0), (0, 0, 0))
    sim.clock.advance(200)
    first = sim.engine_pid
    os.kill(first, signal.SIGSTOP)
    threading.Timer(0.3, os.kill, (first, signal.SIGKILL)).start()
    sim.resets.reset_simulation()
    assert (sim.clock.step, sim.wrenches.ids, sim.engine_pid != first) == (0, (), True)
    sim.clock.advance(100)   # and no force is left of before
    assert sim.states.model_state("box")[0].position[2] <= 0.5 + 1e-3


def test_a_reset_that_no_engine_survives_leaves_the_world_as_it_was(start, monkeypatch):
    sim = start(box())
    sim.models.spawn(Model("empty", pose=Pose((1, 2, 3))))
    sim.states.set_model_state("empty", Pose((4, 5, 6)), STILL)
    sim.wrenches.apply_wrench("box::link", (0, 0, 30.0), (0, 0, 0))
    sim.clock.advance(200)
    before, step = sim.states.model_state("box"), sim.clock.step
    submit = ProcessEngine.submit

    def sent(self, command):
        parts = getattr(command, "commands", (command,))
        if not any(isinstance(part, Restart) for part in parts):
            return submit(self, command)
        os.kill(self.pid, signal.SIGSTOP)
        answer = submit(self, command)
        os.kill(self.pid, signal.SIGKILL)
        return answer

    monkeypatch.setattr(ProcessEngine, "submit", sent)
    with pytest.raises(EngineLostError, match="restored to its state before"):
        sim.resets.reset_simulation()
    assert sim.clock.step == step
    assert sim.states.model_state("box")[0].position == pytest.approx(before[0].position, abs=1e-9)
    assert sim.states.model_state("empty")[0].position == (4, 5, 6)
    sim.clock.advance(100)   # the force acts on
    assert sim.states.model_state("box")[1].linear[2] - before[1].linear[2] == pytest.approx(
        0.1 * (30 - 9.8), rel=1e-6)


def test_what_an_engine_has_done_before_it_died_is_not_done_again(start):
    """A move in the model's own frame, of which only the answer is missing."""
    sim = start(box(gravity=False))
    sim.states.set_model_state("box", Pose((0, 0, 5)), STILL)
    engine, wire = sim._session.supervisor.engine, sim._session.supervisor.engine._wire
    received = wire.receive

    def deaf(timeout):   # the reader thread hears no answer any more
        if held.is_set():
            received(timeout)
            return []
        return received(timeout)

    held = threading.Event()
    wire.receive = deaf
    held.set()
    shown = engine.ring.latest
    mover = threading.Thread(target=sim.states.set_model_state,
                             args=("box", Pose((1, 0, 0)), STILL, "box"))
    mover.start()
    deadline = time.monotonic() + 60
    while engine.ring.latest == shown:
        assert time.monotonic() < deadline
    os.kill(engine.pid, signal.SIGKILL)
    mover.join(20)
    assert not mover.is_alive()
    assert sim.states.model_state("box")[0].position == pytest.approx((1, 0, 5), abs=1e-9)


def test_a_refused_model_leaves_nothing_behind(start):
    from test_joints import _chain
    sim = start()
    with pytest.raises(CommandError, match="129"):
        sim.models.spawn(_chain(129))
    assert sim.models.names() == ["ground"]
    sim.models.spawn(_chain(3))


def test_a_state_that_becomes_infinite_is_put_back_and_reported(start):
    sim = start(box())
    sim.clock.advance(10)
    sim.wrenches.add([TimedWrench(0, sim._session.registry.link("box::link")[0].first_link_row, 0,
                                  FOREVER, force=(1e308, 1e308, 0.0))])
    sim.clock.advance(20)
    assert all(abs(v) < 1e300 for v in sim.states.model_state("box")[0].position)
    until(lambda: any(issue.code == "state-diverged" for issue in sim.issues),
          "nobody was told of the infinite state")


def test_the_engine_ends_with_its_parent():
    script = ("import sys, time; sys.path.insert(0, 'src')\n"
              "from my_simulations.engine.process_engine import ProcessEngine\n"
              "from my_simulations.engine.commands import Ping\n"
              "engine = ProcessEngine(); engine.submit(Ping()).result()\n"
              "print(engine.pid, flush=True); time.sleep(60)\n")
    parent = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True,
                              env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    child = int(parent.stdout.readline())
    parent.kill()
    parent.wait()
    deadline = time.monotonic() + 60
    while os.path.exists(f"/proc/{child}") and _state(child) != "Z":
        assert time.monotonic() < deadline, "the engine outlived its parent"
        time.sleep(0.01)


def _state(pid: int) -> str:
    with open(f"/proc/{pid}/stat", encoding="ascii") as stream:
        return stream.read().rsplit(")", 1)[1].split()[0]


def _run(sim: Simulator) -> str:
    digest = hashlib.sha256()
    for _ in range(40):
        sim.clock.advance(50)
        digest.update(repr(whole_state(sim)).encode())
    return digest.hexdigest()



def test_the_same_world_and_commands_give_the_same_bits_in_another_process_and_after_a_reset(start):
    def build():
        sim = start(paused=True)
        for n in range(9):
            sim.models.spawn(box(f"b{n}"), Pose((0.03 * n, 0.0, 0.5 + n)))
        for n in range(3):   # slippery, in a ring of contacts
            sim.models.spawn(box(f"s{n}", surface=Surface(mu=0.4)), Pose((5.0 + n, 0.0, 0.5)))
        sim.models.spawn(arm("revolute", JointAxis((0, 1, 0), spring_stiffness=30.0, damping=2.0)),
                  Pose((0, 6, 2)))
        sim.models.spawn(ball("hitter"), Pose((-4, 0, 3)))
        sim.states.set_model_state("hitter", Pose((-4, 0, 3)), Twist((9, 0, 0)))
        sim.states.set_model_state("s0", Pose((5, 0, 0.5)), Twist((1, 0.5, 0)))
        return sim

    first, second = build(), build()
    expected = _run(first)
    assert _run(second) == expected
    first.resets.reset_simulation()
    first.states.set_model_state("hitter", Pose((-4, 0, 3)), Twist((9, 0, 0)))
    first.states.set_model_state("s0", Pose((5, 0, 0.5)), Twist((1, 0.5, 0)))
    assert _run(first) == expected


def test_a_world_starts_at_its_saved_time_with_its_velocities_and_joint_positions():
    pendulum = arm("revolute", JointAxis((0, 1, 0)))
    world = World(models=[ball(), pendulum], initial_ns=2_500_000_000, initial={
        "ball": InitialState({"link": Twist((1, 0, 0), (0, 0, 2))}),
        "arm": InitialState(joints={"hinge": 0.4})})
    with running(world, engine=ProcessEngine, log=print) as sim:
        for _ in range(2):   # again after a reset, which goes back to time 0
            assert sim.states.model_state("ball")[1] == Twist((1, 0, 0), (0, 0, 2))
            assert sim.joints.states("hinge")[0] == (0.4, 0.0)
            assert sim.clock.sim_ns == world.initial_ns
            sim.clock.advance(10)
            sim.resets.reset_simulation()
            world.initial_ns = 0


def test_a_driven_joint_is_driven_on_after_an_edit_and_a_crash(start):
    sim = start()
    sim.models.spawn(arm("revolute", JointAxis((0, 0, 1))), Pose((0, 0, 2)))
    sim.wrenches.apply_effort("arm::hinge", JointPid(1.0, p=50.0, i=0.0, d=10.0))
    for happens in (lambda: None, lambda: kill(sim), lambda: sim.models.set_link_inertial(
            "arm::bob", Inertial(1.5, Pose((1, 0, 0)), 0.1, 0, 0, 0.1, 0, 0.1))):
        happens()
        sim.joints.set_positions({"arm::hinge": 0.0})
        sim.clock.advance(3000)
        assert sim.joints.states("arm::hinge")[0][0] == pytest.approx(1.0, abs=1e-3)
    sim.resets.reset_simulation()
    sim.clock.advance(100)
    assert sim.joints.states("arm::hinge")[0] == (0.0, 0.0)
    assert sim.wrenches.efforts_on("arm::hinge") == ()


def test_a_force_by_a_law_acts_until_a_reset_and_no_service_clears_it(start):
    """The box reaches the velocity that the law wants within a few times m / gain, 10 ms."""
    sim = start()
    sim.models.spawn(box("load", 0.5, 4.0), Pose((0.0, 0.0, 50.0)))
    law = VelocityForce((400.0, 400.0, 0.0), 1.0, 0.0, 0.0)
    sim.wrenches.swap([], [("load::link", ZERO3, ZERO3, law, "")])
    for happens in (lambda: None, lambda: kill(sim), lambda: sim.wrenches.clear_wrenches(
            "load::link"), lambda: sim.models.set_link_inertial(
                "load::link", Inertial(2.0, Pose((0.1, 0.0, 0.0)), 0.1, 0, 0, 0.1, 0, 0.1))):
        happens()
        sim.states.set_model_state("load", Pose((0.0, 0.0, 50.0)), STILL)
        sim.clock.advance(200)
        assert sim.states.model_state("load")[1].linear[0] == pytest.approx(1.0, abs=1e-3)
    sim.resets.reset_simulation()
    sim.clock.advance(100)
    assert sim.states.model_state("load")[1].linear[0] == 0.0


def test_a_world_whose_files_have_gone_is_reset_by_another_engine(start, tmp_path, monkeypatch):
    from test_contact import _cube_mesh
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    mesh = Mesh("cube", "/cube")
    sim = start()
    sim.models.spawn(Model("cube", links=[Link("link", inertial=Inertial(1, Pose(), 1, 0, 0, 1, 0,
                                                                         1),
                                               collisions=[Collision("c", mesh)])]), Pose((0, 0,
                                                                                           5)),
                     meshes={mesh_key(mesh): _cube_mesh()})

    def lose_files():
        found = list(tmp_path.glob("my_simulations_scratch_*/*.obj"))
        assert found
        for file in found:
            file.unlink()

    lose_files()
    sim.clock.advance(300)
    sim.resets.reset_simulation()   # by an engine that has files of its own
    assert sim.states.model_state("cube")[0].position == (0, 0, 5)
    sim.clock.advance(300)
    lose_files()
    sim.resets.reset_simulation()   # known how it looks, and built at the next step
    assert sim.states.model_state("cube")[0].position == (0, 0, 5)
    with pytest.raises(EngineLostError):
        sim.clock.advance(1)
    assert sim.states.model_state("cube")[0].position == (0, 0, 5)
    sim.clock.advance(300)
    assert sim.states.model_state("cube")[0].position[2] == pytest.approx(5 - 0.441, abs=0.01)


def test_a_moving_concave_mesh_is_divided_before_it_is_spawned(start, tmp_path, monkeypatch):
    from test_contact import _cube_mesh
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    cube = _cube_mesh()
    boxes = [((2, 1, 0.2), (0, 0, 0)), ((0.2, 1, 1), (-0.9, 0, 0.6)), ((0.2, 1, 1), (0.9, 0, 0.6))]
    u = MeshData(np.concatenate([cube.vertices * size + at for size, at in boxes]),
                 np.concatenate([cube.triangles + 8 * n for n in range(3)]))
    mesh = Mesh("u", "/u")
    sim = start()
    sim.models.spawn(Model("u", links=[Link("link", inertial=Inertial(50, Pose(), 9, 0, 0, 9, 0, 9),
                                     collisions=[Collision("c", mesh)])]),
              Pose((0, 0, 0.1)), meshes={mesh_key(mesh): u})
    sim.models.spawn(ball(radius=0.3), Pose((0, 0, 1.2)))
    sim.clock.advance(2000)
    assert sim.states.model_state("ball")[0].position[2] == pytest.approx(0.5, abs=0.05)


def _sliding_pair(start):
    """Two boxes with a prismatic joint between them, and the history of their edits."""
    slide = Joint("slide", "prismatic", "left::link", "right::link", axis=JointAxis((1, 0, 0)))
    sim = start(box("left"), box("right"), joints=[slide])
    return sim, History(sim)


def _poses(sim):
    return [number for name in sim.models.names()
            for part in sim.states.model_state(name)[0] for number in part]


def test_undo_brings_back_both_models_of_a_prismatic_joint(start):
    sim, history = _sliding_pair(start)
    history.do("delete right", RemoveModel("right"))
    history.do("delete left", RemoveModel("left"))
    history.undo()
    history.undo()
    assert sim.models.names() == ["ground", "left", "right"]
    assert [joint.name for joint in sim.models.inter_model_joints] == ["slide"]
    assert sim.issues == []


def test_a_spawn_that_is_refused_halfway_leaves_no_body_behind(start):
    sim, _ = _sliding_pair(start)
    sim.models.spawn(box("rigid"), Pose((0, 3, 0.5)))
    deleted = sim.models.delete("right")
    joint = Joint("bad", "prismatic", "rigid::link", "right::link", axis=JointAxis((1, 0, 0)))
    sim.clock.advance(40)
    before = _poses(sim)
    with pytest.raises(CommandError, match="articulated"):
        sim.models.spawn(box("right"), Pose((0, 5, 0.5)),
                         deleted=replace(deleted, joints=InterModelJoints([joint])))
    assert [issue.code for issue in sim.issues] == ["engine-replaced"]
    assert _poses(sim) == pytest.approx(before, abs=1e-9)
    sim.models.spawn(box("next"), Pose((7, 0, 0.5)))
    sim.clock.advance(200)
    assert sim.states.model_state("next")[0].position == pytest.approx((7, 0, 0.5), abs=1e-3)
    assert not any("right" in name for name in sim.states.link_names().values())


def test_a_death_before_somebody_listens_is_reported_to_the_listener(tmp_path, monkeypatch):
    (tmp_path / "pybullet.py").write_text("raise SystemExit(3)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    engine = ProcessEngine()
    try:
        with pytest.raises(EngineDiedError):   # the ping waits until the end is noticed
            engine.submit(Ping()).result(60.0)
        heard = []
        engine.on_death(lambda reason, lost: bool(heard.append(reason)))
        assert heard == ["the physics engine ended with code 3"]
    finally:
        engine.close()
