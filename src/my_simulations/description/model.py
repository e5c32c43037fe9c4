"""Models: links, joints, inertia."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List, Optional

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
    """Mass in kg; `pose`: centre of mass and inertia axes in the link frame; kg m^2 about it.

    The defaults are SDF's: a dynamic link without `<inertial>` has mass 1 and unit inertia.
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
    """A rigid body; `pose` in the model frame. `sensors` show what the XML in `extra` says."""

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


@dataclass
class JointAxis:
    """One degree of freedom; `xyz` a unit vector in the joint frame.

    Limits in rad or m; `effort` N m or N and `velocity` rad/s or m/s, -1 for unlimited;
    `damping`, `friction`, `spring_stiffness` per rad or m. Friction is a brake that drives the rate
    to `motor_rate`: with another rate than 0 it is ODE's joint motor (`vel` and `fmax`), which no
    file can say.
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


@dataclass
class Mimic:
    """An axis that follows another joint's: q = multiplier q_joint + offset (URDF, SDF 1.11)."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass
class Joint:
    """A connection of two links of the model (`parent` may be `world`).

    `type` is SDF's word: revolute, prismatic, fixed, … `pose` is in the child link's frame.
    `axis` is None for a fixed joint. Position 0 is the configuration of the file.
    `thread_pitch` rad/m of a screw, positive left-handed as in Gazebo Classic; `gearbox_ratio`:
    theta2 = -ratio theta1, both about the link `gearbox_reference`.
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
    """A model; `pose` in the world (or in the parent model, when nested).

    `canonical_link` is "" for the first link. `models` are nested ones; `flattened` in
    `description.flatten` gives the same model with the nested links under scoped names.
    `extra` holds the XML of children that are kept but not simulated. `guide` is, in one that was
    flattened, the model as it was.
    """

    name: str
    pose: Pose = IDENTITY
    static: bool = False
    self_collide: bool = False
    allow_auto_disable: bool = True
    canonical_link: str = ""
    links: List[Link] = field(default_factory=list)
    joints: List[Joint] = field(default_factory=list)
    models: List["Model"] = field(default_factory=list)
    plugins: List[PluginSpec] = field(default_factory=list)
    transmissions: List[Transmission] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)
    uri: str = ""
    guide: Optional["Model"] = field(default=None, compare=False, repr=False)
