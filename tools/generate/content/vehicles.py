"""Motor vehicles. They face +x, and their wheels do not turn."""

from __future__ import annotations

import math
from typing import Iterator, List, Sequence, Tuple

import numpy as np

from .meshes import Mesh, ball, block, lathe, level, loft, plate, rod, rounded, standing, tube
from .model import Model


def models() -> Iterator[Model]:
    yield from (car(), van(), pickup(), bus(), forklift())


def wheel(radius: float, width: float, at: Tuple[float, float, float]) -> List[Tuple[str, Mesh]]:
    """A tyre and its rim, the axle along y."""
    half = width / 2
    tyre = lathe(
        [
            (radius * 0.6, -half),
            (radius * 0.93, -half),
            (radius, -half * 0.6),
            (radius, half * 0.6),
            (radius * 0.93, half),
            (radius * 0.6, half),
        ],
        22,
    )
    rim = lathe(
        [
            (radius * 0.6, -half * 0.9),
            (radius * 0.55, -half * 0.8),
            (radius * 0.2, -half * 1.02),
            (radius * 0.2, half * 1.02),
            (radius * 0.55, half * 0.8),
            (radius * 0.6, half * 0.9),
        ],
        14,
    )
    return [
        ("rubber", tyre.turned(math.pi / 2).moved(*at)),
        ("light_grey", rim.turned(math.pi / 2).moved(*at)),
    ]


def axles(model: Model, places: Sequence[float], track: float, radius: float, width: float) -> None:
    """Pairs of wheels at these x; they collide as cylinders."""
    for x in places:
        for y in (track / 2, -track / 2):
            at = (x, y, radius)
            model.parts += wheel(radius, width, at)
            model.cylinder(radius, width, at, (math.pi / 2, 0, 0))


def ring(x: float, shift: float, y: float, z: float, corner: float = 0.12) -> np.ndarray:
    """A horizontal rectangle with round corners of size (x, y), its centre at (shift, 0, z)."""
    return level(rounded(x, y, corner, 3), z) + (shift, 0, 0)


def lights(model: Model, front: float, rear: float, y: float, z: float) -> None:
    """Head and tail lamps on both sides."""
    for side in (y, -y):
        model.look("light", block((0.06, 0.3, 0.12), (front, side, z), 0.03))
        model.look("red", block((0.06, 0.24, 0.14), (rear, side, z + 0.05), 0.025))


def car() -> Model:
    model = Model("car", "Car", "A small car of 4 x 1.75 x 1.45 m. It is static.")
    model.look(
        "blue",
        loft(
            [
                ring(3.7, 0, 1.6, 0.2),
                ring(3.98, 0, 1.74, 0.34),
                ring(4.0, 0, 1.75, 0.6),
                ring(3.8, 0, 1.68, 0.8),
                ring(3.55, -0.02, 1.56, 0.88),
            ]
        ),
    )
    model.look("glass", loft([ring(2.7, -0.25, 1.5, 0.86), ring(1.75, -0.3, 1.28, 1.36)]))
    model.look(
        "blue",
        loft(
            [
                ring(1.78, -0.3, 1.3, 1.355),
                ring(1.74, -0.3, 1.27, 1.41),
                ring(1.5, -0.3, 1.05, 1.45),
            ]
        ),
    )
    for y in (1, -1):
        for x, lean in ((0.93, -0.42), (-0.28, -0.02), (-1.5, 0.36)):
            model.look(
                "blue", rod((x, 0.745 * y, 0.87), (x + lean, 0.64 * y, 1.38), 0.035, 0.03, 8)
            )
        model.look("blue", block((0.12, 0.2, 0.12), (0.75, 0.9 * y, 0.95), 0.04))
        model.look(
            "dark_grey",
            block((0.16, 0.02, 0.03), (-0.1, 0.865 * y, 0.72), 0.008),
            block((2.0, 0.03, 0.1), (0, 0.85 * y, 0.25), 0.012),
        )
    model.look(
        "dark_grey",
        block((0.08, 1.1, 0.16), (1.965, 0, 0.38), 0.03),
        block((0.08, 1.2, 0.14), (-1.965, 0, 0.36), 0.03),
    )
    model.look(
        "white",
        block((0.02, 0.5, 0.11), (2.01, 0, 0.38), 0.004),
        block((0.02, 0.5, 0.11), (-1.995, 0, 0.52), 0.004),
    )
    lights(model, 1.985, -1.985, 0.62, 0.6)
    model.box((4.0, 1.75, 0.68), (0, 0, 0.54))
    model.box((2.2, 1.4, 0.57), (-0.28, 0, 1.165))
    axles(model, (1.25, -1.25), 1.56, 0.31, 0.22)
    return model


