"""Models that hang on the world by a joint: its anchor stays, whatever moves the model."""
from __future__ import annotations

import math

import pytest

import my_simulations
from my_simulations.geometry import Pose, Twist, pose_from_xyzrpy

BODY = """<inertial><mass>5</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia>
</inertial>"""


def hung(kind, axis, lower, upper, more=""):
    return f"""<model name="door"><pose>0 3 0 0 0 0</pose>
<link name="leaf"><gravity>0</gravity><pose>0.5 0 1 0 0 0</pose>{BODY}</link>
<joint name="hinge" type="{kind}"><parent>world</parent><child>leaf</child>
<pose>-0.5 0 0 0 0 0</pose><axis><xyz>{axis}</xyz><limit><lower>{lower}</lower>
<upper>{upper}</upper></limit><dynamics><damping>0.5</damping></dynamics></axis></joint>{more}
</model>"""


DOOR = hung("revolute", "0 0 1", 0, 1.57)
LIFT = hung("prismatic", "0 0 1", -2, 3)
DOUBLE = hung("revolute", "0 1 0", -3, 3, f"""<link name="end"><pose>1.5 0 1 0 0 0</pose>{BODY}
</link><joint name="elbow" type="revolute"><parent>leaf</parent><child>end</child>
<pose>-0.5 0 0 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint>""")


def sdf(model, state=""):
    return f'<sdf version="1.7"><world name="w">{model}{state}</world></sdf>'


@pytest.fixture
def opened(tmp_path):
    """Opens a world of one model, with a saved state."""
    worlds = []

    def start(model, state=""):
        path = tmp_path / f"{len(worlds)}.world"
        path.write_text(sdf(model, state))
        worlds.append(my_simulations.open_world(str(path)))
        return worlds[-1]

    yield start
    for world in worlds:
        world.close()


def position(world, name="hinge"):
    return world.joints().position[f"door::{name}"]


def leaf(world):
    return world.links().pose["door::leaf"]


def push(world, effort, seconds=1.0):
    world.apply_effort("door::hinge", effort, duration=seconds)
    world.step(round(seconds * 1000) + 500)


@pytest.mark.parametrize("model", [DOOR, LIFT], ids=["door", "lift"])
def test_a_reset_of_poses_moves_its_joint_back_and_leaves_the_anchor(opened, model):
    world = opened(model)
    before = leaf(world)
    push(world, 2.0)
    assert position(world) > 0.3
    world.simulator.resets.reset_world()
    assert position(world) == pytest.approx(0.0, abs=1e-9)
    assert leaf(world) == pytest.approx(before, abs=1e-9)
    world.step(100)
    assert leaf(world) == pytest.approx(before, abs=1e-9)


def test_a_door_that_was_reset_opens_as_far_as_before(opened):
    world = opened(DOOR)
    push(world, 2.0)
    world.simulator.resets.reset_world()
    push(world, 5.0, 3.0)
    assert position(world) == pytest.approx(1.57, abs=1e-3)
    assert leaf(world)[:2] == pytest.approx([0.0, 3.5], abs=1e-3)


def test_a_pose_that_a_joint_allows_sets_the_joint(opened):
    world = opened(DOOR)
    world.simulator.states.set_model_state("door", pose_from_xyzrpy(0, 3, 0, 0, 0, 0.7),
                                           Twist((0.0, 0.0, 0.0), (0.0, 0.0, 0.3)))
    assert position(world) == pytest.approx(0.7, abs=1e-9)
    assert world.joints().rate["door::hinge"] == pytest.approx(0.3, abs=1e-9)
    push(world, -5.0, 3.0)
    assert leaf(world)[:2] == pytest.approx([0.5, 3.0], abs=1e-3)


def test_a_pose_that_no_joint_allows_moves_the_anchor(opened):
    world = opened(DOOR)
    push(world, 2.0)
    angle = position(world)
    world.simulator.states.set_model_state("door", Pose((5.0, 0.0, 2.0)), Twist())
    assert position(world) == pytest.approx(angle, abs=1e-9)
    assert leaf(world)[:3] == pytest.approx([5.5, 0.0, 3.0], abs=1e-9)
    world.simulator.resets.reset_world()
    assert leaf(world)[:3] == pytest.approx([0.5, 3.0, 1.0], abs=1e-9)


@pytest.mark.parametrize("model", [DOOR, LIFT, DOUBLE], ids=["door", "lift", "double"])
def test_a_kept_state_comes_back_with_its_joints(opened, model):
    world = opened(model)
    world.apply_effort("door::hinge", 2.0, duration=1.0)
    world.step(300)
    kept, joints, links = world.save(), world.joints(), world.links()
    world.step(700)
    world.restore(kept)
    for name, value in joints.position.items():
        assert world.joints().position[name] == pytest.approx(value, abs=1e-9)
        assert world.joints().rate[name] == pytest.approx(joints.rate[name], abs=1e-6)
    for name, value in links.pose.items():
        assert world.links().pose[name] == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize("model", [DOOR, LIFT, DOUBLE], ids=["door", "lift", "double"])
@pytest.mark.parametrize("state", [True, False])
def test_a_saved_world_opens_with_its_anchor_in_place(opened, tmp_path, model, state):
    world = opened(model)
    push(world, 2.0)
    path = str(tmp_path / "saved.world")
    world.save_world(path, state=state)
    with my_simulations.open_world(path) as again:
        for name, value in world.joints().position.items():
            assert again.joints().position[name] == pytest.approx(value, abs=1e-5)
        assert leaf(again) == pytest.approx(leaf(world), abs=1e-5)
        again.simulator.resets.reset_world()
        assert position(again) == pytest.approx(0.0, abs=1e-5)
        assert leaf(again)[:3] == pytest.approx([0.5, 3.0, 1.0], abs=1e-5)


def test_a_state_of_gazebo_opens_the_door(opened):
    x, y = 0.5 * math.cos(0.5), 3.0 + 0.5 * math.sin(0.5)
    world = opened(DOOR, f"""<state world_name="w"><model name="door"><pose>0 3 0 0 0 0.5</pose>
<link name="leaf"><pose>{x:.6g} {y:.6g} 1 0 0 0.5</pose></link></model></state>""")
    assert position(world) == pytest.approx(0.5, abs=1e-5)
    assert leaf(world)[:2] == pytest.approx([x, y], abs=1e-5)


def test_the_twist_of_a_model_is_that_of_its_first_link():
    model = f"""<sdf version="1.7"><model name="m"><link name="a"><pose>0 0 13 0 0 0</pose>
<gravity>0</gravity>{BODY}</link></model></sdf>"""
    with my_simulations.open_world() as world:
        world.spawn(model)
        world.simulator.states.set_model_state("m", Pose(), Twist((1.0, 0.0, 0.0),
                                                                  (0.0, 3.0, 0.0)))
        told = world.links().twist["m::a"]
        assert list(told[:3]) == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
        assert list(told[3:]) == pytest.approx([0.0, 3.0, 0.0], abs=1e-9)


def test_a_position_beyond_a_limit_is_the_limit(opened):
    world = opened(DOOR)
    for asked, reached in ((2.5, 1.57), (-0.5, 0.0), (0.7, 0.7)):
        world.simulator.joints.set_positions({"door::hinge": asked})
        world.step(100)
        assert position(world) == pytest.approx(reached, abs=1e-6)
        assert world.joints().rate["door::hinge"] == pytest.approx(0.0, abs=1e-6)
