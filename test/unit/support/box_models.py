"""Models of boxes for tests of the simulator."""
from __future__ import annotations

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision
from my_simulations.geometry import Pose


def box(name, links=("link",), **changes):
    """A model of links 1 m apart along x, each with a box 2 m above its origin."""
    return Model(name, links=[Link(link, Pose((float(n), 0, 0)), Inertial(),
                                   [Collision("c", Box(), Pose((0, 0, 2.0)))])
                              for n, link in enumerate(links)], **changes)


def arm(name):
    """Two links and a hinge."""
    made = box(name, ("base", "tip"))
    made.joints.append(Joint("hinge", "revolute", "base", "tip", axis=JointAxis()))
    return made