def van() -> Model:
    model = Model("van", "Van", "A delivery van of 5.2 x 2 x 2.3 m. It is static.")
    model.look(
        "white",
        loft(
            [
                ring(5.0, 0, 1.88, 0.28),
                ring(5.2, 0, 2.0, 0.42),
                ring(5.2, 0, 2.0, 0.95),
                ring(4.9, -0.13, 1.98, 1.15),
            ]
        ),
        loft(
            [ring(4.25, -0.45, 1.96, 1.14), ring(3.55, -0.8, 1.9, 2.2), ring(3.4, -0.85, 1.75, 2.3)]
        ),
    )
    model.look(
        "glass",
        standing(plate([(0.9, 1.25), (1.55, 1.25), (1.05, 1.85), (0.9, 1.85)], 1.985)),
        loft([ring(0.3, 1.42, 1.6, 1.25, 0.05), ring(0.3, 1.0, 1.5, 2.0, 0.05)]),
    )
    model.look("orange", block((2.6, 2.01, 0.28), (-1.05, 0, 1.25), 0.01))
    model.look(
        "dark_grey",
        block((0.1, 1.9, 0.2), (2.58, 0, 0.45), 0.04),
        block((0.1, 1.9, 0.18), (-2.58, 0, 0.42), 0.04),
        block((0.02, 1.2, 0.18), (2.6, 0, 0.72), 0.008),
    )
    for y in (1, -1):
        model.look("dark_grey", block((0.14, 0.2, 0.3), (1.4, 1.08 * y, 1.4), 0.03))
    lights(model, 2.59, -2.59, 0.78, 0.8)
    model.box((5.2, 2.0, 0.87), (0, 0, 0.715))
    model.box((3.9, 1.94, 1.15), (-0.65, 0, 1.725))
    axles(model, (1.6, -1.6), 1.74, 0.36, 0.24)
    return model


def pickup() -> Model:
    model = Model("pickup", "Pickup", "A pickup of 5.2 x 1.9 x 1.75 m. It is static.")
    model.look(
        "red",
        loft(
            [
                ring(5.0, 0, 1.78, 0.4),
                ring(5.2, 0, 1.9, 0.5),
                ring(5.2, 0, 1.9, 0.9),
                ring(5.1, 0, 1.84, 0.98),
            ]
        ),
    )
    model.look("red", loft([ring(1.5, 1.7, 1.76, 0.97), ring(1.35, 1.66, 1.6, 1.08)]))
    model.look("glass", loft([ring(2.2, 0.15, 1.72, 0.97), ring(1.35, 0.1, 1.46, 1.62)]))
    model.look(
        "red",
        loft([ring(1.4, 0.1, 1.5, 1.61), ring(1.36, 0.1, 1.46, 1.68), ring(1.1, 0.1, 1.2, 1.74)]),
    )
    for y in (1, -1):
        model.look(
            "red",
            block((1.65, 0.1, 0.28), (-1.72, 0.89 * y, 1.1), 0.03),
            block((0.14, 0.2, 0.16), (1.0, 1.0 * y, 1.1), 0.04),
        )
        for x, lean in ((1.15, -0.4), (0.1, -0.02), (-0.9, 0.3)):
            model.look("red", rod((x, 0.85 * y, 0.98), (x + lean, 0.73 * y, 1.64), 0.04, 0.035, 8))
    model.look("red", block((0.1, 1.86, 0.28), (-2.52, 0, 1.1), 0.03))
    model.look(
        "dark_grey",
        block((1.55, 1.66, 0.02), (-1.7, 0, 0.985), 0.005),
        block((0.1, 1.5, 0.24), (2.57, 0, 0.72), 0.03),
        block((0.12, 1.9, 0.16), (2.6, 0, 0.5), 0.04),
    )
    lights(model, 2.585, -2.59, 0.75, 0.75)
    model.box((5.2, 1.9, 0.58), (0, 0, 0.69))
    model.box((3.3, 1.7, 0.7), (0.9, 0, 1.33))
    for y in (0.89, -0.89):
        model.box((1.7, 0.1, 0.26), (-1.72, y, 1.11))
    model.box((0.1, 1.7, 0.26), (-2.52, 0, 1.11))
    axles(model, (1.65, -1.6), 1.62, 0.4, 0.26)
    return model


