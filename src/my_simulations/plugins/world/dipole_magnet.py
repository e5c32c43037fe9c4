"""libgazebo_dipole_magnet.so: magnets of different models attract and turn each other.

Parameters, defaults, topics and law are those of storm_gazebo_ros_magnet: dipoles m1 and m2 at a
distance r e (from m2 to m1). The field at m1 is B = mu0 / (4 pi r^3) (3 (m2 e) e - m2), its torque
m1 x B, its force 3 mu0 / (4 pi r^4) ((m1 e) m2 + (m2 e) m1 + (m1 m2) e - 5 (m1 e) (m2 e) e).
Source: Griffiths, Introduction to Electrodynamics, 6.1. Where it differs: the force acts at the
magnet (original: at the centre of mass of the link); without `<topicNs>` the topics are below the
name of the link.
"""
from __future__ import annotations

from typing import List, NamedTuple, Tuple

from ...geometry import (
    Pose,
    Quat,
    Vec3,
    add,
    conjugate,
    cross,
    dot,
    multiply,
    norm,
    rotate,
    scale,
    subtract,
    transform,
)
from ..base import Plugin
from ..parameters import Parameters
from ..standard_messages import magnetic_message, wrench_message

LIBRARY = "libgazebo_dipole_magnet.so"
_MU0_BY_4_PI = 1e-7   # T m / A
_NEAREST = 1e-6       # m: dipoles nearer than this do not act


class Magnet(NamedTuple):
    """A dipole on a link (a scoped name): where it is on it, and its moment in its axes, A m^2."""

    link: str
    offset: Vec3
    turn: Quat
    moment: Vec3

    def placed(self, pose: Pose) -> Tuple[Vec3, Vec3]:
        """Place and moment in the world, by the pose of the link."""
        at = subtract(pose.position, rotate(pose.orientation, self.offset))
        return at, rotate(multiply(pose.orientation, conjugate(self.turn)), self.moment)


def magnet_of(link: str, p: Parameters) -> Magnet:
    return Magnet(link, p.vector("xyzOffset"), p.turn("rpyOffset"), p.vector("dipole_moment"))


def field_of(moment: Vec3, arm: Vec3) -> Vec3:
    """The field of a dipole at `arm` (m) from it, T."""
    distance = norm(arm)
    way = scale(arm, 1.0 / distance)
    return scale(subtract(scale(way, 3.0 * dot(moment, way)), moment),
                 _MU0_BY_4_PI / distance ** 3)


def force_between(moment: Vec3, other: Vec3, arm: Vec3) -> Vec3:
    """The force on a dipole at `arm` (m) from another one, N."""
    distance = norm(arm)
    way = scale(arm, 1.0 / distance)
    one, two = dot(moment, way), dot(other, way)
    along = dot(moment, other) - 5.0 * one * two
    return scale(add(add(scale(other, one), scale(moment, two)), scale(way, along)),
                 3.0 * _MU0_BY_4_PI / distance ** 4)


class DipoleMagnet(Plugin):
    """The magnet `<bodyName>`; with `<calculate>` false it only acts on others."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(self.required_text("bodyName"))
        self._magnet = magnet_of(self._link.name, p)
        self._known: Tuple[str, ...] = ()
        self._others: List[Magnet] = []
        self._publishes = p.flag("shouldPublish", False)
        self._next_ns = 0
        rate = p.number("updateRate", 0.0)
        self._period_ns = round(1e9 / rate) if rate > 0.0 else 0
        if self._publishes:
            below = p.text("topicNs", self._link.name)
            self._wrenches = context.publish(f"{below}/wrench", "geometry_msgs/WrenchStamped")
            self._fields = context.publish(f"{below}/mfs", "sensor_msgs/MagneticField")
        if p.flag("calculate", True):
            context.every(0.0, self.update)

    def clock_set(self) -> None:
        """The next messages are due at once."""
        self._next_ns = 0

    reset = clock_set

    def update(self) -> None:
        self._find_others()
        pose = self._link.pose
        at, moment = self._magnet.placed(pose)
        force, torque, field = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for other in self._others:
            place, acting = other.placed(self.context.model_link(other.link).pose)
            arm = subtract(at, place)
            if norm(arm) < _NEAREST:
                continue
            felt = field_of(acting, arm)
            field, torque = add(field, felt), add(torque, cross(moment, felt))
            force = add(force, force_between(moment, acting, arm))
        lever = subtract(at, transform(pose, self._link.inertial.pose.position))
        self.context.set_wrench(self._link.name, force, add(torque, cross(lever, force)))
        if self._publishes and self.context.now_ns >= self._next_ns:
            self._next_ns = self.context.now_ns + self._period_ns
            self._publish(force, torque, field)

    def _find_others(self) -> None:
        """Find the magnets of the other models, if the models have changed."""
        models = self.context.models()
        names = tuple(models)
        if names == self._known:
            return
        self._known, self._others = names, []
        for name, model in models.items():
            for spec in model.plugins:
                if name != self.context.model and spec.filename.endswith(LIBRARY):
                    p = Parameters(spec.xml)
                    self._others.append(magnet_of(f"{name}::{p.text('bodyName')}", p))

    def _publish(self, force: Vec3, torque: Vec3, field: Vec3) -> None:
        if self._wrenches.wanted:
            self._wrenches.publish(wrench_message(self.context, "world", (force, torque)))
        if self._fields.wanted:
            self._fields.publish(magnetic_message(self.context, self._link.name, field))
