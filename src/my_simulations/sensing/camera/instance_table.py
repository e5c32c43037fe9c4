"""The instances of all batches in one table: one computation finds what a camera sees."""
from __future__ import annotations

from typing import Iterable, Iterator, Optional, Tuple

import numpy as np

from ..api import NO_ROW, CameraSpec
from .batches import INSTANCE, Batch
from .frustum import is_in_view

SeenInstances = Tuple[Batch, np.ndarray, np.ndarray]
"""See `InstanceTable.seen`."""


class InstanceTable:
    """The instances of some batches, one batch after the other; valid until a batch changes.

    Arrays of NumPy take as long for one instance as for a hundred, and most batches have one.
    """

    def __init__(self, batches: Iterable[Batch]) -> None:
        self._batches = [batch for batch in batches if len(batch.rows)]
        counts = [len(batch.rows) for batch in self._batches]
        self._ends = np.cumsum(counts, dtype=np.int64)
        self._rows = np.concatenate([np.zeros(0, np.int64), *(one.rows for one in self._batches)])
        self._local = np.concatenate([np.zeros((0, 4, 4)), *(one.local for one in self._batches)])
        self._centers = np.repeat(np.reshape([one.center for one in self._batches], (-1, 3, 1)),
                                  counts, axis=0)
        self._radii = np.repeat([one.radius for one in self._batches], counts)
        self._cast = np.repeat([one.casts_shadow for one in self._batches], counts)
        self._table = np.repeat(np.array([one.instance for one in self._batches], INSTANCE), counts)
        self._table["link"] = np.maximum(self._rows, NO_ROW)  # scenery is no link

    def seen(self, view: np.ndarray, links: np.ndarray, placed: int, spec: Optional[CameraSpec],
             casters: bool) -> Iterator[SeenInstances]:
        """Yield each batch with the instances that a camera can see.

        Args:
            view: (4, 4), view from world.
            links: (n, 4, 4), world from link.
            placed: how many links have a place; rows below 0 always have one.
            spec: None for all instances.
            casters: only instances that cast shadows.

        Yields:
            A batch, (k,) of INSTANCE, (k, 3) centres in the view.
        """
        has_place = self._rows < placed
        if not len(links):
            links = np.eye(4)[None]
        frames = view @ links[np.where(has_place, self._rows, 0)] @ self._local
        centers = (frames[:, :3, :3] @ self._centers)[:, :, 0] + frames[:, :3, 3]
        wanted = has_place & self._cast if casters else has_place
        if spec is not None:
            wanted &= is_in_view(centers, self._radii, spec)
        self._table["rows"] = frames[:, :3]
        chosen = np.flatnonzero(wanted)
        instances, centers, start = self._table[chosen], centers[chosen], 0
        for batch, end in zip(self._batches, np.searchsorted(chosen, self._ends).tolist()):
            yield batch, instances[start:end], centers[start:end]
            start = end
