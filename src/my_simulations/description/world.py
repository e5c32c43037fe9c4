"""Worlds: models, lights, physics, and what is kept for the editor."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, List, Optional

from ..geometry import IDENTITY, STILL, Pose, Twist, Vec3
from .model import Joint, Model, PluginSpec
from .shapes import Color, Material


@dataclass
class Light:
    """A light; `type` is point, directional or spot; defaults are SDF's."""

    name: str
    type: str = "point"
    pose: Pose = IDENTITY
    cast_shadows: bool = False
    diffuse: Color = (1.0, 1.0, 1.0, 1.0)
    specular: Color = (0.1, 0.1, 0.1, 1.0)
    range: float = 10.0
    constant: float = 1.0
    linear: float = 1.0
    quadratic: float = 0.0
    direction: Vec3 = (0.0, 0.0, -1.0)
    inner_angle: float = 0.0
    outer_angle: float = 0.0
    falloff: float = 0.0
    extra: List[str] = field(default_factory=list)


@dataclass
class OdePhysics:
    """Settings of Gazebo's ODE engine: stored and read back; two of them also drive ours.

    Attributes:
        iters: the most iterations of a step.
        friction_model: "pyramid_model" or "cone_model" (SDF, ode/solver); "" for the default.
    """

    auto_disable_bodies: bool = False
    precon_iters: int = 0
    iters: int = 50
    sor: float = 1.3
    friction_model: str = ""
    rms_error_tol: float = 0.0
    cfm: float = 0.0
    erp: float = 0.2
    contact_surface_layer: float = 0.001
    contact_max_correcting_vel: float = 100.0
    max_contacts: int = 20


@dataclass
class Physics:
    """`max_step_size` s; `real_time_update_rate` steps per second of wall time, 0 = unthrottled."""

    name: str = "default_physics"
    type: str = "ode"
    max_step_size: float = 0.001
    real_time_factor: float = 1.0
    real_time_update_rate: float = 1000.0
    ode: OdePhysics = field(default_factory=OdePhysics)


@dataclass
class Fog:
    """`type` is none, constant, linear or quadratic; `start`, `end` in metres."""

    type: str = "none"
    color: Color = (1.0, 1.0, 1.0, 1.0)
    start: float = 1.0
    end: float = 100.0
    density: float = 1.0


@dataclass
class Sky:
    """Hours of the day; clouds drift at `cloud_speed` m/s towards `cloud_direction` rad."""

    time: float = 10.0
    sunrise: float = 6.0
    sunset: float = 20.0
    cloud_speed: float = 0.6
    cloud_direction: float = 0.0
    cloud_humidity: float = 0.5
    cloud_mean_size: float = 0.5
    cloud_ambient: Color = (0.8, 0.8, 0.8, 1.0)


@dataclass
class Scene:
    """What the editor's view looks like; no sky means a plain background."""

    ambient: Color = (0.4, 0.4, 0.4, 1.0)
    background: Color = (0.7, 0.7, 0.7, 1.0)
    shadows: bool = True
    grid: bool = True
    origin_visual: bool = True
    sky: Optional[Sky] = None
    fog: Optional[Fog] = None


@dataclass
class GuiCamera:
    """The view a world opens with; `track` names the model it follows, "" for none."""

    name: str = "user_camera"
    pose: Pose = IDENTITY
    view_controller: str = "orbit"
    projection_type: str = "perspective"
    track: str = ""
    track_min_dist: float = 0.0
    track_max_dist: float = 0.0
    track_static: bool = False
    track_use_model_frame: bool = True
    track_xyz: Vec3 = (-5.0, 0.0, 3.0)
    track_inherit_yaw: bool = False


@dataclass
class Wind:
    """`linear_velocity` m/s in world axes."""

    linear_velocity: Vec3 = (0.0, 0.0, 0.0)


@dataclass
class Atmosphere:
    """K, Pa and K/m at sea level."""

    type: str = "adiabatic"
    temperature: float = 288.15
    pressure: float = 101325.0
    temperature_gradient: float = -0.0065


