"""Kinematics of a model's tree of joints: poses of links, Jacobians, inverse kinematics."""
from __future__ import annotations

import math
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..description.model import INFINITE, Joint, Model
from ..errors import CommandError
from ..geometry import (
    IDENTITY,
    ZERO3,
    Pose,
    Vec3,
    add,
    compose,
    conjugate,
    cross,
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


class _MovingJoint(NamedTuple):
    """A joint of a chain that moves.

    Attributes:
        slides: along its axis; else it turns about it.
        frame: at position 0, in the frame of the moving joint before it, or in the root.
        axis: a unit vector in its frame.
    """

    name: str
    slides: bool
    frame: Pose
    axis: Vec3


class ChainPoses(NamedTuple):
    """Poses in the root link; for `world`, in the frame of the model when its joints are at 0.

    Attributes:
        last: of the last link.
        joints: of the frames of the moving joints.
    """

    last: Pose
    joints: List[Pose]


class Chain:
    """The joints between the root of a model and one of its links.

    Attributes:
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
        path: List[Joint] = []
        at = link
        while at in above and len(path) < len(model.joints):
            path.insert(0, above[at])
            at = above[at].parent
        self._moving: List[_MovingJoint] = []
        before = poses.get(at, IDENTITY)   # of the last joint frame, all joints at 0
        for joint in path:
            axis = _axis(joint)
            if joint.type != "fixed":
                frame = compose(poses[joint.child], joint.pose)
                self._moving.append(_MovingJoint(joint.name, joint.type in _SLIDING,
                                                 compose(inverse(before), frame), axis))
                before = frame
        self._end = compose(inverse(before), poses[link])
        self.joints = tuple(one.name for one in self._moving)

    def poses(self, positions: Mapping[str, float]) -> ChainPoses:
        """Poses at positions of joints in rad or m; 0 for those not named."""
        at, frames = IDENTITY, []
        for name, slides, frame, axis in self._moving:
            position, turn = compose(at, frame)
            value = positions.get(name, 0.0)
            if slides:
                at = Pose(add(position, rotate(turn, scale(axis, value))), turn)
            else:
                at = Pose(position, multiply(turn, _turn(axis, value)))
            frames.append(at)
        return ChainPoses(compose(at, self._end), frames)

    def jacobian(self, poses: ChainPoses, link: Pose, point: Vec3) -> np.ndarray:
        """Return the derivative of the twist of the last link by the rates of `joints`.

        Args:
            poses: of the present positions.
            link: present pose of the last link.
            point: of the last link, m in its frame.

        Returns:
            Shape (6, joints): m/s of the point and rad/s, along the axes of the frame of `link`.
        """
        root = multiply(link.orientation, conjugate(poses.last.orientation))
        end = transform(poses.last, point)
        rows = []
        for one, frame in zip(self._moving, poses.joints):
            axis = rotate(frame.orientation, one.axis)
            lever = ZERO3 if one.slides else rotate(root, subtract(end, frame.position))
            axis = rotate(root, axis)
            rows.append((*axis, *ZERO3) if one.slides else (*cross(axis, lever), *axis))
        return np.array(rows, float).reshape(-1, 6).T


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
        poses = self._chain.poses(positions)
        pose = compose(root, poses.last)
        columns = self._chain.jacobian(poses, pose, target.point)
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


def damped_step(jacobian: np.ndarray, way: np.ndarray, damping: float) -> np.ndarray:
    """Return the x that minimises |jacobian x - way|^2 + |damping x|^2, shape (n,).

    Args:
        jacobian: (m, n).
        way: (m,).
        damping: above 0; bounds x near singular poses.
    """
    square = jacobian @ jacobian.T
    square.flat[::len(way) + 1] += damping ** 2
    # Not by np.linalg.solve: for it, OpenBLAS wakes threads that then keep the processors busy.
    found: np.ndarray = jacobian.T @ np.linalg.lstsq(square, way, rcond=None)[0]
    return found


def _step(jacobian: np.ndarray, miss: np.ndarray) -> np.ndarray:
    step = damped_step(jacobian, miss, _DAMPING * min(1.0, float(np.linalg.norm(miss))) + 1e-6)
    longest = float(np.max(np.abs(step)))
    return step if longest <= _LONGEST_STEP else step * (_LONGEST_STEP / longest)


def _limit(value: float, none: float) -> float:
    return value if abs(value) < INFINITE else none
