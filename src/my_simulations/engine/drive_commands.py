"""Commands that drive joints, wheels and models: motors, servos, slips, planar velocities."""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Optional, Tuple

from ..description.model import SoftLimits
from .commands import Command
from .spline import Spline


@dataclass(frozen=True)
class RateRamp:
    """How motors approach their rates; the engine changes these at the steps of a rate.

    Source: `wheelAcceleration` of gazebo_plugins' differential drive (`motor_ramps`).

    Attributes:
        acceleration: rad/s^2 or m/s^2, greater than 0.
        tolerance: rad/s or m/s; once one joint of the group is so near to its rate, all motors get
            their rates.
        hertz: of sim time; 0 or less is every step.
        group: a name that the motors of one drive share, and no others.
    """

    acceleration: float
    tolerance: float
    hertz: float
    group: str


@dataclass(frozen=True)
class JointMotor:
    """A motor that drives a joint axis to a rate with a limited effort (ODE's `vel` and `fmax`).

    Attributes:
        row: joint row.
        rate: rad/s or m/s.
        effort: maximum effort, N m or N; 0 turns the motor off and restores the joint friction.
        ramp: how it approaches the rate; None for at once.
    """

    row: int
    rate: float
    effort: float
    ramp: Optional[RateRamp] = None


@dataclass(frozen=True)
class SetMotors(Command):
    """Set motors of some joint axes; others are unchanged. A motor replaces joint friction."""

    motors: Tuple[JointMotor, ...]


@dataclass(frozen=True)
class PidGains:
    """Gains of a loop, and the limits of its integral term; control_toolbox's parameters.

    Attributes:
        p, i, d: output by error, by its integral over time, and by its rate.
        i_min, i_max: limits of the integral term.
        antiwindup: the integral itself stays within the limits.
    """

    p: float
    i: float = 0.0
    d: float = 0.0
    i_min: float = 0.0
    i_max: float = 0.0
    antiwindup: bool = False


@dataclass(frozen=True)
class JointServo:
    """A controller of a joint axis, which the engine evaluates in every step.

    A target, or a loop about it (`gains`), commands a drive: an effort, the rate of a motor, or
    the position that a motor follows; or, with `drive_gains`, the target of a loop that gives an
    effort. Sources: ros_control's controllers, gazebo_ros_control. Units: rad or m, s, N m or N.

    Attributes:
        row: joint row.
        drive: "effort", "velocity" or "position"; "" ends the servo.
        target: a position, with `of_rate` or as the command of a velocity drive a rate, as the
            command of an effort drive an effort.
        target_rate: the rate at the target.
        spline: the target as a function of time, instead of `target`.
        gains: of the loop about the target; None passes it on.
        holds: `target` is the position that the joint has when the servo begins, and each one that
            it is set to later; see `JointServo.held_at`.
        of_rate: that loop is about the rate, else about the position.
        by_rates: its d is about the difference of the rates, else that of errors in time.
        feedforward: the command for each unit of target rate.
        drive_gains: of the loop of the drive.
        wraps: position errors are angles in -pi to pi.
        lags: time constants, s, with which the rate of a velocity drive without loops follows its
            target, a first-order lag: of one that rises, and of one that falls.
        lower, upper, most_rate, most_effort: limits of commands.
        soft: soft limits.
    """

    row: int
    drive: str
    target: float = 0.0
    target_rate: float = 0.0
    spline: Optional[Spline] = None
    gains: Optional[PidGains] = None
    holds: bool = False
    of_rate: bool = False
    by_rates: bool = False
    feedforward: float = 0.0
    drive_gains: Optional[PidGains] = None
    wraps: bool = False
    lags: Optional[Tuple[float, float]] = None
    lower: float = -math.inf
    upper: float = math.inf
    most_rate: float = math.inf
    most_effort: float = math.inf
    soft: Optional[SoftLimits] = None

    def held_at(self, position: float) -> "JointServo":
        """The servo of a joint that is at a position now: its target, if the servo `holds`."""
        return replace(self, target=position) if self.holds else self

    def same_loops(self, other: "JointServo") -> bool:
        """Whether it differs in its target alone."""
        return self == replace(other, target=self.target, target_rate=self.target_rate,
                               spline=self.spline, holds=self.holds)


@dataclass(frozen=True)
class SetServos(Command):
    """Set the servos of some joint axes; those of others stay, and so do integrals of loops."""

    servos: Tuple[JointServo, ...]


@dataclass(frozen=True)
class ReadEfforts(Command):
    """Reply value: what servos and motors spent in the last step, N m or N, by joint row."""

    rows: Tuple[int, ...]


@dataclass(frozen=True)
class WheelSlip:
    """A wheel that slips in proportion to its speed (Gazebo's WheelSlipPlugin).

    Its slips (see `Surface.slip1`) are `radius` times the rate of its joint, by the normal force,
    times a compliance: computed in every step.

    Attributes:
        row: link row of the wheel.
        joint_row: row of the joint axis that it turns about.
        radius: m.
        normal_force: N, about what the wheel carries.
        lateral, longitudinal: compliances along the first direction of friction (the axle, by the
            plugin's convention) and across it, no unit.
    """

    row: int
    joint_row: int
    radius: float
    normal_force: float
    lateral: float = 0.0
    longitudinal: float = 0.0


@dataclass(frozen=True)
class SetWheelSlips(Command):
    """Let wheels slip from now on, until their models are removed; those of others stay."""

    wheels: Tuple[WheelSlip, ...]


@dataclass(frozen=True)
class PlanarVelocity:
    """A velocity that is set before every step, in the heading of the model frame.

    Attributes:
        model_id: the model.
        x, y: m/s, along the model frame's x and y axis, level; the vertical velocity is 0.
        yaw_rate: rad/s, about the vertical.
    """

    model_id: int
    x: float
    y: float
    yaw_rate: float


@dataclass(frozen=True)
class SetPlanarVelocities(Command):
    """Set the planar velocities of models, regardless of forces; replaces all earlier ones."""

    velocities: Tuple[PlanarVelocity, ...]
