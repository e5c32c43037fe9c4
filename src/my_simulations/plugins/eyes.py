"""Looking at the world for plugins: the sensing process, told of the models that there are."""
from __future__ import annotations

from concurrent.futures import Future
from typing import TYPE_CHECKING, Callable, Dict, Optional

from ..errors import Issue, warning
from ..geometry import Pose
from ..sensing.api import (
    COLLISIONS,
    VISUALS,
    AddBody,
    Body,
    CastRays,
    Mount,
    RayFan,
    RayReturns,
    RemoveBody,
)
from ..simulator.registry import Entity
from ..simulator.simulator import Simulator

if TYPE_CHECKING:
    from ..sensing.process import SensingProcess


class Eyes:
    """Casts rays; nothing is started before the first one. For one thread.

    Args:
        simulator: the world that is looked at.
        log: hears of what is left out, and of deaths of the process.
    """

    def __init__(self, simulator: Simulator, log: Callable[[Issue], None]) -> None:
        self._simulator, self._log = simulator, log
        self._process: "Optional[SensingProcess]" = None
        self._known: Dict[str, Entity] = {}
        self._revision = -1

    def cast(self, row: int, mount: Pose, fan: RayFan, visuals: bool) -> "Future[RayReturns]":
        """Ranges as of now, of a sensor at `mount` in the frame of the link of a row.

        `visuals`: rays see what is drawn, else what collides.
        """
        process = self._running()
        rows = self._simulator.feed.states()[2]
        return process.cast(CastRays(
            Mount(row, mount), fan, VISUALS if visuals else COLLISIONS, rows))

    def close(self) -> None:
        """End the process, if there is one."""
        if self._process is not None:
            self._process.close()
            self._process = None

    def _running(self) -> "SensingProcess":
        if self._process is None:
            from ..sensing.process import SensingProcess

            process = self._process = SensingProcess()
            process.on_trouble(lambda text: self._log(warning("sensing", text)))
        revision, entities = self._simulator.models.inventory()
        if revision != self._revision:
            self._revision = revision
            self._tell({entity.model.name: entity for entity in entities})
        return self._process

    def _tell(self, present: Dict[str, Entity]) -> None:
        assert self._process is not None
        change = self._process.change
        for name in [name for name in self._known if name not in present]:
            change(RemoveBody(name))
        for name, entity in present.items():
            if self._known.get(name) is not entity:
                change(AddBody(Body(name, entity.model, entity.first_link_row)))
        self._known = present
