"""Models: links, joints, inertia."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import List, Optional, Tuple

from ..geometry import IDENTITY, Pose, Vec3
from .plugin import PluginSpec as PluginSpec
from .sensor import Sensor
from .shapes import Collision, Visual
from .transmission import Transmission

INFINITE = 1e16
"""SDF's spelling of "no limit" (joint/axis/limit lower and upper)."""

WORLD = "world"
"""The name of the world as parent of a joint."""


@dataclass
class Inertial:
    """Mass and inertia of a link. Source: SDF spec 1.7, inertial.

    The defaults are SDF's: a dynamic link without `<inertial>` has mass 1 and unit inertia.

    Attributes:
        mass: kg.
        pose: pose of the inertial frame in the link frame; its origin is the centre of mass.
        ixx, ixy, ixz, iyy, iyz, izz: inertia tensor about the centre of mass, in the axes of the
            inertial frame, kg m^2.
    """

    mass: float = 1.0
    pose: Pose = IDENTITY
    ixx: float = 1.0
    ixy: float = 0.0
    ixz: float = 0.0
    iyy: float = 1.0
    iyz: float = 0.0
    izz: float = 1.0


@dataclass
class Link:
    """A rigid body. Source: SDF spec 1.7, link.

    Attributes:
        name: unique among the links, joints and nested models of its model.
        pose: pose of the link frame in the model frame.
        inertial: mass and inertia.
        collisions: shapes that collide.
        visuals: shapes that are drawn.
        gravity: whether gravity acts on the link.
        kinematic: whether the link ignores forces and contacts and moves only on command.
        self_collide: whether the link collides with other links of its model; None for the
            model's own value.
        linear_decay: share of the linear velocity that is removed in every step, 0 to 1.
        angular_decay: share of the angular velocity that is removed in every step, 0 to 1.
        extra: XML of child elements that no field holds, and of sensors.
        sensors: what the XML of the sensors says.
    """

    name: str
    pose: Pose = IDENTITY
    inertial: Inertial = field(default_factory=Inertial)
    collisions: List[Collision] = field(default_factory=list)
    visuals: List[Visual] = field(default_factory=list)
    gravity: bool = True
    kinematic: bool = False
    self_collide: Optional[bool] = None
    linear_decay: float = 0.0
    angular_decay: float = 0.0
    sensors: List[Sensor] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)


@dataclass(frozen=True)
class SoftLimits:
    """Within these the rate gets smaller towards the limits (URDF, safety_controller).

    Attributes:
        lower, upper: rad or m; infinite for a joint without position limits.
        k_position: rate by distance to the limit, 1/s.
        k_velocity: effort by what the rate is too high, N m s/rad or N s/m.
    """

    lower: float
    upper: float
    k_position: float
    k_velocity: float

    def rates(self, position: float, most: float) -> Tuple[float, float]:
        """The least and the greatest rate that may be commanded at a position."""
        if math.isinf(self.upper - self.lower):
            return -most, most
        return (max(-most, min(most, -self.k_position * (position - self.lower))),
                max(-most, min(most, -self.k_position * (position - self.upper))))


@dataclass
class JointAxis:
    """One degree of freedom of a joint. Source: SDF spec 1.7, joint/axis.

    Units are those of a revolute axis first, of a prismatic one second.

    Attributes:
        xyz: direction, a unit vector in the joint frame.
        lower: lower limit of the position, rad or m; -1e16 for none.
        upper: upper limit of the position, rad or m; 1e16 for none.
        effort: greatest effort applied by clients, N m or N; -1 for no limit.
        velocity: greatest rate, rad/s or m/s; -1 for no limit.
        damping: viscous damping, N m s/rad or N s/m.
        friction: dry friction, N m or N.
        spring_reference: position at which the spring is relaxed, rad or m.
        spring_stiffness: N m/rad or N/m.
        mimic: makes the axis follow another joint; None for a free axis.
        motor_rate: rate to which the friction drives the axis, rad/s or m/s. With a value other
            than 0 it is ODE's joint motor (`vel` and `fmax`), which no file can describe.
        soft: soft limits, which controllers keep (URDF); None without.
    """

    xyz: Vec3 = (0.0, 0.0, 1.0)
    lower: float = -INFINITE
    upper: float = INFINITE
    effort: float = -1.0
    velocity: float = -1.0
    damping: float = 0.0
    friction: float = 0.0
    spring_reference: float = 0.0
    spring_stiffness: float = 0.0
    mimic: Optional["Mimic"] = None
    motor_rate: float = 0.0
    soft: Optional[SoftLimits] = None


