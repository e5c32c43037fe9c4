"""Rays against closed forms: every shape, far from the origin, turned, in the sensor's frame."""
from __future__ import annotations

import math

import numpy as np
import pytest
from sensing_scene import table

from my_simulations.description.shapes import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Mesh,
    Plane,
    Polyline,
    Sphere,
)
from my_simulations.geometry import IDENTITY, Pose, quat_from_rpy
from my_simulations.sensing.rays.embree import Embree, library_path
from my_simulations.sensing.rays.fan import fan_directions
from my_simulations.sensing.rays.ray_scene import RayScene
from my_simulations.sensing.rays.ray_shapes import RayShape

TENTH_MM = 1e-4
LEVEL = np.zeros(3)


@pytest.fixture(scope="module")
def embree():
    return Embree()


@pytest.fixture
def scene(embree):
    said = []
    made = RayScene(embree, said.append)
    made.said = said
    yield made
    made.clear()


def show(scene, geometry, pose=IDENTITY, name="m", row=0, retro=0.0, endless=False):
    scene.add(name, [(row, [RayShape(geometry, pose, retro, endless)])])


def ranges(scene, origin, directions, near=0.0, far=50.0):
    ways = np.atleast_2d(np.asarray(directions, dtype=float))
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    return scene.cast(np.asarray(origin, dtype=float), ways, near, far)[0]


def test_the_library_is_that_of_the_wheel():
    assert "embreex" in str(library_path())


def test_a_fan_on_a_box_a_wall_seen_from_all_angles(scene):
    show(scene, Box((2.0, 40.0, 3.0)))
    scene.move(table([Pose((4.0, 0.0, 0.0))]))
    yaw = np.linspace(-1.2, 1.2, 721)
    found = ranges(scene, LEVEL, fan_directions(721, -1.2, 1.2, 1, 0.0, 0.0))
    assert np.abs(found - 3.0 / np.cos(yaw)).max() < 1e-5


def test_no_ray_slips_through_an_edge_or_a_diagonal(scene):
    show(scene, Box((1.0, 1.0, 1.0)))
    scene.move(table([Pose((3.0, 0.0, 0.0))]))
    edge = np.linspace(-0.5, 0.5, 101)
    for ways in (np.stack([np.full(101, 2.5), edge, edge], axis=1),
                 np.stack([np.full(101, 2.5), edge, -edge], axis=1),
                 np.stack([np.full(101, 2.5), edge, np.full(101, 0.4999999)], axis=1)):
        assert np.isfinite(ranges(scene, LEVEL, ways)).all()


@pytest.mark.parametrize("place", [(3.0, 0.0, 0.0), (103.0, 200.0, 10.0)])
def test_a_sphere_is_round(scene, place):
    show(scene, Sphere(0.5))
    scene.move(table([Pose(place)]))
    yaw = np.linspace(-0.16, 0.16, 321)
    found = ranges(scene, np.array(place) - (3.0, 0.0, 0.0),
                   np.stack([np.cos(yaw), np.sin(yaw), 0 * yaw], axis=1))
    expected = 3.0 * np.cos(yaw) - np.sqrt(0.25 - (3.0 * np.sin(yaw)) ** 2)
    assert np.abs(found - expected).max() < (2e-6 if place[0] < 10 else TENTH_MM)


@pytest.mark.parametrize("radius", [0.05, 0.5, 2.0, 10.0])
def test_a_cylinder_is_round_within_a_tenth_of_a_millimetre(scene, radius):
    show(scene, Cylinder(radius, 1.0))
    scene.move(table([Pose((3.0 + radius, 0.0, 0.2))]))
    away = 3.0 + radius
    yaw = np.linspace(-0.7, 0.7, 501) * math.asin(radius / away)
    found = ranges(scene, LEVEL, np.stack([np.cos(yaw), np.sin(yaw), 0 * yaw], axis=1))
    expected = away * np.cos(yaw) - np.sqrt(radius ** 2 - (away * np.sin(yaw)) ** 2)
    assert np.abs(found - expected).max() < TENTH_MM


def test_lids_tips_and_caps_are_where_they_belong(scene):
    for geometry, top in ((Cylinder(0.5, 2.0), 1.0), (Capsule(0.5, 2.0), 1.5),
                          (Ellipsoid((0.5, 0.7, 1.2)), 1.2)):
        show(scene, geometry)
        scene.move(table([Pose()]))
        assert ranges(scene, (0.0, 0.0, 5.0), (0, 0, -1)) == pytest.approx(5.0 - top, abs=TENTH_MM)
        assert ranges(scene, (0.0, 0.0, -5.0), (0, 0, 1)) == pytest.approx(5.0 - top, abs=TENTH_MM)
    show(scene, Ellipsoid((0.5, 0.7, 1.2)))
    scene.move(table([Pose()]))
    assert ranges(scene, (5.0, 0, 0), (-1, 0, 0)) == pytest.approx(4.5, abs=TENTH_MM)
    assert ranges(scene, (0, 5.0, 0), (0, -1, 0)) == pytest.approx(4.3, abs=TENTH_MM)