def bus() -> Model:
    model = Model("bus", "Bus", "A city bus of 11 x 2.5 x 3 m. It is static.")
    model.look(
        "yellow",
        loft(
            [
                ring(10.8, 0, 2.4, 0.3),
                ring(11, 0, 2.5, 0.45),
                ring(11, 0, 2.5, 1.3),
                ring(10.95, 0, 2.46, 1.34),
            ]
        ),
        loft([ring(10.8, 0, 2.44, 2.35), ring(10.8, 0, 2.44, 2.75), ring(10.5, 0, 2.2, 2.95)]),
    )
    model.look("glass", loft([ring(10.85, 0, 2.42, 1.32), ring(10.7, 0, 2.38, 2.37)]))
    for k in range(8):
        model.look("yellow", block((0.1, 2.46, 1.05), (-4.9 + 1.35 * k, 0, 1.83), 0.02))
    model.look("white", block((7.0, 2.51, 0.16), (-0.4, 0, 0.95), 0.01))
    for x in (3.9, -0.2):
        model.look("glass", block((1.1, 0.02, 1.85), (x, -1.25, 1.35), 0.005))
    model.look(
        "black",
        block((0.02, 1.6, 0.24), (5.42, 0, 2.56), 0.006),
        block((0.1, 2.3, 0.25), (5.46, 0, 0.5), 0.04),
        block((0.1, 2.3, 0.25), (-5.46, 0, 0.5), 0.04),
    )
    lights(model, 5.48, -5.48, 0.95, 0.8)
    model.box((11, 2.5, 2.55), (0, 0, 1.625))
    axles(model, (3.4, -3.2), 2.2, 0.48, 0.3)
    return model


def forklift() -> Model:
    model = Model(
        "forklift", "Forklift", "A counterbalance forklift of 3.2 x 1.2 x 2.1 m. It is static."
    )
    model.look(
        "orange",
        loft(
            [
                ring(1.9, -0.15, 1.1, 0.2),
                ring(1.95, -0.15, 1.16, 0.4),
                ring(1.9, -0.17, 1.14, 0.72),
                ring(1.2, -0.5, 1.05, 0.98),
            ]
        ),
    )
    model.look(
        "dark_grey",
        block((0.5, 0.5, 0.12), (-0.25, 0, 1.02), 0.05),
        block((0.14, 0.5, 0.5), (-0.5, 0, 1.3), 0.05),
        rod((0.25, 0, 0.8), (0.12, 0, 1.2), 0.03),
    )
    wheel_ring = [
        (0.1 + 0.06 * math.sin(a), 0.17 * math.cos(a), 1.21 + 0.16 * math.sin(a))
        for a in np.arange(14) * 2 * math.pi / 14
    ]
    model.look("black", tube(wheel_ring, 0.014, 6, closed=True))
    for y in (0.48, -0.48):
        model.look(
            "dark_grey",
            tube([(0.62, y, 0.7), (0.35, y, 2.05), (-0.85, y, 2.05), (-1.0, y, 0.9)], 0.035, 8),
        )
    for k in range(5):
        model.look("dark_grey", block((0.05, 0.98, 0.03), (0.3 - 0.27 * k, 0, 2.06), 0.01))
    for y in (0.3, -0.3):
        model.look(
            "steel",
            block((0.12, 0.1, 1.95), (0.92, y, 1.07), 0.02),
            block((1.05, 0.12, 0.04), (1.52, y, 0.08), 0.012),
            block((0.05, 0.12, 0.5), (1.02, y, 0.3), 0.012),
        )
        model.box((1.05, 0.12, 0.04), (1.52, y, 0.08))
        model.look("light", ball(0.06, (0.66, y * 1.5, 0.85), 8))
    model.look("black", block((0.04, 0.8, 0.34), (1.0, 0, 0.4), 0.01))
    model.box((0.16, 0.72, 1.95), (0.94, 0, 1.075))
    model.box((1.95, 1.16, 0.8), (-0.15, 0, 0.62))
    model.box((1.4, 1.06, 1.06), (-0.25, 0, 1.55))
    axles(model, (0.55, -0.8), 1.0, 0.28, 0.2)
    return model
