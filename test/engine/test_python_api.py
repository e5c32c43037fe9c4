"""A world that a Python program opens, without ROS."""
from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import my_simulations
from my_simulations.engine.commands import Advance
from my_simulations.errors import CommandError, EngineLostError, InputError
from my_simulations.python_api.plain_values import pose_of, twist_of, vector_of
from my_simulations.python_api.world_choice import WorldChoice

ROOT = Path(__file__).resolve().parents[2]
LIST = str(ROOT / "test/data/object_list/object_locations.yaml")
BALL = """<sdf version="1.7"><model name="ball"><link name="link">
<inertial><mass>2</mass></inertial>
<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>
</link></model></sdf>"""
PENDULUM = """<sdf version="1.7"><model name="pendulum"><link name="rod">
<pose>0 0 1 0 0 0</pose><inertial><pose>0 0 -0.5 0 0 0</pose><mass>1</mass>
<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
<joint name="pin" type="revolute"><parent>world</parent><child>rod</child>
<axis><xyz>0 1 0</xyz></axis></joint></model></sdf>"""


@pytest.fixture
def world():
    with my_simulations.open_world() as opened:
        yield opened


def test_a_ball_falls_as_far_as_it_should(world):
    assert world.spawn(BALL, pose=[1, 2, 5]) == "ball"
    world.step(500)
    assert world.time == pytest.approx(0.5)
    states = world.states()
    fallen = 9.8 * 0.5 * world.step_size * 500 * (0.5 + world.step_size)  # semi-implicit Euler
    assert states.pose["ball"] == pytest.approx([1, 2, 5 - fallen, 0, 0, 0, 1], abs=1e-9)
    assert states.twist["ball"] == pytest.approx([0, 0, -4.9, 0, 0, 0], abs=1e-9)
    assert states.names == tuple(world.names) == states.pose.names


def test_readings_are_of_their_time(world):
    world.spawn(BALL, pose=[0, 0, 5])
    before = world.states()
    world.step(10)
    assert before.time == 0.0 and before.pose["ball"][2] == 5.0
    assert world.states().pose["ball"][2] < 5.0


def test_links_joints_and_contacts_are_named(world):
    world.spawn(PENDULUM)
    world.spawn(BALL, "other", [1, 0, 0.1])
    assert "pendulum::rod" in world.links().names
    assert world.joints().position["pendulum::pin"] == 0.0
    world.step(200)
    (contact,) = world.contacts()
    assert set(contact.links) == {"other::link", "ground_plane::link"}
    assert contact.force == pytest.approx(2 * 9.8, rel=1e-2)
    assert abs(contact.normal[2]) == pytest.approx(1.0)


def test_wrenches_and_efforts_act_for_their_time(world):
    world.spawn(BALL, pose=[0, 0, 5])
    world.spawn(PENDULUM, pose=[3, 0, 0])
    world.apply_wrench("ball::link", force=[4, 0, 0], duration=0.1)
    world.apply_effort("pendulum::pin", 0.5, duration=0.1)
    world.step(300)
    assert world.states().twist["ball"][0] == pytest.approx(0.2, rel=1e-6)  # F t / m
    assert world.joints().position["pendulum::pin"] > 0.0


def test_steps_may_be_a_whole_float_and_nothing_else(world):
    world.step(10.0)
    for steps in (1.5, math.nan, math.inf, "two", None):
        with pytest.raises(CommandError, match="whole number"):
            world.step(steps)
    assert world.time == pytest.approx(0.01)


def test_steps_that_are_interrupted_end(world, monkeypatch):
    call = world.simulator.clock._session.supervisor._answer

    def interrupted(engine, command):
        if isinstance(command, Advance):
            engine.submit(Advance(1_000_000_000))  # hours: no engine is done before it is told
            raise KeyboardInterrupt
        return call(engine, command)

    monkeypatch.setattr(world.simulator.clock._session.supervisor, "_answer", interrupted)
    with pytest.raises(KeyboardInterrupt):
        world.step(1_000_000)
    monkeypatch.undo()
    at = world.time
    assert at < 1e6
    world.step(1)
    assert world.time == pytest.approx(at + world.step_size)


