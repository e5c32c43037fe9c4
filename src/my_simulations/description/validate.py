"""Validates models, independent of the file format.

The rules need no file. Readers add file and line with `locate`; requests of programs use
`validate` without it.
"""
from __future__ import annotations

import difflib
from dataclasses import dataclass
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Set, Union

from ..errors import Issue, Severity
from ..geometry import is_finite, norm, pose_is_finite
from .model import WORLD, Inertial, Joint, JointAxis, Link, Model
from .shapes import (
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

JOINT_TYPES = (
    "revolute", "prismatic", "fixed", "continuous", "revolute2", "universal", "ball", "screw",
    "gearbox",
)
"""Joint types of the format (SDF spec, joint@type)."""

_AXIS_FREE = ("fixed", "ball")


@dataclass(frozen=True)
class Fault:
    """One fault of a model; `subject` is the faulty object of the description."""

    code: str
    message: str
    subject: Any
    severity: Severity = Severity.ERROR
    hint: str = ""


Locate = Callable[[Any], Dict[str, Any]]
"""Returns `file`, `line` and `xpath` of an object of the description, for its `Issue`."""


def validate(model: Model, locate: Optional[Locate] = None) -> List[Issue]:
    """All faults of the model; with a fault of severity ERROR it cannot be simulated."""
    return [
        Issue(fault.severity, fault.code, fault.message, hint=fault.hint,
              **(locate(fault.subject) if locate else {}))
        for fault in find_faults(model)
    ]


def find_faults(model: Model, static: bool = False) -> Iterator[Fault]:
    """Yield all faults of a model and its nested models; `static`: an outer model is static."""
    static = static or model.static
    yield from find_own_faults(model, static)
    for nested in model.models:
        yield from find_faults(nested, static)


def find_own_faults(model: Model, static: bool = False) -> Iterator[Fault]:
    """Yield the faults of a model without those of its nested models."""
    static = static or model.static
    yield from name_and_pose_faults(model)
    yield from _find_repeated("link", model.links)
    yield from _find_repeated("joint", model.joints)
    yield from _find_repeated("model", model.models)
    for link in model.links:
        yield from link_faults(link, static)
    known = set(link_names(model))
    for joint in model.joints:
        yield from joint_faults(joint, known)
    if model.canonical_link and model.canonical_link not in known:
        yield Fault("link-unknown", f"canonical_link names {model.canonical_link!r}, which is not"
                    " a link of the model", model, Severity.WARNING)


def name_and_pose_faults(model: Model) -> Iterator[Fault]:
    """Faults of name and pose, which depend on the outer model."""
    if not model.name:
        yield Fault("name-empty", "the model has no name", model)
    if not pose_is_finite(model.pose):
        yield Fault("pose-not-finite", f"the pose of model {model.name!r} is not finite", model)


def link_names(model: Model) -> Iterator[str]:
    """Names of all links as seen from the model: `link`, `nested::link`."""
    waiting = [("", model)]
    while waiting:
        scope, one = waiting.pop()
        for link in one.links:
            yield scope + link.name
        waiting += [(f"{scope}{nested.name}::", nested) for nested in reversed(one.models)]


def _find_repeated(kind: str, items: Sequence[Any]) -> Iterator[Fault]:
    seen: Set[str] = set()
    for item in items:
        if not item.name:
            # A nested model reports its own empty name.
            if kind != "model":
                yield Fault("name-empty", f"a {kind} has no name", item)
        elif item.name in seen:
            yield Fault("name-repeated", f"there are two {kind}s named {item.name!r}", item,
                        hint="names are unique within a model")
        seen.add(item.name)


def link_faults(link: Link, static: bool) -> Iterator[Fault]:
    """Faults of a link; mass and inertia are checked for dynamic links only."""
    if link.name == WORLD:
        yield Fault("name-reserved",
                    "a link is named 'world', which means the world in joints", link)
    if not pose_is_finite(link.pose):
        yield Fault("pose-not-finite", f"the pose of link {link.name!r} is not finite", link)
    if not (static or link.kinematic):
        yield from inertial_faults(link.inertial, link.name)
    for collision in link.collisions:
        problem = geometry_fault(collision.geometry)
        if not pose_is_finite(collision.pose):
            problem = "the pose is not finite"
        if problem:
            yield Fault("bad-shape", f"collision {collision.name!r} of link {link.name!r}:"
                        f" {problem}", collision)
    for visual in link.visuals:
        problem = geometry_fault(visual.geometry)
        if problem:
            yield Fault("bad-shape", f"visual {visual.name!r} of link {link.name!r}: {problem}",
                        visual, Severity.WARNING)


def inertial_faults(inertial: Inertial, link: str) -> Iterator[Fault]:
    """Faults of mass (must be positive) and inertia (finite, positive definite)."""
    tensor = (inertial.ixx, inertial.iyy, inertial.izz, inertial.ixy, inertial.ixz, inertial.iyz)
    if not is_finite(inertial.mass, *tensor) or not pose_is_finite(inertial.pose):
        yield Fault("inertia-not-finite", f"mass or inertia of link {link!r} is not finite",
                    inertial)
        return
    if inertial.mass <= 0:
        yield Fault("mass-not-positive", f"the mass of link {link!r} is {inertial.mass:g} kg; a"
                    " link that can move needs more than 0", inertial,
                    hint="give it a mass, or make the model static")
    if not is_positive_definite(inertial):
        yield Fault("inertia-not-positive", f"the inertia of link {link!r} is not positive"
                    f" definite: {tensor_text(inertial)}", inertial,
                    hint="a body's principal moments of inertia are all above 0")
    elif not _is_a_body(inertial):
        yield Fault("inertia-impossible", f"no body has the inertia of link {link!r}: one principal"
                    f" moment is larger than the sum of the others: {tensor_text(inertial)}",
                    inertial, Severity.WARNING)


def tensor_text(i: Inertial) -> str:
    """The six numbers of the tensor, for a message."""
    return (f"ixx {i.ixx:g}, iyy {i.iyy:g}, izz {i.izz:g}, ixy {i.ixy:g}, ixz {i.ixz:g},"
            f" iyz {i.iyz:g}")


def is_positive_definite(i: Inertial) -> bool:
    """True if all leading minors of the tensor are positive (Sylvester's criterion)."""
    return i.ixx > 0 and i.ixx * i.iyy - i.ixy * i.ixy > 0 and _determinant(
        i.ixx, i.iyy, i.izz, i.ixy, i.ixz, i.iyz) > 0


def _determinant(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> float:
    return (xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz))


def _is_a_body(i: Inertial) -> bool:
    """The triangle inequality of the principal moments: trace/2 E - I has no negative eigenvalue.

    The tolerance is 1e-4 of the trace, because files contain rounded numbers.
    """
    half = (i.ixx + i.iyy + i.izz) / 2 * (1 + 1e-4)
    xx, yy, zz = half - i.ixx, half - i.iyy, half - i.izz
    return xx >= 0 and xx * yy - i.ixy ** 2 >= 0 and _determinant(
        xx, yy, zz, -i.ixy, -i.ixz, -i.iyz) >= 0


def geometry_fault(geometry: Geometry) -> str:
    """The fault of a shape's numbers, as a phrase; "" if there is none."""
    if isinstance(geometry, Box):
        return _not_positive("size of the box", geometry.size)
    if isinstance(geometry, Sphere):
        return _not_positive("radius of the sphere", (geometry.radius,))
    if isinstance(geometry, (Cylinder, Capsule, Cone)):
        shape = type(geometry).__name__.lower()
        return (_not_positive(f"radius of the {shape}", (geometry.radius,))
                or _not_positive(f"length of the {shape}", (geometry.length,)))
    if isinstance(geometry, Ellipsoid):
        return _not_positive("radii of the ellipsoid", geometry.radii)
    if isinstance(geometry, (Heightmap, ImageMap, Polyline)):
        return _solid_fault(geometry)
    if isinstance(geometry, Plane):
        if not is_finite(*geometry.normal) or norm(geometry.normal) < 1e-12:
            return "the normal of the plane has no direction"
    if isinstance(geometry, Mesh):
        if not is_finite(*geometry.scale) or 0.0 in geometry.scale:
            shown = " ".join(f"{value:g}" for value in geometry.scale)
            return f"the scale of the mesh must not be 0, found {shown}"
    return ""


def _solid_fault(solid: Union[Heightmap, ImageMap, Polyline]) -> str:
    if isinstance(solid, Heightmap):
        if not is_finite(*solid.size, *solid.position) or 0.0 in solid.size:
            return "the size of the heightmap must not be 0"
        return (_not_positive("extent of the heightmap", solid.size[:2])
                or _not_positive("sampling of the heightmap", (solid.sampling,)))
    if isinstance(solid, ImageMap):
        return (_not_positive("scale of the image", (solid.scale,))
                or _not_positive("height of the image", (solid.height,))
                or _not_positive("granularity of the image", (solid.granularity,)))
    if not solid.loops or min(len(loop) for loop in solid.loops) < 3:
        return "a polyline needs at least 3 points"
    return _not_positive("height of the polyline", (solid.height,))


def has_zero_size(geometry: Geometry) -> bool:
    """True for a flat or empty shape: a size is 0, none is negative or non-finite."""
    sizes: Sequence[float] = ()
    if isinstance(geometry, Box):
        sizes = geometry.size
    elif isinstance(geometry, Sphere):
        sizes = (geometry.radius,)
    elif isinstance(geometry, Ellipsoid):
        sizes = geometry.radii
    elif isinstance(geometry, (Cylinder, Capsule, Cone)):
        sizes = (geometry.radius, geometry.length)
    return 0 in sizes and is_finite(*sizes) and min(sizes) >= 0


def _not_positive(what: str, values: Sequence[float]) -> str:
    if is_finite(*values) and min(values) > 0:
        return ""
    shown = " ".join(f"{value:g}" for value in values)
    return f"the {what} must be above 0, found {shown}"


def closest_name_hint(name: str, known: List[str]) -> str:
    """Return the hint `did you mean X?` with the known name most like `name`; "" if none is.

    One with the same letters comes first: `ixy` for `iyx`.
    """
    near = ([one for one in known if sorted(one) == sorted(name)]
            or difflib.get_close_matches(name, known, 1))
    return f"did you mean {near[0]}?" if near else ""


def joint_faults(joint: Joint, links: Set[str]) -> Iterator[Fault]:
    """Faults of a joint; `links`: names of the links it may connect, besides the world."""
    name = joint.name
    for role, link in (("parent", joint.parent), ("child", joint.child)):
        if not link:
            yield Fault("joint-link-missing", f"joint {name!r} has no {role} link", joint)
        elif link not in links and (link != WORLD or role == "child"):
            yield Fault("joint-link-unknown", f"joint {name!r} names {link!r} as its {role}, which"
                        " is not a link of the model", joint,
                        hint=closest_name_hint(link, sorted(links)))
    if joint.parent and joint.parent == joint.child:
        yield Fault("joint-link-repeated", f"joint {name!r} connects {joint.child!r} with itself",
                    joint)
    if not pose_is_finite(joint.pose):
        yield Fault("pose-not-finite", f"the pose of joint {name!r} is not finite", joint)
    if joint.axis is None and joint.type not in _AXIS_FREE:
        yield Fault("joint-axis-missing", f"joint {name!r} of type {joint.type} has no axis", joint)
    for axis in (joint.axis, joint.axis2):
        if axis is not None and joint.type != "fixed":
            yield from _axis_faults(axis, joint)


def _axis_faults(axis: JointAxis, joint: Joint) -> Iterator[Fault]:
    if not is_finite(*axis.xyz) or norm(axis.xyz) < 1e-12:
        yield Fault("joint-axis-zero", f"the axis of joint {joint.name!r} has no direction", joint)
    plain = (axis.damping, axis.friction, axis.spring_reference, axis.spring_stiffness)
    limits = (axis.lower, axis.upper, axis.effort, axis.velocity)
    if not is_finite(*plain) or any(limit != limit for limit in limits):
        yield Fault("joint-not-finite", f"a number of joint {joint.name!r} is not finite", joint)
    elif axis.lower > axis.upper:
        yield Fault("joint-limits-reversed", f"the lower limit of joint {joint.name!r},"
                    f" {axis.lower:g}, is above the upper one, {axis.upper:g}", joint,
                    Severity.WARNING)
