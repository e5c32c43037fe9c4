"""Tables of the elements of an SDF world besides models. Source: SDF specification, 1.2 to 1.7."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional

from ...description.actor import Actor, Animation, Trajectory, Waypoint
from ...description.saved_state import LightState, LinkState, ModelState, SavedState
from ...description.surroundings import (
    Atmosphere,
    Fog,
    Gui,
    GuiCamera,
    Road,
    Scene,
    Sky,
    SphericalCoordinates,
    Wind,
)
from ...geometry import IDENTITY, Pose, Twist, Vec3
from ..xml.source import FaultLevel
from ..xml.tables import (
    Entry,
    Group,
    Kept,
    Nested,
    Part,
    Table,
    Use,
    Value,
    kept,
    values_named,
)
from ..xml.values import (
    BOOL,
    COLOR,
    FLOAT,
    INT,
    PATH_POSE,
    POSE,
    SCALE,
    SECONDS,
    TEXT,
    VECTOR3,
    parse_numbers,
)

WARNING = FaultLevel.WARNING
PLUGINS, SHOWN, KEPT = Use.PLUGINS, Use.SHOWN, Use.KEPT

SKY = Table("sky", Sky, {
    **values_named(FLOAT, "time", "sunrise", "sunset"),
    "clouds": Group({
        "speed": Value("cloud_speed", FLOAT), "direction": Value("cloud_direction", FLOAT),
        "humidity": Value("cloud_humidity", FLOAT), "mean_size": Value("cloud_mean_size", FLOAT),
        "ambient": Value("cloud_ambient", COLOR),
    }),
    "material": Kept(),
}, level=WARNING, use=SHOWN)

FOG = Table("fog", Fog, {
    "type": Value("type", TEXT), "color": Value("color", COLOR),
    **values_named(FLOAT, "start", "end", "density"),
}, level=WARNING, use=SHOWN)

SCENE = Table("scene", Scene, {
    "ambient": Value("ambient", COLOR), "background": Value("background", COLOR),
    **values_named(BOOL, "shadows", "grid", "origin_visual"),
    "sky": Nested("sky", SKY), "fog": Nested("fog", FOG, required=("type",)),
}, level=WARNING, use=SHOWN)

GUI = Table("gui", Gui, {
    "camera": Part(), "plugin": Part(use=KEPT, reported=True),
}, attributes={"fullscreen": Value("fullscreen", BOOL, use=KEPT)}, level=WARNING, use=SHOWN)

GUI_CAMERA = Table("camera", GuiCamera, {
    "pose": Value("pose", POSE), **values_named(TEXT, "view_controller", "projection_type"),
    "track_visual": Group({
        "name": Value("track", TEXT), "min_dist": Value("track_min_dist", FLOAT),
        "max_dist": Value("track_max_dist", FLOAT), "static": Value("track_static", BOOL),
        "use_model_frame": Value("track_use_model_frame", BOOL),
        "xyz": Value("track_xyz", VECTOR3), "inherit_yaw": Value("track_inherit_yaw", BOOL),
    }),
}, attributes={"name": Value("name", TEXT)}, level=WARNING, use=SHOWN)

WIND = Table("wind", Wind, {"linear_velocity": Value("linear_velocity", VECTOR3)},
             level=WARNING, use=PLUGINS)

ATMOSPHERE = Table("atmosphere", Atmosphere, values_named(
    FLOAT, "temperature", "pressure", "temperature_gradient"),
    attributes={"type": Value("type", TEXT)}, level=WARNING, use=KEPT)

SPHERICAL = Table("spherical_coordinates", SphericalCoordinates, {
    **values_named(TEXT, "surface_model", "world_frame_orientation"),
    **values_named(FLOAT, "latitude_deg", "longitude_deg", "elevation", "heading_deg"),
}, level=WARNING, use=PLUGINS)

SURROUNDINGS: Mapping[str, Entry] = {
    "gui": Part(use=SHOWN),
    "scene": Nested("scene", SCENE, required=("ambient", "background", "shadows"), use=SHOWN),
    "actor": Part(use=SHOWN, reported=True), "road": Part(use=SHOWN, reported=True),
    "wind": Nested("wind", WIND, required=("linear_velocity",), use=PLUGINS),
    "atmosphere": Nested("atmosphere", ATMOSPHERE, required=("@type",), use=KEPT),
    "spherical_coordinates": Nested("spherical_coordinates", SPHERICAL, required=(
        "surface_model", "latitude_deg", "longitude_deg", "elevation", "heading_deg"), use=PLUGINS),
}
"""Children of `<world>` around its models, in the order in which they are written."""

ROAD = Table("road", Road, {
    "width": Value("width", FLOAT), "point": Value("points", VECTOR3, repeated=True),
    "material": Part(use=SHOWN),
}, level=WARNING, known_attributes=("name",), use=SHOWN)

ANIMATION = Table("animation", Animation, {
    "filename": Value("filename", TEXT), "scale": Value("scale", FLOAT),
    "interpolate_x": Value("interpolate_x", BOOL),
}, attributes={"name": Value("name", TEXT)}, level=WARNING, use=SHOWN)

WAYPOINT = Table("waypoint", Waypoint, {
    "time": Value("time", FLOAT), "pose": Value("pose", PATH_POSE),
}, level=WARNING, use=SHOWN)

TRAJECTORY = Table("trajectory", Trajectory, {
    "waypoint": Nested("waypoints", WAYPOINT, required=("time", "pose")),
}, attributes={
    "id": Value("id", INT), "type": Value("type", TEXT),
    "tension": Value("tension", FLOAT),
}, level=WARNING, use=SHOWN)

ACTOR = Table("actor", Actor, {
    "pose": Value("pose", POSE),
    "skin": Group({"filename": Value("skin", TEXT), "scale": Value("skin_scale", FLOAT)}),
    "animation": Nested("animations", ANIMATION, required=("@name", "filename")),
    "script": Group({
        "loop": Value("loop", BOOL), "delay_start": Value("delay_start", FLOAT),
        "auto_start": Value("auto_start", BOOL),
        "trajectory": Nested("trajectories", TRAJECTORY, required=("@id", "@type")),
    }),
    "plugin": Part(use=PLUGINS),
    **kept("link", "joint", "frame", "static", "origin", "enable_wind",
           "allow_auto_disable", "self_collide"),
}, level=WARNING, known_attributes=("name", "static"), use=SHOWN)


@dataclass
class Population:
    """`<population>`: number and distribution of copies of a model."""

    name: str = ""
    pose: Pose = IDENTITY
    model_count: int = 1
    box: Optional[Vec3] = None
    radius: Optional[float] = None
    length: float = 1.0
    distribution: str = "random"
    rows: int = 1
    cols: int = 1
    step: Vec3 = (0.5, 0.5, 0.0)


POPULATION = Table("population", Population, {
    "pose": Value("pose", POSE), "model": Part(), "include": Part(),
    "model_count": Value("model_count", INT),
    "box": Group({"size": Value("box", VECTOR3)}),
    "cylinder": Group(values_named(FLOAT, "radius", "length")),
    "distribution": Group({
        "type": Value("distribution", TEXT), **values_named(INT, "rows", "cols"),
        "step": Value("step", VECTOR3),
    }),
    "frame": Kept(),
}, attributes={"name": Value("name", TEXT)})


class TwistKind:
    """Six numbers: linear m/s, angular rad/s."""

    def parse(self, text: str) -> Twist:
        x, y, z, roll, pitch, yaw = parse_numbers(text, 6)
        return Twist((x, y, z), (roll, pitch, yaw))

    def format(self, value: Twist) -> str:
        return f"{VECTOR3.format(value.linear)} {VECTOR3.format(value.angular)}"

    def parse_leniently(self, text: str) -> Twist:
        raise ValueError("not a twist")


class Nanoseconds:
    """`sec nsec`, or plain seconds, as whole nanoseconds."""

    def parse(self, text: str) -> int:
        parts = text.split()
        if len(parts) == 2:
            return INT.parse(parts[0]) * 10 ** 9 + INT.parse(parts[1])
        return round(SECONDS.parse(text) * 1e9)

    def format(self, value: int) -> str:
        return f"{value // 10 ** 9} {value % 10 ** 9}"

    def parse_leniently(self, text: str) -> int:
        return round(SECONDS.parse_leniently(text) * 1e9)


_NS: Any = Nanoseconds()
_LINK: Mapping[str, Entry] = {
    "pose": Value("pose", POSE), "velocity": Value("twist", TwistKind()),
    **kept("acceleration", "wrench", "collision", use=Use.IGNORED),
}
LINK_STATE = Table("link", LinkState, _LINK, level=WARNING, known_attributes=("name",))
MODEL_STATE = Table("model", ModelState, {
    "pose": Value("pose", POSE), "scale": Value("scale", SCALE),
    "link": Part(), "model": Part(), "joint": Part(), "frame": Kept(use=Use.IGNORED),
}, level=WARNING, known_attributes=("name",))
LIGHT_STATE = Table("light", LightState, {"pose": Value("pose", POSE)}, level=WARNING,
                    known_attributes=("name",))
STATE = Table("state", SavedState, {
    "sim_time": Value("sim_time_ns", _NS), "real_time": Value("real_time_ns", _NS),
    "wall_time": Value("wall_time_ns", _NS), "iterations": Value("iterations", INT),
    "insertions": Part(), "model": Part(), "light": Part(),
    "deletions": Group({"name": Value("deletions", TEXT, repeated=True)}),
    "road": Kept(use=Use.IGNORED),
}, attributes={"world_name": Value("world_name", TEXT)}, level=WARNING)
