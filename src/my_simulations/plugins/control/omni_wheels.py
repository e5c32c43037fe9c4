"""Wheels that are driven and steered, as cob_omni_drive_controller describes and moves them.

Source: UndercarriageCtrlGeom of cob_omni_drive_controller. Lengths in m, angles in rad, from the
base's frame: x forward, y left, steering angles about z. A wheel may stand beside its steering
axis, and its drive may turn with the steering.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from ...description.model import Joint as JointSpec
from ...engine.servo_law import wrapped_angle
from ..context import Context, PluginError
from .base_controller import STANDING, Planar
from .four_wheel_steering_controller import Corner, fitted_motion
from .limits import joint_origin
from .settings import Settings

_FEWEST = 3
_NEAR, _LAST = 0.6, 0.4   # weights of the way to a steering angle, and from the last target


@dataclass(frozen=True)
class Steering:
    """The virtual spring, damper and mass that a steering angle follows its target with.

    Attributes:
        spring: 1/s^2, times the mass.
        damp: 1/s, times the mass.
        mass: without a unit.
        most_rate, most_acceleration: rad/s and rad/s^2; 0 for no limit.
    """

    spring: float
    damp: float
    mass: float
    most_rate: float
    most_acceleration: float

    def advance(self, delta: float, rate: float, dt: float, steps: int) -> Tuple[float, float]:
        """Return the angle that is turned in `dt` s, and the rate after it.

        Args:
            delta: rad from the steering angle to its target.
            rate: the last commanded one, rad/s.
            dt: s.
            steps: number of steps in `dt`; the original updates in each.
        """
        turned, part = 0.0, dt / steps
        for _ in range(steps):
            change = (self.spring * (delta - turned) - self.damp * rate) / self.mass
            rate = clamp(rate + part * clamp(change, self.most_acceleration), self.most_rate)
            turned += rate * part
        return turned, rate


class WheelState(NamedTuple):
    """The steering angle and how far the drive joint has turned, rad."""

    angle: float
    turned: float


class WheelTarget(NamedTuple):
    """A steering angle, rad, and the rate of the rolling wheel, rad/s."""

    angle: float
    rate: float


@dataclass(frozen=True)
class OmniWheel:
    """One wheel.

    Attributes:
        steer, drive: names of the joints.
        x, y: position of the steering axis.
        radius: of the wheel.
        offset: distance of the wheel from the steering axis, to the right at steering angle 0.
        coupling: turns of the drive per turn of the steering.
        most_steer, most_drive: rad/s; 0 for no limit.
        steering: None if only the odometry needs the wheel.
    """

    steer: str
    drive: str
    x: float
    y: float
    radius: float
    offset: float
    coupling: float = 0.0
    most_steer: float = 0.0
    most_drive: float = 0.0
    steering: Optional[Steering] = None

    @property
    def corner(self) -> Corner:
        return Corner(self.x, self.y, -self.offset)

    @property
    def drive_per_steer(self) -> float:
        """Rotation of the drive joint per rotation of the steering joint if the base stands."""
        return self.offset / self.radius - self.coupling

    def target(self, motion: Planar, angle: float, last: float) -> WheelTarget:
        """Return the target for a motion of the base; the wheel can roll forward or backward.

        Args:
            motion: m/s and rad/s.
            angle: the steering angle now.
            last: the last target of the steering angle.
        """
        if motion == STANDING:
            return WheelTarget(angle, 0.0)
        x, y, yaw = motion
        u = x - yaw * (self.y - self.offset * math.cos(angle))
        v = y + yaw * (self.x + self.offset * math.sin(angle))
        forward = math.atan2(v, u) if u or v else 0.0
        rate = math.hypot(u, v) / self.radius
        choices = (WheelTarget(forward, rate), WheelTarget(wrapped_angle(forward + math.pi), -rate))
        return min(choices, key=lambda one: _NEAR * abs(wrapped_angle(one.angle - angle))
                   + _LAST * abs(wrapped_angle(one.angle - last)))


def base_displacement(wheels: Sequence[OmniWheel], before: Sequence[WheelState],
                      now: Sequence[WheelState]) -> Planar:
    """Return the motion of the base between two states of its wheels: m, m, rad; least squares."""
    rolled = []
    for wheel, then, state in zip(wheels, before, now):
        steered = state.angle - then.angle
        way = wheel.radius * (state.turned - then.turned - wheel.drive_per_steer * steered)
        rolled.append((then.angle + steered / 2.0, way))
    return fitted_motion([wheel.corner for wheel in wheels], rolled)


def clamp(value: float, most: float) -> float:
    """Clamp a value to -most..most; a limit of 0 means none."""
    return max(-most, min(most, value)) if most else value


def read_wheels(context: Context, settings: Settings, steered: bool) -> List[OmniWheel]:
    """Return the wheels in the parameters `wheels` and `defaults` of a controller.

    Missing values come from the robot's description: positions and radius from the steering
    joint, the offset from the drive joint, the limits from both.

    Args:
        context: of the plugin, with the description.
        settings: of the controller.
        steered: whether `steer_ctrl` is needed.

    Raises:
        PluginError: a parameter is missing or wrong, or there are fewer than three wheels.
    """
    found = settings.get("wheels")
    if isinstance(found, dict):
        found = [found[key] for key in sorted(found)]
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise PluginError(f"parameter {settings.name}/wheels must list the wheels")
    if len(found) < _FEWEST:
        raise PluginError(f"parameter {settings.name}/wheels lists {len(found)} wheels;"
                          f" at least {_FEWEST} are needed")
    defaults = settings.get("defaults") or {}
    if not isinstance(defaults, dict):
        raise PluginError(f"parameter {settings.name}/defaults must be a dictionary")
    return [_read_wheel(context, Settings(context, f"{settings.name}/wheels/{n}", one),
                        Settings(context, f"{settings.name}/wheels/{n}", _merge(one, defaults)),
                        steered)
            for n, one in enumerate(found)]


def _merge(first: Dict[str, Any], second: Dict[str, Any]) -> Dict[str, Any]:
    """Both dictionaries, at each level; the first one has priority."""
    made = {**second, **first}
    for key, value in first.items():
        if isinstance(value, dict) and isinstance(second.get(key), dict):
            made[key] = _merge(value, second[key])
    return made


def _read_wheel(context: Context, own: Settings, merged: Settings, steered: bool) -> OmniWheel:
    names = own.text("steer"), own.text("drive")
    steer, drive = (context.joint(name).spec for name in names)
    axis, hub = (joint_origin(joint, context.description) for joint in (steer, drive))
    radius = abs(merged.number("wheel_radius", axis[2]))
    if radius == 0.0:
        raise PluginError(f"parameter {merged.name}/wheel_radius must not be 0")
    return OmniWheel(
        *names, own.number("x_pos", axis[0]), own.number("y_pos", axis[1]), radius,
        merged.number("wheel_offset", math.hypot(hub[0] - axis[0], hub[1] - axis[1])),
        own.number("steer_drive_coupling", merged.number("steer_drive_coupling", 0.0)),
        merged.number("max_steer_rate", _limit(steer)),
        merged.number("max_drive_rate", _limit(drive)),
        _read_steering(merged) if steered else None)


def _limit(joint: JointSpec) -> float:
    """The greatest rate of a joint, rad/s; 0 without a limit."""
    return joint.axis.velocity if joint.axis is not None and joint.axis.velocity > 0.0 else 0.0


def _read_steering(settings: Settings) -> Steering:
    needed = ("spring", "damp", "virt_mass", "d_phi_max", "dd_phi_max")
    for name in needed:
        if settings.get(f"steer_ctrl/{name}") is None:
            raise PluginError(f"parameter {settings.name}/steer_ctrl/{name} is missing, and so is"
                              " its default")
    found = Steering(*(settings.number(f"steer_ctrl/{name}", 0.0) for name in needed))
    if found.mass <= 0.0:
        raise PluginError(f"parameter {settings.name}/steer_ctrl/virt_mass must be positive")
    return found
