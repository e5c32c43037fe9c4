"""libgazebo_ros_imu.so (of a model) and libgazebo_ros_imu_sensor.so (of a sensor): sensor_msgs/Imu.

Parameters, defaults, topics and frames are those of gazebo_plugins. Both measure in the sensor's
frame and feel gravity, +9.8 upwards at rest, as the message is defined; the original of the first
turns its vectors the wrong way and leaves gravity out.
"""
from __future__ import annotations

from typing import Any, Optional

from ...description.sensor import Imu as ImuBlock
from ...geometry import IDENTITY_QUAT, Pose, Quat, compose, multiply
from ...sensing.sensor_models import ImuSample
from ..imu_meter import ImuMeter
from ..noise import WhiteNoise
from ..parameters import lowest_rate
from ..standard_messages import diagonal_covariance, imu_message
from .noisy_plugin import NoisyPlugin


class Imu(NoisyPlugin):
    """What both have: a link, a place on it, and the velocity at the sample before."""

    _meter: ImuMeter
    _offset: Quat = IDENTITY_QUAT

    def _begin(self, topic: str, frame: str, who: str) -> None:
        context, p = self.context, self.context.parameters
        self._frame, self._stddev = frame, p.number("gaussianNoise", 0.0)
        self._white = WhiteNoise(context.seed, f"{context.model}::{who}::imu", self._stddev)
        self._topic = context.publish(topic, "sensor_msgs/Imu")
        self._offset = p.turn("rpyOffset")

    def reset(self) -> None:
        """Restart noises; measure accelerations from the present time and velocity on."""
        super().reset()
        self._meter.restart()

    def follow(self, hertz: float) -> None:
        """Measure at a rate while there are subscribers.

        The first sample after a time without subscribers is left out: the velocity before it is too
        old for an acceleration.
        """
        self.context.observe(hertz, self.update, [self._topic], resume=self._meter.restart)

    def update(self) -> None:
        sample = self._noisy(self._meter.measure())
        context, noise = self.context, self._white.draw(6, self.context.now_ns)
        message = imu_message(
            context, self._frame, multiply(self._offset, sample.orientation),
            (w + n for w, n in zip(sample.angular_velocity, noise)),
            (a + n for a, n in zip(sample.linear_acceleration, noise[3:])))
        variance = diagonal_covariance([self._stddev ** 2] * 3)
        message.orientation_covariance = variance
        message.angular_velocity_covariance = list(variance)
        message.linear_acceleration_covariance = list(variance)
        self._topic.publish(message)

    def _noisy(self, sample: ImuSample) -> ImuSample:
        return sample


class ModelImu(Imu):
    """On the link `<bodyName>`."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        body = self.required_text("bodyName")
        self._meter = ImuMeter(context, context.link(body), Pose(p.vector("xyzOffset")))
        self._begin(p.text("topicName", "/default_imu"), p.text("frameName", body), body)
        context.serve(p.text("serviceName", "/default_imu"), "std_srvs/Empty",
                      lambda request, response: None)
        self.follow(p.number("updateRate", 0.0))


class SensorImu(Imu):
    """Of a `<sensor type="imu">`, with the noise of its block.

    As in Gazebo accelerations are over one period of the sensor, however seldom the plugin asks.
    """

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        sensor = self.required_sensor("imu")
        # An empty element, such as xacro leaves, is the root (GazeboRosImuSensor::LoadParameters).
        context.use_namespace(p.text("robotNamespace", f"/{context.model}") or "/")
        frame = self.required_text("frameName")
        link, mount = context.link(context.sensor_link), sensor.pose
        relative = p.flag("initialOrientationAsReference", False)
        self._meter = ImuMeter(context, link, mount, compose(
            link.pose, mount).orientation if relative else IDENTITY_QUAT)
        self._block: Optional[ImuBlock] = sensor.imu
        self._axes = [self.add_noise(getattr(getattr(self._block, kind), axis), f"{kind}/{axis}")
                      for kind in ("angular_velocity", "linear_acceleration") for axis in "xyz"
                      ] if self._block is not None else []
        self._begin(p.text("topicName", "imu_data"), frame, sensor.name)
        sensor_hertz = sensor.update_rate
        hertz = lowest_rate(p.number("updateRateHZ", 1.0), sensor_hertz)
        period = 1.0 / sensor_hertz if sensor_hertz > 0.0 else context.step_size
        self.follow(hertz)
        if 0.0 < hertz * period < 1.0 - 1e-9:
            context.observe(hertz, self._meter.restart, [self._topic], lead=period)

    def _noisy(self, sample: ImuSample) -> ImuSample:
        if not self._axes:
            return sample
        ns = self.context.now_ns
        values: Any = [noise.apply(value, ns) for noise, value in zip(
            self._axes, (*sample.angular_velocity, *sample.linear_acceleration))]
        return ImuSample(sample.orientation, tuple(values[:3]), tuple(values[3:]))
