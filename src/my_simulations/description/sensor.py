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
    """Noise of one measured quantity. Source: SDF spec 1.7, sensor/noise.

    Numbers without another unit are in the unit of the quantity.

    Attributes:
        type: `none`, `gaussian` or `gaussian_quantized`.
        mean: mean of the white noise.
        stddev: standard deviation of the white noise.
        bias_mean: mean of the constant bias, drawn once at the start with a random sign.
        bias_stddev: standard deviation of the constant bias.
        dynamic_bias_stddev: standard deviation of the slowly changing bias.
        dynamic_bias_correlation_time: correlation time of the slowly changing bias, s.
        precision: step to which `gaussian_quantized` rounds; 0 for no rounding.
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
class AxesNoise:
    """Noise of a vector quantity, one for each axis of the sensor's frame.

    Attributes:
        x, y, z: noise of the components.
    """

    x: Noise = field(default_factory=Noise)
    y: Noise = field(default_factory=Noise)
    z: Noise = field(default_factory=Noise)


@dataclass
class ScanAngles:
    """Ray angles of a scan in one direction. Source: SDF spec 1.7, sensor/ray/scan.

    Attributes:
        samples: number of rays.
        resolution: number of returned points per ray; points between rays are interpolated.
        min_angle: angle of the first ray, rad.
        max_angle: angle of the last ray, rad.
    """

    samples: int = 1
    resolution: float = 1.0
    min_angle: float = 0.0
    max_angle: float = 0.0


def _horizontal() -> ScanAngles:
    return ScanAngles(samples=640)


@dataclass
class Ray:
    """A range finder. Source: SDF spec 1.7, sensor/ray.

    Sensors of type `ray` detect collisions, those of type `gpu_ray` visuals.

    Attributes:
        horizontal: angles about z of the sensor frame.
        vertical: elevation angles, positive upwards.
        min_range: least measured distance, m.
        max_range: greatest measured distance, m.
        range_resolution: step of measured distances, m; 0 for none.
        noise: noise of the distance, m.
    """

    horizontal: ScanAngles = field(default_factory=_horizontal)
    vertical: ScanAngles = field(default_factory=ScanAngles)
    min_range: float = 0.0
    max_range: float = 0.0
    range_resolution: float = 0.0
    noise: Noise = field(default_factory=Noise)


@dataclass
class Lens:
    """The lens of a wide-angle camera. Source: SDF spec 1.7, sensor/camera/lens.

    A ray at an angle theta to the optical axis falls at r = c1 f fun(theta / c2 + c3) from the
    middle of the picture; r is 1 at half of the picture's width.

    Attributes:
        type: `gnomonical`, `stereographic`, `equidistant`, `equisolid_angle`, `orthographic` or
            `custom`; only the last one uses `c1` to `fun`.
        c1, c2, c3, f: numbers of the mapping; `c3` in rad.
        fun: `tan`, `sin` or `id`.
        scale_to_hfov: replace `f`, so that the picture's width is the horizontal field of view.
        cutoff_angle: rays at greater angles are black, rad.
        env_texture_size: pixels along the sides of the pictures that the picture is made of.
    """

    type: str = "stereographic"
    c1: float = 1.0
    c2: float = 1.0
    c3: float = 0.0
    f: float = 1.0
    fun: str = "tan"
    scale_to_hfov: bool = True
    cutoff_angle: float = 1.5707
    env_texture_size: int = 256


@dataclass
class Camera:
    """A pinhole camera. Source: SDF spec 1.7, sensor/camera.

    Also used by depth, multicamera and wide-angle cameras.

    Attributes:
        name: name of the camera in its sensor.
        pose: pose of the camera in the sensor frame.
        horizontal_fov: horizontal field of view, rad.
        width: pixels.
        height: pixels.
        format: pixel format, e.g. `R8G8B8`.
        anti_aliasing: samples per pixel.
        near: distance of the near clip plane, m.
        far: distance of the far clip plane, m.
        depth_output: kind of the depth output, e.g. `depths`.
        depth_near: near clip of depth images, m.
        depth_far: far clip of depth images, m.
        noise: noise of the pixel values, of 0..1.
        k1, k2, k3: radial coefficients of Brown's distortion model.
        p1, p2: tangential coefficients of Brown's distortion model.
        distortion_center: centre of the distortion as fractions of width and height.
        lens: of a wide-angle camera; other cameras have none.
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
    lens: Lens = field(default_factory=Lens)


@dataclass
class ContactSensor:
    """A contact sensor. Source: SDF spec 1.7, sensor/contact.

    Attributes:
        collisions: names of the collisions of the link that are observed.
        topic: topic of Gazebo's transport.
    """

    collisions: List[str] = field(default_factory=list)
    topic: str = ""


