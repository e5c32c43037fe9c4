"""Bodies that files describe and no world holds: the engine takes them all the same."""
from __future__ import annotations

import pytest
from running_simulator import running, started

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.geometry import Pose, Twist, rotate

PLATE = Inertial(1.0, Pose((0.0, -0.5, 0.0)), ixx=0.05, iyy=0.05, izz=1.5)


def swinging(axis, seconds=0.2):
    """The position of a hinge about x, after a while, of a plate that starts beside it."""
    model = Model("m", Pose((0, 0, 3)), links=[Link("l", inertial=PLATE)],
                  joints=[Joint("j", "revolute", "world", "l", axis=axis)])
    faults = []
    with running(World(models=[model]), BulletBackend, log=faults.append) as sim:
        sim.clock.advance(round(seconds * 1000))
        ((position, rate),) = sim.joints.states("j")
    assert faults == []
    return position, rate


@pytest.mark.parametrize("damping", [0.0, 5.0])
def test_a_moment_above_the_sum_of_the_others_moves_as_the_file_says(damping):
    position, rate = swinging(JointAxis((1.0, 0.0, 0.0), damping=damping))
    if damping:
        assert 0.3 < rate < 9.8 * 0.5 / damping * 1.01  # at most where damper and weight balance
    else:  # 0.05 + 1 * 0.5^2 kg m^2 about the hinge, which the weight turns by 4.9 N m
        assert position == pytest.approx(0.5 * 4.9 / 0.3 * 0.2 ** 2, rel=0.03)


def test_a_welded_hinge_stays_where_it_is():
    position, rate = swinging(JointAxis((1.0, 0.0, 0.0), lower=0.0, upper=0.0, damping=1.0))
    assert abs(position) < 1e-3 and abs(rate) < 1e-3


BALL = {"ixx": 0.4, "iyy": 0.4, "izz": 0.4}
FLAT = {"ixx": 0.1, "iyy": 0.1, "izz": 0.2}


def thrown_arm(inertial, seconds=0.5):
    """Places, axes and rates of a free robot of three links that tumbles and bends."""
    links = [Link(f"l{n}", Pose((0.5 * n, 0, 0)), inertial) for n in range(3)]
    joints = [Joint("first", "revolute", "l0", "l1", axis=JointAxis((0, 1, 0), damping=0.3)),
              Joint("second", "revolute", "l1", "l2", axis=JointAxis((0, 0, 1)))]
    faults = []
    with running(World(models=[Model("m", links=links, joints=joints)]), BulletBackend,
                 log=faults.append) as sim:
        sim.states.set_model_state("m", Pose((0, 0, 9)), Twist((1.0, 0.0, 4.0), (3.0, -2.0, 5.0)))
        sim.wrenches.apply_effort("second", 0.5)
        sim.clock.advance(round(seconds * 1000))
        found = [number for n in range(3) for pose, twist in [sim.states.link_state(f"m::l{n}")]
                 for number in (*pose.position, *rotate(pose.orientation, (1, 0, 0)),
                                *rotate(pose.orientation, (0, 1, 0)), *twist.angular)]
        found += [number for joint in ("first", "second")
                  for number in sim.joints.states(joint)[0]]
    assert faults == []
    return found


@pytest.mark.parametrize("ideal, noise", [
    (BALL, {"ixx": 1e-13}), (BALL, {"iyy": -1e-13, "izz": 1e-13}), (BALL, {"ixy": 1e-13}),
    (BALL, {"ixy": 1e-13, "ixz": -1e-13, "iyz": 2e-13}),
    (FLAT, {"izz": 1e-13}), (FLAT, {"ixx": -1e-13}), (FLAT, {"ixy": 1e-13}),
    (FLAT, {"iyy": 1e-13, "iyz": 1e-13}),
], ids=str)
def test_noise_in_the_inertia_of_a_robots_links_changes_nothing_of_its_motion(ideal, noise):
    com = Pose((0.2, 0.0, 0.0))
    noisy = {name: ideal.get(name, 0.0) + noise.get(name, 0.0) for name in {*ideal, *noise}}
    wanted = thrown_arm(Inertial(2.0, com, **ideal))
    found = thrown_arm(Inertial(2.0, com, **noisy))
    assert max(abs(number) for number in wanted[-4:]) > 0.1  # it did bend
    assert found == pytest.approx(wanted, abs=1e-6)


def branches(depth, width):
    """A tree in which every link carries `width` others, listed level by level."""
    links = [Link("base", inertial=Inertial(1.0), gravity=False)]
    joints, level = [], ["base"]
    for _ in range(depth):
        above, level = level, []
        for parent in above:
            for n in range(width):
                name = f"{parent}_{n}"
                kind = ("revolute", "prismatic", "universal")[len(links) % 3]
                links.append(Link(name, Pose((0.1 * len(links), 0.0, 0.0)),
                                  Inertial(1.0 + len(links)), gravity=False))
                joints.append(Joint(f"to_{name}", kind, parent, name, axis=JointAxis((0, 0, 1)),
                                    axis2=JointAxis((0, 1, 0)) if kind == "universal" else None))
                level.append(name)
    return Model("tree", links=links, joints=joints)


@pytest.mark.parametrize("depth, width", [(2, 2), (3, 2), (2, 4)])
def test_each_link_and_joint_of_a_branching_robot_is_itself(depth, width):
    model = branches(depth, width)
    sim = started(World(gravity=(0, 0, 0)), BulletBackend)
    sim.models.spawn(model)
    for link in model.links:
        assert sim.states.link_state(f"tree::{link.name}")[0].position == pytest.approx(
            link.pose.position, abs=1e-9)
    for joint in model.joints:
        if joint.type != "prismatic":
            continue
        before = {
            link.name: sim.states.link_state(link.name)[0].position[2] for link in model.links
        }
        sim.joints.set_positions({joint.name: 0.25})
        for link in model.links:
            carried = 0.25 if link.name.startswith(joint.child) else 0.0
            assert sim.states.link_state(link.name)[0].position[2] == pytest.approx(
                before[link.name] + carried, abs=1e-9), (joint.name, link.name)
    sim.close()


def test_an_effort_on_a_branching_robot_meets_the_mass_of_its_own_link():
    model = branches(2, 2)
    sim = started(World(gravity=(0, 0, 0)), BulletBackend)
    sim.models.spawn(model)
    leaf = next(joint for joint in model.joints
                if joint.type == "prismatic" and joint.child.count("_") == 2)
    mass = next(link for link in model.links if link.name == leaf.child).inertial.mass
    rest = sum(link.inertial.mass for link in model.links) - mass
    sim.wrenches.apply_effort(leaf.name, 1.0, start_ns=0, duration_ns=-1)
    sim.clock.advance(1)
    # The leaf accelerates up by F / m. The rest, if it were one body, would accelerate down by
    # F / M; its other joints can move, so the rate is at least that of two rigid bodies.
    rate = sim.joints.states(leaf.name)[0][1]
    assert rate >= 1e-3 * (1.0 / mass + 1.0 / rest) * (1 - 1e-9)
    velocity = sim.states.link_state(leaf.child)[1].linear[2]
    assert velocity == pytest.approx(1e-3 / mass, rel=1e-6)
    sim.close()
