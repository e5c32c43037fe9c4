"""Surroundings of a world: scene, GUI, wind, atmosphere, place, roads.

Drawn by the editor and saved, without effect on motion.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List, Optional

from ..geometry import IDENTITY, Pose, Vec3
from .model import PluginSpec
from .shapes import Color, Material


@dataclass
class Fog:
    """Fog of a scene. Source: SDF spec 1.7, scene/fog; Gazebo 11 reads linear, exp, exp2 and none.

    At distance d a share of exp(-density d) is seen through `exp`, exp(-(density d)^2) through
    `exp2`. Gazebo refuses the specification's words constant and quadratic: they are drawn as thin
    `exp2` here.

    Attributes:
        type: `none`, `linear`, `exp`, `exp2`, `constant` or `quadratic`.
        color: r, g, b, a in 0..1.
        start: distance from the camera at which linear fog begins, m.
        end: distance from the camera at which linear fog is complete, m.
        density: density of all but linear fog, from 0 (clear), 1/m for exp and exp2.
        extra: XML of child elements that no field holds.
    """

    type: str = "none"
    color: Color = (1.0, 1.0, 1.0, 1.0)
    start: float = 1.0
    end: float = 100.0
    density: float = 1.0
    extra: List[str] = field(default_factory=list)


@dataclass
class Sky:
    """Sky of a scene. Source: SDF spec 1.7, scene/sky.

    Attributes:
        time: time of day, hours, 0..24.
        sunrise: time of sunrise, hours.
        sunset: time of sunset, hours.
        cloud_speed: speed of the clouds, m/s.
        cloud_direction: direction in which the clouds move, rad about the world's z from x.
        cloud_humidity: density of the clouds, 0 to 1.
        cloud_mean_size: mean size of the clouds, 0 to 1.
        cloud_ambient: ambient colour of the clouds, r, g, b, a in 0..1.
        extra: XML of child elements that no field holds.
    """

    time: float = 10.0
    sunrise: float = 6.0
    sunset: float = 20.0
    cloud_speed: float = 0.6
    cloud_direction: float = 0.0
    cloud_humidity: float = 0.5
    cloud_mean_size: float = 0.5
    cloud_ambient: Color = (0.8, 0.8, 0.8, 1.0)
    extra: List[str] = field(default_factory=list)


@dataclass
class Scene:
    """How the world is drawn. Source: SDF spec 1.7, scene.

    Attributes:
        ambient: ambient light, r, g, b, a in 0..1.
        background: colour of the background where there is no sky, r, g, b, a in 0..1.
        shadows: whether shadows are drawn.
        grid: whether the ground grid is drawn.
        origin_visual: whether the axes of the world frame are drawn.
        sky: the sky; None for a plain background.
        fog: the fog; None for no fog.
        extra: XML of child elements that no field holds.
    """

    ambient: Color = (0.4, 0.4, 0.4, 1.0)
    background: Color = (0.7, 0.7, 0.7, 1.0)
    shadows: bool = True
    grid: bool = True
    origin_visual: bool = True
    sky: Optional[Sky] = None
    fog: Optional[Fog] = None
    extra: List[str] = field(default_factory=list)


@dataclass
class GuiCamera:
    """The camera with which the world opens. Source: SDF spec 1.7, gui/camera.

    Attributes:
        name: name of the camera.
        pose: pose of the camera in the world frame; it looks along its x axis, z is up.
        view_controller: `orbit` or `fps`.
        projection_type: `perspective` or `orthographic`.
        track: name of the model that the camera follows, "" for none.
        track_min_dist: least distance from the followed model, m.
        track_max_dist: greatest distance from the followed model, m.
        track_static: whether the camera keeps its place relative to the model (`track_xyz`).
        track_use_model_frame: whether `track_xyz` is in the model frame; else in the world frame.
        track_xyz: position of the camera relative to the followed model, m.
        track_inherit_yaw: whether the camera turns with the yaw of the model.
        extra: XML of child elements that no field holds.
    """

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
    extra: List[str] = field(default_factory=list)


@dataclass
class Gui:
    """`<gui>` besides its camera; without effect here. Source: SDF spec 1.7, gui.

    Attributes:
        fullscreen: whether Gazebo's window opens full screen.
        plugins: plugins of Gazebo's client.
        extra: XML of child elements that no field holds.
    """

    fullscreen: bool = False
    plugins: List[PluginSpec] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)


@dataclass
class Wind:
    """Wind, without effect on motion. Source: SDF spec 1.7, world/wind.

    Attributes:
        linear_velocity: m/s, world axes.
        extra: XML of child elements that no field holds.
    """

    linear_velocity: Vec3 = (0.0, 0.0, 0.0)
    extra: List[str] = field(default_factory=list)


@dataclass
class Atmosphere:
    """The atmosphere at sea level, without effect on motion. Source: SDF spec 1.7, atmosphere.

    Attributes:
        type: model of the atmosphere, `adiabatic`.
        temperature: K.
        pressure: Pa.
        temperature_gradient: change of the temperature with altitude, K/m.
        extra: XML of child elements that no field holds.
    """

    type: str = "adiabatic"
    temperature: float = 288.15
    pressure: float = 101325.0
    temperature_gradient: float = -0.0065
    extra: List[str] = field(default_factory=list)


@dataclass
class SphericalCoordinates:
    """Place of the world's origin on Earth. Source: SDF spec 1.7, spherical_coordinates.

    Attributes:
        surface_model: model of Earth's surface, `EARTH_WGS84`.
        world_frame_orientation: directions of the world's axes at heading 0, `ENU` (east, north,
            up).
        latitude_deg: geodetic latitude, degrees, north positive.
        longitude_deg: longitude, degrees, east positive.
        elevation: height above the surface model, m.
        heading_deg: rotation of the world frame about up, degrees, counterclockwise positive.
        extra: XML of child elements that no field holds.
    """

    surface_model: str = "EARTH_WGS84"
    world_frame_orientation: str = "ENU"
    latitude_deg: float = 0.0
    longitude_deg: float = 0.0
    elevation: float = 0.0
    heading_deg: float = 0.0
    extra: List[str] = field(default_factory=list)


@dataclass
class Road:
    """A flat strip along a line; drawn, without collisions. Source: SDF spec 1.7, road.

    Attributes:
        name: name of the road.
        width: m.
        points: points of the centre line in the world frame, m.
        material: appearance; None for the default.
        extra: XML of child elements that no field holds.
    """

    name: str
    width: float = 1.0
    points: List[Vec3] = field(default_factory=list)
    material: Optional[Material] = None
    extra: List[str] = field(default_factory=list)