@dataclass
class SphericalCoordinates:
    """Where on the globe the world's origin lies; degrees and metres."""

    surface_model: str = "EARTH_WGS84"
    world_frame_orientation: str = "ENU"
    latitude_deg: float = 0.0
    longitude_deg: float = 0.0
    elevation: float = 0.0
    heading_deg: float = 0.0


@dataclass
class Road:
    """A ribbon along `points`, `width` metres wide; seen, never touched."""

    name: str
    width: float = 1.0
    points: List[Vec3] = field(default_factory=list)
    material: Optional[Material] = None


@dataclass
class Animation:
    """A named cycle of a skeleton."""

    name: str
    filename: str = ""
    scale: float = 1.0
    interpolate_x: bool = False


@dataclass
class Waypoint:
    """`time` s since the trajectory began; `pose` in the world (Gazebo behaviour)."""

    time: float = 0.0
    pose: Pose = IDENTITY


@dataclass
class Trajectory:
    """`type` names the animation played meanwhile; trajectories run in the order of `id`."""

    id: int = 0
    type: str = ""
    tension: float = 0.0
    waypoints: List[Waypoint] = field(default_factory=list)


@dataclass
class Actor:
    """A walking figure; `skin` and the files of animations are URIs, `base_dir` anchors them."""

    name: str
    pose: Pose = IDENTITY
    skin: str = ""
    skin_scale: float = 1.0
    animations: List[Animation] = field(default_factory=list)
    loop: bool = True
    delay_start: float = 0.0
    auto_start: bool = True
    trajectories: List[Trajectory] = field(default_factory=list)
    plugins: List[PluginSpec] = field(default_factory=list)
    base_dir: str = ""


@dataclass
class LinkState:
    """Where a link was when the world was saved: pose and twist of the link frame in the world.

    `name` is scoped within its model: `link`, `nested::link`.
    """

    name: str
    pose: Pose = IDENTITY
    twist: Twist = STILL


@dataclass
class ModelState:
    """A model when the world was saved; `pose` in the world; `joints`: positions by axis."""

    name: str
    pose: Optional[Pose] = None
    scale: Vec3 = (1.0, 1.0, 1.0)
    links: List[LinkState] = field(default_factory=list)
    joints: Dict[str, List[float]] = field(default_factory=dict)


@dataclass
class LightState:
    """A light when the world was saved; `pose` in the world."""

    name: str
    pose: Pose = IDENTITY


@dataclass
class SavedState:
    """A `<state>`: what had become of the world when it was saved; times in ns."""

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
    """What a model starts with besides its pose.

    `twists` of link frames by scoped link name; `joints`: positions in rad or m by joint name.
    """

    twists: Dict[str, Twist] = field(default_factory=dict)
    joints: Dict[str, float] = field(default_factory=dict)


@dataclass
class World:
    """A world file, read.

    `extra` holds the XML of children kept but not simulated, those with a field of their own from
    `scene` to `roads` included: the fields show what that XML says. `joints` connect links of
    different models, by scoped names. `initial_ns` is the sim time it starts at, and `initial`
    what its models start with, by name; both come from a saved state (`formats.state`). `losses`
    says what of the file could not be read and is therefore missing here.
    """

    name: str = "default"
    gravity: Vec3 = (0.0, 0.0, -9.8)
    physics: Physics = field(default_factory=Physics)
    models: List[Model] = field(default_factory=list)
    lights: List[Light] = field(default_factory=list)
    plugins: List[PluginSpec] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)
    file: str = ""
    magnetic_field: Vec3 = (5.5645e-6, 22.8758e-6, -42.3884e-6)
    scene: Scene = field(default_factory=Scene)
    gui_camera: Optional[GuiCamera] = None
    wind: Wind = field(default_factory=Wind)
    atmosphere: Atmosphere = field(default_factory=Atmosphere)
    spherical_coordinates: Optional[SphericalCoordinates] = None
    actors: List[Actor] = field(default_factory=list)
    roads: List[Road] = field(default_factory=list)
    joints: List[Joint] = field(default_factory=list)
    state: Optional[SavedState] = None
    initial_ns: int = 0
    initial: Dict[str, InitialState] = field(default_factory=dict)
    seed: int = 0
    losses: List[str] = field(default_factory=list)
