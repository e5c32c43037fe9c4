#!/usr/bin/env python3
"""Prints what rays and pictures cost. Run it in a shell that has sourced the workspace.

usage: sensing.py [ROW …]   rows: rays scan wide_scan lidar camera small memory (default: all)

Processor time is that of the sensing process, all its threads, unless a row says more. Nothing here
fails on a slow machine.
"""
from __future__ import annotations

import math
import statistics
import time
from typing import Callable, List, Tuple

import numpy as np
from row_table import Row, Rows, shown
from server import processor, proportional

from my_simulations.appearance.looks import Look
from my_simulations.description.light import Light
from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import (
    Box,
    Collision,
    Cylinder,
    Geometry,
    Plane,
    Sphere,
    Visual,
)
from my_simulations.geometry import Pose
from my_simulations.sensing.api import (
    DEPTH,
    RGB,
    Body,
    CameraSpec,
    CastBatch,
    CastRays,
    LoadScene,
    Mount,
    RayFan,
    RenderCamera,
)
from my_simulations.sensing.process import SensingProcess

BODIES = 100
PATTERNS = ("bricks", "wood", "wood_floor", "painted_wall")
EYE = Mount(pose=Pose((0.0, 0.0, 0.3)))


def body(name: str, geometry: Geometry, row: int, pattern: str = "") -> Body:
    link = Link("link", collisions=[Collision("c", geometry)], visuals=[Visual("v", geometry)])
    look = Look(pattern=pattern, diffuse=(1.0, 1.0, 1.0, 1.0))
    return Body(name, Model(name, links=[link]), row, {(0, 0): look} if pattern else {})


def moving(count: int = BODIES) -> List[Body]:
    shapes = (Box((0.4, 0.4, 0.6)), Sphere(0.25), Cylinder(0.2, 0.6))
    return [body("ground", Plane(size=(100, 100)), count)] + [
        body(f"m{n}", shapes[n % 3], n) for n in range(count)]


def furnished() -> List[Body]:
    """A room of four textured walls and a floor, with 30 things in it."""
    walls = [body("floor", Plane(size=(10, 10)), 0, "wood_floor")] + [
        body(f"wall{n}", Box((10, 0.1, 3) if n < 2 else (0.1, 10, 3)), 1 + n, "bricks")
        for n in range(4)]
    shapes = (Box((0.5, 0.4, 0.6)), Sphere(0.3), Cylinder(0.2, 0.8))
    return walls + [body(f"thing{n}", shapes[n % 3], 5 + n, PATTERNS[n % 4]) for n in range(30)]


def room_places() -> List[Tuple[float, float, float]]:
    draws = np.random.default_rng(1)
    walls = [(0, 0, 0), (0, 5, 1.5), (0, -5, 1.5), (5, 0, 1.5), (-5, 0, 1.5)]
    return walls + [(float(draws.uniform(1, 4.5)), float(draws.uniform(-4, 4)), 0.3)
                    for _ in range(30)]


def rows_of(places: List[Tuple[float, float, float]]) -> bytes:
    table = np.zeros((len(places), 13))
    table[:, :3], table[:, 6] = places, 1.0
    return table.tobytes()


def crowd(shift: float, count: int = BODIES) -> bytes:
    draws = np.random.default_rng(2)
    places = [(float(x), float(y), 0.3 + shift)
              for x, y in draws.uniform(-8, 8, (count, 2))] + [(0.0, 0.0, 0.0)]
    return rows_of(places)


class Sensed:
    """A process with a scene, and what it has cost."""

    def __init__(self, bodies: List[Body], light: bool = False) -> None:
        self.sensing = SensingProcess()
        sun = Light("sun", "directional", Pose((0, 0, 10)), True, direction=(-0.4, 0.3, -1.0))
        self.sensing.change(LoadScene(bodies, [sun] if light else []))

    def __enter__(self) -> "Sensed":
        return self

    def __exit__(self, *_fault: object) -> None:
        self.sensing.close()

    def each(self, ask: Callable[[int], object], count: int) -> Tuple[float, float]:
        """Processor seconds of a request in the process, and median wall seconds here."""
        for n in range(3):
            ask(n)
        before, walls = processor([self.sensing.pid]), []
        for n in range(count):
            began = time.perf_counter()
            ask(3 + n)
            walls.append(time.perf_counter() - began)
        return (processor([self.sensing.pid]) - before) / count, statistics.median(walls)


