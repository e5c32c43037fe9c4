"""The joints of a robot as in ros_control: a name, an interface, limits, gains.

Source: gazebo_ros_control's DefaultRobotHWSim. Loops run in the engine, in every step.
"""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Dict, List, Optional, Sequence, Tuple

from ...description.transmission import Transmission
from ...engine.drive_commands import JointServo, PidGains
from ...engine.spline import Spline
from ..context import Context, Joint, PluginError
from ..reconfigure import Reconfigure
from .limits import JointLimits, holding_effort, limits_of
from .settings import Settings, offer_gains

STATE, EFFORT, VELOCITY, POSITION = (f"hardware_interface::{kind}Interface" for kind in (
    "JointState", "EffortJoint", "VelocityJoint", "PositionJoint"))
DRIVES = {EFFORT: "effort", VELOCITY: "velocity", POSITION: "position"}


class HardwareJoint:
    """One joint through one interface.

    Attributes:
        name: of the joint.
        interface: e.g. `hardware_interface::EffortJointInterface`.
        limits: of the joint.
        halted: commands are not carried out.
        is_held: see `hold`.
    """

    def __init__(self, joint: Joint, interface: str, limits: JointLimits,
                 gains: Optional[PidGains], holding: float) -> None:
        self.name, self.interface, self.limits = joint.name, interface, limits
        self.halted = self.is_held = False
        self._joint = joint
        most = limits.effort
        if interface == POSITION and gains is None:
            most = max(most, holding) if most > 0.0 else math.inf
        self._servo = JointServo(
            0, DRIVES[interface], drive_gains=None if interface == EFFORT else gains,
            wraps=limits.wraps, lower=limits.lower, upper=limits.upper, most_rate=limits.rate,
            most_effort=most, soft=limits.soft)
        self._ordered = self._servo

    @property
    def position(self) -> float:
        """rad or m."""
        return self._joint.position

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""
        return self._joint.velocity

    def command(self, value: float) -> None:
        """Command an effort, rate or position, whichever the interface has."""
        if not self.halted:
            self._steer(replace(self._servo, target=value))

    def read_command(self, step: int, step_size: float) -> Optional[float]:
        """Return the command of the interface at a step; None if an engine loop computes it."""
        ordered = self._ordered
        if ordered.gains is not None:
            return None
        if ordered.spline is not None:
            return ordered.spline.at_step(step, step_size)[0]
        return ordered.target

    def follow(self, target: float = 0.0, *, spline: Optional[Spline] = None,
               gains: Optional[PidGains] = None, target_rate: float = 0.0, of_rate: bool = False,
               by_rates: bool = False, feedforward: float = 0.0,
               most_effort: float = math.inf) -> None:
        """Command the interface by a loop with a target (`engine.drive_commands.JointServo`)."""
        if self.halted:
            return
        self._steer(replace(
            self._servo, target=target, target_rate=target_rate, spline=spline, gains=gains,
            of_rate=of_rate, by_rates=by_rates, feedforward=feedforward,
            most_effort=min(most_effort, self._servo.most_effort)))

    def hold(self) -> None:
        """Hold the joint at its position until `command`, `follow` or `set_idle` is called."""
        limits = self.limits   # the joint can be spawned outside of them
        self._steer(JointServo(0, "position", holds=True, lower=limits.lower, upper=limits.upper))
        self.is_held = True

    def _steer(self, servo: JointServo) -> None:
        self._ordered, self.is_held = servo, False
        self._joint.set_servo(servo)

    @property
    def drive_gains(self) -> Optional[PidGains]:
        """Gains of the loop between the interface and the joint; None without a loop."""
        return self._servo.drive_gains

    def retune(self, gains: PidGains) -> None:
        """Change the gains of the controller's loop."""
        if self._ordered.gains is not None:
            self._steer(replace(self._ordered, gains=gains))

    def retune_drive(self, gains: PidGains) -> None:
        """Change the gains of the loop between the interface and the joint."""
        self._servo = replace(self._servo, drive_gains=gains)
        if not self.is_held:
            self._steer(replace(self._ordered, drive_gains=gains))

    def set_idle(self) -> None:
        """Hold the position, or command rate or effort 0, while no controller uses the joint."""
        if not self.halted:
            self._steer(replace(self._servo, holds=self.interface == POSITION))


