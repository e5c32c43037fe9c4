"""Where all links are now, out of the simulator's ring."""
from __future__ import annotations

from typing import Any, Optional

from ...simulator.feeds import ROW_WIDTH
from ...simulator.simulator import Simulator
from .pose_messages import Poses


class PoseReader:
    """Reads the poses of one world. For one thread at a time."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._layout: Any = None
        self._ids: Any = None

    def read(self, revision: int, real_time: float) -> Optional[Poses]:
        """The newest poses, with the step and sim time at which links were there.

        `real_time`: wall time in s to mark them with.

        None while the world's names are not those of `revision`.
        """
        import numpy as np

        layout, step, clock, raw = self._simulator.feed.poses()
        if layout.revision != revision:
            return None
        if layout is not self._layout:
            self._layout = layout
            self._ids = np.fromiter((row for row, _ in layout.link_places), dtype=np.int64,
                                    count=len(layout.link_places))
        ids = self._ids
        table = np.frombuffer(raw, dtype=np.float64).reshape(-1, ROW_WIDTH)
        if len(ids) and int(ids.max()) >= len(table):
            return None
        return Poses(ids, table[ids, :7].astype(np.float32), step, clock.sim_ns(step) * 1e-9,
                     real_time)
