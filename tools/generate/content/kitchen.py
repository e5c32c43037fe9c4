"""Appliances, tableware and groceries."""

from __future__ import annotations

import math
from typing import Iterator

import numpy as np

from .meshes import Mesh, block, joined, lathe, limb, loft, rod, tube
from .model import Model


def models() -> Iterator[Model]:
    yield from (
        refrigerator(),
        stove(),
        sink_unit(),
        kitchen_cupboard(),
        kitchen_island(),
        microwave(),
        mug(),
        plate_of_china(),
        bowl(),
        bottle(),
        pan(),
        kettle(),
        food_can(),
        cereal_box(),
        milk_carton(),
    )


def handle(x: float, y: float, low: float, high: float) -> Mesh:
    """An upright bar handle in front of a door at x."""
    return tube([(x, y, low), (x + 0.035, y, low), (x + 0.035, y, high), (x, y, high)], 0.008, 6)


def refrigerator() -> Model:
    model = Model(
        "refrigerator", "Refrigerator", "A refrigerator (fridge) of 0.6 x 0.65 x 1.8 m, 65 kg.", 65
    )
    model.block("light_grey", (0.6, 0.6, 1.76), (-0.02, 0, 0.92), 0.015)
    model.block("dark_grey", (0.5, 0.54, 0.04), (-0.02, 0, 0.02), 0.005)
    for low, high in ((0.06, 0.62), (0.64, 1.79)):
        model.look("white", block((0.05, 0.59, high - low), (0.3, 0, (low + high) / 2), 0.015))
    model.look("steel", handle(0.325, 0.24, 0.42, 0.58), handle(0.325, 0.24, 0.72, 1.1))
    model.box((0.05, 0.59, 1.73), (0.305, 0, 0.925))
    return model


def base_unit(model: Model, front: str = "white") -> None:
    """A kitchen base unit of 0.6 x 0.6 x 0.9 m with a worktop."""
    model.block("light_grey", (0.56, 0.6, 0.77), (-0.02, 0, 0.475), 0.004)
    model.block("dark_grey", (0.48, 0.58, 0.09), (-0.04, 0, 0.045), 0.004)
    model.block("dark_wood", (0.62, 0.6, 0.04), (0, 0, 0.88), 0.006)
    model.look(front, block((0.02, 0.59, 0.76), (0.27, 0, 0.475), 0.005))


def stove() -> Model:
    model = Model("stove", "Stove", "A stove with oven, 0.6 x 0.6 x 0.9 m, 50 kg.", 50)
    base_unit(model, "steel")
    model.look(
        "black",
        block((0.54, 0.56, 0.012), (0, 0, 0.902), 0.004),
        block((0.02, 0.46, 0.38), (0.277, 0, 0.4), 0.006),
    )
    for x in (0.13, -0.13):
        for y in (0.14, -0.14):
            model.look(
                "grey",
                lathe([(0.085 + 0.02 * (x > 0), 0.9075), (0.085 + 0.02 * (x > 0), 0.91)], 20).moved(
                    x, y
                ),
            )
    model.look(
        "light_grey",
        tube(
            [(0.28, 0.22, 0.65), (0.32, 0.22, 0.65), (0.32, -0.22, 0.65), (0.28, -0.22, 0.65)],
            0.01,
            8,
        ),
    )
    for k in range(5):
        model.look(
            "dark_grey",
            lathe([(0.022, 0), (0.018, 0.03)], 12)
            .turned(0, math.pi / 2)
            .moved(0.28, -0.2 + 0.1 * k, 0.78),
        )
    return model


def sink_unit() -> Model:
    model = Model(
        "sink_unit", "Sink unit", "A kitchen unit with sink and tap, 0.6 x 0.6 x 0.9 m, 38 kg.", 38
    )
    base_unit(model)
    model.look(
        "steel",
        block((0.42, 0.42, 0.012), (0.03, 0, 0.902), 0.004),
        tube(
            [
                (-0.21, 0, 0.9),
                (-0.21, 0, 1.12),
                (-0.16, 0, 1.18),
                (-0.07, 0, 1.18),
                (-0.03, 0, 1.1),
            ],
            0.014,
        ),
        rod((-0.21, 0.05, 0.94), (-0.21, 0.11, 0.97), 0.008, 0, 8),
    )
    model.look("dark_grey", block((0.36, 0.36, 0.006), (0.03, 0, 0.907), 0.002))
    model.look("steel", handle(0.28, 0.22, 0.62, 0.78))
    model.cylinder(0.02, 0.28, (-0.21, 0, 1.04))
    return model


