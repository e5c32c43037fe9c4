"""A model made larger or smaller by the user: real sizes, and the inertia that goes with them."""
from __future__ import annotations

from dataclasses import replace

from ...description.model import Inertial, Model
from ...errors import CommandError
from ...formats.inertia import combine_inertia
from ...formats.sdf.state_applied import scale_model
from ...geometry import IDENTITY, Pose, Vec3, is_finite
from ..scene.scene_json import is_scalable

SMALLEST = 1e-4
"""Least factor (Gazebo behaviour)."""


def resize_model(model: Model, factor: Vec3) -> Model:
    """Scale the shapes of a model by `factor` along the link's axes; its mass stays.

    Raises CommandError for a model that cannot be scaled, and for factors below `SMALLEST`.
    """
    if not is_finite(*factor) or min(factor) < SMALLEST:
        raise CommandError(f"scale factors must be {SMALLEST} or more, found {factor}")
    if not is_scalable(model):
        raise CommandError(f"{model.name!r} cannot be scaled: it has several links, or a shape"
                           " without a size of its own")
    made = scale_model(model, factor)
    return replace(made, links=[
        replace(link, inertial=scale_inertial(link.inertial, factor)) for link in made.links])


def scale_inertial(inertial: Inertial, factor: Vec3) -> Inertial:
    """Scale the mass distribution of an inertia; its mass stays.

    The integrals of x x, x y, … over the mass scale with the product of two factors, and the
    tensor is made of them; exact for any body.
    """
    i = combine_inertia(None, inertial, IDENTITY) or inertial   # along the link's axes
    fx, fy, fz = factor
    xx = (i.iyy + i.izz - i.ixx) / 2 * fx * fx
    yy = (i.ixx + i.izz - i.iyy) / 2 * fy * fy
    zz = (i.ixx + i.iyy - i.izz) / 2 * fz * fz
    x, y, z = i.pose.position
    return replace(i, pose=Pose((x * fx, y * fy, z * fz)), ixx=yy + zz, iyy=xx + zz, izz=xx + yy,
                   ixy=i.ixy * fx * fy, ixz=i.ixz * fx * fz, iyz=i.iyz * fy * fz)
