"""How the tables look when a world begins anew."""
from __future__ import annotations

from typing import NamedTuple, Sequence, Tuple
from weakref import WeakKeyDictionary

import numpy as np

from ...geometry import Pose
from .body_builder import Builder
from .state_readout import StateReadout
from .state_restore import Entry

Start = Tuple[Entry, Pose]
"""A model, and the world pose of its frame at which it begins."""


class _Rows(NamedTuple):
    pose: Pose
    links: np.ndarray
    joints: np.ndarray


class InitialStateCache:
    """The rows that models have when they have just been built at some pose.

    The same builder and the same pose give the same rows, bit for bit.
    """

    def __init__(self, readout: StateReadout) -> None:
        self._readout = readout
        self._known: "WeakKeyDictionary[Builder, _Rows]" = WeakKeyDictionary()

    def keep(self, starts: Sequence[Start]) -> None:
        """Remember the rows of models that have just been built, and nothing else has happened."""
        self._readout.read()
        for entry, pose in starts:
            links, joints = entry.builder.link_rows, entry.builder.joint_rows
            self._known[entry.builder] = _Rows(pose, self._readout.links[links].copy(),
                                               self._readout.joints[joints].copy())

    def show(self, starts: Sequence[Start]) -> bool:
        """Put these rows into the tables; False, and nothing is done, unless all are known."""
        known = [self._known.get(entry.builder) for entry, _ in starts]
        if any(rows is None or rows.pose != pose for rows, (_, pose) in zip(known, starts)):
            return False
        for rows, (entry, _) in zip(known, starts):
            if rows is not None:
                self._readout.links[entry.builder.link_rows] = rows.links
                self._readout.joints[entry.builder.joint_rows] = rows.joints
        return True
