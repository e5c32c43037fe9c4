"""libplugin_drone.so: the quadrotor of sjtu_drone, which takes off, lands and flies by `/cmd_vel`.

Parameters, defaults, topics and laws are those of sjtu_drone. The loops of the hector quadrotor
(quadrotor_simple_controller) turn velocity or position commands into roll and pitch, and these into
a thrust along the z axis of the body and a torque. Where it differs: `<imuTopic>` is ignored, as
the original does; `drone/gt_vel` and `drone/gt_acc` are in the axes of the body, where the original
turns them the wrong way.
"""
from __future__ import annotations

from typing import Any

from ...geometry import ZERO3, Vec3, conjugate, norm, rotate, rpy_from_quat, scale, subtract
from ...geometry_messages import fill_pose, fill_vector
from ..base import Plugin
from ..call_slot import CallSlot
from ..finite_messages import subscribe_finite
from .body_wrench import NO_WRENCH, hold_wrench, wrench_at_mass_centre
from .command_noise import CommandNoise
from .filtered_pid import FilteredPid
from .quadrotor_simple_controller import load_factor, to_heading

_LANDED, _FLYING, _TAKING_OFF, _LANDING = range(4)    # the numbers on the topic `state`
_SECONDS = {_TAKING_OFF: 0.5, _LANDING: 1.0}          # of the two manoeuvres
_STRENGTH = {_FLYING: 1.0, _TAKING_OFF: 1.5, _LANDING: 0.8}   # factor of thrust and torque


