"""The child's inside: one thread receives and copies poses, one casts rays, one draws."""
from __future__ import annotations

import os
import queue
import threading
import traceback
from typing import Any, Callable, Dict, List, Optional, Tuple, Union

import numpy as np

from ..appearance.looks import Look
from ..engine.message_pipe import Wire
from ..engine.ring import RingReader
from .api import (
    COLLISIONS,
    PROBLEM,
    READY,
    VISUALS,
    WORLD_ROW,
    At,
    Body,
    CastBatch,
    CastRays,
    Change,
    Mount,
    Pictures,
    RayBundle,
    RayReturns,
    RenderCamera,
    SensingError,
    SnapshotOverwrittenError,
)
from .poses import matrices, matrix, rows_of
from .scene import SceneState

_FAULT = 70

State = Tuple[np.ndarray, int]
"""Poses (n, 7) by link row, and the step count."""


class Service:
    """Answers until the parent hangs up."""

    def __init__(self, wire: Wire, ring: Optional[RingReader]) -> None:
        self._wire = wire
        self._ring = ring
        self._sending = threading.Lock()
        # Rays are short: a request that brings its rows is spared the way to another thread. One
        # that names a state of the ring is copied from there while others are cast.
        self._rays = _Worker("rays", _Rays(self.report_problem), self._reply, at_once=ring is None)
        self._camera = _Worker("camera", _Camera(self.report_problem), self._reply)

    def run(self) -> None:
        """Receive; what each request is to see is copied before the next is looked at."""
        self._reply(READY, None)
        while True:
            try:
                messages = self._wire.receive(3600.0)
            except (EOFError, OSError):
                return
            for number, message in messages:
                self._dispatch(number, message)

    def _dispatch(self, number: int, message: Any) -> None:
        if number == 0:
            self._rays.put(0, message, None)
            self._camera.put(0, message, None)
            return
        try:
            state = self._state(message.at)
        except SensingError as fault:
            self._reply(number, fault)
            return
        worker = self._rays if isinstance(message, (CastRays, CastBatch)) else self._camera
        worker.put(number, message, state)

    def _state(self, at: At) -> State:
        if isinstance(at, bytes):
            return rows_of(at), -1
        if self._ring is None:
            raise SensingError("this simulation has no shared states: requests must bring rows")
        if at is None:
            step, _, rows = self._ring.raw_poses()
            return rows_of(rows), step
        found = self._ring.earlier_links(at)
        if found is None:
            raise SnapshotOverwrittenError(f"state {at} is gone, the simulation runs too far ahead")
        return rows_of(found[1]), found[0]

    def _reply(self, number: int, answer: object) -> None:
        with self._sending:
            try:
                self._wire.send((number, answer))
            except OSError:
                return  # the parent is gone: `run` sees it, too

    def report_problem(self, text: str) -> None:
        """Report to the parent what is left out."""
        self._reply(PROBLEM, text)


class _Worker:
    """A thread with a queue; it begins with the first request. Changes before are taken at once:
    they only describe what the first request will find, and no thread empties the queue yet.

    `at_once`: there is no thread; `put` does the work itself.
    """

    def __init__(self, name: str, viewer: "Union[_Rays, _Camera]",
                 reply: Callable[[int, object], None], at_once: bool = False) -> None:
        self._name = name
        self._viewer = viewer
        self._reply = reply
        self._at_once = at_once
        self._queue: "queue.Queue[Tuple[int, Any, Optional[State]]]" = queue.Queue()
        self._thread: Optional[threading.Thread] = None

    def put(self, number: int, message: object, state: Optional[State]) -> None:
        if self._at_once or (not number and self._thread is None):
            self._work(number, message, state)
            return
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name=self._name, daemon=True)
            self._thread.start()
        self._queue.put((number, message, state))

    def _run(self) -> None:
        while True:
            self._work(*self._queue.get())

    def _work(self, number: int, message: Any, state: Optional[State]) -> None:
        try:
            if state is None:
                self._viewer.change(message)
            else:
                self._reply(number, self._viewer.answer(message, state))
        except SensingError as fault:
            self._reply(number, fault)
        except Exception:  # a fault of ours: the parent starts another process
            traceback.print_exc()
            os._exit(_FAULT)


