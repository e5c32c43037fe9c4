"""Obstacles of streets, gardens and test courses."""

from __future__ import annotations

import math
from typing import Iterator

import numpy as np

from .meshes import Mesh, ball, block, lathe, plate, rod, standing
from .model import Model


def models() -> Iterator[Model]:
    yield from (
        jersey_barrier(),
        bollard(),
        fence(),
        tree(),
        fir(),
        bush(),
        rock(),
        speed_bump(),
        tyre(),
        hydrant(),
        park_bench(),
        waste_bin(),
        picnic_table(),
        mailbox(),
        gate_arch(),
    )


def jersey_barrier() -> Model:
    """The size is that of Gazebo's model: saved worlds name its mesh beside their collisions."""
    model = Model(
        "jersey_barrier",
        "Jersey barrier",
        "A concrete barrier of 4.07 x 0.81 x 1.14 m. It is static.",
        None,
        0.7,
    )
    length = 4.066
    profile = [
        (-0.406, 0),
        (0.406, 0),
        (0.406, 0.065),
        (0.2, 0.33),
        (0.13, 1.143),
        (-0.13, 1.143),
        (-0.2, 0.33),
        (-0.406, 0.065),
    ]
    model.look("concrete", standing(plate(profile, length, 0.012)).turned(0, 0, math.pi / 2))
    for x in (1.4, -1.4):
        model.look(
            "orange",
            block((0.4, 0.002, 0.14), (x, 0.1545, 0.75), 0.0),
            block((0.4, 0.002, 0.14), (x, -0.1545, 0.75), 0.0),
        )
    model.box((length, 0.812, 0.065), (0, 0, 0.0325))
    model.box((length, 0.65, 0.1), (0, 0, 0.115))
    model.box((length, 0.5, 0.12), (0, 0, 0.225))
    model.box((length, 0.306, 0.858), (0, 0, 0.714))
    return model


def bollard() -> Model:
    model = Model("bollard", "Bollard", "A steel bollard, 1 m high. It is static.")
    model.look(
        "dark_grey",
        lathe([(0.1, 0), (0.1, 0.02), (0.07, 0.04), (0.07, 0.95), (0.05, 0.99), (0, 1.0)], 20),
    )
    for z in (0.65, 0.8):
        model.look("yellow", lathe([(0.0715, z), (0.0715, z + 0.08)], 20))
    model.cylinder(0.07, 1.0, (0, 0, 0.5))
    return model


def fence() -> Model:
    model = Model("fence", "Fence", "A wooden fence of 2 m length and 1 m height. It is static.")
    for x in (0.96, -0.96):
        model.block("dark_wood", (0.08, 0.08, 1.05), (x, 0, 0.525), 0.01)
    for z in (0.3, 0.75):
        model.block("wood", (1.84, 0.03, 0.08), (0, 0, z), 0.006)
    for k in range(13):
        slat = standing(
            plate(
                [(-0.045, 0.06), (0.045, 0.06), (0.045, 0.93), (0, 1.0), (-0.045, 0.93)],
                0.018,
                0.004,
            )
        )
        model.look("light_wood", slat.moved(-0.84 + 0.14 * k, 0.026))
    model.box((1.84, 0.02, 0.94), (0, 0.026, 0.53))
    return model


def crown(radius: float, seed: int, x: float, y: float, z: float) -> Mesh:
    """An uneven ball, the same for the same seed."""
    mesh = ball(radius, sides=10)
    rows = np.round(mesh.vertices, 6)
    uneven = 1 + 0.13 * np.sin(rows @ np.array([7.1, 5.3, 6.7]) / radius + seed)
    return Mesh(mesh.vertices * uneven[:, None], mesh.triangles).moved(x, y, z)


def tree() -> Model:
    model = Model("tree", "Tree", "A broad-leaved tree, 4.5 m high. It is static.")
    model.look(
        "dark_wood",
        lathe([(0.2, 0), (0.14, 0.15), (0.11, 1.2), (0.08, 2.4)], 12),
        rod((0, 0, 1.5), (0.7, 0.3, 2.4), 0.06, 0.03, 8),
        rod((0, 0, 1.7), (-0.6, -0.35, 2.5), 0.055, 0.03, 8),
    )
    for k, (r, x, y, z) in enumerate(
        (
            (1.05, 0, 0, 3.3),
            (0.75, 0.75, 0.35, 2.75),
            (0.7, -0.7, -0.4, 2.85),
            (0.65, -0.35, 0.7, 2.8),
            (0.65, 0.35, -0.75, 2.95),
        )
    ):
        model.look("leaf" if k % 2 else "green", crown(r, k, x, y, z))
    model.cylinder(0.13, 2.4, (0, 0, 1.2))
    model.sphere(1.25, (0, 0, 3.15))
    return model


