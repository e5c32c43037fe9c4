"""What PyBullet keeps of bodies that were removed, and what is used again."""
from __future__ import annotations

import glob
import os
import tempfile
from dataclasses import replace

import pybullet
import pytest
from conftest import ball, box, ground

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Cylinder
from my_simulations.geometry import Pose

KEPT_KB = 2.5
"""Of a removed body without links: 1.4 kB were measured, 4.2 kB with a shape of its own."""

HEAP = Model("heap", links=[Link("link", collisions=[
    Collision("a", Box((1.0, 0.2, 0.2))), Collision("b", Cylinder(0.1, 1.0), Pose((0, 0, 0.5)))])])

JOINED = Model("joined", links=[
    Link("link", collisions=[Collision("c", Box())]),
    Link("tip", Pose((0, 0, 1.5)), collisions=[Collision("c", Box())])], joints=[
        Joint("hinge", "revolute", "link", "tip", axis=JointAxis((0, 1, 0)))])

BRUSH = Model("brush", links=[Link("link", collisions=[
    Collision(f"bristle {n}", Box((0.02, 0.02, 0.2)), Pose((0.05 * n, 0.0, 0.0)))
    for n in range(20)])])
"""More shapes than PyBullet takes in one compound."""


def resident_kb():
    with open("/proc/self/status", encoding="ascii", errors="replace") as stream:
        return next(int(line.split()[1]) for line in stream if line.startswith("VmRSS"))


@pytest.fixture
def made(monkeypatch):
    """Shapes that PyBullet was asked for."""
    shapes = []
    real = pybullet.createCollisionShapeArray
    monkeypatch.setattr(pybullet, "createCollisionShapeArray",
                        lambda **arguments: shapes.append(arguments) or real(**arguments))
    return shapes


@pytest.mark.parametrize("model", [box(), ball(), HEAP, JOINED],
                         ids=lambda model: model.name)
def test_the_next_body_of_equal_shape_takes_that_of_a_removed_one(lab, made, model):
    lab.load(ground())
    first = lab.load(model, (0, 0, 2))
    lab.steps(700)
    fallen, count = lab.pose(first), len(made)
    lab.remove(first)
    second = lab.load(model, (0, 0, 2))
    assert len(made) == count
    lab.steps(700)
    assert lab.pose(second).position == pytest.approx(fallen.position, abs=1e-5)
    lab.load(model, (5, 0, 2))  # beside one that is still there
    assert len(made) == count + sum(1 for link in model.links if link.collisions)


def hull_files():
    """The mesh files of this process's engines."""
    return set(glob.glob(os.path.join(tempfile.gettempdir(), "my_simulations_scratch_*", "*.obj")))


def test_a_link_of_many_shapes_leaves_neither_files_nor_shapes(lab, made, monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    for _ in range(65):
        brush = lab.load(BRUSH, (0, 0, 2))
        assert len(hull_files()) == 1
        lab.remove(brush)
        assert not hull_files()
    assert len(made) == 1


def test_equal_links_of_many_shapes_share_a_file_until_the_last_one_goes(
        lab, monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    one, other = lab.load(BRUSH, (0, 0, 2)), lab.load(BRUSH, (0, 5, 2))
    wider = lab.load(replace(BRUSH, links=[replace(BRUSH.links[0], collisions=[
        replace(part, geometry=Box((0.03, 0.02, 0.2))) for part in BRUSH.links[0].collisions])]),
        (0, 9, 2))
    assert len(hull_files()) == 2
    lab.remove(one)
    assert len(hull_files()) == 2
    lab.remove(other)
    assert len(hull_files()) == 1
    lab.remove(wider)
    assert not hull_files()


def test_a_body_of_another_size_gets_a_shape_of_its_own(lab, made):
    lab.remove(lab.load(box(size=1.0), (0, 0, 2)))
    other = lab.load(box(size=0.5), (0, 0, 2))
    assert len(made) == 2
    lab.load(ground())
    lab.steps(2000)
    assert lab.pose(other).position[2] == pytest.approx(0.25, abs=1e-3)


def test_little_is_kept_of_bodies_that_come_and_go(lab):
    def rounds(count):
        for _ in range(count):
            lab._links = lab._joints = 0  # rows are used again, as the registry does
            lab.remove(lab.load(box()))

    rounds(300)
    before = resident_kb()
    rounds(1500)
    kept = (resident_kb() - before) / 1500
    print(f"{kept:.2f} kB of each removed body")
    assert kept < KEPT_KB
