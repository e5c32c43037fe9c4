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

from .link_states import hung_states

_CENTRED = 1e-7  # m: a centre of mass closer to the axis counts as on it
_ROUND = 1e-6    # share by which moments of what is round may differ

_AXES = {pybullet.JOINT_REVOLUTE: True, pybullet.JOINT_PRISMATIC: False}  # kind: it turns


class MassMatrix:
    """The masses and freedoms of one body, as they are now; the configuration may change.

    Freedoms stand in this order: three turns and three shifts of a base that can move, then the
    axes by joint index, three for a ball joint.

    Attributes:
        places: where the axis of a joint index stands among the freedoms.
        count: the number of freedoms.
    """

    def __init__(self, uid: int) -> None:
        self._uid = uid
        count = pybullet.getNumJoints(uid)
        infos = [pybullet.getJointInfo(uid, index) for index in range(count)]
        dynamics = [pybullet.getDynamicsInfo(uid, index) for index in range(-1, count)]
        self._links = list(range(count))
        self._masses = np.array([entry[0] for entry in dynamics])
        self._moments = np.array([entry[2] for entry in dynamics])
        self.places: Dict[int, int] = {}
        owners, turns, local = [], [], []   # freedom: link number from the base on, turning, axis
        if self._masses[0] > 0.0:
            owners, turns = [0] * 6, [True] * 3 + [False] * 3
            local = np.tile(np.eye(3), (2, 1)).tolist()
        for index, info in enumerate(infos):
            if info[2] in _AXES:
                self.places[index] = len(owners)
                owners.append(index + 1)
                turns.append(_AXES[info[2]])
                local.append(info[13])
            elif info[2] == pybullet.JOINT_SPHERICAL:
                owners += [index + 1] * 3
                turns += [True] * 3
                local += np.eye(3).tolist()
        self.count = len(owners)
        self._owners = np.array(owners, dtype=int)
        self._turns = np.array(turns, dtype=bool)
        self._local = np.array(local).reshape(-1, 3)
        self._hangs = _descent([info[16] for info in infos])
        self._moves = self._hangs[:, self._owners]

    def now(self) -> np.ndarray:
        """The matrix in the present configuration: (count, count), kg, kg m or kg m^2."""
        centres, pivots, turned = self._where()
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
        """Return the velocity of a point of a link, by its index, by each freedom: (3, count)."""
        _, pivots, turned = self._where()
        axes = np.einsum("fij,fj->fi", turned[self._owners], self._local)
        lever = np.array(point) - pivots[self._owners]
        moved = np.where(self._turns[:, None], np.cross(axes, lever), axes)
        found: np.ndarray = (moved * self._moves[index + 1][:, None]).T
        return found

    def centre(self) -> np.ndarray:
        """Return the centre of mass of the body, m; world axes."""
        found: np.ndarray = self._masses @ self._where()[0] / self._masses.sum()
        return found

    def balanced(self) -> Set[int]:
        """Indices of the axes that turn, alone, a link that is round about them, such as a wheel.

        Their angle does not change the matrix, seen from the link that carries them.
        """
        centres, pivots, turned = self._where()
        found: Set[int] = set()
        for index, place in self.places.items():
            owner = index + 1
            alone = int(self._hangs[:, owner].sum()) == 1 and int(
                (self._owners == owner).sum()) == 1
            local = self._local[place]
            along = turned[owner] @ local
            lever = np.cross(centres[owner] - pivots[owner], along)
            tensor = np.diag(self._moments[owner])
            about = float(local @ tensor @ local)
            # Round about the axis: I = b 1 + (a - b) u u^T.
            across = (float(np.trace(tensor)) - about) / 2.0
            rest = tensor - across * np.eye(3) - (about - across) * np.outer(local, local)
            if (self._turns[place] and alone and float(np.abs(lever).max()) < _CENTRED
                    and float(np.abs(rest).max()) <= _ROUND * across):
                found.add(index)
        return found

    def changes_only_by(self, axes: Set[int]) -> bool:
        """Whether the body has no freedoms but these axes and those of its base."""
        base = 6 if self._masses[0] > 0.0 else 0
        return self.count == base + len(axes)

    def _where(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the base and each link: centre of mass, pivot, rotation of the principal axes."""
        position, turn = pybullet.getBasePositionAndOrientation(self._uid)
        centres, pivots, quaternions = [position], [position], [turn]
        for state in hung_states(self._uid, self._links, velocities=0):
            centres.append(state[0])
            pivots.append(state[4])
            quaternions.append(state[1])
        return np.array(centres), np.array(pivots), _rotations(np.array(quaternions))


def _descent(parents: List[int]) -> np.ndarray:
    """(k, i): whether link k hangs on link i or is it; 0 is the base. Parents come first."""
    count = len(parents) + 1
    hangs = np.eye(count, dtype=bool)
    hangs[:, 0] = True
    for index, parent in enumerate(parents):
        hangs[index + 1] |= hangs[parent + 1]
    return hangs


def _rotations(q: np.ndarray) -> np.ndarray:
    """(n, 3, 3) of unit quaternions (n, 4), x y z w."""
    x, y, z, w = q.T
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)
