"""Rays and pictures of the world; keeps the scenes of the sensing processes up to date."""
from __future__ import annotations

from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

from ..errors import Issue, warning
from ..sensing.api import (
    COLLISIONS,
    VISUALS,
    AddBody,
    CameraSpec,
    CastBatch,
    CastRays,
    Change,
    Mount,
    Pictures,
    RayBundle,
    RayFan,
    RayReturns,
    RemoveBody,
    RenderCamera,
    SensingError,
    SetLights,
)
from .entity import Entity
from .simulator import Simulator

if TYPE_CHECKING:
    from ..sensing.process import SensingProcess


Shot = Tuple[Mount, CameraSpec, Tuple[str, ...]]
"""Where a camera is, what it is, and what it gives (outputs of `sensing.api`)."""


class SceneSensing:
    """Casts rays and takes pictures, each in a process of its own. For one thread.

    Rays do not wait for pictures, which take a hundred times as long, and are not lost with them. A
    process starts with the first request.

    Args:
        simulator: the world.
        log: receives issues about missing files and crashes of the processes.
    """

    def __init__(self, simulator: Simulator, log: Callable[[Issue], None]) -> None:
        self._simulator, self._log = simulator, log
        self._processes: "Optional[Tuple[SensingProcess, SensingProcess]]" = None
        self._materials: Any = None
        self._casts: "List[Tuple[CastRays, Future[RayReturns]]]" = []
        self._cast_at = b""
        self._known: Dict[str, Entity] = {}
        self._revision = -1
        self._surroundings: Tuple[Any, ...] = ()
        self._scenery: Tuple[List[Any], List[Any]] = ([], [])
        self._resolver: Any = None

    def cast(self, mount: Mount, fan: Union[RayFan, RayBundle], visuals: bool, ns: int,
             rows: bytes) -> "Future[RayReturns]":
        """Return the future ranges; `send` sends the request.

        Casts of the same step are sent as one request.

        Args:
            mount: where the sensor is.
            fan: its rays.
            visuals: rays hit visuals, else collisions.
            ns: sim time of the rows.
            rows: of all links, as in the ring.
        """
        self._update()
        if visuals:
            self._send_scenery()
        future: "Future[RayReturns]" = Future()
        if rows != self._cast_at:
            self.send()
            self._cast_at = rows
        self._casts.append((CastRays(mount, fan, VISUALS if visuals else COLLISIONS, ns=ns),
                            future))
        return future

    def send(self) -> None:
        """Send the casts that were requested."""
        if not self._casts:
            return
        casts, self._casts = self._casts, []
        futures = [future for _, future in casts]
        batch = CastBatch(tuple(cast for cast, _ in casts), self._cast_at)
        rays, _ = self._update()
        rays.cast_all(batch).add_done_callback(lambda done: _set_results(done, futures))

    def render(self, shots: Sequence[Shot], ns: int, rows: bytes) -> "List[Future[Pictures]]":
        """Pictures, one of each shot; of the rows of all links, as of a sim time (ns)."""
        _, cameras = self._update()
        self._send_surroundings()
        self._send_scenery()
        return [cameras.render(RenderCamera(mount, camera, outputs, rows, ns))
                for mount, camera, outputs in shots]

    def close(self) -> None:
        for process in self._processes or ():
            process.close()
        self._processes = None

    def _update(self) -> "Tuple[SensingProcess, SensingProcess]":
        """The processes for rays and for pictures, told of the models."""
        if self._processes is None:
            from ..appearance.materials import Materials
            from ..appearance.textures import TextureFiles
            from ..resources.resolver import Resolver
            from ..sensing.process import SensingProcess

            resolver = self._resolver = Resolver.from_environment()
            self._materials = Materials(resolver, TextureFiles(resolver))
            self._processes = SensingProcess("lasers"), SensingProcess("cameras")
            for process in self._processes:
                process.on_problem(lambda text: self._log(warning("sensing", text)))
        revision, entities = self._simulator.models.inventory()
        if revision != self._revision:
            self._revision = revision
            self._send_models({entity.model.name: entity for entity in entities})
        return self._processes

    def _change(self, change: Change) -> None:
        for process in self._processes or ():
            process.change(change)

    def _send_models(self, present: Dict[str, Entity]) -> None:
        from ..sensing.scene import body

        for name in [name for name in self._known if name not in present]:
            self._change(RemoveBody(name))
        for name, entity in present.items():
            if self._known.get(name) is not entity:
                self._change(AddBody(body(name, entity.model, entity.first_link_row,
                                          self._materials)))
        self._known = present

    def _send_surroundings(self) -> None:
        """Send the lights and the scene if they have changed."""
        world = self._simulator.world
        lights, scene = world.lights, world.scene
        if not self._surroundings or self._surroundings[0] is not lights \
                or self._surroundings[1] is not scene:
            self._surroundings = (lights, scene)
            self._change(SetLights(list(lights), scene))

    def _send_scenery(self) -> None:
        """Send roads and actors if they have changed."""
        world = self._simulator.world
        if self._scenery[0] is world.roads and self._scenery[1] is world.actors:
            return
        before, self._scenery = self._scenery, (world.roads, world.actors)
        if any((*before, *self._scenery)):
            from ..sensing.scene import scenery

            self._change(scenery(world, self._materials, self._resolver))


def _set_results(done: "Future[List[Union[RayReturns, SensingError]]]",
              futures: "List[Future[RayReturns]]") -> None:
    """Give each of the futures its part of an answer, or the fault of all."""
    fault = done.exception()
    found: Sequence[Any] = [fault] * len(futures) if fault is not None else done.result()
    for future, one in zip(futures, found):
        if isinstance(one, BaseException):
            future.set_exception(one)
        else:
            future.set_result(one)