def test_a_cone_leans_as_it_should(scene):
    show(scene, Cone(0.5, 1.0))
    scene.move(table([Pose()]))
    heights = np.array([-0.4, -0.1, 0.2, 0.4])
    found = [ranges(scene, (3.0, 0.0, z), (-1, 0, 0))[0] for z in heights]
    assert found == pytest.approx(3.0 - 0.5 * (0.5 - heights), abs=TENTH_MM)


def test_a_turned_box_on_a_turned_link(scene):
    yaw = 0.3
    show(scene, Box((1.0, 1.0, 1.0)), Pose((0.0, 0.0, 0.0), quat_from_rpy(0, 0, 0.2)))
    scene.move(table([Pose((3.0, 0.0, 0.0), quat_from_rpy(0, 0, yaw - 0.2))]))
    assert ranges(scene, LEVEL, (1, 0, 0)) == pytest.approx(3.0 - 0.5 / math.cos(yaw), abs=1e-6)


def test_an_endless_plane_is_exact_from_both_sides_and_a_visual_one_ends(scene):
    show(scene, Plane((0.0, 0.0, 1.0), (2.0, 2.0)), endless=True)
    scene.move(table([Pose((0.0, 0.0, -1.0))]))
    pitch = np.linspace(0.05, 1.5, 50)
    ways = np.stack([np.cos(pitch), 0 * pitch, -np.sin(pitch)], axis=1)
    assert np.abs(ranges(scene, LEVEL, ways) - 1.0 / np.sin(pitch)).max() < 1e-12
    assert ranges(scene, (500.0, 0, -3.0), (0, 0, 1))[0] == 2.0
    show(scene, Plane((0.0, 0.0, 1.0), (2.0, 2.0)))
    scene.move(table([Pose((0.0, 0.0, -1.0))]))
    assert ranges(scene, (0.9, -0.9, 0.0), (0, 0, -1)) == pytest.approx(1.0, abs=1e-6)
    assert ranges(scene, (1.1, 0.0, 0.0), (0, 0, -1))[0] == math.inf


def test_rays_begin_at_the_minimum_range_and_end_at_the_maximum(scene):
    scene.add("m", [(0, [RayShape(Box((0.1, 1.0, 1.0)), IDENTITY, 0.0)]),
                    (1, [RayShape(Box((0.1, 1.0, 1.0)), IDENTITY, 0.0)])])
    scene.move(table([Pose((1.0, 0.0, 0.0)), Pose((3.0, 0.0, 0.0))]))
    assert ranges(scene, LEVEL, (1, 0, 0), near=0.5) == pytest.approx(0.95, abs=1e-6)
    assert ranges(scene, LEVEL, (1, 0, 0), near=1.5) == pytest.approx(2.95, abs=1e-6)
    assert ranges(scene, LEVEL, (1, 0, 0), near=1.5, far=2.9)[0] == math.inf


def test_what_is_met_is_known_with_its_retro(scene):
    show(scene, Sphere(0.5), name="a", row=0, retro=10.0)
    scene.add("b", [(1, [RayShape(Sphere(0.3), Pose((0, 0, 1.0)), 20.0),
                         RayShape(Box((0.4, 0.4, 0.4)), Pose((0, 0, 2.0)), 30.0)]),
                    (2, [RayShape(Plane(), Pose(), 40.0, endless=True)])])
    scene.move(table([Pose((3.0, 0, 0)), Pose((3.0, 0, 0)), Pose((0, 0, -1.0))]))
    ways = np.array([[3, 0, 0], [3, 0, 1], [3, 0, 2], [0, 0, -1], [-1, 0, 0]], dtype=float)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    found, retro, rows = scene.cast(LEVEL, ways, 0.0, 50.0)
    assert retro.tolist() == [10.0, 20.0, 30.0, 40.0, 0.0]
    assert rows.tolist() == [0, 1, 1, 2, -1]
    assert found[-1] == math.inf


def test_links_move_come_and_go(scene):
    show(scene, Sphere(0.5), name="a", row=0)
    show(scene, Sphere(0.5), name="b", row=1)
    scene.move(table([Pose((3.0, 0, 0))]))  # b has no row yet
    assert ranges(scene, LEVEL, [(1, 0, 0), (0, 1, 0)]).tolist() == pytest.approx([2.5, math.inf])
    scene.move(table([Pose((4.0, 0, 0)), Pose((0, 2.0, 0))]))
    assert ranges(scene, LEVEL, [(1, 0, 0), (0, 1, 0)]) == pytest.approx([3.5, 1.5])
    scene.remove("a")
    scene.move(table([Pose((4.0, 0, 0)), Pose((0, 2.0, 0))]))
    assert ranges(scene, LEVEL, [(1, 0, 0), (0, 1, 0)]).tolist() == pytest.approx([math.inf, 1.5])
    scene.move(table([Pose((4.0, 0, 0))]))
    assert ranges(scene, LEVEL, (0, 1, 0))[0] == math.inf


