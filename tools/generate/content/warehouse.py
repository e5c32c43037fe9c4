"""Things of warehouses and workshops."""

from __future__ import annotations

import math
from typing import Iterator

from .meshes import block, lathe, rod, tube
from .model import Model


def models() -> Iterator[Model]:
    yield from (
        pallet(),
        loaded_pallet(),
        pallet_rack(),
        roller_conveyor(),
        tote(),
        steel_drum(),
        gas_bottle(),
        cardboard_box(),
        ladder(),
        workbench(),
        charging_station(),
    )


def euro_pallet(model: Model, z: float = 0.0) -> None:
    """A pallet of 1.2 x 0.8 x 0.144 m with its lower side at z."""
    for y in (0.35, 0.0, -0.35):
        model.block("light_wood", (1.2, 0.1, 0.022), (0, y, z + 0.011), 0.003)
        for x in (0.53, 0.0, -0.53):
            model.block("wood", (0.14, 0.1, 0.078), (x, y, z + 0.061), 0.003)
    for x in (0.53, 0.0, -0.53):
        model.look("light_wood", block((0.14, 0.8, 0.022), (x, 0, z + 0.111), 0.003))
    for k in range(5):
        model.look(
            "light_wood", block((1.2, 0.125, 0.022), (0, -0.3375 + 0.16875 * k, z + 0.133), 0.003)
        )
    model.box((1.2, 0.8, 0.044), (0, 0, z + 0.122))


def pallet() -> Model:
    model = Model("pallet", "Pallet", "A wooden pallet of 1.2 x 0.8 x 0.144 m, 25 kg.", 25)
    euro_pallet(model)
    return model


def carton(model: Model, size: tuple, at: tuple) -> None:
    x, y, z = size
    model.look("cardboard", block(size, at, 0.006))
    model.look("cream", block((0.05, y + 0.002, z + 0.002), at, 0.001))
    model.look(
        "white", block((0.1, y + 0.003, 0.07), (at[0] + x * 0.28, at[1], at[2] + z * 0.12), 0.001)
    )


def loaded_pallet() -> Model:
    model = Model(
        "loaded_pallet", "Loaded pallet", "A pallet with twelve cartons, 1.05 m high, 240 kg.", 240
    )
    euro_pallet(model)
    for z in range(3):
        for x in (0.295, -0.295):
            for y in (0.195, -0.195):
                carton(model, (0.58, 0.38, 0.295), (x, y, 0.144 + 0.15 + 0.3 * z))
    model.box((1.17, 0.77, 0.9), (0, 0, 0.594))
    return model


def pallet_rack() -> Model:
    model = Model(
        "pallet_rack", "Pallet rack", "A rack of 2.7 x 1 x 3 m with three levels. It is static."
    )
    for y in (1.3, -1.3):
        for x in (0.45, -0.45):
            model.block("blue", (0.08, 0.1, 3.0), (x, y, 1.5), 0.01)
            model.look("dark_grey", block((0.14, 0.16, 0.012), (x, y, 0.006), 0.003))
        for k in range(4):
            z = 0.2 + 0.7 * k
            model.look("blue", rod((0.42, y, z), (-0.42, y, z + 0.55), 0.018, 0, 6))
    for z in (0.15, 1.2, 2.25):
        for x in (0.45, -0.45):
            model.block("orange", (0.05, 2.5, 0.12), (x, 0, z), 0.01)
        model.look("light_grey", block((0.86, 2.48, 0.02), (0, 0, z + 0.07), 0.004))
        model.box((0.86, 2.5, 0.03), (0, 0, z + 0.065))
    return model


