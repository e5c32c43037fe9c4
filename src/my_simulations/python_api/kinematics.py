"""Kinematics of a model's tree of joints: poses of links, Jacobians, inverse kinematics."""
from __future__ import annotations

import math
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..description.model import INFINITE, Joint, Model
from ..errors import CommandError
from ..geometry import (
    IDENTITY,
    Pose,
    Vec3,
    compose,
    conjugate,
    inverse,
    multiply,
    rotate,
    rotation_vector,
    scale,
    subtract,
    transform,
)

_TURNING, _SLIDING = ("revolute", "continuous"), ("prismatic",)
_STEPS, _ATTEMPTS = 200, 20
_DAMPING, _LONGEST_STEP = 0.02, 0.3
_RANGE = math.pi   # rad or m about the start, for axes without limits


class _Link(NamedTuple):
    """A joint of a chain, with the poses that its description gives.

    Attributes:
        parent_from_joint: the joint frame at position 0, in the parent link.
        joint_from_child: the child link in the joint frame.
        axis: a unit vector in the joint frame.
    """

    joint: Joint
    parent_from_joint: Pose
    joint_from_child: Pose
    axis: Vec3


class Chain:
    """The joints between the root of a model and one of its links.

    Attributes:
        root: the name of the root link, or `world`.
        joints: the joints of the chain that move, from the root on.

    Args:
        model: the description.
        link: name of the last link.

    Raises CommandError: no such link, or a joint whose type is not supported.
    """

    def __init__(self, model: Model, link: str) -> None:
        poses = {one.name: one.pose for one in model.links}
        if link not in poses:
            raise CommandError(f"model '{model.name}' has no link '{link}'; it has"
                               f" {', '.join(poses)}")
        above = {one.child: one for one in reversed(model.joints)}
        self._links: List[_Link] = []
        at = link
        while at in above and len(self._links) < len(model.joints):
            joint = above[at]
            parent = poses.get(joint.parent, IDENTITY)
            frame = compose(poses[at], joint.pose)
            self._links.insert(0, _Link(joint, compose(inverse(parent), frame),
                                        inverse(joint.pose), _axis(joint)))
            at = joint.parent
        self.root = at
        self.joints = tuple(one.joint.name for one in self._links if one.joint.type != "fixed")

    def pose(self, root: Pose, positions: Mapping[str, float]) -> Pose:
        """The pose of the last link.

        Args:
            root: pose of the root link; for `world`, of the model when its joints are at 0.
            positions: rad or m by joint.
        """
        return self._frames(root, positions)[0]

    def jacobian(self, root: Pose, positions: Mapping[str, float], point: Vec3) -> np.ndarray:
        """Return the derivative of the twist of the last link by the rates of `joints`.

        Args:
            root: see `pose`.
            positions: rad or m by joint.
            point: of the last link, m in its frame.

        Returns:
            Shape (6, joints): m/s of the point and rad/s, along the axes of the frame of `root`.
        """
        last, frames = self._frames(root, positions)
        at = np.array(transform(last, point))
        columns = np.zeros((6, len(self.joints)))
        moving = [one for one in zip(self._links, frames) if one[0].joint.type != "fixed"]
        for n, (one, frame) in enumerate(moving):
            axis = np.array(rotate(frame.orientation, one.axis))
            if one.joint.type in _SLIDING:
                columns[:3, n] = axis
            else:
                columns[:3, n] = np.cross(axis, at - np.array(frame.position))
                columns[3:, n] = axis
        return columns

    def _frames(self, root: Pose, positions: Mapping[str, float]) -> Tuple[Pose, List[Pose]]:
        """The pose of the last link, and the frames of all joints."""
        at, frames = root, []
        for one in self._links:
            frame = compose(at, one.parent_from_joint)
            position = positions.get(one.joint.name, 0.0)
            if one.joint.type in _TURNING:
                frame = compose(frame, Pose((0.0, 0.0, 0.0), _turn(one.axis, position)))
            elif one.joint.type in _SLIDING:
                frame = compose(frame, Pose(scale(one.axis, position)))
            frames.append(frame)
            at = compose(frame, one.joint_from_child)
        return at, frames


def _axis(joint: Joint) -> Vec3:
    if joint.type == "fixed":
        return (0.0, 0.0, 1.0)
    if joint.type not in (*_TURNING, *_SLIDING) or joint.axis is None:
        raise CommandError(f"kinematics support revolute, prismatic and fixed joints;"
                           f" '{joint.name}' is of type {joint.type}")
    return joint.axis.xyz