@pytest.mark.parametrize("longest", [math.inf, 1e300])
def test_a_duration_may_be_infinite_but_not_nan(world, longest):
    world.spawn(BALL, pose=[0, 0, 5])
    world.apply_wrench("ball::link", force=[2, 0, 0], duration=longest)
    world.step(100)
    assert world.states().twist["ball"][0] == pytest.approx(0.1, rel=1e-6)
    with pytest.raises(CommandError, match="a duration must be a finite number, is nan"):
        world.apply_wrench("ball::link", force=[2, 0, 0], duration=math.nan)


def test_reset_repeats_bit_for_bit_and_brings_back_what_was_removed():
    with my_simulations.open_world(objects=["MY_OBJECT", "crate"], object_list=LIST) as world:
        def run():
            world.apply_wrench("MY_OBJECT::" + world.description("MY_OBJECT").links[0].name,
                               force=[30, 5, 0], duration=0.2)
            world.step(400)
            return world.links().pose.array.tobytes()

        first = run()
        world.reset()
        assert world.time == 0.0 and run() == first
        world.remove("crate")
        world.spawn(BALL, pose=[0, 0, 1])
        world.reset()
        assert "crate" in world.names and "ball" not in world.names
        assert run() == first


def test_reset_repeats_a_room_with_a_stack_bit_for_bit():
    with my_simulations.open_world("lab_room.world") as world:
        runs = []
        for _again in range(3):
            world.step(1000)
            runs.append(world.links().pose.array.tobytes())
            world.reset()
        assert runs[0] == runs[1] == runs[2]


def test_another_seed_places_a_population_elsewhere(tmp_path):
    path = tmp_path / "many.world"
    path.write_text(
        "<sdf version='1.6'><world name='w'><population name='p'><model name='b'><link name='l'/>"
        "</model><model_count>3</model_count><distribution><type>random</type></distribution>"
        "<box><size>5 5 1</size></box></population></world></sdf>")
    with my_simulations.open_world(str(path), seed=1) as world:
        first = world.states().pose.array
        world.reset(seed=2)
        assert not np.allclose(world.states().pose.array, first)
        world.reset(seed=1)
        assert np.array_equal(world.states().pose.array, first)


def test_restore_repeats_from_what_was_saved(world):
    world.spawn(BALL, pose=[0, 0, 0.4])
    world.step(100)
    saved = world.save()
    world.step(300)
    runs = []
    for _again in range(2):
        world.restore(saved)
        assert world.time == saved.time == pytest.approx(0.1)
        world.step(300)
        runs.append(world.links().pose.array.tobytes())
    assert runs[0] == runs[1]


def test_a_model_and_a_link_are_moved(world):
    world.spawn(BALL)
    world.set_pose("ball", [1, 2, 3, 0, 0, math.pi / 2], twist=[0, 0, 1, 0, 0, 0])
    assert world.states().pose["ball"] == pytest.approx([1, 2, 3, 0, 0, 0.5 ** 0.5, 0.5 ** 0.5])
    assert world.states().twist["ball"][2] == pytest.approx(1.0)
    world.set_pose("ball::link", [0, 0, 1])
    assert world.links().pose["ball::link"][2] == pytest.approx(1.0)


@pytest.mark.parametrize(("pose", "count"), [([1, 2], 2), ([0] * 8, 8), ([], 0)])
def test_a_pose_of_another_length_is_refused(pose, count):
    with pytest.raises(CommandError, match=f"not {count}"):
        pose_of(pose)


@pytest.mark.parametrize("values", ["123", "abc", None, 3, [[1, 2, 3]], [None] * 3])
def test_values_that_are_no_numbers_are_refused(values):
    for read in (pose_of, twist_of, lambda given: vector_of(given, "a force")):
        with pytest.raises(CommandError, match="is a sequence of numbers, not"):
            read(values)