def kitchen_cupboard() -> Model:
    model = Model(
        "kitchen_cupboard",
        "Kitchen cupboard",
        "A base unit with doors, 0.6 x 0.6 x 0.9 m, 35 kg.",
        35,
    )
    base_unit(model)
    model.look("light_grey", block((0.004, 0.006, 0.76), (0.281, 0, 0.475), 0.001))
    model.look("steel", handle(0.28, 0.05, 0.62, 0.78), handle(0.28, -0.05, 0.62, 0.78))
    return model


def kitchen_island() -> Model:
    model = Model(
        "kitchen_island", "Kitchen island", "A work block of 0.9 x 1.6 x 0.92 m, 95 kg.", 95
    )
    model.block("navy", (0.7, 1.5, 0.8), (0, 0, 0.48), 0.008)
    model.block("dark_grey", (0.62, 1.42, 0.08), (0, 0, 0.04), 0.004)
    model.block("light_wood", (0.9, 1.6, 0.04), (0, 0, 0.9), 0.01)
    for y in (0.5, 0, -0.5):
        model.look("blue", block((0.02, 0.47, 0.74), (0.352, y, 0.48), 0.006))
        model.look("steel", handle(0.36, y + 0.18, 0.62, 0.8))
    return model


def microwave() -> Model:
    model = Model("microwave", "Microwave", "A microwave oven of 0.5 x 0.36 x 0.28 m, 12 kg.", 12)
    model.block("steel", (0.36, 0.5, 0.27), (0, 0, 0.145), 0.012)
    model.block("black", (0.3, 0.44, 0.01), (0, 0, 0.005), 0.002)
    model.look("black", block((0.012, 0.34, 0.21), (0.18, 0.06, 0.145), 0.004))
    model.look("dark_grey", block((0.012, 0.1, 0.23), (0.18, -0.18, 0.145), 0.004))
    model.look("green", block((0.006, 0.07, 0.03), (0.187, -0.18, 0.22), 0.002))
    model.look("light_grey", handle(0.184, -0.1, 0.07, 0.22))
    return model


def hollow(outer: float, height: float, wall: float, foot: float = 0.0, sides: int = 24) -> Mesh:
    """A round vessel that is open at the top."""
    foot = foot or outer * 0.9
    return lathe(
        [
            (foot, 0),
            (outer, height * 0.15),
            (outer, height),
            (outer - wall, height),
            (outer - wall, height * 0.2),
            (outer * 0.5, wall * 2),
        ],
        sides,
    )


def mug() -> Model:
    model = Model("mug", "Mug", "A mug with a handle, 95 mm high, 0.35 kg.", 0.35)
    model.look(
        "red",
        hollow(0.04, 0.095, 0.004),
        tube(
            [
                (0.037, 0, 0.075),
                (0.06, 0, 0.076),
                (0.068, 0, 0.05),
                (0.06, 0, 0.026),
                (0.037, 0, 0.024),
            ],
            0.006,
            8,
        ),
    )
    model.cylinder(0.04, 0.095, (0, 0, 0.0475))
    model.box((0.032, 0.012, 0.06), (0.055, 0, 0.05))
    return model


def plate_of_china() -> Model:
    model = Model("plate", "Plate", "A dinner plate of 0.26 m diameter, 0.6 kg.", 0.6, 0.4)
    model.look(
        "white",
        lathe(
            [(0.075, 0), (0.09, 0.006), (0.13, 0.02), (0.13, 0.023), (0.092, 0.011), (0.07, 0.007)],
            32,
        ),
    )
    model.cylinder(0.085, 0.008, (0, 0, 0.004))
    model.cylinder(0.13, 0.012, (0, 0, 0.016))
    return model


def bowl() -> Model:
    model = Model("bowl", "Bowl", "A bowl of 0.16 m diameter, 0.4 kg.", 0.4, 0.4)
    model.look(
        "teal",
        lathe(
            [
                (0.035, 0),
                (0.04, 0.006),
                (0.065, 0.03),
                (0.08, 0.07),
                (0.077, 0.07),
                (0.06, 0.032),
                (0.03, 0.012),
            ],
            28,
        ),
    )
    model.cylinder(0.05, 0.03, (0, 0, 0.015))
    model.cylinder(0.08, 0.04, (0, 0, 0.05))
    return model


