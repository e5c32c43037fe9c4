"""Worlds: models, lights, physics settings and surroundings."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, List, Optional

from ..geometry import Vec3
from .actor import Actor
from .light import Light
from .model import Joint, Model, PluginSpec
from .saved_state import InitialState, SavedState
from .surroundings import (
    Atmosphere,
    Gui,
    GuiCamera,
    Road,
    Scene,
    SphericalCoordinates,
    Wind,
)


@dataclass
class OdePhysics:
    """Settings of Gazebo's ODE engine: kept and reported; two of them also set PyBullet's solver.

    Source: SDF spec 1.7, physics/ode.

    Attributes:
        auto_disable_bodies: whether bodies at rest are put to sleep.
        precon_iters: number of preconditioning iterations.
        iters: greatest number of solver iterations per step; sets PyBullet's solver.
        sor: successive over-relaxation factor, no unit.
        rms_error_tol: residual at which the solver stops, no unit.
        cfm: constraint force mixing, ODE's units.
        erp: error reduction parameter, 0 to 1.
        contact_surface_layer: depth of penetration without contact forces, m.
        contact_max_correcting_vel: greatest velocity that corrects penetration, m/s.
        max_contacts: greatest number of contacts between two collisions.
        friction_model: "pyramid_model" or "cone_model"; "" for the default. Sets PyBullet's solver.
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
    """A physics preset. Source: SDF spec 1.7, physics.

    Attributes:
        name: name of the preset.
        type: engine that Gazebo would use: `ode`, `bullet`, `simbody` or `dart`.
        max_step_size: sim time per step, s.
        real_time_factor: kept and reported; `real_time_update_rate` sets the speed, as in Gazebo.
        real_time_update_rate: steps per second of wall time, Hz; 0 for as many as possible.
        ode: settings of the ODE engine.
    """

    name: str = "default_physics"
    type: str = "ode"
    max_step_size: float = 0.001
    real_time_factor: float = 1.0
    real_time_update_rate: float = 1000.0
    ode: OdePhysics = field(default_factory=OdePhysics)


@dataclass
class World:
    """A world. Source: SDF spec 1.7, world.

    Attributes:
        name: name of the world.
        gravity: m/s^2, world axes.
        physics: the physics preset in use.
        models: top-level models, in the order of the file.
        lights: lights, in the order of the file.
        plugins: world plugins.
        extra: XML of child elements that no field holds.
        file: path of the file, or a name for text from elsewhere.
        magnetic_field: T, world axes.
        scene: how the world is drawn.
        gui: `<gui>` besides its camera.
        gui_camera: the camera with which the world opens; None for the default one.
        wind: wind.
        atmosphere: atmosphere.
        spherical_coordinates: place of the origin on Earth; None if unknown.
        actors: actors, in the order of the file.
        roads: roads, in the order of the file.
        joints: joints between models; parent and child are scoped link names, or `world`.
        state: a saved state that is not applied yet; None otherwise.
        initial_ns: sim time at the start, ns; from a saved state.
        initial: initial states of models by name; from a saved state.
        seed: seed of populations that are placed at random.
        losses: errors of the file, one sentence each: what they name is missing here.
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
    gui: Gui = field(default_factory=Gui)
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
