"""Short ways to build what sensors look at."""
from __future__ import annotations

from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

from my_simulations.appearance.looks import Look
from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Collision, Geometry, Visual
from my_simulations.geometry import IDENTITY, Pose
from my_simulations.sensing.api import Body

DEADLINE_S = 60.0


def body(name: str, geometry: Geometry, row: int, look: Optional[Look] = None,
         retro: float = 0.0, pose: Pose = IDENTITY, transparency: float = 0.0) -> Body:
    """A model of one link that is the same to collisions and visuals."""
    link = Link("link", collisions=[Collision("c", geometry, pose, laser_retro=retro)],
                visuals=[Visual("v", geometry, pose, transparency=transparency,
                                laser_retro=retro)])
    looks: Dict[Tuple[int, int], Look] = {(0, 0): look} if look else {}
    return Body(name, Model(name, links=[link]), row, looks)


def rows(poses: Sequence[Pose]) -> bytes:
    """Link rows as the ring holds them."""
    table: List[List[float]] = [[*pose.position, *pose.orientation, *([0.0] * 6)]
                                for pose in poses]
    return np.array(table, dtype=np.float64).tobytes()


def table(poses: Sequence[Pose]) -> np.ndarray:
    """Poses as the scenes want them."""
    return np.array([[*pose.position, *pose.orientation] for pose in poses]).reshape(-1, 7)
