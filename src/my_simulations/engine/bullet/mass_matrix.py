"""Compute the joint-space mass matrix of an articulated body.

PyBullet's calculateMassMatrix is not usable: it caches a copy of each body by memory address and
never updates it. So a new body at the address of a removed one gets the masses, or the number of
axes, of the removed one (measured, 3.2.7). It also rejects physically impossible inertia tensors,
which occur in files.

M = sum over links of m Jv^T Jv + Jw^T I Jw, with the Jacobians of the centre of mass and of the
rotation (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 3.1).
"""
from __future__ import annotations

from typing import Dict, List, Set, Tuple

import numpy as np
import pybullet

from .link_states import child_states

_CENTRED = 1e-7  # m: a centre of mass closer to the axis counts as on it
_ROUND = 1e-6    # relative difference below which moments count as equal

_TURNS = {pybullet.JOINT_REVOLUTE: True, pybullet.JOINT_PRISMATIC: False}


class MassMatrix:
    """Computes the mass matrix of one body in its present configuration.

    The degrees of freedom are in this order: three rotations and three translations of a base that
    can move, then the axes by joint index, three for a ball joint.

    Attributes:
        columns: the columns of the joint axes in the matrix, by joint index.
        count: the number of degrees of freedom.
    """

    def __init__(self, uid: int) -> None:
        self._uid = uid
        count = pybullet.getNumJoints(uid)
        infos = [pybullet.getJointInfo(uid, index) for index in range(count)]
        dynamics = [pybullet.getDynamicsInfo(uid, index) for index in range(-1, count)]
        self._links = list(range(count))
        self._masses = np.array([entry[0] for entry in dynamics])
        self._moments = np.array([entry[2] for entry in dynamics])
        self.columns: Dict[int, int] = {}
        owners, turns, local = [], [], []   # of degrees of freedom: link (0: base), turning, axis
        if self._masses[0] > 0.0:
            owners, turns = [0] * 6, [True] * 3 + [False] * 3
            local = np.tile(np.eye(3), (2, 1)).tolist()
        for index, info in enumerate(infos):
            if info[2] in _TURNS:
                self.columns[index] = len(owners)
                owners.append(index + 1)
                turns.append(_TURNS[info[2]])
                local.append(info[13])
            elif info[2] == pybullet.JOINT_SPHERICAL:
                owners += [index + 1] * 3
                turns += [True] * 3
                local += np.eye(3).tolist()
        self.count = len(owners)
        self._owners = np.array(owners, dtype=int)
        self._turns = np.array(turns, dtype=bool)
        self._local = np.array(local).reshape(-1, 3)
        self._descendants = _descendants([info[16] for info in infos])
        self._moves = self._descendants[:, self._owners]

    def compute(self) -> np.ndarray:
        """Return the matrix in the present configuration: (count, count), kg, kg m or kg m^2."""
        centres, pivots, turned = self._kinematics()
        axes = np.einsum("fij,fj->fi", turned[self._owners], self._local)
        lever = centres[:, None, :] - pivots[self._owners][None, :, :]
        shifts = np.where(self._turns[None, :, None], np.cross(axes[None], lever), axes[None])
        shifts = shifts * self._moves[:, :, None]
        spins = np.einsum("kji,fj->kfi", turned, axes) * (
            self._moves & self._turns[None, :])[:, :, None]
        matrix: np.ndarray = (
            np.einsum("k,kfi,kgi->fg", self._masses, shifts, shifts)
            + np.einsum("ki,kfi,kgi->fg", self._moments, spins, spins))
        return matrix

    def jacobian(self, index: int, point: np.ndarray) -> np.ndarray:
        """Return the velocity of a point of a link per rate of each degree of freedom: (3, count).

        Args:
            index: PyBullet's index of the link.
            point: world axes, m.
        """
        _, pivots, turned = self._kinematics()
        axes = np.einsum("fij,fj->fi", turned[self._owners], self._local)
        lever = np.array(point) - pivots[self._owners]
        moved = np.where(self._turns[:, None], np.cross(axes, lever), axes)
        found: np.ndarray = (moved * self._moves[index + 1][:, None]).T
        return found

    def centre(self) -> np.ndarray:
        """Return the centre of mass of the body, m; world axes."""
        found: np.ndarray = self._masses @ self._kinematics()[0] / self._masses.sum()
        return found

    def wheels(self) -> Set[int]:
        """Return the joint indices of wheels: links without children, symmetric about the axis.

        The angle of a wheel does not change the matrix, seen from the parent of the wheel.
        """
        centres, pivots, turned = self._kinematics()
        found: Set[int] = set()
        for index, column in self.columns.items():
            owner = index + 1
            alone = int(self._descendants[:, owner].sum()) == 1 and int(
                (self._owners == owner).sum()) == 1
            local = self._local[column]
            along = turned[owner] @ local
            lever = np.cross(centres[owner] - pivots[owner], along)
            tensor = np.diag(self._moments[owner])
            about = float(local @ tensor @ local)
            # Round about the axis: I = b 1 + (a - b) u u^T.
            across = (float(np.trace(tensor)) - about) / 2.0
            rest = tensor - across * np.eye(3) - (about - across) * np.outer(local, local)
            if (self._turns[column] and alone and float(np.abs(lever).max()) < _CENTRED
                    and float(np.abs(rest).max()) <= _ROUND * across):
                found.add(index)
        return found

    def moves_only_by(self, axes: Set[int]) -> bool:
        """Whether the body has no degrees of freedom but these axes and those of its base."""
        base = 6 if self._masses[0] > 0.0 else 0
        return self.count == base + len(axes)

    def _kinematics(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return centre of mass, pivot and rotation of the principal axes of the base and links."""
        position, turn = pybullet.getBasePositionAndOrientation(self._uid)
        centres, pivots, quaternions = [position], [position], [turn]
        for state in child_states(self._uid, self._links, velocities=0):
            centres.append(state[0])
            pivots.append(state[4])
            quaternions.append(state[1])
        return np.array(centres), np.array(pivots), _rotations(np.array(quaternions))


def _descendants(parents: List[int]) -> np.ndarray:
    """Return a matrix (k, i): whether link k is link i or its descendant; 0 is the base.

    Args:
        parents: of the links other than the base; each index is higher than that of its parent.
    """
    count = len(parents) + 1
    is_descendant = np.eye(count, dtype=bool)
    is_descendant[:, 0] = True
    for index, parent in enumerate(parents):
        is_descendant[index + 1] |= is_descendant[parent + 1]
    return is_descendant


def _rotations(q: np.ndarray) -> np.ndarray:
    """Return rotation matrices (n, 3, 3) of unit quaternions (n, 4), x y z w."""
    x, y, z, w = q.T
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)
