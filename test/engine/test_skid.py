"""A skid-steered base turns on the spot, whatever its heading."""
from __future__ import annotations

import math
from dataclasses import replace

import pytest
from conftest import Lab, ground, inertial_of_box
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Collision, Cylinder, Surface
from my_simulations.geometry import Pose, quat_from_rpy

AHEAD, ASIDE, RADIUS, SPEED = 0.2, 0.25, 0.1, 0.3   # wheels from the centre, m; m/s


def _base() -> Model:
    """Four wheels whose joints turn at given rates, the left ones backwards."""
    links = [Link("link", inertial=inertial_of_box(10, 0.6, 0.4, 0.1))]
    joints = []
    wheel = Link("wheel", inertial=Inertial(0.5, ixx=0.0015, iyy=0.0015, izz=0.0025), collisions=[
        Collision("c", Cylinder(RADIUS, 0.05), surface=Surface(mu=1.0))])
    for n, (x, y) in enumerate([(AHEAD, ASIDE), (AHEAD, -ASIDE), (-AHEAD, ASIDE),
                                (-AHEAD, -ASIDE)]):
        links.append(replace(wheel, name=f"w{n}", pose=Pose(
            (x, y, 0), quat_from_rpy(-math.pi / 2, 0, 0))))
        joints.append(Joint(f"j{n}", "revolute", "link", f"w{n}", axis=JointAxis(
            (0, 0, 1), friction=1e3, motor_rate=SPEED / RADIUS * (-1 if y > 0 else 1))))
    return Model("base", links=links, joints=joints)


@pytest.mark.parametrize("heading", range(0, 91, 15))
def test_a_skid_steered_base_turns_at_every_heading(lab: Lab, laws: Laws, heading: int):
    # Four equal wheels that slip in the direction of Coulomb's law: v b / (a^2 + b^2). Friction
    # along the world's axes, as Gazebo's, turns it by up to half faster, and never slower by much.
    lab.load(ground(1.0))
    base = lab.load(_base(), (0, 0, RADIUS), quat_from_rpy(0, 0, math.radians(heading)))
    lab.steps(400)
    laws.near("a skid-steered base with pyramid friction: turn, rad/s",
              lab.twist(base).angular[2], SPEED * ASIDE / (AHEAD ** 2 + ASIDE ** 2), rel=0.5)