class SjtuDrone(Plugin):
    """Flies the link `<bodyName>`, or the model's first one, after a message on `takeoff`.

    On the ground its motors are off. `posctrl` true makes the linear part of a command a position
    in the world, m. While it takes off or lands, `angular.x` and `angular.y` are roll and pitch in
    rad, or velocities in m/s after a true on `vel_mode`.
    """

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(p.text("bodyName"))
        self._most_force = p.number("maxForce", -1.0)
        self._noise = CommandNoise(context)
        self._roll, self._pitch, self._yaw, self._vx, self._vy, self._vz, self._px, self._py, \
            self._pz = self._pids = [_pid(self.context.parameters, name) for name in (
                "rollpitch", "rollpitch", "yaw", "velocityXY", "velocityXY", "velocityZ",
                "positionXY", "positionXY", "positionZ")]
        own = p.text("rosNamespace")
        if own:
            context.use_namespace(own)
        place = "" if own else "drone/"
        self._poses = context.publish(f"{place}gt_pose", "geometry_msgs/Pose", 10)
        self._velocities = context.publish(f"{place}gt_vel", "geometry_msgs/Twist", 10)
        self._accelerations = context.publish(f"{place}gt_acc", "geometry_msgs/Twist", 10)
        command = "cmd_vel" if own else "/cmd_vel"
        subscribe_finite(context, command, "geometry_msgs/Twist", self._receive)
        context.subscribe(f"{place}takeoff", "std_msgs/Empty", lambda message: self._take_off())
        context.subscribe(f"{place}land", "std_msgs/Empty", lambda message: self._land())
        context.subscribe(f"{place}posctrl", "std_msgs/Bool", self._choose_positions)
        context.subscribe("dronevel_mode" if own else "/drone/vel_mode", "std_msgs/Bool",
                          self._choose_velocities)
        self._moves_to_positions = self._tilts_by_velocity = False
        self._timer = CallSlot()   # while it is not landed
        self.reset()
        context.observe(0.0, self._publish, [self._poses, self._velocities, self._accelerations],
                        resume=self._begin_motion)

    def reset(self) -> None:
        for pid in self._pids:
            pid.reset()
        self._linear: Vec3 = (0.0, 0.0, 0.0)
        self._angular: Vec3 = (0.0, 0.0, 0.0)
        self._noise.reset()
        self._switch_off()
        self.clock_set()

    def clock_set(self) -> None:
        """Restart the time since the last update, and a manoeuvre."""
        self._last_ns = self._since_ns = self.context.now_ns
        self._begin_motion()

    def _begin_motion(self) -> None:
        """Publish accelerations from the present time and velocity on."""
        self._seen_velocity, self._seen_ns = self._link.twist.linear, self.context.now_ns

    def _receive(self, message: Any) -> None:
        """Keep a command, with the noise of its motion."""
        roll, pitch, yaw, up = self._noise.draw()
        linear, angular = message.linear, message.angular
        self._linear = linear.x, linear.y, linear.z + up
        self._angular = angular.x + roll, angular.y + pitch, angular.z + yaw

    def _choose_positions(self, message: Any) -> None:
        self._moves_to_positions = message.data

    def _choose_velocities(self, message: Any) -> None:
        self._tilts_by_velocity = message.data

    def _take_off(self) -> None:
        if self._state == _LANDED:
            self._start(_TAKING_OFF)
            self._velocity, self._position = self._link.twist.linear, self._link.pose.position
            self._last_ns = self.context.now_ns
            self._timer.set(self.context.every(0.0, self.update))

    def _land(self) -> None:
        if self._state in (_FLYING, _TAKING_OFF):
            self._start(_LANDING)

    def _start(self, state: int) -> None:
        self._state, self._since_ns = state, self.context.now_ns

    def _switch_off(self) -> None:
        self._state = _LANDED
        self._timer.end()
        hold_wrench(self.context, self._link, NO_WRENCH)

    def update(self) -> None:
        """In each step between a take-off and the landing."""
        elapsed_ns = self.context.now_ns - self._last_ns
        if elapsed_ns <= 0:
            return
        self._last_ns = self.context.now_ns
        dt = elapsed_ns * 1e-9
        pose, twist = self._link.pose, self._link.twist
        acceleration = scale(subtract(twist.linear, self._velocity), 1.0 / dt)
        self._velocity = twist.linear
        if self._state in _SECONDS and \
                self._last_ns - self._since_ns > _SECONDS[self._state] * 1e9:
            if self._state == _LANDING:
                self._switch_off()
                return
            self._start(_FLYING)
        change = subtract(pose.position, self._position)
        self._position = pose.position
        self._control(acceleration, change, dt)

    def _control(self, acceleration: Vec3, change: Vec3, dt: float) -> None:
        """Push the body; `change` is that of its position since the last step, m."""
        link, inertial = self._link, self._link.inertial
        roll, pitch, yaw = rpy_from_quat(link.pose.orientation)
        spin = rotate(conjugate(link.pose.orientation), link.twist.angular)
        gravity = norm(self.context.gravity)
        to_positions = self._moves_to_positions and self._state == _FLYING
        wanted, flat = self._linear, self._angular[:2]
        if to_positions:
            p = link.pose.position
            # The original passes the change per step, not per second, as the rate.
            wanted = (self._px.update(wanted[0], p[0], change[0], dt),
                      self._py.update(wanted[1], p[1], change[1], dt),
                      self._pz.update(wanted[2], p[2], change[2], dt))
            flat = to_heading(yaw, wanted)[:2]
        elif self._state == _FLYING:
            flat = wanted[0], wanted[1]
        if self._state == _FLYING or self._tilts_by_velocity:
            speed, slope = to_heading(yaw, self._velocity), to_heading(yaw, acceleration)
            per_gravity = 1.0 / gravity if gravity > 0.0 else 0.0
            flat = (-self._vy.update(flat[1], speed[1], slope[1], dt) * per_gravity,
                    self._vx.update(flat[0], speed[0], slope[0], dt) * per_gravity)
        torque = (inertial.ixx * self._roll.update(flat[0], roll, spin[0], dt),
                  inertial.iyy * self._pitch.update(flat[1], pitch, spin[1], dt),
                  0.0 if to_positions else inertial.izz * self._yaw.update(
                      self._angular[2], link.twist.angular[2], 0.0, dt))
        lift = inertial.mass * (
            self._vz.update(wanted[2], self._velocity[2], acceleration[2], dt)
            + load_factor(self.context.gravity, link.pose.orientation) * gravity)
        if self._most_force > 0.0:
            lift = min(lift, self._most_force)
        strength = _STRENGTH[self._state]
        hold_wrench(self.context, link, wrench_at_mass_centre(
            link, (0.0, 0.0, max(0.0, lift) * strength), scale(torque, strength)))

    def _publish(self) -> None:
        pose, velocity, now = self._link.pose, self._link.twist.linear, self.context.now_ns
        gained, elapsed = subtract(velocity, self._seen_velocity), (now - self._seen_ns) * 1e-9
        acceleration = scale(gained, 1.0 / elapsed) if elapsed > 0.0 else ZERO3
        self._seen_velocity, self._seen_ns = velocity, now
        if self._poses.wanted:
            message = self.context.message("geometry_msgs/Pose")
            fill_pose(message, pose)
            self._poses.publish(message)
        for topic, vector in ((self._velocities, velocity),
                              (self._accelerations, acceleration)):
            if topic.wanted:
                message = self.context.message("geometry_msgs/Twist")
                fill_vector(message.linear, rotate(conjugate(pose.orientation), vector))
                topic.publish(message)


def _pid(parameters: Any, prefix: str) -> FilteredPid:
    return FilteredPid(parameters, prefix, (5.0, 0.0, 1.0), filters_rate=True)