def fir() -> Model:
    model = Model("fir", "Fir", "A fir, 4 m high. It is static.")
    model.look("dark_wood", lathe([(0.15, 0), (0.1, 0.9)], 10))
    for k in range(5):
        z, r = 0.6 + 0.62 * k, 1.05 - 0.18 * k
        model.look(
            "dark_leaf",
            lathe([(r * 0.35, z + 0.1), (r, z), (r * 0.4, z + 0.55), (0.03, z + 0.9)], 12).turned(
                0, 0, 0.4 * k
            ),
        )
    model.cylinder(0.13, 0.8, (0, 0, 0.4))
    model.cylinder(0.75, 1.4, (0, 0, 1.4))
    model.cylinder(0.42, 1.2, (0, 0, 2.7))
    return model


def bush() -> Model:
    model = Model("bush", "Bush", "A bush of 1 m diameter and 0.8 m height. It is static.")
    for k, (r, x, y, z) in enumerate(
        (
            (0.4, 0, 0, 0.4),
            (0.3, 0.27, 0.1, 0.3),
            (0.3, -0.25, 0.15, 0.3),
            (0.28, 0.05, -0.28, 0.28),
        )
    ):
        model.look("leaf" if k % 2 else "green", crown(r, k + 3, x, y, z))
    model.cylinder(0.48, 0.6, (0, 0, 0.3))
    return model


def rock() -> Model:
    model = Model("rock", "Rock", "A rock of 0.9 m length, 350 kg.", 350, 0.8)
    mesh = crown(1.0, 5, 0, 0, 0).scaled(0.46, 0.36, 0.3)
    flat = np.maximum(mesh.vertices + (0, 0, 0.22), (-9, -9, 0))
    model.look("rock", Mesh(flat, mesh.triangles))
    model.box((0.7, 0.52, 0.4), (0, 0, 0.2))
    return model


def speed_bump() -> Model:
    model = Model(
        "speed_bump", "Speed bump", "A speed bump of 2 x 0.4 m, 50 mm high. It is static."
    )
    for k in range(8):
        profile = [(-0.2, 0), (0.2, 0), (0.1, 0.05), (-0.1, 0.05)]
        part = standing(plate(profile, 0.25)).turned(0, 0, math.pi / 2).turned(0, 0, math.pi / 2)
        model.look("black" if k % 2 else "yellow", part.moved(y=-0.875 + 0.25 * k))
    model.box((0.2, 2.0, 0.05), (0, 0, 0.025))
    lean = math.atan2(0.05, 0.1)
    for side in (1, -1):
        model.box(
            (0.1118, 2.0, 0.02),
            (side * (0.15 - 0.01 * math.sin(lean)), 0, 0.025 - 0.01 * math.cos(lean)),
            (0, side * lean, 0),
        )
    return model


def tyre() -> Model:
    model = Model("tyre", "Tyre", "A car tyre that lies on its side, 9 kg.", 9, 0.8)
    model.look(
        "rubber",
        lathe(
            [
                (0.2, 0.03),
                (0.24, 0.0),
                (0.29, 0.01),
                (0.31, 0.05),
                (0.31, 0.15),
                (0.29, 0.19),
                (0.24, 0.2),
                (0.2, 0.17),
                (0.19, 0.1),
                (0.19, 0.04),
            ],
            28,
        ),
    )
    model.look("dark_grey", lathe([(0.19, 0.035), (0.185, 0.09)], 28))
    model.cylinder(0.3, 0.2, (0, 0, 0.1))
    return model


def hydrant() -> Model:
    model = Model("hydrant", "Fire hydrant", "A fire hydrant, 0.8 m high. It is static.")
    model.look(
        "red",
        lathe(
            [
                (0.16, 0),
                (0.16, 0.05),
                (0.11, 0.06),
                (0.11, 0.55),
                (0.15, 0.56),
                (0.15, 0.6),
                (0.11, 0.7),
                (0.05, 0.76),
                (0.05, 0.8),
            ],
            20,
        ),
    )
    for yaw in (0, math.pi / 2, -math.pi / 2):
        side = lathe([(0.05, 0.08), (0.05, 0.15), (0.065, 0.15), (0.065, 0.19)], 14).turned(
            0, math.pi / 2, yaw
        )
        model.look("light_grey", side.moved(z=0.42))
    model.cylinder(0.14, 0.8, (0, 0, 0.4))
    model.box((0.19, 0.38, 0.13), (0.095, 0, 0.42))
    return model


