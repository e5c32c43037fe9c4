"""Tables of SDF sensors. Source: SDF specification 1.7, sensor."""
from __future__ import annotations

from typing import Mapping

from ...description.sensor import (
    AirPressure,
    Altimeter,
    Camera,
    ContactSensor,
    ForceTorque,
    Gps,
    Imu,
    LogicalCamera,
    Magnetometer,
    Ray,
    Sensor,
    Sonar,
    Transceiver,
)
from ..xml.source import FaultLevel
from ..xml.tables import Entry, Group, Part, Table, Use, Value, kept, values_named
from ..xml.values import BOOL, FLOAT, INT, LIMIT, POSE, TEXT, VECTOR2, VECTOR3

_WARNING, _KEPT = FaultLevel.WARNING, Use.KEPT
_UNUSED = ("sonar", "air_pressure", "logical_camera", "transceiver")
"""Sensor blocks that no plugin reads."""


def _noise(part: str) -> Group:
    numbers = values_named(FLOAT, "mean", "stddev", "bias_mean", "bias_stddev",
                           "dynamic_bias_stddev", "dynamic_bias_correlation_time", "precision")
    # SDF up to 1.4 has the type as an element.
    return Group({**numbers, "type": Value("type", TEXT)}, {"type": Value("type", TEXT)}, part=part)


def _noisy(part: str) -> Group:
    """The entry of a measured quantity with a `<noise>` only."""
    return Group({"noise": _noise(part)})


_AXES: Mapping[str, Entry] = {axis: _noisy(axis) for axis in "xyz"}
"""A vector quantity, with a `<noise>` for each axis."""


def _table(name: str, of: type, children: Mapping[str, Entry], **more: object) -> Table:
    use = _KEPT if name in _UNUSED else Use.PLUGINS
    return Table(name, of, children, level=_WARNING, use=use, **more)  # type: ignore[arg-type]


def _scan(part: str) -> Group:
    return Group({
        "samples": Value("samples", INT),
        **values_named(FLOAT, "resolution", "min_angle", "max_angle"),
    }, part=part)


RAY = _table("ray", Ray, {
    "scan": Group({"horizontal": _scan("horizontal"), "vertical": _scan("vertical")}),
    "range": Group({
        "min": Value("min_range", LIMIT), "max": Value("max_range", LIMIT),
        "resolution": Value("range_resolution", FLOAT, use=_KEPT),
    }),
    "noise": _noise("noise"),
    **kept("visibility_mask"),
})

CAMERA = _table("camera", Camera, {
    "pose": Value("pose", POSE),
    "horizontal_fov": Value("horizontal_fov", FLOAT),
    "image": Group({
        "width": Value("width", INT), "height": Value("height", INT),
        "format": Value("format", TEXT), "anti_aliasing": Value("anti_aliasing", INT),
    }),
    "clip": Group({"near": Value("near", FLOAT), "far": Value("far", FLOAT)}),
    "depth_camera": Group({
        "output": Value("depth_output", TEXT, use=_KEPT),
        "clip": Group({"near": Value("depth_near", FLOAT, use=_KEPT),
                       "far": Value("depth_far", FLOAT, use=_KEPT)}),
    }),
    "noise": _noise("noise"),
    "distortion": Group({
        **values_named(FLOAT, "k1", "k2", "k3", "p1", "p2"),
        "center": Value("distortion_center", VECTOR2),
    }),
    "lens": Group({
        "type": Value("type", TEXT),
        "custom_function": Group({
            **values_named(FLOAT, "c1", "c2", "c3", "f"),
            "fun": Value("fun", TEXT),
        }),
        "scale_to_hfov": Value("scale_to_hfov", BOOL),
        "cutoff_angle": Value("cutoff_angle", FLOAT),
        "env_texture_size": Value("env_texture_size", INT),
        **kept("intrinsics", "projection"),
    }, part="lens"),
    **kept("save", "visibility_mask", "frame", "segmentation_type", "box_type",
           "optical_frame_id", "camera_info_topic", "trigger_topic", "triggered"),
}, attributes={"name": Value("name", TEXT)})

