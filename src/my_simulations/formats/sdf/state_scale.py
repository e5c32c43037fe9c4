"""Applies the `<scale>` of a saved state to a model."""
from __future__ import annotations

from dataclasses import replace
from typing import Any

from ...description.model import Model
from ...description.shapes import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Heightmap,
    ImageMap,
    Mesh,
    Plane,
    Polyline,
    Sphere,
)
from ...geometry import Pose, Vec3

_ONE: Vec3 = (1.0, 1.0, 1.0)


def scaled(model: Model, factor: Vec3) -> Model:
    """The model with its shapes scaled along the axes of their own frames.

    Positions of shapes within their link are scaled, too; poses of links are not, because the state
    holds them. Mass and inertia are unchanged (Gazebo behaviour).
    """
    if factor == _ONE:
        return model

    def resized(item: Any) -> Any:
        return replace(item, geometry=scaled_geometry(item.geometry, factor),
                       pose=Pose(_times(item.pose.position, factor), item.pose.orientation))

    links = [replace(link, collisions=[resized(item) for item in link.collisions],
                     visuals=[resized(item) for item in link.visuals]) for link in model.links]
    return replace(model, links=links, models=[scaled(inner, factor) for inner in model.models])


def _times(a: Vec3, b: Vec3) -> Vec3:
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


def scaled_geometry(shape: Geometry, factor: Vec3) -> Geometry:
    """The shape scaled; round ones by the larger factor across their axis (Gazebo behaviour)."""
    across = max(abs(factor[0]), abs(factor[1]))
    if isinstance(shape, Box):
        return Box(_times(shape.size, factor))
    if isinstance(shape, Sphere):
        return Sphere(shape.radius * max(across, abs(factor[2])))
    if isinstance(shape, (Cylinder, Capsule, Cone)):
        return replace(shape, radius=shape.radius * across, length=shape.length * abs(factor[2]))
    if isinstance(shape, Ellipsoid):
        return Ellipsoid(_times(shape.radii, factor))
    if isinstance(shape, Mesh):
        return replace(shape, scale=_times(shape.scale, factor))
    if isinstance(shape, Plane):
        return replace(shape, size=(shape.size[0] * factor[0], shape.size[1] * factor[1]))
    if isinstance(shape, Heightmap):
        upwards = abs(factor[2])
        return replace(shape, size=_times(shape.size, factor), blends=[
            replace(blend, min_height=blend.min_height * upwards,
                    fade_dist=blend.fade_dist * upwards) for blend in shape.blends])
    if isinstance(shape, Polyline):
        return Polyline([[(x * factor[0], y * factor[1]) for x, y in loop]
                         for loop in shape.loops], shape.height * abs(factor[2]))
    if isinstance(shape, ImageMap):
        return replace(shape, scale=shape.scale * across, height=shape.height * abs(factor[2]))
    return shape
