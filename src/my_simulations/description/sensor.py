"""Sensors of links and joints, and what they measure.

Defaults are SDF's. Angles in rad, lengths in m, rates in Hz of sim time. Rays and optical axes look
along +x of the sensor's frame; y is left, z is up. Source: SDF specification 1.7, sensor.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List, Optional

from ..geometry import IDENTITY, Pose, Vec3
from .plugin import PluginSpec


@dataclass
class Noise:
    """Noise of one measured quantity, in its unit.

    `type` is none, gaussian or gaussian_quantized. The bias is drawn once, at the start, with a
    random sign; `precision` is the step to which gaussian_quantized rounds.
    """

    type: str = "none"
    mean: float = 0.0
    stddev: float = 0.0
    bias_mean: float = 0.0
    bias_stddev: float = 0.0
    dynamic_bias_stddev: float = 0.0
    dynamic_bias_correlation_time: float = 0.0
    precision: float = 0.0


@dataclass
class ScanAngles:
    """One direction of a scan; `resolution` times `samples` points are given out."""

    samples: int = 1
    resolution: float = 1.0
    min_angle: float = 0.0
    max_angle: float = 0.0


def _horizontal() -> ScanAngles:
    return ScanAngles(samples=640)


@dataclass
class Ray:
    """A range finder; `ray` sees collisions, `gpu_ray` sees visuals."""

    horizontal: ScanAngles = field(default_factory=_horizontal)
    vertical: ScanAngles = field(default_factory=ScanAngles)
    min_range: float = 0.0
    max_range: float = 0.0
    range_resolution: float = 0.0
    noise: Noise = field(default_factory=Noise)


@dataclass
class Camera:
    """A pinhole camera; depth, multicamera and wide-angle cameras have the same block.

    `depth_near` and `depth_far` are the clip of a depth image. Distortion is Brown's, its centre a
    share of the picture's width and height.
    """

    name: str = ""
    pose: Pose = IDENTITY
    horizontal_fov: float = 1.047
    width: int = 320
    height: int = 240
    format: str = "R8G8B8"
    anti_aliasing: int = 4
    near: float = 0.1
    far: float = 100.0
    depth_output: str = "depths"
    depth_near: float = 0.1
    depth_far: float = 10.0
    noise: Noise = field(default_factory=Noise)
    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    distortion_center: "tuple[float, float]" = (0.5, 0.5)


@dataclass
class ContactSensor:
    """Names collisions of its link."""

    collisions: List[str] = field(default_factory=list)
    topic: str = ""


@dataclass
class Imu:
    """Angular velocity in rad/s, linear acceleration in m/s^2."""

    angular_velocity_x: Noise = field(default_factory=Noise)
    angular_velocity_y: Noise = field(default_factory=Noise)
    angular_velocity_z: Noise = field(default_factory=Noise)
    linear_acceleration_x: Noise = field(default_factory=Noise)
    linear_acceleration_y: Noise = field(default_factory=Noise)
    linear_acceleration_z: Noise = field(default_factory=Noise)
    localization: str = "CUSTOM"
    custom_rpy: Vec3 = (0.0, 0.0, 0.0)
    grav_dir_x: Vec3 = (1.0, 0.0, 0.0)
    enable_orientation: bool = True


@dataclass
class Gps:
    """Position in m, velocity in m/s."""

    position_horizontal: Noise = field(default_factory=Noise)
    position_vertical: Noise = field(default_factory=Noise)
    velocity_horizontal: Noise = field(default_factory=Noise)
    velocity_vertical: Noise = field(default_factory=Noise)


@dataclass
class ForceTorque:
    """Of a joint; `frame` is child, parent or sensor."""

    frame: str = "child"
    measure_direction: str = "child_to_parent"
    force_x: Noise = field(default_factory=Noise)
    force_y: Noise = field(default_factory=Noise)
    force_z: Noise = field(default_factory=Noise)
    torque_x: Noise = field(default_factory=Noise)
    torque_y: Noise = field(default_factory=Noise)
    torque_z: Noise = field(default_factory=Noise)


@dataclass
class Sonar:
    """The nearest thing within a cone or sphere."""

    geometry: str = "cone"
    min: float = 0.0
    max: float = 1.0
    radius: float = 0.5


@dataclass
class Altimeter:
    """Height over the place where it began, m."""

    vertical_position: Noise = field(default_factory=Noise)
    vertical_velocity: Noise = field(default_factory=Noise)


@dataclass
class Magnetometer:
    """The world's magnetic field, T."""

    x: Noise = field(default_factory=Noise)
    y: Noise = field(default_factory=Noise)
    z: Noise = field(default_factory=Noise)


@dataclass
class AirPressure:
    """Pressure in Pa; `reference_altitude` is that of the world's origin."""

    reference_altitude: float = 0.0
    pressure: Noise = field(default_factory=Noise)


@dataclass
class LogicalCamera:
    """Which models are within a frustum."""

    near: float = 0.0
    far: float = 1.0
    aspect_ratio: float = 1.0
    horizontal_fov: float = 1.0


@dataclass
class Transceiver:
    """A wireless transmitter or receiver; MHz, dBi, dBm."""

    essid: str = "wireless"
    frequency: float = 2442.0
    min_frequency: float = 2412.0
    max_frequency: float = 2484.0
    gain: float = 2.5
    power: float = 14.5
    sensitivity: float = -90.0


@dataclass
class Sensor:
    """A sensor; `pose` in its link's frame, of a joint in the joint's.

    `update_rate` 0 is every step. Of the blocks, those that the file has are set; `cameras` holds
    one of a camera or depth sensor, several of a multicamera. The link or joint keeps the XML of
    the whole sensor in its `extra`, which is what is written back. `file` and `line` tell where it
    was read.
    """

    name: str
    type: str = ""
    pose: Pose = IDENTITY
    always_on: bool = False
    update_rate: float = 0.0
    visualize: bool = False
    topic: str = ""
    ray: Optional[Ray] = None
    cameras: List[Camera] = field(default_factory=list)
    contact: Optional[ContactSensor] = None
    imu: Optional[Imu] = None
    gps: Optional[Gps] = None
    force_torque: Optional[ForceTorque] = None
    sonar: Optional[Sonar] = None
    altimeter: Optional[Altimeter] = None
    magnetometer: Optional[Magnetometer] = None
    air_pressure: Optional[AirPressure] = None
    logical_camera: Optional[LogicalCamera] = None
    transceiver: Optional[Transceiver] = None
    plugins: List[PluginSpec] = field(default_factory=list)
    file: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)