@dataclass
class Mimic:
    """An axis that follows another joint: q = multiplier q_joint + offset (URDF, SDF 1.11).

    Attributes:
        joint: name of the joint that is followed.
        multiplier: ratio of the positions, in the units of the two axes.
        offset: position of the axis where the followed joint is at 0, rad or m.
    """

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass
class Joint:
    """A joint between two links. Source: SDF spec 1.7, joint.

    Its position is 0 in the configuration of the description.

    Attributes:
        name: unique among the joints of its model.
        type: SDF's name of the type: `revolute`, `prismatic`, `fixed`, `universal`, ...
        parent: name of the parent link, or `world`.
        child: name of the child link.
        pose: pose of the joint frame in the frame of the child link.
        axis: the first axis; None for a joint without one, such as a fixed joint.
        axis2: the second axis of a universal, revolute2 or gearbox joint; None for others.
        thread_pitch: of a screw joint, rad/m, positive left-handed as in Gazebo Classic.
        gearbox_ratio: of a gearbox joint: theta2 = -ratio theta1, no unit.
        gearbox_reference: name of the link about which a gearbox measures both angles.
        extra: XML of child elements that no field holds.
    """

    name: str
    type: str
    parent: str
    child: str
    pose: Pose = IDENTITY
    axis: Optional[JointAxis] = None
    axis2: Optional[JointAxis] = None
    thread_pitch: float = 1.0
    gearbox_ratio: float = 1.0
    gearbox_reference: str = ""
    sensors: List[Sensor] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)


@dataclass
class Model:
    """A model. Source: SDF spec 1.7, model.

    `description.flatten` makes it a model without nested ones, with scoped link names.

    Attributes:
        name: unique among the models and lights of the world, or in the outer model.
        pose: pose of the model frame in the world frame, or in that of the outer model.
        static: whether the model never moves.
        self_collide: whether links of the model collide with each other.
        allow_auto_disable: whether the physics engine may put the model to sleep at rest.
        enable_wind: whether the wind of libWindPlugin.so acts on the model.
        canonical_link: name of the link that the model frame moves with, "" for the first link.
        links: links, in the order of the file.
        joints: joints, in the order of the file.
        models: nested models.
        plugins: plugins.
        extra: XML of child elements that no field holds.
        uri: URI of the `<include>` that brings the model, "" for none.
        guide: in a flattened model, the model before flattening; else None.
    """

    name: str
    pose: Pose = IDENTITY
    static: bool = False
    self_collide: bool = False
    allow_auto_disable: bool = True
    enable_wind: bool = False
    canonical_link: str = ""
    links: List[Link] = field(default_factory=list)
    joints: List[Joint] = field(default_factory=list)
    models: List["Model"] = field(default_factory=list)
    plugins: List[PluginSpec] = field(default_factory=list)
    transmissions: List[Transmission] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)
    uri: str = ""
    guide: Optional["Model"] = field(default=None, compare=False, repr=False)

    @property
    def frame_link(self) -> Optional[Link]:
        """Of a model without nested ones, the link that its frame moves with; None: no links."""
        for link in self.links:
            if link.name == self.canonical_link:
                return link
        return self.links[0] if self.links else None