def bottle() -> Model:
    model = Model("bottle", "Bottle", "A bottle of 0.75 l, 0.3 m high, 1.2 kg.", 1.2, 0.4)
    model.look(
        "green",
        lathe(
            [
                (0.032, 0),
                (0.037, 0.006),
                (0.037, 0.18),
                (0.03, 0.21),
                (0.016, 0.24),
                (0.014, 0.285),
            ],
            24,
        ),
    )
    model.look("cream", lathe([(0.0375, 0.06), (0.0375, 0.15)], 24))
    model.look("red", lathe([(0.0155, 0.275), (0.0155, 0.3)], 16))
    model.cylinder(0.037, 0.2, (0, 0, 0.1))
    model.cylinder(0.015, 0.1, (0, 0, 0.25))
    return model


def pan() -> Model:
    model = Model("pan", "Frying pan", "A frying pan of 0.26 m diameter, 1.1 kg.", 1.1)
    model.look("dark_grey", lathe([(0.1, 0), (0.13, 0.045), (0.126, 0.045), (0.098, 0.005)], 28))
    model.look("black", limb((0.125, 0, 0.035), (0.31, 0, 0.06), 0.011, 0.014, 8))
    model.cylinder(0.115, 0.045, (0, 0, 0.0225))
    model.box((0.2, 0.025, 0.025), (0.22, 0, 0.048), (0, -0.13, 0))
    return model


def kettle() -> Model:
    model = Model("kettle", "Kettle", "An electric kettle, 0.25 m high, 1.3 kg.", 1.3)
    model.look(
        "steel",
        lathe([(0.08, 0.02), (0.085, 0.03), (0.075, 0.16), (0.06, 0.2)], 24),
        limb((0.06, 0, 0.14), (0.105, 0, 0.19), 0.022, 0.012, 8),
    )
    model.look(
        "black",
        lathe([(0.085, 0), (0.085, 0.02)], 24),
        lathe([(0.06, 0.2), (0.04, 0.225), (0.012, 0.23), (0.012, 0.25)], 16),
        tube([(-0.06, 0, 0.2), (-0.12, 0, 0.19), (-0.125, 0, 0.08), (-0.082, 0, 0.06)], 0.012, 8),
    )
    model.cylinder(0.085, 0.2, (0, 0, 0.1))
    model.cylinder(0.05, 0.03, (0, 0, 0.215))
    return model


def food_can() -> Model:
    model = Model("food_can", "Food can", "A food can of 74 x 110 mm, 0.45 kg.", 0.45, 0.5)
    model.look(
        "light_grey",
        lathe(
            [
                (0.035, 0),
                (0.037, 0.002),
                (0.037, 0.006),
                (0.036, 0.008),
                (0.036, 0.102),
                (0.037, 0.104),
                (0.037, 0.108),
                (0.035, 0.11),
            ],
            28,
        ),
    )
    model.look("red", lathe([(0.0364, 0.01), (0.0364, 0.1)], 28))
    model.look("cream", lathe([(0.0367, 0.035), (0.0367, 0.06)], 28))
    model.cylinder(0.037, 0.11, (0, 0, 0.055))
    return model


def cereal_box() -> Model:
    model = Model("cereal_box", "Cereal box", "A carton of 0.19 x 0.07 x 0.3 m, 0.5 kg.", 0.5)
    model.block("orange", (0.07, 0.19, 0.3), (0, 0, 0.15), 0.003)
    model.look("cream", block((0.0715, 0.15, 0.1), (0, 0, 0.2), 0.0005))
    model.look("blue", block((0.0715, 0.1915, 0.05), (0, 0, 0.06), 0.0005))
    return model


def milk_carton() -> Model:
    model = Model("milk_carton", "Milk carton", "A carton of 1 l, 1.05 kg.", 1.05)
    ridge = np.array(
        [
            (0.035, 0.035, 0.195),
            (-0.035, 0.035, 0.195),
            (-0.035, -0.035, 0.195),
            (0.035, -0.035, 0.195),
        ]
    )
    roof = [
        (0.003, 0.035, 0.235),
        (-0.003, 0.035, 0.235),
        (-0.003, -0.035, 0.235),
        (0.003, -0.035, 0.235),
    ]
    model.look(
        "white",
        joined(
            [
                block((0.07, 0.07, 0.195), (0, 0, 0.0975), 0.002),
                loft([ridge, np.array(roof), np.array(roof) + (0, 0, 0.015)]),
            ]
        ),
    )
    model.look("blue", block((0.0708, 0.0708, 0.06), (0, 0, 0.05), 0.0005))
    model.box((0.07, 0.07, 0.195), (0, 0, 0.0975))
    model.box((0.035, 0.07, 0.05), (0, 0, 0.22))
    return model