def rays() -> List[Row]:
    count = 100_000
    fan = RayFan(count, -math.pi, math.pi)
    with Sensed(moving()) as sensed:
        cost, _ = sensed.each(lambda n: sensed.sensing.cast(
            CastRays(EYE, fan, at=crowd(1e-4 * n))).result(), 20)
    return [(f"rays a second of a core, {BODIES} moving bodies", f"{count / cost / 1e6:.2f} M",
             "1 M", count / cost >= 1e6)]


def scan() -> List[Row]:
    fan = RayFan(360, -math.pi, math.pi)
    with Sensed(moving()) as sensed:
        states = [crowd(1e-4 * n) for n in range(503)]
        cost, wall = sensed.each(lambda n: sensed.sensing.cast(
            CastRays(EYE, fan, at=states[n])).result(), 500)
    return [(f"scan of 360 rays, {BODIES} moved bodies, processor", f"{cost * 1e3:.2f} ms",
             "0.6 ms", cost <= 0.6e-3),
            ("  asked and answered, wall", f"{wall * 1e3:.2f} ms", "–", True)]


def wide_scan() -> List[Row]:
    """A scan as the node asks for it: with the positions of all links, ten moving bodies."""
    fan, count = RayFan(640, -math.pi / 2.0, math.pi / 2.0), 1000
    with Sensed(moving(10)) as sensed:
        states = [crowd(1e-4 * n, 10) for n in range(count + 3)]
        began = time.process_time()
        cost, _ = sensed.each(lambda n: sensed.sensing.cast_all(
            CastBatch((CastRays(EYE, fan),), states[n])).result(), count)
        asking = (time.process_time() - began) / count
    return [("scan of 640 rays, 10 moved bodies, processor of both processes",
             f"{(cost + asking) * 1e3:.2f} ms", "0.27 ms", cost + asking <= 0.27e-3),
            ("  asking alone, with the pickled positions", f"{asking * 1e3:.2f} ms", "–", True)]


def lidar() -> List[Row]:
    fan = RayFan(1800, -math.pi, math.pi, 16, -0.26, 0.26, far=30.0)
    with Sensed(moving()) as sensed:
        cost, wall = sensed.each(lambda n: sensed.sensing.cast(
            CastRays(EYE, fan, at=crowd(1e-4 * n))).result(), 40)
    return [("3D lidar 16 x 1800 at 10 Hz, processor", f"{cost * 1e3:.1f} ms", "100 ms",
             cost <= 0.1), ("  asked and answered, wall", f"{wall * 1e3:.1f} ms", "–", True)]


def _pictures(title: str, spec: CameraSpec, outputs: Tuple[str, ...], bar: float) -> Row:
    places = room_places()
    with Sensed(furnished(), light=True) as sensed:
        def ask(n: int) -> object:
            moved = [*places[:-1], (2.0, 0.01 * n, 0.3)]
            eye = Mount(pose=Pose((-4.0, 0.002 * n, 1.0)))
            return sensed.sensing.render(RenderCamera(eye, spec, outputs, rows_of(moved))).result()

        cost, _ = sensed.each(ask, 30)
    return title, f"{cost * 1e3:.0f} ms, {1 / cost:.0f} Hz", f"{bar:g} Hz", 1 / cost >= bar


def camera() -> List[Row]:
    spec = CameraSpec(640, 480)
    return [_pictures("camera 640x480, textures, moving shadow, of a core", spec, (RGB,), 15),
            _pictures("depth 640x480, of a core", spec, (DEPTH,), 30)]


def small() -> List[Row]:
    return [_pictures("camera 320x240, textures, moving shadow, of a core", CameraSpec(), (RGB,),
                      30)]


def memory() -> List[Row]:
    places = rows_of(room_places())
    with Sensed(furnished()) as rays, Sensed(furnished(), light=True) as cameras:
        rays.sensing.cast(CastRays(EYE, RayFan(360, -3.0, 3.0), at=places)).result()
        cameras.sensing.render(RenderCamera(EYE, CameraSpec(640, 480), (RGB, DEPTH),
                                            places)).result()
        of_rays, whole = (proportional(pids) for pids in (
            [rays.sensing.pid], [rays.sensing.pid, cameras.sensing.pid]))
    return [("memory of the process for rays", f"{of_rays:.0f} MB", "–", True),
            ("memory of the processes for rays and for cameras", f"{whole:.0f} MB", "200 MB",
             whole <= 200)]


ROWS: Rows = {
    "rays": rays, "scan": scan, "wide_scan": wide_scan, "lidar": lidar, "camera": camera,
    "small": small, "memory": memory}


if __name__ == "__main__":
    shown(ROWS)
