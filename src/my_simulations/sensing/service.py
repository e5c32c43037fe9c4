"""The child's inside: it casts rays and draws, one request after the other."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional, Tuple, Union

import numpy as np

from ..appearance.looks import Look
from ..engine.message_pipe import Wire
from .api import (
    COLLISIONS,
    PROBLEM,
    READY,
    VISUALS,
    WORLD_ROW,
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
)
from .poses import matrices, matrix, rows_of
from .scene import SceneState


class Service:
    """Answers until the parent hangs up."""

    def __init__(self, wire: Wire) -> None:
        self._wire = wire
        self._rays = _Rays(self.report_problem)
        self._camera = _Camera(self.report_problem)

    def run(self) -> None:
        """Receive changes of the scene and requests, and answer these."""
        self._reply(READY, None)
        while True:
            try:
                messages = self._wire.receive(3600.0)
            except (EOFError, OSError):
                return
            for number, message in messages:
                if number:
                    self._answer(number, message)
                else:
                    self._rays.change(message)
                    self._camera.change(message)

    def _answer(self, number: int, message: Any) -> None:
        viewer: Union[_Rays, _Camera] = (
            self._camera if isinstance(message, RenderCamera) else self._rays)
        try:
            self._reply(number, viewer.answer(message, rows_of(message.at)))
        except SensingError as fault:
            self._reply(number, fault)

    def _reply(self, number: int, answer: object) -> None:
        try:
            self._wire.send((number, answer))
        except OSError:
            return  # the parent is gone: `run` sees it, too

    def report_problem(self, text: str) -> None:
        """Report to the parent what is left out."""
        self._reply(PROBLEM, text)


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
               poses: np.ndarray) -> Union[RayReturns, List[Union[RayReturns, SensingError]]]:
        if isinstance(request, CastRays):
            return self._cast(request, poses)
        found: List[Union[RayReturns, SensingError]] = []
        for one in request.casts:
            try:
                found.append(self._cast(one, poses))
            except SensingError as fault:
                found.append(fault)
        return found

    def _cast(self, request: CastRays, poses: np.ndarray) -> RayReturns:
        scene = self._scenes.get(request.sees) or self._made(request.sees)
        frame = sensor_frame(request.mount, poses)
        rays = request.rays
        if isinstance(rays, RayBundle):
            directions = np.asarray(rays.directions, dtype=np.float64)
            origins = np.asarray(rays.origins, dtype=np.float64) @ frame[:3, :3].T + frame[:3, 3]
        else:
            directions, origins = self._fan(rays), frame[:3, 3]
        scene.move(poses, request.ns)
        if not len(directions):
            return RayReturns(np.zeros(0), np.zeros(0, np.float32), np.zeros(0, np.int32))
        ranges, retro, rows = scene.cast(origins, directions @ frame[:3, :3].T, rays.near, rays.far)
        return RayReturns(ranges, retro, rows)

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

    def answer(self, request: RenderCamera, poses: np.ndarray) -> Pictures:
        if self._renderer is None:
            from .camera.renderer import Renderer

            self._renderer = Renderer(self._trouble)
            for body in self._world.bodies.values():
                self._renderer.add(body)
            self._renderer.set_lights(self._world.lights, self._world.scene)
            self._renderer.set_scenery(self._world.scenery)
        pictures: Pictures = self._renderer.render(
            request.camera, sensor_frame(request.mount, poses), poses, request.outputs, request.ns)
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
