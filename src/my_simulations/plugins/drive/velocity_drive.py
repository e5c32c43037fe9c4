"""What drives share that follow velocity commands."""
from __future__ import annotations

from typing import List, Optional, Sequence, Tuple

from ...geometry import Pose
from ..base import Plugin
from ..context import Joint, Publication
from ..stepwise_change import StepwiseChange
from ..time_out import Stopwatch
from .odometry import DRIVE_COVARIANCE, NO_COVARIANCE, Odometer, WheelCounter, heading_velocity
from .wheels import VelocityCommand, WheelFrames, WheelStates


class VelocityDrive(Plugin):
    """Applies the last geometry_msgs/Twist at the steps of a rate, until it expires."""

    def follow_commands(self, hertz: float, topic: str = "",
                        timeout: Optional[float] = None, at_once: bool = False) -> None:
        """Subscribe to commands; `_follow` is called at a rate after each of them.

        Args:
            hertz: of sim time; 0 or less is every step.
            topic: of the commands; "" for that of `<commandTopic>`.
            timeout: s of sim time after which a command expires; None for never.
            at_once: call `_drive` when a command comes, instead of `_follow` at the rate.
        """
        topic = topic or self.context.parameters.text("commandTopic", "cmd_vel")
        self._change = StepwiseChange(self.context, hertz, self._follow)
        self._command = VelocityCommand(self.context, topic, timeout, self._change,
                                        self._drive if at_once else self._change.begin)

    def make_odometer(self, covariance: Tuple[float, ...] = DRIVE_COVARIANCE,
                      twist_covariance: Tuple[float, ...] = NO_COVARIANCE,
                      base: str = "base_footprint", publishes: bool = True) -> Odometer:
        """Return the odometer of `<odometryTopic>`, `<odometryFrame>` and `<robotBaseFrame>`.

        Args:
            covariance: diagonal of the pose's.
            twist_covariance: diagonal of the twist's.
            base: the default of `<robotBaseFrame>`.
            publishes: publish a topic, else only the transform.
        """
        p = self.context.parameters
        return Odometer(self.context, p.text("odometryTopic", "odom") if publishes else "",
                        p.text("odometryFrame", "odom"), p.text("robotBaseFrame", base),
                        covariance, twist_covariance)

    def reset(self) -> None:
        self._command.stop()
        self._change.end()
        self.restart_odometry()
        self.clock_set()
        self._drive()

    def clock_set(self) -> None:
        """Let commands expire by the new clock."""
        self._command.clock_set()

    def restart_odometry(self) -> None:
        """Start the odometry at the present state of the robot."""

    def _follow(self, dt: float) -> bool:
        """Apply the command; return whether nothing is left to change."""
        self._command.discard_if_expired()
        self._drive()
        return True

    def _drive(self) -> None:
        """Drive as the command says."""
        raise NotImplementedError


class OdometryDrive(VelocityDrive):
    """Integrates wheel odometry, and publishes it or the true motion."""

    _counter: WheelCounter
    _odometer: Odometer
    _encoder: bool   # publish wheel odometry, else the true pose
    _publishes = _broadcasts = True

    def offer_wheels(self, joints: Sequence[Joint], with_motion: bool = False) -> None:
        """Publish frames and joint states of the wheels if the parameters ask for it."""
        context, p = self.context, self.context.parameters
        self._frames = WheelFrames(context, joints) if p.flag("publishWheelTF", False) else None
        self._states = WheelStates(context, joints, with_motion) \
            if p.flag("publishWheelJointState", False) else None

    @property
    def topics(self) -> List[Publication]:
        """All that `publish` writes to."""
        return [*self._odometer.topics, *(self._states.topics if self._states else [])]

    def publish(self) -> None:
        """Odometry, as it is before the command of the same update (as the original)."""
        if self._publishes:
            pose, velocity = self.motion()
            if self._broadcasts:
                self._odometer.transform(pose)
            self._odometer.publish(pose, velocity)
        if self._frames is not None:
            self._frames.send()
        if self._states is not None:
            self._states.send()

    def restart_odometry(self) -> None:
        self._counter.reset()

    def clock_set(self) -> None:
        """Measure time from now; keep the odometry pose."""
        super().clock_set()
        self._stopwatch = Stopwatch(self.context)
        self._counter.discard_rotation()

    def motion(self) -> Tuple[Pose, Tuple[float, float, float]]:
        """Return the pose and the (forward, sideways, yaw) velocity to publish.

        The velocity of encoders is the mean since the last call.
        """
        if self._encoder:
            velocity = self._counter.count(self._stopwatch.lap())
            return self._counter.pose, velocity
        return self.context.pose, heading_velocity(self.context.pose, self.context.twist)
