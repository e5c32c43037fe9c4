"""Inertia from shapes, against closed forms and against meshes of the same shapes."""
from __future__ import annotations

import pytest
import trimesh

from my_simulations.description.model import Inertial, Link
from my_simulations.description.shapes import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Mesh,
    MeshData,
    Sphere,
    mesh_key,
)
from my_simulations.editor.editing.solid_inertia import of_shapes
from my_simulations.errors import CommandError
from my_simulations.geometry import Pose


def moments(inertial):
    return (inertial.ixx, inertial.iyy, inertial.izz)


def link_of(*collisions, mass=2.0):
    return Link("link", inertial=Inertial(mass), collisions=list(collisions))


def as_mesh(solid):
    shape = Mesh(uri="a.stl", path="/a.stl")
    return shape, {mesh_key(shape): MeshData(solid.vertices, solid.faces)}


@pytest.mark.parametrize("shape, solid", [
    (Box((1.0, 2.0, 3.0)), trimesh.creation.box((1.0, 2.0, 3.0))),
    (Sphere(0.5), trimesh.creation.icosphere(5, 0.5)),
    (Cylinder(0.3, 1.2), trimesh.creation.cylinder(0.3, 1.2, sections=256)),
    (Capsule(0.3, 1.2), trimesh.creation.capsule(1.2, 0.3, count=[128, 128])),
    (Ellipsoid((0.2, 0.4, 0.6)), trimesh.creation.icosphere(5, 1.0).apply_scale((0.2, 0.4, 0.6))),
    (Cone(0.4, 1.0), trimesh.creation.cone(0.4, 1.0, sections=256).apply_translation(
        (0, 0, -0.5))),
], ids=lambda value: type(value).__name__)
def test_a_shape_and_a_mesh_of_it_have_the_same_inertia(shape, solid):
    exact = of_shapes(link_of(Collision("c", shape)), {})
    mesh, table = as_mesh(solid)
    drawn = of_shapes(link_of(Collision("c", mesh)), table)
    assert exact.mass == drawn.mass == 2.0
    assert moments(exact) == pytest.approx(moments(drawn), rel=3e-3)
    assert exact.pose.position == pytest.approx(drawn.pose.position, abs=2e-3)


def test_two_boxes_share_the_mass_by_volume():
    made = of_shapes(link_of(Collision("a", Box((1, 1, 1)), pose=Pose((-1.0, 0.0, 0.0))),
                             Collision("b", Box((1, 1, 1)), pose=Pose((1.0, 0.0, 0.0)))), {})
    assert made.mass == pytest.approx(2.0)
    assert made.pose.position == pytest.approx((0.0, 0.0, 0.0))
    assert moments(made) == pytest.approx((2 / 6, 2 / 6 + 2, 2 / 6 + 2))


def test_without_a_volume_there_is_no_inertia():
    with pytest.raises(CommandError, match="no collision with a volume"):
        of_shapes(link_of(), {})