def roller_conveyor() -> Model:
    model = Model(
        "roller_conveyor",
        "Roller conveyor",
        "A roller conveyor of 2 x 0.6 m at 0.75 m; its rollers do not turn. It is static.",
    )
    for y in (0.29, -0.29):
        model.block("dark_grey", (2.0, 0.03, 0.12), (0, y, 0.7), 0.006)
        model.look("yellow", block((2.0, 0.032, 0.025), (0, y, 0.71), 0.003))
    for k in range(22):
        x = -0.945 + 0.09 * k
        model.look(
            "light_grey",
            lathe([(0.03, -0.275), (0.03, 0.275)], 12).turned(math.pi / 2).moved(x, 0, 0.72),
        )
    model.box((2.0, 0.55, 0.06), (0, 0, 0.72))
    for x in (0.85, -0.85):
        for y in (0.26, -0.26):
            model.block("dark_grey", (0.06, 0.04, 0.64), (x, y, 0.32), 0.006)
        model.look("dark_grey", block((0.04, 0.5, 0.04), (x, 0, 0.25), 0.006))
    return model


def tote() -> Model:
    model = Model("tote", "Tote", "An open plastic tote of 0.6 x 0.4 x 0.3 m, 2.5 kg.", 2.5, 0.4)
    model.block("blue", (0.56, 0.36, 0.012), (0, 0, 0.006), 0.004)
    for x in (0.292, -0.292):
        model.block("blue", (0.016, 0.4, 0.288), (x, 0, 0.156), 0.004)
        model.look("navy", block((0.02, 0.12, 0.03), (x, 0, 0.24), 0.006))
    for y in (0.192, -0.192):
        model.block("blue", (0.568, 0.016, 0.288), (0, y, 0.156), 0.004)
    for x in (0.296, -0.296):
        model.look("blue", block((0.03, 0.42, 0.025), (x, 0, 0.287), 0.006))
    for y in (0.197, -0.197):
        model.look("blue", block((0.62, 0.03, 0.025), (0, y, 0.287), 0.006))
    return model


def steel_drum() -> Model:
    model = Model("steel_drum", "Steel drum", "A drum of 200 l, 0.88 m high, 180 kg.", 180, 0.5)
    r = 0.29
    model.look(
        "blue",
        lathe(
            [
                (r - 0.01, 0.0),
                (r, 0.01),
                (r, 0.28),
                (r + 0.012, 0.295),
                (r, 0.31),
                (r, 0.57),
                (r + 0.012, 0.585),
                (r, 0.6),
                (r, 0.87),
                (r - 0.01, 0.88),
                (r - 0.02, 0.88),
                (r - 0.02, 0.86),
            ],
            28,
        ),
    )
    model.look("light_grey", lathe([(0.035, 0.86), (0.035, 0.875)], 12).moved(0.18))
    model.cylinder(r, 0.88, (0, 0, 0.44))
    return model


def gas_bottle() -> Model:
    model = Model("gas_bottle", "Gas bottle", "A gas bottle, 1.5 m high, 70 kg.", 70, 0.5)
    model.look(
        "teal",
        lathe(
            [(0.1, 0), (0.115, 0.015), (0.115, 1.15), (0.1, 1.26), (0.05, 1.34), (0.035, 1.37)], 24
        ),
    )
    model.look(
        "steel",
        lathe([(0.02, 1.36), (0.02, 1.44), (0.03, 1.45), (0.03, 1.49), (0.02, 1.5)], 12),
        rod((0.02, 0, 1.43), (0.07, 0, 1.43), 0.012, 0, 8),
    )
    model.look("orange", lathe([(0.1155, 1.0), (0.1155, 1.1)], 24))
    model.cylinder(0.115, 1.24, (0, 0, 0.62))
    model.cylinder(0.045, 0.26, (0, 0, 1.37))
    return model


def cardboard_box() -> Model:
    model = Model(
        "cardboard_box", "Cardboard box", "A taped carton of 0.4 x 0.3 x 0.3 m, 4 kg.", 4, 0.5
    )
    carton(model, (0.4, 0.3, 0.3), (0, 0, 0.15))
    model.box((0.4, 0.3, 0.3), (0, 0, 0.15))
    return model