@pytest.mark.parametrize(("call", "told"), [
    (lambda world: world.robot("pendulum").move([0.1]), "dictionary of numbers by name, not"),
    (lambda world: world.robot("pendulum").set_positions({"pin": "up"}),
     r"positions\['pin'\] must be a finite number, is 'up'"),
    (lambda world: world.robot("pendulum").drive({"pin": None}), "must be a finite number"),
    (lambda world: world.robot("pendulum").drive({"pin": 1.0}, effort=-1.0),
     "effort must not be negative, is -1.0"),
    (lambda world: world.robot("pendulum").jacobian("rod", [0, 0, math.nan]), "contains NaN"),
    (lambda world: world.apply_effort("pin", 1.0, duration="long"), "must be a finite number"),
    (lambda world: world.move_joint("pin", 0.1, 5.0, rate=-1.0), "rate must not be negative"),
    (lambda world: world.restore(3), "what save has returned, not 3"),
    (lambda world: world.reset(seed="a"), "seed must be a whole number, is 'a'"),
    (lambda world: world.render([0, 0, 1], outputs="rgb"), r"a list such as \['rgb'\], not 'rgb'"),
    (lambda world: world.cast_rays("up", [0, 0, 1]), "arrays of numbers"),
    (lambda world: my_simulations.open_world(objects="MY_OBJECT"), "a list of names, not"),
    (lambda world: world.robot(3), "the name of a robot must be text, is 3"),
    (lambda world: world.publish(None, {}), "the name of a topic must be text, is None"),
    (lambda world: world.topics[3], "the name of a topic must be text, is 3"),
    (lambda world: world.call(3), "the name of a service must be text, is 3"),
    (lambda world: world.spawn({}), "path or the text of a URDF or SDF, not {}"),
    (lambda world: world.attach("grip", 3, "pendulum::rod"), "name of the parent must be text"),
    (lambda world: WorldChoice(models=[("pendulum", PENDULUM)]),
     r"a name, a document and a Pose, not \('pendulum', "),
    (lambda world: my_simulations.open_world(plugins=["libfoo.so"]),
     "a dictionary of classes by library, not"),
    (lambda world: my_simulations.open_world(parameters=[1]), "a dictionary or a YAML file, not"),
])
def test_wrong_arguments_are_named(world, call, told):
    world.spawn(PENDULUM)
    with pytest.raises(CommandError, match=told):
        call(world)


def test_an_unknown_row_names_those_that_there_are(world):
    with pytest.raises(KeyError, match="no row 'boll'; rows are ground_plane"):
        world.states().pose["boll"]
    assert "boll" not in world.states().pose


def test_files_may_be_named_by_paths(tmp_path):
    lab = ROOT / "world" / "lab_course.world"
    (tmp_path / "ball.sdf").write_text(BALL)
    with my_simulations.open_world(lab, object_list=Path(LIST)) as opened:
        assert opened.spawn(tmp_path / "ball.sdf") == "ball"
        assert Path(opened.save_world(tmp_path / "saved.world")).is_file()


def test_faults_are_told_and_nothing_is_lost(world, tmp_path):
    with pytest.raises(CommandError, match="nothing"):
        world.remove("nothing")
    with pytest.raises(CommandError, match="steps"):
        world.step(-1)
    with pytest.raises(InputError) as told:
        world.spawn("<sdf version='1.7'><model name='m'><link/></model></sdf>")
    assert told.value.first.line == 1
    missing = str(tmp_path / "none.sdf")
    with pytest.raises(InputError, match="none.sdf"):
        world.spawn(missing)
    assert world.names == ["ground_plane"]


def test_an_unknown_object_names_those_that_there_are():
    with pytest.raises(InputError, match="MY_OBJECT"):
        my_simulations.open_world(objects=["MY_OBJEKT"], object_list=LIST)


def test_a_world_that_was_saved_opens_again(world, tmp_path):
    world.spawn(BALL, pose=[1, 0, 2])
    path = world.save_world(str(tmp_path / "kept.world"))
    with my_simulations.open_world(path) as again:
        assert again.states().pose["ball"] == pytest.approx([1, 0, 2, 0, 0, 0, 1])


