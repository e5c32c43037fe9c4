"""Vehicles that people push or ride. They face +x, and their wheels do not turn."""
from __future__ import annotations

import math
from typing import Iterator

import numpy as np

from .meshes import ball, block, lathe, rod, tube
from .model import Model
from .vehicles import wheel


def models() -> Iterator[Model]:
    yield from (bicycle(), kick_scooter(), pallet_truck(), hand_cart(), wheelchair())


def bicycle() -> Model:
    model = Model("bicycle", "Bicycle", "A bicycle on its side stand. It is static.")
    front, rear, r = (0.52, 0.0, 0.34), (-0.52, 0.0, 0.34), 0.325
    for x, _, z in (front, rear):
        circle = [
            (x + r * math.cos(a), 0.0, z + r * math.sin(a))
            for a in np.arange(22) * 2 * math.pi / 22
        ]
        model.look("rubber", tube(circle, 0.016, 6, closed=True))
        for k in range(8):
            a = math.pi * k / 8
            model.look(
                "steel",
                rod(
                    (x - r * math.cos(a), 0, z - r * math.sin(a)),
                    (x + r * math.cos(a), 0, z + r * math.sin(a)),
                    0.003,
                    0,
                    4,
                ),
            )
        model.cylinder(0.34, 0.04, (x, 0, z), (math.pi / 2, 0, 0))
    crank, seat, head = (-0.08, 0.0, 0.3), (-0.26, 0.0, 0.78), (0.33, 0.0, 0.78)
    for a, b in ((crank, seat), (seat, head), (crank, (0.36, 0, 0.7)), (rear, crank)):
        model.look("red", tube([a, b], 0.017, 8))
    for y in (0.05, -0.05):
        model.look("red", tube([(rear[0], y, rear[2]), (-0.25, y * 0.4, 0.75)], 0.009, 6))
        model.look("dark_grey", tube([(front[0], y, front[2]), (0.36, y * 0.8, 0.7)], 0.011, 6))
    model.look(
        "dark_grey",
        tube([head, (0.3, 0, 0.98)], 0.014, 8),
        tube(
            [(0.2, 0.28, 0.98), (0.32, 0.2, 1.0), (0.32, -0.2, 1.0), (0.2, -0.28, 0.98)], 0.012, 8
        ),
        tube([seat, (-0.29, 0, 0.88)], 0.014, 8),
        tube([(-0.1, 0.06, 0.3), (-0.2, 0.24, 0.02)], 0.008, 6),
    )
    model.look("black", ball(1.0, sides=10).scaled(0.14, 0.07, 0.03).moved(-0.29, 0, 0.91))
    model.look(
        "steel", lathe([(0.09, -0.004), (0.09, 0.004)], 16).turned(math.pi / 2).moved(*crank)
    )
    model.box((0.7, 0.06, 0.5), (0.0, 0, 0.6))
    model.box((0.16, 0.56, 0.05), (0.26, 0, 0.99))
    return model


def kick_scooter() -> Model:
    model = Model("kick_scooter", "Kick scooter", "An electric kick scooter, parked. It is static.")
    for x in (0.45, -0.45):
        model.parts += wheel(0.11, 0.05, (x, 0, 0.11))
        model.cylinder(0.11, 0.05, (x, 0, 0.11), (math.pi / 2, 0, 0))
    model.look(
        "dark_grey",
        block((0.72, 0.16, 0.05), (-0.06, 0, 0.14), 0.02),
        tube([(0.3, 0, 0.14), (0.4, 0, 0.26)], 0.03),
        tube([(0.45, 0, 0.2), (0.34, 0, 1.08)], 0.022),
    )
    model.look("black", tube([(0.33, 0.22, 1.08), (0.33, -0.22, 1.08)], 0.018))
    model.look("green", block((0.6, 0.13, 0.008), (-0.06, 0, 0.168), 0.003))
    model.look("light", ball(0.03, (0.4, 0, 0.95), 8))
    model.box((0.8, 0.16, 0.06), (-0.05, 0, 0.14))
    model.box((0.07, 0.07, 0.9), (0.39, 0, 0.63), (0, -0.124, 0))
    model.box((0.05, 0.48, 0.05), (0.33, 0, 1.08))
    return model