def test_a_mesh_is_seen_as_its_triangles_not_as_its_hull(scene, tmp_path):
    step = Polyline([[(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]], 1.0)  # an L
    show(scene, step)
    scene.move(table([Pose()]))
    assert ranges(scene, (1.5, 3.0, 0.5), (0, -1, 0)) == pytest.approx(2.0, abs=1e-6)
    assert ranges(scene, (0.5, 3.0, 0.5), (0, -1, 0)) == pytest.approx(1.0, abs=1e-6)


HOUSINGS = [Box((0.1, 0.1, 0.1)), Sphere(0.05), Cylinder(0.05, 0.1), Capsule(0.04, 0.05),
            Ellipsoid((0.05, 0.04, 0.06)), Cone(0.06, 0.2)]


@pytest.mark.parametrize("housing", HOUSINGS, ids=lambda shape: type(shape).__name__)
def test_rays_pass_the_back_faces_of_shapes_that_are_not_double_sided(scene, housing):
    wall = RayShape(Box((0.2, 60.0, 60.0)), Pose((3.1, 0.0, 0.0)), 7.0, double_sided=False)
    turned = Pose((0.0, 0.0, 0.0), quat_from_rpy(0.4, 0.2, 0.3))
    scene.add("m", [(0, [RayShape(housing, turned, 1.0, double_sided=False)]), (1, [wall])])
    scene.move(table([Pose((1.0, 2.0, 3.0)), Pose((1.0, 2.0, 3.0))]))
    ways = fan_directions(40, -1.0, 1.0, 9, -0.5, 0.5)
    origin = np.array((1.0, 2.0, 3.0))
    found, retro, rows = scene.cast(origin, ways, 0.0, 50.0)
    assert found == pytest.approx(3.0 / ways[:, 0], rel=1e-5)
    assert (retro == 7.0).all() and (rows == 1).all()
    # From outside its front faces are met as before.
    found, retro, rows = scene.cast(np.array((-9.0, 2.0, 3.0)), np.array([(1.0, 0, 0)]), 0, 50)
    assert rows == [0] and 9.9 < found[0] < 10.0 and retro == [1.0]


def test_a_double_sided_shape_is_met_from_within(scene):
    scene.add("m", [(0, [RayShape(Box((1.0, 1.0, 1.0)), IDENTITY, 0.0, double_sided=True)])])
    scene.move(table([IDENTITY]))
    assert ranges(scene, LEVEL, [(1, 0, 0)]) == pytest.approx([0.5])


def test_a_ray_passes_many_back_faces_one_after_the_other(scene):
    scene.add("m", [(0, [RayShape(Box((size, size, size)), IDENTITY, 0.0, double_sided=False)
                         for size in np.linspace(0.1, 1.0, 20)])])
    scene.move(table([IDENTITY]))
    assert ranges(scene, LEVEL, [(1, 0, 0), (0, -1, 0)]).tolist() == [math.inf] * 2


def test_a_shape_that_cannot_be_read_is_told_and_passed_through(scene):
    scene.add("m", [(0, [RayShape(Mesh("gone.stl", "/nowhere/gone.stl"), IDENTITY, 1.0),
                         RayShape(Sphere(0.5), IDENTITY, 2.0)])])
    scene.move(table([Pose((3.0, 0, 0))]))
    found, retro, _ = scene.cast(LEVEL, np.array([[1.0, 0, 0]]), 0.0, 10.0)
    assert found[0] == pytest.approx(2.5, abs=1e-6) and retro[0] == 2.0
    assert "gone.stl" in scene.said[0]


def test_a_mesh_that_its_reader_did_not_find_is_not_reported_again(scene):
    scene.add("m", [(0, [RayShape(Mesh("gone.stl"), IDENTITY, 1.0)])])
    assert scene.said == []


def test_a_fan_goes_row_by_row_from_the_lowest_and_each_from_the_minimum_angle():
    ways = fan_directions(3, -0.5, 0.5, 2, -0.1, 0.2).reshape(2, 3, 3)
    assert np.arctan2(ways[..., 1], ways[..., 0]) == pytest.approx(
        np.array([[-0.5, 0, 0.5]] * 2))
    assert np.arcsin(ways[..., 2]) == pytest.approx(np.array([[-0.1] * 3, [0.2] * 3]))
    assert fan_directions(1, 0.3, 0.9, 1, 0.0, 0.0)[0] == pytest.approx(
        [math.cos(0.3), math.sin(0.3), 0.0])