def _turn(axis: Vec3, angle: float) -> Tuple[float, float, float, float]:
    x, y, z = scale(axis, math.sin(0.5 * angle))
    return (x, y, z, math.cos(0.5 * angle))


class Target(NamedTuple):
    """What inverse kinematics must reach.

    Attributes:
        position: of the point of the link, m in the world.
        orientation: of the link, a quaternion x, y, z, w; None for any.
        point: of the link, m in its frame.
        tolerance: m, and rad of the orientation.
    """

    position: Vec3
    orientation: Optional[Tuple[float, float, float, float]]
    point: Vec3
    tolerance: float


class InverseKinematics:
    """Finds positions of joints at which the last link of a chain reaches a target.

    Damped least squares within the limits of the joints, from the start and then from random
    positions, which are the same in each call.

    Args:
        chain: the joints.
        model: has their limits, and the joints that mimic others.
        free: names of the joints that may move.
    """

    def __init__(self, chain: Chain, model: Model, free: Sequence[str]) -> None:
        self._chain = chain
        axes = {one.name: one.axis for one in model.joints if one.axis is not None}
        followers = {name: axis.mimic for name, axis in axes.items() if axis.mimic is not None}
        leaders = {followers[name].joint if name in followers else name for name in chain.joints}
        self._free = [name for name in free if name in leaders and name not in followers]
        if not self._free:
            raise CommandError("none of the joints moves the link")
        self._followers = {name: one for name, one in followers.items()
                           if name in chain.joints and one.joint in self._free}
        self._lower = np.array([_limit(axes[name].lower, -math.inf) for name in self._free])
        self._upper = np.array([_limit(axes[name].upper, math.inf) for name in self._free])

    def solve(self, root: Pose, start: Mapping[str, float], target: Target) -> Dict[str, float]:
        """Return the positions (rad or m) of the free joints. Raises CommandError: none found."""
        random = np.random.RandomState(0)
        begin = np.clip([start.get(name, 0.0) for name in self._free], self._lower, self._upper)
        values, best = begin, math.inf
        for _ in range(_ATTEMPTS):
            error = math.inf
            for _ in range(_STEPS):
                miss, jacobian = self._residual(root, start, values, target)
                error = max(float(np.linalg.norm(miss[:3])), float(np.linalg.norm(miss[3:])))
                if error <= target.tolerance:
                    return dict(zip(self._free, map(float, values)))
                values = np.clip(values + _step(jacobian, miss), self._lower, self._upper)
            best = min(best, error)
            low = np.where(np.isfinite(self._lower), self._lower, begin - _RANGE)
            high = np.where(np.isfinite(self._upper), self._upper, begin + _RANGE)
            values = random.uniform(low, high)
        raise CommandError(f"the target is not reached, the best attempt misses it by {best:.3g}"
                           " (m or rad)")

    def _residual(self, root: Pose, start: Mapping[str, float], values: np.ndarray, target: Target
                  ) -> Tuple[np.ndarray, np.ndarray]:
        """What is missing to the target, and its derivative by the free joints."""
        positions = {**start, **dict(zip(self._free, map(float, values)))}
        for name, one in self._followers.items():
            positions[name] = one.multiplier * positions[one.joint] + one.offset
        pose = self._chain.pose(root, positions)
        columns = self._chain.jacobian(root, positions, target.point)
        jacobian = np.zeros((6, len(self._free)))
        for n, name in enumerate(self._chain.joints):
            follower = self._followers.get(name)
            leader = follower.joint if follower is not None else name
            if leader in self._free:
                jacobian[:, self._free.index(leader)] += columns[:, n] * (
                    follower.multiplier if follower is not None else 1.0)
        miss = np.array(subtract(target.position, transform(pose, target.point)))
        if target.orientation is None:
            return miss, jacobian[:3]
        turn = rotation_vector(multiply(target.orientation, conjugate(pose.orientation)))
        return np.concatenate([miss, turn]), jacobian


def _step(jacobian: np.ndarray, miss: np.ndarray) -> np.ndarray:
    damped = jacobian @ jacobian.T + _DAMPING ** 2 * min(1.0, float(miss @ miss)) * np.eye(
        len(miss)) + 1e-12 * np.eye(len(miss))
    step = jacobian.T @ np.linalg.solve(damped, miss)
    longest = float(np.max(np.abs(step)))
    return step if longest <= _LONGEST_STEP else step * (_LONGEST_STEP / longest)


def _limit(value: float, none: float) -> float:
    return value if abs(value) < INFINITE else none
