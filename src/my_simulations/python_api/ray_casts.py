"""Rays in an open world: distances and the links that they meet."""
from __future__ import annotations

from concurrent.futures import TimeoutError as FutureTimeoutError
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Tuple

from ..errors import CommandError
from ..sensing.api import Mount, RayBundle, SensingError
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator

if TYPE_CHECKING:
    import numpy as np

_PATIENCE_S = 60.0


@dataclass(frozen=True)
class RayReading:
    """What rays meet.

    Attributes:
        ranges: (n,) m from the origin of each ray; inf where nothing is met.
        links: the links that are met, as `model::link`; "" for none.
    """

    ranges: "np.ndarray"
    links: Tuple[str, ...]


def cast_rays(simulator: Simulator, scene: SceneSensing, origins: Any, directions: Any,
              far: float, frame: str, visuals: bool) -> RayReading:
    """Cast rays into the world as it is now; see `OpenWorld.cast_rays`. Raises CommandError."""
    import numpy as np

    try:
        starts = np.atleast_2d(np.asarray(origins, float))
        ways = np.atleast_2d(np.asarray(directions, float))
    except (TypeError, ValueError) as fault:
        raise CommandError(f"origins and directions are arrays of numbers: {fault}") from fault
    if starts.shape[1:] != (3,) or ways.shape[1:] != (3,) or not (
            len(starts) == len(ways) or 1 in (len(starts), len(ways))):
        raise CommandError("origins and directions must have the shape (n, 3), or (3,)")
    starts, ways = map(np.ascontiguousarray, np.broadcast_arrays(starts, ways))
    lengths = np.linalg.norm(ways, axis=1, keepdims=True)
    if not (np.isfinite(starts).all() and np.isfinite(lengths).all() and (lengths > 0.0).all()
            and 0.0 < far < np.inf):
        raise CommandError("rays need finite origins, directions that are not zero, and a finite"
                           " range above 0")
    row, offset = simulator.states.frame_mount(frame)
    future = scene.cast(Mount(row, offset), RayBundle(starts, ways / lengths, far=float(far)),
                        visuals, simulator.clock.sim_ns, simulator.feed.rows())
    scene.send()
    try:
        found = future.result(_PATIENCE_S)
    except (SensingError, FutureTimeoutError) as fault:
        raise CommandError(f"the rays could not be cast: {fault or 'it took too long'}") from fault
    names = simulator.states.link_names()
    return RayReading(found.ranges, tuple(names.get(int(row), "") for row in found.link_rows))
