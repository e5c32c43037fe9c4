"""The last picture of each camera, for as long as nothing has changed."""
from __future__ import annotations

from typing import Callable, Dict, Hashable, Optional, Tuple

import numpy as np

_MOST = 16   # cameras

Drawn = Tuple[Optional[np.ndarray], Optional[np.ndarray], Optional[np.ndarray]]
"""Colours, depth and labels, as in `Pictures`; read-only."""


class PictureCache:
    """Draws a view again only when something may look otherwise.

    A world that rests, or is paused, or is asked for two pictures of the same step, costs nothing;
    a picture of 640x480 takes 50 ms where the processor draws.
    """

    def __init__(self) -> None:
        self._kept: Dict[Hashable, Tuple[Hashable, Drawn]] = {}

    def forget(self) -> None:
        """Something that is seen is another."""
        self._kept.clear()

    def get(self, view: Hashable, state: Hashable, draw: Callable[[], Drawn]) -> Drawn:
        """What was drawn of a view when the world was in this state; else `draw()`."""
        known = self._kept.pop(view, None)
        found = known[1] if known is not None and known[0] == state else draw()
        self._kept[view] = state, found
        if len(self._kept) > _MOST:
            del self._kept[next(iter(self._kept))]   # the one that was asked for longest ago
        return found
