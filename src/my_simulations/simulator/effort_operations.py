"""Edits that apply forces: wrenches on links, and efforts on joint axes."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Tuple

from ..description.scoped_names import split_scoped
from ..errors import CommandError
from ..geometry import ZERO3, Vec3, rotate, subtract
from .operations import Operation
from .simulator import Simulator
from .world_state import WorldState
from .wrenches import Effort


@dataclass(frozen=True)
class ApplyWrench:
    """Apply a wrench to a link for a number of steps.

    Attributes:
        link: scoped link name.
        force: N, in world axes, or in link axes with `in_link_axes`.
        torque: N m, likewise.
        point: point of application in the link frame, m; None for the centre of mass.
        in_link_axes: the wrench rotates with the link.
        steps: duration in steps.
    """

    link: str
    force: Vec3
    torque: Vec3
    point: Optional[Vec3]
    in_link_axes: bool
    steps: int

    def apply(self, world: Simulator) -> Operation:
        """Apply the wrench; the inverse restores pose and velocity of the model."""
        name, plain = split_scoped(self.link, world.models.has)
        model = world.models.get(name)
        com = next((link.inertial.pose.position for link in model.links if link.name == plain),
                   None)
        pose, _ = world.states.link_state(self.link)
        back = world.states.capture()
        if com is None:
            raise CommandError(f"unknown link '{self.link}'")
        lever = ZERO3 if self.point is None else subtract(self.point, com)
        duration = round(self.steps * world.physics.settings.max_step_size * 1e9)
        if self.in_link_axes:
            at = com if self.point is None else self.point
            world.wrenches.apply_wrench(self.link, self.force, self.torque, frame=self.link,
                                        point=at, duration_ns=duration)
        else:
            world.wrenches.apply_wrench(self.link, self.force, self.torque, duration_ns=duration,
                                        point=rotate(pose.orientation, lever))
        return _RestoreModel(WorldState(back.step, back.sim_ns, {name: back.models[name]}), self)


@dataclass(frozen=True)
class _RestoreModel:
    """Inverse of `ApplyWrench`: restores states, not the clock; its inverse is the wrench."""

    state: WorldState
    wrench: ApplyWrench

    def apply(self, world: Simulator) -> Operation:
        world.states.restore(self.state, clock=False)
        return self.wrench


@dataclass(frozen=True)
class DriveJoint:
    """Replace the efforts and PID controllers of a joint axis; an empty list removes them."""

    joint: str
    efforts: Tuple[Effort, ...] = ()

    def apply(self, world: Simulator) -> Operation:
        """Replace the efforts and PID controllers of the axis."""
        before = world.wrenches.efforts_on(self.joint)
        world.wrenches.clear_efforts(self.joint)
        for effort in self.efforts:
            world.wrenches.apply_effort(self.joint, effort)
        return DriveJoint(self.joint, before)
