"""The state of a world at one moment of a run, as `<state>` saves it."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, List, Optional

from ..geometry import IDENTITY, STILL, Pose, Twist, Vec3
from .light import Light
from .model import Model


@dataclass
class LinkState:
    """State of a link. Source: SDF spec 1.7, state/model/link.

    Attributes:
        name: scoped name within the model: `link`, `nested::link`.
        pose: pose of the link frame in the world frame.
        twist: velocity of the link frame's origin, m/s and rad/s in world axes.
    """

    name: str
    pose: Pose = IDENTITY
    twist: Twist = STILL


@dataclass
class ModelState:
    """State of a model. Source: SDF spec 1.7, state/model.

    Attributes:
        name: name of the model.
        pose: pose of the model frame in the world frame; None keeps the one of the description.
        scale: scale of the model along the axes of its frame, no unit.
        links: states of its links, nested ones too.
        joints: positions by scoped joint name, one for each axis, rad or m.
    """

    name: str
    pose: Optional[Pose] = None
    scale: Vec3 = (1.0, 1.0, 1.0)
    links: List[LinkState] = field(default_factory=list)
    joints: Dict[str, List[float]] = field(default_factory=dict)


@dataclass
class LightState:
    """State of a light. Source: SDF spec 1.7, state/light.

    Attributes:
        name: name of the light.
        pose: pose of the light frame in the world frame.
    """

    name: str
    pose: Pose = IDENTITY


@dataclass
class SavedState:
    """A `<state>`. Source: SDF spec 1.7, state.

    Attributes:
        world_name: name of the world.
        sim_time_ns: sim time, ns.
        real_time_ns: wall time since the start of the simulation, ns.
        wall_time_ns: wall time of the saving since the Unix epoch, ns.
        iterations: number of steps simulated.
        models: states of models.
        lights: states of lights.
        inserted_models: models added since the world was loaded.
        inserted_lights: lights added since the world was loaded.
        deletions: names of the models and lights deleted since the world was loaded.
    """

    world_name: str = ""
    sim_time_ns: int = 0
    real_time_ns: int = 0
    wall_time_ns: int = 0
    iterations: int = 0
    models: List[ModelState] = field(default_factory=list)
    lights: List[LightState] = field(default_factory=list)
    inserted_models: List[Model] = field(default_factory=list)
    inserted_lights: List[Light] = field(default_factory=list)
    deletions: List[str] = field(default_factory=list)


@dataclass
class InitialState:
    """Initial state of a model besides its pose.

    Attributes:
        twists: velocities of link frames by scoped link name, m/s and rad/s in world axes.
        joints: positions by scoped joint name, rad or m.
    """

    twists: Dict[str, Twist] = field(default_factory=dict)
    joints: Dict[str, float] = field(default_factory=dict)
