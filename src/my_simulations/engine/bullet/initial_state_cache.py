"""Cache the link and joint tables of a world at its start, for later resets."""
from __future__ import annotations

from typing import NamedTuple, Sequence, Tuple
from weakref import WeakKeyDictionary

import numpy as np

from ...geometry import Pose
from .body_builder import Builder
from .state_readout import StateReadout
from .state_restore import Entry

Start = Tuple[Entry, Pose]
"""A model, and the initial world pose of its frame."""


class _Rows(NamedTuple):
    pose: Pose
    links: np.ndarray
    joints: np.ndarray


class InitialStateCache:
    """Stores the rows of models as built at a pose.

    The same builder and the same pose give the same rows, bit for bit.
    """

    def __init__(self, readout: StateReadout) -> None:
        self._readout = readout
        self._known: "WeakKeyDictionary[Builder, _Rows]" = WeakKeyDictionary()

    def keep(self, starts: Sequence[Start]) -> None:
        """Store the rows of models that were just built; no step may have been made since."""
        self._readout.read()
        for entry, pose in starts:
            links, joints = entry.builder.link_rows, entry.builder.joint_rows
            self._known[entry.builder] = _Rows(pose, self._readout.links[links].copy(),
                                               self._readout.joints[joints].copy())

    def show(self, starts: Sequence[Start]) -> bool:
        """Write the stored rows to the tables; return False and write none if any is missing."""
        known = [self._known.get(entry.builder) for entry, _ in starts]
        if any(rows is None or rows.pose != pose for rows, (_, pose) in zip(known, starts)):
            return False
        for rows, (entry, _) in zip(known, starts):
            if rows is not None:
                self._readout.links[entry.builder.link_rows] = rows.links
                self._readout.joints[entry.builder.joint_rows] = rows.joints
        return True
