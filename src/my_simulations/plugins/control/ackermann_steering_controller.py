"""ackermann_steering_controller and steer_drive_controller: a driven rear axle and a steered one.

Each axle is one wheel; the second controller is the older form of the first. `angular.z` of a
command is the steering angle, rad, as in the original. Where it differs: with `open_loop` the base
turns as that angle says (original: the angle counts as a yaw rate). Multipliers correct the
odometry alone.
"""
from __future__ import annotations

import math

from .base_controller import BaseController, Planar
from .hardware import POSITION, VELOCITY, HardwareJoint


class AckermannSteeringController(BaseController):
    """Joints `rear_wheel`, by its rate, and `front_steer`, by its position."""

    def load_wheels(self) -> None:
        s = self.settings
        self._wheel = self.claim_joint(VELOCITY, s.text("rear_wheel", "rear_wheel_joint"))
        self._steer = self.claim_joint(POSITION, s.text("front_steer", "front_steer_joint"))
        self.counted = [self._wheel]
        base = s.number("wheel_separation_h", 0.0)
        if s.get("wheel_separation_h") is None:
            base = abs(self._place(self._steer) - self._place(self._wheel))
        radius = s.number("wheel_radius", 0.0)
        if s.get("wheel_radius") is None:
            radius = self.radius_of(self.context.joint(self._wheel.name).spec)
        self._base = base * s.number("wheel_separation_h_multiplier", 1.0)
        self._radius = radius
        self._counted_radius = radius * s.number("wheel_radius_multiplier", 1.0)
        self._scale = s.number("steer_pos_multiplier", 1.0)
        self.positive(wheel_separation_h=self._base,
                      wheel_radius=min(self._radius, self._counted_radius))

    def _place(self, joint: HardwareJoint) -> float:
        """Along x of the model, m."""
        return self.joint_location(self.context.joint(joint.name).spec)[0]

    def drive(self, velocity: Planar) -> None:
        """Drive the rear wheel, and steer the front wheel."""
        self._wheel.command(velocity[0] / self._radius)
        self._steer.command(velocity[2])

    def displacement(self, dt: float) -> Planar:
        """Return the motion of the rear wheel about the centre on the front wheel's axis."""
        if self.open_loop:
            forward, angle = self.last[0] * dt, self.last[2]
        else:
            forward, angle = (self.count_rotations()[0] * self._counted_radius,
                              self._steer.position * self._scale)
        return forward, 0.0, forward * math.tan(angle) / self._base
