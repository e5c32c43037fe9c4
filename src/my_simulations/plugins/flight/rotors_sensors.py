"""rotors_gazebo_plugins' sensors: IMU, magnetometer, air pressure and GPS.

Parameters, defaults, topics, laws and noise are those of the libraries
librotors_gazebo_imu_plugin.so, _magnetometer_plugin.so, _pressure_plugin.so and _gps_plugin.so.
They measure in each step with a subscriber, the GPS at the rate of its sensor. Where it differs:
noise is drawn by sim time from the seed of the world.
"""
from __future__ import annotations

import math

from ...description.sensor import Gps as GpsBlock
from ...description.sensor import Noise as NoiseSpec
from ...description.surroundings import SphericalCoordinates
from ...geometry import Vec3, add, conjugate, rotate, transform
from ...geometry_messages import fill_vector
from ...sensing import gps
from ...sensing.noise import GAUSSIAN, sample_generator
from ...sensing.sensor_models import velocity_at
from ..base import Plugin
from ..frames import stamp_message
from ..imu_meter import ImuMeter
from ..noise import WhiteNoise
from ..sensors.imu import Imu
from ..sensors.noisy_plugin import NoisyPlugin
from ..standard_messages import (
    diagonal_covariance,
    fix_message,
    imu_message,
    magnetic_message,
)

_DEGREE = math.pi / 180.0
_EARTH_RADIUS = 6356766.0      # m; this and the next four: U.S. Standard Atmosphere 1976
_SEA_LEVEL_PRESSURE = 101325.0
_SEA_LEVEL_TEMPERATURE = 288.15
_LAPSE_RATE = 0.0065           # K/m
_EXPONENT = 9.80665 * 28.9644 / (8314.32 * _LAPSE_RATE)


class RotorsImu(Imu):
    """sensor_msgs/Imu of `<linkName>`, with white noise and biases that wander."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        link = context.link(self.required_text("linkName"))
        self._frame, self._meter = link.name, ImuMeter(context, link)
        gyroscope = (p.number("gyroscopeNoiseDensity", 2.0 * 35.0 / 3600.0 * _DEGREE),
                     p.number("gyroscopeTurnOnBiasSigma", 0.5 * _DEGREE),
                     p.number("gyroscopeBiasRandomWalk", 2.0 * 4.0 / 3600.0 * _DEGREE),
                     p.number("gyroscopeBiasCorrelationTime", 1.0e3))
        accelerometer = (p.number("accelerometerNoiseDensity", 2.0 * 2.0e-3),
                         p.number("accelerometerTurnOnBiasSigma", 20.0e-3 * 9.8),
                         p.number("accelerometerRandomWalk", 2.0 * 3.0e-3),
                         p.number("accelerometerBiasCorrelationTime", 300.0))
        self._errors = [self.add_noise(self._spec(*values), f"{link.name}/{kind}/{axis}")
                        for kind, values in (("rate", gyroscope), ("acceleration", accelerometer))
                        for axis in "xyz"]
        self._variances = [diagonal_covariance([values[0] ** 2] * 3)
                           for values in (gyroscope, accelerometer)]
        self._topic = context.publish(p.text("imuTopic", "imu"), "sensor_msgs/Imu")
        self.follow(0.0)

    def _spec(self, density: float, turn_on: float, walk: float, time: float) -> NoiseSpec:
        """Noise of samples one step apart."""
        return NoiseSpec(GAUSSIAN, stddev=density / math.sqrt(self.context.step_size),
                         bias_stddev=turn_on, dynamic_bias_stddev=walk,
                         dynamic_bias_correlation_time=time)

    def update(self) -> None:
        context, sample = self.context, self._meter.measure()
        values = [errors.apply(value, context.now_ns) for errors, value in zip(
            self._errors, (*sample.angular_velocity, *sample.linear_acceleration))]
        message = imu_message(context, self._frame, sample.orientation, values[:3], values[3:])
        message.orientation_covariance = [-1.0] * 9
        message.angular_velocity_covariance = list(self._variances[0])
        message.linear_acceleration_covariance = list(self._variances[1])
        self._topic.publish(message)


class RotorsMagnetometer(Plugin):
    """sensor_msgs/MagneticField in the axes of `<linkName>`; the world's x, y, z are N, E, D."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(p.text("linkName"))
        who = f"{context.model}::{self._link.name}"
        width, self._stddev = p.vector("noiseUniformInitialBias"), p.vector("noiseNormal")
        bias = sample_generator(context.seed, who, "magnetic bias", 0).uniform(-1.0, 1.0, 3)
        field = (p.number("refMagNorth", 0.000021493), p.number("refMagEast", 0.000000815),
                 p.number("refMagDown", 0.000042795))
        x, y, z = (value + size * float(part) for value, size, part in zip(field, width, bias))
        self._field: Vec3 = (x, y, z)
        self._noise = WhiteNoise(context.seed, f"{who}::magnetometer", 1.0)
        self._topic = context.publish(p.text("magnetometerTopic", "magnetic_field"),
                                      "sensor_msgs/MagneticField")
        context.observe(0.0, self.update, [self._topic])

    def update(self) -> None:
        context = self.context
        x, y, z = (size * draw for size, draw in zip(
            self._stddev, self._noise.draw(3, context.now_ns)))
        felt = rotate(conjugate(self._link.pose.orientation), add(self._field, (x, y, z)))
        self._topic.publish(magnetic_message(context, self._link.name, felt,
                                             [size ** 2 for size in self._stddev]))


