"""Worlds: models, lights, physics, and what is kept for the editor."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List

from ..geometry import IDENTITY, Pose, Vec3
from .model import Model, PluginSpec
from .shapes import Color


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
    """Settings of Gazebo's ODE engine: stored and read back; `iters` also drives ours."""

    auto_disable_bodies: bool = False
    precon_iters: int = 0
    iters: int = 50
    sor: float = 1.3
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
class World:
    """A world file, read. `extra` holds the XML of children kept but not simulated."""

    name: str = "default"
    gravity: Vec3 = (0.0, 0.0, -9.8)
    physics: Physics = field(default_factory=Physics)
    models: List[Model] = field(default_factory=list)
    lights: List[Light] = field(default_factory=list)
    plugins: List[PluginSpec] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)
    file: str = ""