@dataclass
class Imu:
    """An inertial measurement unit. Source: SDF spec 1.7, sensor/imu.

    Attributes:
        angular_velocity: noise of the angular velocity, rad/s.
        linear_acceleration: noise of the linear acceleration, m/s^2.
        localization: reference frame of the orientation: `CUSTOM`, `ENU`, `NED`, `NWU`, ...
        custom_rpy: with `CUSTOM`, roll, pitch and yaw of the reference frame, rad.
        grav_dir_x: with `GRAV_UP` and `GRAV_DOWN`, direction of the reference frame's x axis.
        enable_orientation: whether the orientation is measured.
    """

    angular_velocity: AxesNoise = field(default_factory=AxesNoise)
    linear_acceleration: AxesNoise = field(default_factory=AxesNoise)
    localization: str = "CUSTOM"
    custom_rpy: Vec3 = (0.0, 0.0, 0.0)
    grav_dir_x: Vec3 = (1.0, 0.0, 0.0)
    enable_orientation: bool = True


@dataclass
class Gps:
    """A satellite receiver. Source: SDF spec 1.7, sensor/gps.

    Attributes:
        position_horizontal: noise of the position in the horizontal plane, m.
        position_vertical: noise of the altitude, m.
        velocity_horizontal: noise of the horizontal velocity, m/s.
        velocity_vertical: noise of the vertical velocity, m/s.
    """

    position_horizontal: Noise = field(default_factory=Noise)
    position_vertical: Noise = field(default_factory=Noise)
    velocity_horizontal: Noise = field(default_factory=Noise)
    velocity_vertical: Noise = field(default_factory=Noise)


@dataclass
class ForceTorque:
    """A force-torque sensor of a joint. Source: SDF spec 1.7, sensor/force_torque.

    Attributes:
        frame: frame of the wrench: `child`, `parent` or `sensor`.
        measure_direction: `child_to_parent` or `parent_to_child`.
        force: noise of the force, N.
        torque: noise of the torque, N m.
    """

    frame: str = "child"
    measure_direction: str = "child_to_parent"
    force: AxesNoise = field(default_factory=AxesNoise)
    torque: AxesNoise = field(default_factory=AxesNoise)


@dataclass
class Sonar:
    """A sonar: distance of the nearest object. Source: SDF spec 1.7, sensor/sonar.

    Attributes:
        geometry: shape of the beam: `cone` or `sphere`.
        min: least distance, m.
        max: greatest distance, m.
        radius: radius of the cone at its greatest distance, m.
    """

    geometry: str = "cone"
    min: float = 0.0
    max: float = 1.0
    radius: float = 0.5


@dataclass
class Altimeter:
    """An altimeter: height above its position at the start. Source: SDF spec 1.7, sensor/altimeter.

    Attributes:
        vertical_position: noise of the height, m.
        vertical_velocity: noise of the vertical velocity, m/s.
    """

    vertical_position: Noise = field(default_factory=Noise)
    vertical_velocity: Noise = field(default_factory=Noise)


@dataclass
class Magnetometer(AxesNoise):
    """A magnetometer: noise of the magnetic field, T. Source: SDF spec 1.7, sensor/magnetometer."""


@dataclass
class AirPressure:
    """An air pressure sensor. Source: SDF spec 1.8, sensor/air_pressure.

    Attributes:
        reference_altitude: altitude of the world's origin, m.
        pressure: noise of the pressure, Pa.
    """

    reference_altitude: float = 0.0
    pressure: Noise = field(default_factory=Noise)


@dataclass
class LogicalCamera:
    """Detects the models in a frustum. Source: SDF spec 1.7, sensor/logical_camera.

    Attributes:
        near: distance of the near clip plane, m.
        far: distance of the far clip plane, m.
        aspect_ratio: width over height of the near and far planes.
        horizontal_fov: horizontal field of view, rad.
    """

    near: float = 0.0
    far: float = 1.0
    aspect_ratio: float = 1.0
    horizontal_fov: float = 1.0


@dataclass
class Transceiver:
    """A wireless transmitter or receiver. Source: SDF spec 1.7, sensor/transceiver.

    Attributes:
        essid: name of the network.
        frequency: frequency of the transmitter, MHz.
        min_frequency: least frequency of the receiver, MHz.
        max_frequency: greatest frequency of the receiver, MHz.
        gain: gain of the antenna, dBi.
        power: transmission power, dBm.
        sensitivity: least power that is received, dBm.
    """

    essid: str = "wireless"
    frequency: float = 2442.0
    min_frequency: float = 2412.0
    max_frequency: float = 2484.0
    gain: float = 2.5
    power: float = 14.5
    sensitivity: float = -90.0


@dataclass
class Sensor:
    """A sensor. Source: SDF spec 1.7, sensor.

    The link or joint keeps the XML of the whole sensor in its `extra`, which is written on saving.

    Attributes:
        name: unique in its link or joint.
        type: SDF's name of the type: `ray`, `camera`, `imu`, ...
        pose: pose in the frame of the link; of a joint's sensor, in the joint's.
        always_on: whether the sensor works without subscribers.
        update_rate: Hz of sim time; 0 for every step.
        visualize: whether the editor draws it.
        topic: topic of Gazebo's transport.
        ray, contact, imu, gps, force_torque, sonar, altimeter, magnetometer, air_pressure,
            logical_camera, transceiver: the element of that name; None if the file has none.
        cameras: one camera of a camera or depth sensor, several of a multicamera.
        plugins: plugins of the sensor.
        file, line: where it was read.
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