class Hardware:
    """All joints that have a transmission.

    Attributes:
        switches: whether a joint offers all interfaces of its transmission and moves by the one
            that was claimed last; else it has the first one only, as in gazebo_ros_control.
        needs_transmissions: whether the joints are those of transmissions.
    """

    switches = False
    needs_transmissions = True

    def __init__(self, context: Context, transmissions: Sequence[Transmission]) -> None:
        self._context = context
        self._tunings: List[Reconfigure] = []
        self._all: Dict[Tuple[str, str], HardwareJoint] = {}
        self.names: List[str] = []
        self._active: Dict[str, HardwareJoint] = {}
        gains = Settings(context, "gazebo_ros_control/pid_gains")
        for transmission in transmissions:
            self._add(transmission, gains)

    def _add(self, transmission: Transmission, gains: Settings) -> None:
        context = self._context
        if len(transmission.joints) != 1:
            context.warn(f"transmission '{transmission.name}' has {len(transmission.joints)}"
                         " joints; only those with one are simulated")
            return
        spec = transmission.joints[0]
        named = spec.interfaces or [name for actuator in transmission.actuators
                                    for name in actuator.interfaces]
        try:
            joint = context.joint(spec.name)
        except PluginError as fault:
            context.warn(f"transmission '{transmission.name}': {fault}")
            return
        if not transmission.actuators:
            context.warn(f"transmission '{transmission.name}' of joint '{joint.name}' has no"
                         " <actuator>; here controllers can move the joint, but gazebo_ros_control"
                         " ignores such a transmission")
        if joint.name not in self.names:
            self.names.append(joint.name)
        known = [name for name in map(_interface, named) if name in DRIVES]
        if not known:
            if any(_interface(name) != STATE for name in named) or not named:
                context.warn(f"transmission '{transmission.name}' of joint '{joint.name}' has the"
                             f" interface '{', '.join(named)}', which is not simulated; only the"
                             " state of the joint is known")
            return
        limits = limits_of(joint.spec, context)
        holding = holding_effort(context.description, joint.spec, context.gravity)
        for interface in known if self.switches else known[:1]:
            made = HardwareJoint(joint, interface, limits,
                                 None if self.switches else gains.gains(joint.name), holding)
            self._all.setdefault((interface, joint.name), made)
            if self._active.setdefault(joint.name, made) is made and made.drive_gains is not None:
                self._tunings.append(offer_gains(
                    context, f"{gains.name}/{joint.name}", made.drive_gains, made.retune_drive))

    def joint(self, interface: str, name: str) -> HardwareJoint:
        """A joint through an interface. Raises PluginError."""
        found = self._all.get((interface, name))
        if found is None:
            others = [one for one, joint in self._all if joint == name]
            raise PluginError(f"joint '{name}' has no transmission with {interface}" + (
                f", but one with {', '.join(others)}" if others else ""))
        return found

    def has(self, interface: str, name: str) -> bool:
        return (interface, name) in self._all

    @property
    def joints(self) -> List[HardwareJoint]:
        """The joints, each through the interface that moves it."""
        return list(self._active.values())

    def state(self, name: str) -> Joint:
        """The state of a joint that has a transmission. Raises PluginError."""
        if name not in self.names:
            raise PluginError(f"joint '{name}' has no transmission")
        return self._context.joint(name)

    def efforts(self, names: Sequence[str]) -> List[float]:
        """Return the efforts of joints in the last step, N m or N."""
        return self._context.efforts(list(names))

    def set_idle(self, but: Sequence[str] = ()) -> None:
        """Call `set_idle` of all joints besides those named."""
        for name, joint in self._active.items():
            if name not in but:
                joint.set_idle()

    def claim(self, interface: str, name: str) -> None:
        """Move a joint by this interface. Raises PluginError."""
        self._active[name] = self.joint(interface, name)

    def hold(self) -> None:
        """Hold all joints at their positions until they are commanded or `set_idle` is called."""
        for joint in self._active.values():
            joint.hold()

    def end_holds(self, but: Sequence[str]) -> List[str]:
        """End the holds, besides those of joints named; return joints that can move freely now."""
        held = [name for name, joint in self._active.items() if joint.is_held and name not in but]
        for name in held:
            self._active[name].set_idle()
        return [name for name in held if self._active[name].interface == EFFORT]

    def set_emergency_stop(self, active: bool) -> None:
        """Begin or end an emergency stop, which holds positions and sets rates and efforts to 0.

        Controllers continue, but their commands are ignored (DefaultRobotHWSim::writeSim).
        """
        for joint in self._all.values():
            joint.halted = False
        self.set_idle()
        for joint in self._all.values():
            joint.halted = active

    def release(self, name: str) -> None:
        """Call `set_idle` of a joint that no controller uses any longer."""
        if name in self._active:
            self._active[name].set_idle()


class SwitchingHardware(Hardware):
    """Joints with several interfaces. Source: cob_gazebo_ros_control's HWISwitchRobotHWSim.

    It ignores `pid_gains`, as the original.
    """

    switches = True


class PalHardware(SwitchingHardware):
    """Joints of PAL's robots; transmissions can have several. Source: pal_hardware_gazebo."""

    def __init__(self, context: Context, transmissions: Sequence[Transmission]) -> None:
        super().__init__(context, [replace(one, joints=[joint]) for one in transmissions
                                   for joint in one.joints])


def _interface(name: str) -> str:
    """`hardware_interface::EffortJointInterface` of any spelling."""
    return "hardware_interface::" + name.replace("::", "/").rpartition("/")[2].strip()
