"""Tables of URDF's elements and of Gazebo's extensions.

Source: the URDF specification; for `<gazebo>`, what Gazebo's converter reads.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Mapping, Optional, Tuple

from ...description.model import Inertial, JointAxis, Link, Mimic, Model
from ...description.shapes import Box, Capsule, Collision, Color, Cylinder, Mesh, Sphere, Visual
from ...geometry import IDENTITY_QUAT, ZERO3, Quat, Vec3
from ..xml.source import FaultLevel
from ..xml.tables import Group, Kept, Part, Table, Use, Value, kept, values_named
from ..xml.values import (
    BOOL,
    COLOR,
    FLOAT,
    FRICTION,
    INT,
    LIMIT,
    NEGATED,
    RPY,
    SCALE,
    TEXT,
    VECTOR3,
)

FATAL, WARNING = FaultLevel.FATAL, FaultLevel.WARNING


def _ignored(*names: str) -> Dict[str, Kept]:
    """Elements that are known and not kept, because SDF, in which robots are saved, lacks them."""
    return kept(*names, use=Use.IGNORED)


@dataclass
class Origin:
    """`<origin xyz rpy>`."""

    xyz: Vec3 = ZERO3
    rpy: Quat = IDENTITY_QUAT


@dataclass
class Ends:
    """Parent and child of a joint."""

    parent: str = ""
    child: str = ""


@dataclass
class Limits:
    """`<limit>`; unlike in SDF, missing bounds are 0."""

    lower: float = 0.0
    upper: float = 0.0
    effort: float = -1.0
    velocity: float = -1.0


@dataclass
class Safety:
    """`<safety_controller>`."""

    lower: float = 0.0
    upper: float = 0.0
    k_position: float = 0.0
    k_velocity: float = 0.0


@dataclass
class Axis:
    """`<axis xyz>`; x by default."""

    xyz: Vec3 = (1.0, 0.0, 0.0)


@dataclass
class Paint:
    """`<material>`."""

    name: str = ""
    color: Optional[Color] = None
    texture: str = ""


ORIGIN = Table("origin", Origin, attributes={
    "xyz": Value("xyz", VECTOR3), "rpy": Value("rpy", RPY),
}, level=FATAL, strict=True)

ROBOT = Table("robot", Model, {
    "link": Part(), "joint": Part(), "material": Part(), "gazebo": Part(), "origin": Part(),
    "transmission": Part(use=Use.PLUGINS),
    **_ignored("sensor", "verbose", "group_state", "ros2_control"),
}, known_attributes=("name", "version", "static", "type"), strict=True,
    hint="call a macro of xacro with the prefix: <xacro:{name}>")

LINK = Table("link", Link, {
    "inertial": Part(), "visual": Part(), "collision": Part(),
    **_ignored("sensor", "self_collision_checking", "verbose", "origin", "gravity"),
}, known_attributes=("name", "type"), strict=True)

INERTIAL = Table("inertial", Inertial, {
    "origin": Part(),
    "mass": Group(attributes={"value": Value("mass", FLOAT)}),
    "inertia": Group(attributes=values_named(FLOAT, "ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
}, level=FATAL, strict=True)

COLLISION = Table("collision", Collision, {
    "origin": Part(), "geometry": Part(), **_ignored("verbose", "contact_coefficients"),
}, known_attributes=("name", "group"), strict=True)

VISUAL = Table("visual", Visual, {
    "origin": Part(), "geometry": Part(), "material": Part(), **_ignored("verbose"),
}, known_attributes=("name", "group"), use=Use.SHOWN, strict=True)

GEOMETRIES: Mapping[str, Tuple[Table, Tuple[str, ...]]] = {
    "box": (Table("box", Box, attributes={"size": Value("size", VECTOR3)}, strict=True), ("size",)),
    "sphere": (Table("sphere", Sphere, attributes={"radius": Value("radius", FLOAT)}, strict=True),
               ("radius",)),
    "cylinder": (Table("cylinder", Cylinder, attributes=values_named(
        FLOAT, "radius", "length"), strict=True), ("radius", "length")),
    "capsule": (Table("capsule", Capsule, attributes=values_named(
        FLOAT, "radius", "length"), strict=True), ("radius", "length")),
    "mesh": (Table("mesh", Mesh, attributes={
        "filename": Value("uri", TEXT), "scale": Value("scale", SCALE),
    }, strict=True), ("filename",)),
}
"""Tables of the shapes, with their required attributes."""

MATERIAL = Table("material", Paint, {
    "color": Group(attributes={"rgba": Value("color", COLOR)}),
    "texture": Group(attributes={"filename": Value("texture", TEXT)}),
}, attributes={"name": Value("name", TEXT)}, level=WARNING, use=Use.SHOWN, strict=True)

JOINT = Table("joint", Ends, {
    "origin": Part(), "axis": Part(), "limit": Part(), "dynamics": Part(), "mimic": Part(),
    "parent": Group(attributes={"link": Value("parent", TEXT)}),
    "child": Group(attributes={"link": Value("child", TEXT)}),
    "safety_controller": Part(), **_ignored("calibration"),
}, known_attributes=("name", "type"), strict=True)
AXIS = Table("axis", Axis, attributes={"xyz": Value("xyz", VECTOR3)}, level=FATAL, strict=True)
LIMIT_TABLE = Table("limit", Limits, attributes=values_named(
    LIMIT, "lower", "upper", "effort", "velocity"), level=FATAL, strict=True)
SAFETY = Table("safety_controller", Safety, attributes={
    "soft_lower_limit": Value("lower", FLOAT), "soft_upper_limit": Value("upper", FLOAT),
    "k_position": Value("k_position", FLOAT), "k_velocity": Value("k_velocity", FLOAT),
}, level=WARNING, strict=True)
MIMIC = Table("mimic", Mimic, attributes={
    "joint": Value("joint", TEXT), **values_named(FLOAT, "multiplier", "offset"),
}, level=FATAL, strict=True)
DYNAMICS = Table("dynamics", JointAxis, attributes=values_named(FLOAT, "damping", "friction"),
                 level=FATAL, strict=True)

GAZEBO_MODEL = Table("gazebo", Model, {
    **values_named(BOOL, "static", "self_collide", "allow_auto_disable"),
    "enable_wind": Value("enable_wind", BOOL, use=Use.PLUGINS),
    "plugin": Part(use=Use.PLUGINS), "link": Part(), "joint": Part(),
    "gripper": Part(),
    **kept("frame", "canonicalBody", "selfCollide", "turnGravityOff"),
})
"""`<gazebo>` without a reference."""

GAZEBO_COLLISION: Mapping[str, Value] = {
    "mu1": Value("mu", FRICTION, part="surface"), "mu2": Value("mu2", FRICTION, part="surface"),
    "fdir1": Value("fdir1", VECTOR3, part="surface"),
    "kp": Value("kp", FLOAT, part="surface"), "kd": Value("kd", FLOAT, part="surface"),
    "minDepth": Value("min_depth", FLOAT, part="surface"),
    "maxVel": Value("max_vel", FLOAT, part="surface"),
    "maxContacts": Value("max_contacts", INT), "laserRetro": Value("laser_retro", FLOAT),
}
"""Tags of `<gazebo reference="link">` that set every collision of the link."""

GAZEBO_LINK: Mapping[str, Tuple[Value, ...]] = {
    "selfCollide": (Value("self_collide", BOOL),), "self_collide": (Value("self_collide", BOOL),),
    "turnGravityOff": (Value("gravity", NEGATED),), "gravity": (Value("gravity", BOOL),),
    "dampingFactor": (Value("linear_decay", FLOAT), Value("angular_decay", FLOAT)),
    "kinematic": (Value("kinematic", BOOL),),
}
"""Tags of `<gazebo reference="link">` that set the link."""

GAZEBO_LINK_KEPT = (
    "sensor", "light", "projector", "plugin", "audio_source", "audio_sink", "battery",
    "enable_wind", "must_be_base_link", "particle_emitter", "genTexCoord", "static",
)

GAZEBO_JOINT: Mapping[str, Tuple[str, ...]] = {
    "stopCfm": ("physics/ode/limit/cfm",), "stopErp": ("physics/ode/limit/erp",),
    "fudgeFactor": ("physics/ode/fudge_factor",),
    "provideFeedback": ("physics/provide_feedback", "physics/ode/provide_feedback"),
    "implicitSpringDamper": ("physics/ode/implicit_spring_damper",),
    "cfmDamping": ("physics/ode/cfm_damping",),
}
"""Tags of `<gazebo reference="joint">` and the SDF elements they become."""

GAZEBO_JOINT_AXIS: Mapping[str, Value] = {
    "springReference": Value("spring_reference", FLOAT),
    "springStiffness": Value("spring_stiffness", FLOAT),
}