class _Rays:
    """Two scenes, each made with the first ray that looks at it."""

    def __init__(self, trouble: Callable[[str], None]) -> None:
        self._trouble = trouble
        self._world = SceneState()
        self._embree: Any = None
        self._scenes: Dict[str, Any] = {}
        self._fans: Dict[Any, np.ndarray] = {}

    def change(self, change: Change) -> None:
        before = self._world.bodies
        self._world.bodies = dict(before)
        self._world.apply(change)
        for sees, scene in self._scenes.items():
            for name in before:
                if self._world.bodies.get(name) is not before[name]:
                    scene.remove(name)
            for name, body in self._world.bodies.items():
                if before.get(name) is not body:
                    self._add(scene, sees, body)
            if sees == VISUALS:
                scene.set_scenery(self._world.scenery)

    def answer(self, request: Union[CastRays, CastBatch],
               state: State) -> Union[RayReturns, List[Union[RayReturns, SensingError]]]:
        if isinstance(request, CastRays):
            return self._cast(request, state)
        found: List[Union[RayReturns, SensingError]] = []
        for one in request.casts:
            try:
                found.append(self._cast(one, state))
            except SensingError as fault:
                found.append(fault)
        return found

    def _cast(self, request: CastRays, state: State) -> RayReturns:
        scene = self._scenes.get(request.sees) or self._made(request.sees)
        poses, step = state
        frame = sensor_frame(request.mount, poses)
        rays = request.rays
        if isinstance(rays, RayBundle):
            directions = np.asarray(rays.directions, dtype=np.float64)
            origins = np.asarray(rays.origins, dtype=np.float64) @ frame[:3, :3].T + frame[:3, 3]
        else:
            directions, origins = self._fan(rays), frame[:3, 3]
        scene.move(poses, request.ns)
        if not len(directions):
            return RayReturns(np.zeros(0), np.zeros(0, np.float32), np.zeros(0, np.int32), step)
        ranges, retro, rows = scene.cast(origins, directions @ frame[:3, :3].T, rays.near, rays.far)
        return RayReturns(ranges, retro, rows, step)

    def _fan(self, fan: Any) -> np.ndarray:
        found = self._fans.get(fan)
        if found is None:
            from .rays.fan import fan_directions

            found = self._fans[fan] = fan_directions(
                fan.samples, fan.min_angle, fan.max_angle, fan.rows, fan.min_elevation,
                fan.max_elevation)
        return found

    def _made(self, sees: str) -> Any:
        from .rays.embree import Embree
        from .rays.ray_scene import RayScene

        self._embree = self._embree or Embree()
        scene = self._scenes[sees] = RayScene(self._embree, self._trouble)
        for body in self._world.bodies.values():
            self._add(scene, sees, body)
        if sees == VISUALS:
            scene.set_scenery(self._world.scenery)
        return scene

    @staticmethod
    def _add(scene: Any, sees: str, body: Body) -> None:
        from .rays.ray_shapes import RayShape

        links: List[Tuple[int, List[RayShape]]] = []
        for n, link in enumerate(body.model.links):
            if sees == COLLISIONS:
                shapes = [RayShape(one.geometry, one.pose, one.laser_retro, endless=True)
                          for one in link.collisions]
            else:
                shapes = [RayShape(one.geometry, one.pose, one.laser_retro,
                                   double_sided=_is_double_sided(body.looks.get((n, m))))
                          for m, one in enumerate(link.visuals) if one.transparency < 1.0]
            links.append((body.first_link_row + n, shapes))
        scene.add(body.name, links)


class _Camera:
    """One renderer, made with the first picture."""

    def __init__(self, trouble: Callable[[str], None]) -> None:
        self._trouble = trouble
        self._world = SceneState()
        self._renderer: Any = None

    def change(self, change: Change) -> None:
        before = self._world.bodies
        self._world.bodies = dict(before)
        self._world.apply(change)
        if self._renderer is None:
            return
        for name in before:
            if self._world.bodies.get(name) is not before[name]:
                self._renderer.remove(name)
        for name, body in self._world.bodies.items():
            if before.get(name) is not body:
                self._renderer.add(body)
        self._renderer.set_lights(self._world.lights, self._world.scene)
        self._renderer.set_scenery(self._world.scenery)

    def answer(self, request: RenderCamera, state: State) -> Pictures:
        if self._renderer is None:
            from .camera.renderer import Renderer

            self._renderer = Renderer(self._trouble)
            for body in self._world.bodies.values():
                self._renderer.add(body)
            self._renderer.set_lights(self._world.lights, self._world.scene)
            self._renderer.set_scenery(self._world.scenery)
        poses, step = state
        frame = sensor_frame(request.mount, poses)
        pictures: Pictures = self._renderer.render(request.camera, frame, poses, request.outputs,
                                                   step, request.ns)
        return pictures


def _is_double_sided(look: Optional[Look]) -> bool:
    return look is not None and look.double_sided


def sensor_frame(mount: Mount, poses: np.ndarray) -> np.ndarray:
    """World from sensor, (4, 4). Raises SensingError for a link that the state does not have."""
    if mount.row == WORLD_ROW:
        return matrix(mount.pose)
    if not 0 <= mount.row < len(poses):
        raise SensingError(f"the state has no link {mount.row}: the sensor's model is not in it")
    frame: np.ndarray = matrices(poses[mount.row:mount.row + 1])[0] @ matrix(mount.pose)
    return frame