CONTACT = _table("contact", ContactSensor, {
    "collision": Value("collisions", TEXT, repeated=True),
    "topic": Value("topic", TEXT, use=_KEPT),
})

IMU = _table("imu", Imu, {
    "angular_velocity": Group(_AXES, part="angular_velocity"),
    "linear_acceleration": Group(_AXES, part="linear_acceleration"),
    "orientation_reference_frame": Group({
        "localization": Value("localization", TEXT, use=_KEPT),
        "custom_rpy": Value("custom_rpy", VECTOR3, use=_KEPT),
        "grav_dir_x": Value("grav_dir_x", VECTOR3, use=_KEPT),
    }),
    "enable_orientation": Value("enable_orientation", BOOL, use=_KEPT),
    **kept("topic", "noise"),
})

GPS = _table("gps", Gps, {
    "position_sensing": Group({
        "horizontal": _noisy("position_horizontal"), "vertical": _noisy("position_vertical")}),
    "velocity_sensing": Group({
        "horizontal": _noisy("velocity_horizontal"), "vertical": _noisy("velocity_vertical")}),
})

FORCE_TORQUE = _table("force_torque", ForceTorque, {
    **values_named(TEXT, "frame", "measure_direction"),
    "force": Group(_AXES, part="force"), "torque": Group(_AXES, part="torque"),
})

SONAR = _table("sonar", Sonar, {
    "geometry": Value("geometry", TEXT), **values_named(FLOAT, "min", "max", "radius"),
})

ALTIMETER = _table("altimeter", Altimeter, {
    "vertical_position": _noisy("vertical_position"),
    "vertical_velocity": _noisy("vertical_velocity"),
})

MAGNETOMETER = _table("magnetometer", Magnetometer, _AXES)

AIR_PRESSURE = _table("air_pressure", AirPressure, {
    "reference_altitude": Value("reference_altitude", FLOAT), "pressure": _noisy("pressure"),
})

LOGICAL_CAMERA = _table("logical_camera", LogicalCamera, values_named(
    FLOAT, "near", "far", "aspect_ratio", "horizontal_fov"))

TRANSCEIVER = _table("transceiver", Transceiver, {
    "essid": Value("essid", TEXT),
    **values_named(FLOAT, "frequency", "min_frequency", "max_frequency", "gain", "power",
                   "sensitivity"),
})

BLOCKS: Mapping[str, Table] = {
    "ray": RAY, "lidar": RAY, "contact": CONTACT, "imu": IMU, "gps": GPS, "navsat": GPS,
    "force_torque": FORCE_TORQUE, "sonar": SONAR, "altimeter": ALTIMETER,
    "magnetometer": MAGNETOMETER, "air_pressure": AIR_PRESSURE,
    "logical_camera": LOGICAL_CAMERA, "transceiver": TRANSCEIVER,
}
"""Tables of the sensor blocks by tag; cameras, which may be repeated, are separate."""

FIELDS: Mapping[str, str] = {"lidar": "ray", "navsat": "gps"}
"""Fields of the blocks whose name differs from the tag."""

SENSOR = _table("sensor", Sensor, {
    "pose": Value("pose", POSE),
    "always_on": Value("always_on", BOOL, use=_KEPT),
    "update_rate": Value("update_rate", FLOAT),
    "visualize": Value("visualize", BOOL, use=_KEPT),
    "topic": Value("topic", TEXT, use=_KEPT),
    "camera": Part(), "plugin": Part(),
    **{tag: Part(use=table.use) for tag, table in BLOCKS.items()},
    **kept("frame", "rfid", "rfidtag", "enable_metrics", "force_torque_sensor", "gz_frame_id",
           "ignition_frame_id"),
}, attributes={"type": Value("type", TEXT)}, known_attributes=("name",))