def test_a_lost_engine_ends_the_run_and_reset_opens_it_anew(world, tmp_path):
    world.spawn(BALL, pose=[0, 0, 1])
    world.step(100)
    os.kill(world.simulator.engine_pid, signal.SIGKILL)
    with pytest.raises(EngineLostError, match="reset"):
        for _step in range(100):
            world.step(10)
    changes = (lambda: world.set_pose("ball", [0, 0, 2, 0, 0, 0]), lambda: world.remove("ball"),
               lambda: world.spawn(BALL, name="other"), lambda: world.apply_wrench("ball::link"),
               lambda: world.save_world(str(tmp_path / "rolled_back.world")))
    for call in (world.states, *changes):
        with pytest.raises(EngineLostError):
            call()
    assert not list(tmp_path.glob("rolled_back*"))
    world.reset()
    assert world.time == 0.0 and world.names == ["ground_plane"]
    world.step(10)


def test_it_needs_no_ros():
    script = ("import sys\n"
              "for name in ('rospy', 'rospkg', 'genpy', 'catkin_pkg'): sys.modules[name] = None\n"
              "import my_simulations\n"
              "with my_simulations.open_world() as world:\n"
              "    world.step(10)\n"
              "    print(world.names)\n")
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                          timeout=120, env={"PATH": os.environ["PATH"], "HOME": os.environ["HOME"],
                                            "PYTHONPATH": str(ROOT / "src")})
    assert done.stdout == "['ground_plane']\n", done.stderr


def test_a_motor_keeps_a_rate_a_servo_a_position_and_a_release_lets_go(world):
    world.spawn(PENDULUM)
    world.drive_joint("pin", rate=1.5, effort=100.0)
    world.step(1000)
    assert world.joints().rate["pendulum::pin"] == pytest.approx(1.5, abs=1e-3)
    world.move_joint("pin", math.pi / 2, effort=100.0, rate=2.0)
    world.step(2000)
    assert world.joints().position["pendulum::pin"] == pytest.approx(math.pi / 2, abs=1e-3)
    world.release_joint("pin")
    world.step(100)
    assert abs(world.joints().rate["pendulum::pin"]) > 0.1


def test_a_joint_is_driven_with_finite_numbers(world):
    world.spawn(PENDULUM)
    for rate, effort in ((math.nan, 1.0), (1.0, math.inf)):
        with pytest.raises(CommandError, match="finite"):
            world.drive_joint("pin", rate, effort)
    with pytest.raises(CommandError, match="nobody"):
        world.drive_joint("nobody", 1.0, 1.0)


STATE = """<sdf version="1.6"><world name="default"><model name="box"><pose>0 0 5 0 0 0</pose>
<link name="link"/></model><state world_name="default"><sim_time>5 0</sim_time><model name="box">
<pose>0 0 5 0 0 0</pose><link name="link"><pose>0 0 5 0 0 0</pose>
<velocity>2 0 0 0 0 0</velocity></link></model></state></world></sdf>"""


@pytest.fixture
def saved_world(tmp_path):
    (tmp_path / "saved.world").write_text(STATE)
    with my_simulations.open_world(str(tmp_path / "saved.world")) as opened:
        yield opened


def test_a_reset_goes_back_to_the_time_at_which_the_world_began(saved_world):
    assert saved_world.time == 5.0
    for seed in (None, 7, None):
        saved_world.step(10)
        saved_world.reset(seed)
        assert saved_world.time == 5.0
    saved_world.simulator.resets.reset_simulation()   # that of Gazebo's service
    assert saved_world.time == 0.0


def test_a_saved_motion_stays_with_its_model(saved_world):
    resets, models = saved_world.simulator.resets, saved_world.simulator.models
    models.edit("box", replace(models.get("box"), name="renamed"))
    saved_world.spawn(BALL, "box", [3, 0, 5])
    resets.reset_simulation()
    assert list(saved_world.states().twist["renamed"]) == [2, 0, 0, 0, 0, 0]
    assert not any(saved_world.states().twist["box"])


def test_a_wrench_lasts_as_long_after_time_was_put_back(world):
    states = world.simulator.states
    start = states.capture()
    world.step(500)
    world.spawn(BALL, pose=[0, 0, 50])
    world.apply_wrench("ball::link", (10, 0, 0), duration=0.5)
    world.step(100)
    states.restore(start)
    world.step(1000)
    assert world.states().twist["ball"][0] == pytest.approx(2.5, rel=1e-6)   # F t / m