def park_bench() -> Model:
    model = Model("park_bench", "Park bench", "A bench of 1.6 m width, 35 kg.", 35)
    for y in (0.65, -0.65):
        model.look(
            "dark_grey",
            block((0.44, 0.05, 0.05), (0, y, 0.405), 0.012),
            rod((0.18, y, 0), (0.16, y, 0.4), 0.025),
            rod((-0.2, y, 0), (-0.16, y, 0.4), 0.025),
            rod((-0.18, y, 0.4), (-0.3, y, 0.85), 0.022),
        )
        model.box((0.44, 0.06, 0.43), (0, y, 0.215))
    for k in range(4):
        model.look("wood", block((0.095, 1.6, 0.03), (-0.17 + 0.115 * k, 0, 0.445), 0.008))
    for k in range(3):
        z = 0.57 + 0.12 * k
        model.look(
            "wood", block((0.03, 1.6, 0.095), (-0.185 - 0.267 * (z - 0.45), 0, z), 0.008)
        )
    model.box((0.45, 1.6, 0.03), (0, 0, 0.445))
    model.box((0.04, 1.6, 0.42), (-0.235, 0, 0.66), (0, -0.261, 0))
    return model


def waste_bin() -> Model:
    model = Model("waste_bin", "Waste bin", "A street waste bin, 0.95 m high, 18 kg.", 18)
    model.look(
        "green", lathe([(0.2, 0), (0.21, 0.02), (0.25, 0.75), (0.26, 0.76), (0.26, 0.8)], 22)
    )
    model.look(
        "dark_grey",
        lathe([(0.26, 0.8), (0.25, 0.84), (0.14, 0.93), (0.0, 0.95)], 22),
        block((0.12, 0.26, 0.06), (0.18, 0, 0.86), 0.015),
    )
    model.cylinder(0.235, 0.85, (0, 0, 0.425))
    model.cylinder(0.18, 0.1, (0, 0, 0.9))
    return model


def picnic_table() -> Model:
    model = Model(
        "picnic_table", "Picnic table", "A picnic table with benches, 1.8 x 1.5 m, 60 kg.", 60
    )
    for k in range(5):
        model.look("wood", block((1.8, 0.13, 0.04), (0, -0.29 + 0.145 * k, 0.73), 0.008))
    for y in (0.65, -0.65):
        for shift in (0.065, -0.065):
            model.look("wood", block((1.8, 0.12, 0.04), (0, y + shift, 0.45), 0.008))
        model.box((1.8, 0.25, 0.04), (0, y, 0.45))
    for x in (0.65, -0.65):
        model.look(
            "dark_wood",
            block((0.05, 1.5, 0.09), (x, 0, 0.385), 0.008),
            block((0.05, 0.68, 0.08), (x, 0, 0.67), 0.008),
        )
        model.box((0.06, 1.5, 0.09), (x, 0, 0.385))
        for side in (1, -1):
            model.look(
                "dark_wood",
                rod((x + 0.05, 0.5 * side, 0.0), (x + 0.05, 0.25 * side, 0.7), 0.035, 0, 8),
            )
            model.cylinder(0.035, 0.34, (x + 0.05, 0.44 * side, 0.17))
        model.box((0.06, 0.5, 0.28), (x, 0, 0.57))
    model.box((1.8, 0.72, 0.04), (0, 0, 0.73))
    return model


def mailbox() -> Model:
    model = Model("mailbox", "Mailbox", "A letter box on a post, 1.2 m high. It is static.")
    model.block("dark_wood", (0.09, 0.09, 0.95), (0, 0, 0.475), 0.008)
    outline = [
        (-0.11, 0),
        (0.11, 0),
        (0.11, 0.14),
        *((0.11 * math.cos(a), 0.14 + 0.11 * math.sin(a)) for a in np.arange(1, 8) * math.pi / 8),
        (-0.11, 0.14),
    ]
    model.look(
        "blue", standing(plate(outline, 0.46, 0.006)).turned(0, 0, math.pi / 2).moved(0.05, 0, 0.95)
    )
    model.look(
        "red",
        block((0.02, 0.012, 0.2), (0.1, 0.118, 1.16), 0.004),
        block((0.09, 0.012, 0.06), (0.13, 0.118, 1.24), 0.004),
    )
    model.look("white", block((0.004, 0.12, 0.03), (0.281, 0, 1.06), 0.001))
    model.box((0.46, 0.22, 0.25), (0.05, 0, 1.075))
    return model


def gate_arch() -> Model:
    model = Model(
        "gate_arch", "Start arch", "An arch of 3 m width for races of robots. It is static."
    )
    for y in (1.4, -1.4):
        model.block("white", (0.2, 0.2, 2.0), (0, y, 1.0), 0.03)
        model.block("dark_grey", (0.5, 0.4, 0.05), (0, y, 0.025), 0.01)
        for k in range(3):
            model.look("red", block((0.204, 0.204, 0.25), (0, y, 0.35 + 0.6 * k), 0.03))
    model.block("red", (0.2, 3.0, 0.5), (0, 0, 2.25), 0.04)
    for row in range(2):
        for k in range(16):
            if (row + k) % 2:
                model.look(
                    "white",
                    block((0.206, 0.15, 0.15), (0, -1.125 + 0.15 * k, 2.175 + 0.15 * row), 0.0),
                )
    return model