def pallet_truck() -> Model:
    model = Model("pallet_truck", "Pallet truck", "A hand pallet truck, 70 kg.", 70)
    for y in (0.19, -0.19):
        model.block("red", (1.15, 0.16, 0.05), (0.2, y, 0.085), 0.012)
        model.look(
            "rubber",
            lathe([(0.04, -0.05), (0.04, 0.05)], 12).turned(math.pi / 2).moved(0.62, y, 0.04),
        )
        model.cylinder(0.04, 0.1, (0.62, y, 0.04), (math.pi / 2, 0, 0))
    model.block("red", (0.16, 0.5, 0.3), (-0.45, 0, 0.28), 0.03)
    model.look(
        "rubber", lathe([(0.09, -0.08), (0.09, 0.08)], 16).turned(math.pi / 2).moved(-0.55, 0, 0.09)
    )
    model.cylinder(0.09, 0.16, (-0.55, 0, 0.09), (math.pi / 2, 0, 0))
    model.look(
        "dark_grey",
        rod((-0.52, 0, 0.2), (-0.6, 0, 0.4), 0.045),
        tube([(-0.58, 0, 0.36), (-0.78, 0, 1.05)], 0.022),
        tube(
            [
                (-0.78, 0, 1.05),
                (-0.79, 0.14, 1.12),
                (-0.82, 0.14, 1.22),
                (-0.82, -0.14, 1.22),
                (-0.79, -0.14, 1.12),
            ],
            0.016,
            8,
            closed=True,
        ),
    )
    model.box((0.06, 0.06, 0.8), (-0.7, 0, 0.77), (0, -0.281, 0))
    model.box((0.05, 0.32, 0.16), (-0.81, 0, 1.16))
    return model


def hand_cart() -> Model:
    model = Model(
        "hand_cart", "Hand cart", "A platform cart of 0.9 x 0.6 m with a push bar, 22 kg.", 22, 0.4
    )
    model.block("wood", (0.9, 0.6, 0.03), (0, 0, 0.185), 0.008)
    model.look(
        "steel",
        block((0.92, 0.62, 0.025), (0, 0, 0.165), 0.006),
        tube(
            [(-0.44, 0.27, 0.17), (-0.47, 0.27, 0.95), (-0.47, -0.27, 0.95), (-0.44, -0.27, 0.17)],
            0.016,
        ),
    )
    model.box((0.92, 0.62, 0.024), (0, 0, 0.159))
    model.box((0.035, 0.57, 0.76), (-0.455, 0, 0.585))
    for x in (0.34, -0.34):
        for y in (0.22, -0.22):
            model.parts += wheel(0.07, 0.035, (x, y, 0.07))
            model.look("dark_grey", block((0.07, 0.06, 0.06), (x, y, 0.13), 0.01))
            model.cylinder(0.07, 0.035, (x, y, 0.07), (math.pi / 2, 0, 0))
    return model


def wheelchair() -> Model:
    model = Model("wheelchair", "Wheelchair", "A wheelchair with its brakes set, 17 kg.", 17)
    for y in (0.3, -0.3):
        circle = [
            (-0.12 + 0.29 * math.cos(a), y, 0.3 + 0.29 * math.sin(a))
            for a in np.arange(20) * 2 * math.pi / 20
        ]
        model.look("rubber", tube(circle, 0.014, 6, closed=True))
        for k in range(6):
            a = math.pi * k / 6
            model.look(
                "steel",
                rod(
                    (-0.12 - 0.28 * math.cos(a), y, 0.3 - 0.28 * math.sin(a)),
                    (-0.12 + 0.28 * math.cos(a), y, 0.3 + 0.28 * math.sin(a)),
                    0.003,
                    0,
                    4,
                ),
            )
        model.cylinder(0.304, 0.03, (-0.12, y, 0.304), (math.pi / 2, 0, 0))
        model.parts += wheel(0.09, 0.03, (0.28, y * 0.8, 0.09))
        model.cylinder(0.09, 0.03, (0.28, y * 0.8, 0.09), (math.pi / 2, 0, 0))
        model.look(
            "steel",
            tube([(-0.24, y * 0.8, 0.48), (-0.26, y * 0.8, 0.92), (-0.38, y * 0.8, 0.93)], 0.013),
            tube([(-0.24, y * 0.8, 0.68), (0.16, y * 0.8, 0.68), (0.24, y * 0.8, 0.48)], 0.013),
            tube([(0.24, y * 0.8, 0.48), (0.32, y * 0.7, 0.1), (0.44, y * 0.7, 0.1)], 0.013),
            rod((0.28, y * 0.8, 0.1), (0.26, y * 0.8, 0.46), 0.012, 0, 8),
        )
        model.look(
            "black",
            block((0.26, 0.05, 0.03), (0.0, y * 0.8, 0.7), 0.012),
            block((0.12, 0.13, 0.02), (0.45, y * 0.4, 0.1), 0.008),
        )
    model.block("navy", (0.44, 0.44, 0.06), (0.02, 0, 0.48), 0.025)
    model.look("navy", block((0.05, 0.44, 0.42), (-0.25, 0, 0.72), 0.02))
    model.box((0.05, 0.5, 0.42), (-0.25, 0, 0.72))
    model.box((0.18, 0.3, 0.03), (0.43, 0, 0.1))
    return model