class RotorsPressure(Plugin):
    """sensor_msgs/FluidPressure at the height of the model."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._frame = context.link(p.text("linkName")).name
        self._reference = p.number("referenceAltitude", 500.0)
        self._variance = max(0.0, p.number("pressureVariance", 0.0))
        self._noise = WhiteNoise(context.seed, f"{context.model}::{self._frame}::pressure",
                                 math.sqrt(self._variance))
        self._topic = context.publish(p.text("pressureTopic", "air_pressure"),
                                      "sensor_msgs/FluidPressure")
        context.observe(0.0, self.update, [self._topic])

    def update(self) -> None:
        context = self.context
        message = stamp_message(context, "sensor_msgs/FluidPressure", self._frame)
        (noise,) = self._noise.draw(1, context.now_ns)
        message.fluid_pressure = air_pressure(
            self._reference + context.pose.position[2]) + noise
        message.variance = self._variance
        self._topic.publish(message)


def air_pressure(height: float) -> float:
    """Pressure in Pa at a height in m (U.S. Standard Atmosphere 1976)."""
    geopotential = _EARTH_RADIUS * height / (_EARTH_RADIUS + height)
    temperature = max(1.0, _SEA_LEVEL_TEMPERATURE - _LAPSE_RATE * geopotential)
    return _SEA_LEVEL_PRESSURE * (temperature / _SEA_LEVEL_TEMPERATURE) ** _EXPONENT


class RotorsGps(NoisyPlugin):
    """sensor_msgs/NavSatFix and the velocity of a `<sensor type="gps">`."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        sensor = self.required_sensor("gps")
        self._link, self._mount = context.link(context.sensor_link), sensor.pose
        self._frame = p.text("linkName", self._link.name)
        block = sensor.gps or GpsBlock()
        self._place = [self.add_noise(noise, f"position/{axis}") for axis, noise in (
            ("x", block.position_horizontal), ("y", block.position_horizontal),
            ("z", block.position_vertical))]
        level, up = p.number("horPosStdDev", 3.0), p.number("verPosStdDev", 6.0)
        self._variances = (level ** 2, level ** 2, up ** 2)
        self._speeds = [p.number("horVelStdDev", 0.1)] * 2 + [p.number("verVelStdDev", 0.1)]
        self._noise = WhiteNoise(context.seed, f"{context.model}::{self._frame}::gps", 1.0)
        self._fix = context.publish(p.text("gpsTopic", "gps"), "sensor_msgs/NavSatFix")
        self._speed = context.publish(p.text("groundSpeedTopic", "ground_speed"),
                                      "geometry_msgs/TwistStamped")
        context.observe(sensor.update_rate, self.update, [self._fix, self._speed])

    def update(self) -> None:
        context, link, ns = self.context, self._link, self.context.now_ns
        velocity = velocity_at(link.pose, link.twist, self._mount)
        if self._fix.wanted:
            x, y, z = (noise.apply(value, ns) for noise, value in zip(
                self._place, transform(link.pose, self._mount.position)))
            found = gps.measure((x, y, z), velocity,
                                context.spherical_coordinates or SphericalCoordinates())
            self._fix.publish(fix_message(context, self._frame, found.latitude_deg,
                                          found.longitude_deg, found.altitude, self._variances,
                                          service=1))
        if self._speed.wanted:
            message = stamp_message(context, "geometry_msgs/TwistStamped", self._frame)
            fill_vector(message.twist.linear, (value + size * draw for value, size, draw in zip(
                velocity, self._speeds, self._noise.draw(3, ns))))
            self._speed.publish(message)
