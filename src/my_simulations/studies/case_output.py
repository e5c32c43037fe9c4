"""The files of a case besides its row."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Tuple, Union

import numpy as np


@dataclass(frozen=True)
class CaseTrajectory:
    """The motion in one case.

    Attributes:
        times: (frames,) s of sim time.
        names: of the models, in the order of the second axis.
        poses: (frames, models, 7) x, y, z in m and a quaternion x, y, z, w, world frame.
    """

    times: np.ndarray
    names: Tuple[str, ...]
    poses: np.ndarray

    def arrays(self, case: str) -> Dict[str, np.ndarray]:
        """Return the arrays by their keys in the file."""
        return {f"{case}.time": self.times, f"{case}.names": np.array(self.names, dtype=str),
                f"{case}.pose": self.poses}


@dataclass(frozen=True)
class ScenarioFiles:
    """Results and output of a scenario, by name of the file."""

    files: Dict[str, bytes]


CaseOutput = Union[CaseTrajectory, ScenarioFiles]
