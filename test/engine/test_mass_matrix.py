"""The mass matrix against what Bullet's step does with the same body."""
from __future__ import annotations

import math
import random
from dataclasses import replace

import numpy as np
import pybullet
import pytest
from conftest import arm
from running_simulator import started

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.engine.bullet.mass_matrix import MassMatrix
from my_simulations.geometry import Pose

DT = 1e-5


@pytest.fixture
def bullet():
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setTimeStep(DT)
    yield
    pybullet.disconnect(client)


def tree(rng: random.Random) -> int:
    """A body of up to six links, hung together at random, with random joints."""
    def vector(size):
        return [rng.uniform(-size, size) for _ in range(3)]

    def unit(width):
        values = [rng.gauss(0, 1) for _ in range(width)]
        return [value / math.hypot(*values) for value in values]

    count = rng.randint(1, 6)
    kinds = [rng.choice([pybullet.JOINT_REVOLUTE, pybullet.JOINT_PRISMATIC, pybullet.JOINT_FIXED])
             for _ in range(count - 1)] + [pybullet.JOINT_REVOLUTE]
    uid = pybullet.createMultiBody(
        baseMass=rng.choice([0.0, 1.5]), basePosition=vector(1), baseOrientation=unit(4),
        baseInertialFramePosition=vector(0.3), baseInertialFrameOrientation=unit(4),
        linkMasses=[rng.uniform(0.5, 3) for _ in kinds], linkCollisionShapeIndices=[-1] * count,
        linkVisualShapeIndices=[-1] * count, linkPositions=[vector(1) for _ in kinds],
        linkOrientations=[unit(4) for _ in kinds],
        linkInertialFramePositions=[vector(0.3) for _ in kinds],
        linkInertialFrameOrientations=[unit(4) for _ in kinds],
        linkParentIndices=[rng.randint(0, n) for n in range(count)], linkJointTypes=kinds,
        linkJointAxis=[unit(3) for _ in kinds])
    for index in range(-1, count):
        if index >= 0 or pybullet.getDynamicsInfo(uid, -1)[0]:
            pybullet.changeDynamics(uid, index, localInertiaDiagonal=[1.0, 1.2, 1.5])
        pybullet.changeDynamics(uid, index, linearDamping=0.0, angularDamping=0.0)
    for index in range(count):  # PyBullet has numbered them its own way
        if pybullet.getJointInfo(uid, index)[2] != pybullet.JOINT_FIXED:
            pybullet.resetJointState(uid, index, rng.uniform(-1, 1))
            pybullet.setJointMotorControl2(uid, index, pybullet.VELOCITY_CONTROL, force=0.0)
            pybullet.changeDynamics(uid, index, jointDamping=0.0)
    return uid


@pytest.mark.parametrize("seed", range(30))
def test_its_inverse_is_what_an_effort_accelerates(bullet, seed):
    uid = tree(random.Random(seed))
    matrix = MassMatrix(uid)
    index, place = list(matrix.columns.items())[-1]
    expected = np.linalg.inv(matrix.compute())[:, place]
    pybullet.setJointMotorControl2(uid, index, pybullet.TORQUE_CONTROL, force=1.0)
    pybullet.stepSimulation()
    for joint, row in matrix.columns.items():
        assert pybullet.getJointState(uid, joint)[1] / DT == pytest.approx(
            expected[row], abs=1e-3 * abs(expected).max())


def chain(count: int, mass: float) -> Model:
    links = [Link(f"l{n}", Pose((0.5 * n, 0, 0)), Inertial(mass, Pose((0.25, 0, 0)), ixx=0.1,
                                                          iyy=0.1, izz=0.1), gravity=False)
             for n in range(count)]
    joints = [Joint(f"j{n}", "revolute", f"l{n - 1}" if n else "world", f"l{n}",
                    axis=JointAxis((0, 0, 1), damping=40.0)) for n in range(count)]
    return Model("chain", links=links, joints=joints)


def test_a_body_that_comes_where_another_has_gone_has_its_own_masses():
    faults = []
    sim = started(World(), BulletBackend, log=faults.append)
    seen = {}
    for turn in range(30):
        count, mass = 1 + turn % 3, 1.0 + turn % 2
        sim.models.spawn(chain(count, mass))
        sim.wrenches.apply_effort("chain::j0", 1.0, start_ns=0, duration_ns=-1)
        sim.clock.advance(50)
        rate = sim.joints.states("j0")[0][1]
        assert seen.setdefault((count, mass), rate) == pytest.approx(rate, rel=1e-9)
        sim.models.delete("chain")
    sim.close()
    assert not faults
    assert len(set(seen.values())) == 6


def test_a_stiff_axis_keeps_its_law_when_a_lighter_body_was_there_before():
    sim = started(World(), BulletBackend)
    damped = JointAxis((0, 0, 1), damping=1000.0)
    for mass in (0.01, 100.0):
        model = replace(arm("revolute", damped, mass=mass, gravity=False), name="arm")
        sim.models.spawn(model)
        entity = sim.models.inventory()[1][-1]
        sim.wrenches.apply_effort("arm::hinge", 1000.0, start_ns=0, duration_ns=-1)
        sim.clock.advance(3000)
        inertia = mass + 1e-3
        assert entity.joint_names == ["hinge"]
        assert sim.joints.states("hinge")[0][1] == pytest.approx(
            1.0 - math.exp(-3.0 * 1000.0 / inertia), rel=0.02)
        sim.models.delete("arm")
    sim.close()


def _on_wheel(centre: "tuple[float, float, float]", moments: "tuple[float, float, float]"
              ) -> MassMatrix:
    """A base with one wheel about its y axis, with this centre of mass and these moments."""
    uid = pybullet.createMultiBody(
        baseMass=1.0, linkMasses=[0.3], linkCollisionShapeIndices=[-1],
        linkVisualShapeIndices=[-1], linkPositions=[(0.2, 0.1, 0.0)],
        linkOrientations=[(0, 0, 0, 1)], linkInertialFramePositions=[centre],
        linkInertialFrameOrientations=[(0, 0, 0, 1)], linkParentIndices=[0],
        linkJointTypes=[pybullet.JOINT_REVOLUTE], linkJointAxis=[(0, 1, 0)])
    pybullet.changeDynamics(uid, -1, localInertiaDiagonal=(0.1, 0.2, 0.3))
    pybullet.changeDynamics(uid, 0, localInertiaDiagonal=moments)
    return MassMatrix(uid)


@pytest.mark.parametrize("centre, moments, balanced", [
    ((0.0, 0.02, 0.0), (2e-4, 3e-4, 2e-4), True), ((0.001, 0.0, 0.0), (2e-4, 3e-4, 2e-4), False),
    ((0.0, 0.0, 0.0), (2e-4, 3e-4, 2.1e-4), False)], ids=["round", "eccentric", "oval"])
def test_what_turns_without_changing_the_matrix(bullet, centre, moments, balanced):
    tree = _on_wheel(centre, moments)
    assert tree.wheels() == ({0} if balanced else set())
    assert tree.moves_only_by(tree.wheels()) == balanced
    seen = []
    for angle in (0.0, 0.7):
        pybullet.resetJointState(tree._uid, 0, angle)
        seen.append(tree.compute())
    assert np.allclose(*seen, rtol=1e-9, atol=1e-12) == balanced