def ladder() -> Model:
    model = Model("ladder", "Step ladder", "A step ladder, 1.6 m high, open, 9 kg.", 9)
    for y in (0.23, -0.23):
        s = y / abs(y)
        model.look(
            "steel",
            rod((0.45, y, 0.02), (0.04, y - 0.04 * s, 1.55), 0.02, 0, 8),
            rod((-0.45, y, 0.02), (-0.04, y - 0.04 * s, 1.55), 0.016, 0, 8),
        )
        for x in (0.45, -0.45):
            model.look("rubber", block((0.06, 0.05, 0.04), (x, y, 0.02), 0.01))
            model.box((0.06, 0.05, 0.04), (x, y, 0.02))
    for k in range(1, 6):
        z = 0.26 * k
        model.look(
            "light_grey",
            block((0.09, 0.42 - 0.015 * k, 0.025), (0.45 - 0.268 * z, 0, z + 0.02), 0.006),
        )
    model.block("red", (0.24, 0.42, 0.035), (0, 0, 1.57), 0.01)
    model.box((0.05, 0.42, 1.55), (0.245, 0, 0.79), (0, -0.262, 0))
    model.box((0.03, 0.42, 1.55), (-0.245, 0, 0.79), (0, 0.262, 0))
    return model


def workbench() -> Model:
    model = Model(
        "workbench", "Workbench", "A workbench of 1.5 x 0.75 m at 0.85 m with a vice, 75 kg.", 75
    )
    model.block("wood", (0.75, 1.5, 0.06), (0, 0, 0.82), 0.01)
    for x in (0.3, -0.3):
        for y in (0.66, -0.66):
            model.block("green", (0.08, 0.08, 0.79), (x, y, 0.395), 0.008)
    model.block("green", (0.5, 1.24, 0.04), (0, 0, 0.2), 0.008)
    model.block("grey", (0.55, 0.42, 0.34), (0.02, 0.38, 0.61), 0.008)
    for z in (0.52, 0.68):
        model.look("light_grey", block((0.02, 0.38, 0.13), (0.3, 0.38, z), 0.005))
        model.look("dark_grey", block((0.02, 0.14, 0.015), (0.315, 0.38, z + 0.03), 0.005))
    model.look(
        "dark_grey",
        block((0.16, 0.12, 0.06), (0.22, -0.5, 0.88), 0.015),
        block((0.05, 0.14, 0.08), (0.24, -0.5, 0.92), 0.012),
        block((0.05, 0.14, 0.08), (0.34, -0.5, 0.92), 0.012),
        rod((0.3, -0.5, 0.9), (0.46, -0.5, 0.9), 0.014, 0, 8),
        rod((0.45, -0.58, 0.9), (0.45, -0.42, 0.9), 0.008, 0, 8),
    )
    model.box((0.2, 0.14, 0.11), (0.26, -0.5, 0.905))
    return model


def charging_station() -> Model:
    model = Model(
        "charging_station",
        "Charging station",
        "A dock for mobile robots, 0.5 m wide. It is static.",
    )
    model.block("white", (0.16, 0.5, 0.34), (-0.1, 0, 0.17), 0.03)
    model.block("dark_grey", (0.36, 0.46, 0.025), (0.1, 0, 0.0125), 0.006)
    model.look(
        "yellow",
        block((0.03, 0.2, 0.012), (-0.012, 0, 0.16), 0.003),
        block((0.03, 0.2, 0.012), (-0.012, 0, 0.11), 0.003),
    )
    model.look("black", block((0.012, 0.3, 0.14), (-0.02, 0, 0.135), 0.004))
    model.look("leaf", lathe([(0.02, 0), (0.02, 0.006)], 12).moved(-0.1, 0, 0.338))
    model.look(
        "steel",
        tube([(0.02, 0.16, 0.03), (0.26, 0.16, 0.03)], 0.008, 6),
        tube([(0.02, -0.16, 0.03), (0.26, -0.16, 0.03)], 0.008, 6),
    )
    return model