def test_a_model_does_not_hang_where_one_of_its_name_was_held(world):
    for _ in range(2):
        world.spawn(BALL, pose=[0, 0, 5])
        world.simulator.models.hold("ball", True)
        world.remove("ball")
    world.spawn(BALL, pose=[0, 0, 5])
    world.simulator.resets.reset_simulation()
    world.step(100)
    assert world.states().twist["ball"][2] == pytest.approx(-0.98, rel=1e-6)
    models = world.simulator.models
    models.hold("ball", True)
    models.spawn(models.get("ball"), replace=True)   # a successor is held, too
    before = world.states().pose["ball"][2]
    world.step(100)
    assert world.states().pose["ball"][2] == before


def test_a_renamed_model_can_still_let_go(world):
    models = world.simulator.models
    for name, x in (("a", 0), ("b", 1)):
        world.spawn(BALL, name, [x, 0, 5])
    models.attach("a::grip", "a::link", "b::link")
    models.edit("a", replace(models.get("a"), name="renamed"))
    assert models.inter_model_joints == []
    assert models.detach("a::grip")
    with pytest.raises(CommandError, match="to itself"):
        models.attach("c", "b::link", "b::link")


def test_a_joint_that_attaches_something_attaches_nothing_else(world):
    for name in "abc":
        world.spawn(BALL.replace("ball", name), name)
    world.attach("grip", "a::link", "b::link")
    with pytest.raises(CommandError, match="the joint 'grip' attaches 'b::link' to 'a::link': "
                                           "detach it, or choose another name"):
        world.attach("grip", "a::link", "c::link")
    world.detach("grip")
    world.attach("grip", "a::link", "c::link")


def test_what_was_attached_does_not_come_back_with_a_deleted_model(world):
    models = world.simulator.models
    for name, x in (("a", 0), ("b", 1)):
        world.spawn(BALL, name, [x, 0, 5])
    models.attach("a::grip", "a::link", "b::link")
    description = models.get("a")
    deleted = models.delete("a")
    world.simulator.resets.reset_simulation()
    models.spawn(description, deleted=deleted)
    assert models.inter_model_joints == []


def test_a_reset_in_which_the_engine_dies_needs_no_second_one(world):
    world.spawn(BALL, pose=[0, 0, 5])
    world.reset()
    os.kill(world.simulator.engine_pid, signal.SIGKILL)
    world.reset()
    world.step(10)
    assert world.time == pytest.approx(0.01) and world.names == ["ground_plane"]


def test_a_world_whose_engine_is_lost_for_good_is_opened_by_another(world):
    world.simulator._session.supervisor._failure = "it died repeatedly; restart the simulator"
    with pytest.raises(CommandError, match="repeatedly"):
        world.step()
    world._lost = "it died repeatedly"   # as its log says
    world.reset()
    world.step(10)
    assert world.time == pytest.approx(0.01) and world.names == ["ground_plane"]


def test_a_log_that_raises_does_not_keep_the_engine_from_coming_back(capfd):
    def log(issue):
        pytest.fail(issue.message)

    with my_simulations.open_world(log=log) as world:
        os.kill(world.simulator.engine_pid, signal.SIGKILL)
        with pytest.raises(EngineLostError):
            for _ in range(1000):
                world.step(1000)
        world.reset()
        world.step(10)
        assert world.time == pytest.approx(0.01)


def test_a_world_that_is_refused_leaves_none(world, tmp_path):
    file = tmp_path / "slow.world"
    file.write_text(STATE.replace('<model name="box"><pose>', "<physics type='ode'><max_step_size>"
                                  '50</max_step_size></physics><model name="box"><pose>', 1))
    with pytest.raises(CommandError, match="step size"):
        world.open(WorldChoice(str(file)))
    with pytest.raises(EngineLostError, match="no world.*step size"):
        world.step()


def test_a_description_that_cannot_be_changed_leaves_the_world_open(world, tmp_path):
    def alter(_):
        raise KeyError("nothing to change")

    (tmp_path / "saved.world").write_text(STATE)
    with pytest.raises(KeyError):
        world.open(WorldChoice(str(tmp_path / "saved.world"), alter=alter))
    world.reset(seed=3)
    assert world.names == ["ground_plane"]
