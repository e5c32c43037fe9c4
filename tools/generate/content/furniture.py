"""Furniture of homes and offices."""

from __future__ import annotations

import math
from typing import Iterator

from .meshes import ball, block, lathe, level, loft, rod, rounded
from .model import Model


def models() -> Iterator[Model]:
    yield from (
        sofa(),
        armchair(),
        bed(),
        desk(),
        office_chair(),
        stool(),
        bookcase(),
        wardrobe(),
        coffee_table(),
        dining_table(),
        floor_lamp(),
        potted_plant(),
        television(),
        monitor(),
        rug(),
        drawer_unit(),
    )


def legs(model: Model, color: str, x: float, y: float, height: float, side: float) -> None:
    """Four upright legs with their centres at (±x, ±y)."""
    for i in (x, -x):
        for j in (y, -y):
            model.block(color, (side, side, height), (i, j, height / 2), 0.006)


def seat(model: Model, width: float, seats: int) -> None:
    """An upholstered seat of 0.9 m depth that faces +x."""
    arm = 0.18
    inner = width - 2 * arm
    model.block("teal", (0.86, width, 0.22), (0, 0, 0.21), 0.03)
    model.block("teal", (0.2, inner, 0.5), (-0.33, 0, 0.57), 0.05)
    for side in (1, -1):
        model.block("teal", (0.86, arm, 0.34), (0, side * (width - arm) / 2, 0.49), 0.05)
        for x in (0.35, -0.35):
            model.block("dark_wood", (0.06, 0.06, 0.1), (x, side * (width / 2 - 0.08), 0.05))
    each = inner / seats
    for k in range(seats):
        y = (k + 0.5) * each - inner / 2
        model.look("cream", block((0.6, each - 0.02, 0.14), (0.1, y, 0.385), 0.045))
        model.look("teal", block((0.16, each - 0.03, 0.38), (-0.19, y, 0.62), 0.06))
    model.box((0.62, inner, 0.13), (0.1, 0, 0.385))


def sofa() -> Model:
    model = Model("sofa", "Sofa", "A sofa (couch) for three, 2.1 m wide, 48 kg.", 48)
    seat(model, 2.1, 3)
    return model


def armchair() -> Model:
    model = Model("armchair", "Armchair", "An upholstered armchair, 0.95 m wide, 26 kg.", 26)
    seat(model, 0.95, 1)
    return model


def bed() -> Model:
    model = Model("bed", "Bed", "A double bed, mattress 1.6 x 2 m at 0.52 m, 65 kg.", 65)
    legs(model, "wood", 0.95, 0.76, 0.18, 0.08)
    model.block("wood", (2.06, 1.68, 0.14), (0, 0, 0.25), 0.02)
    model.block("wood", (0.06, 1.68, 0.78), (-1.06, 0, 0.57), 0.02)
    model.block("white", (2.0, 1.6, 0.2), (0, 0, 0.42), 0.06)
    model.look("blue", block((1.35, 1.66, 0.14), (0.34, 0, 0.475), 0.06))
    for y in (0.4, -0.4):
        model.look("cream", block((0.42, 0.62, 0.15), (-0.72, y, 0.575), 0.07))
    return model


def desk() -> Model:
    model = Model("desk", "Desk", "A desk of 1.4 x 0.7 m at 0.74 m with drawers, 32 kg.", 32)
    model.block("light_wood", (0.7, 1.4, 0.03), (0, 0, 0.725), 0.006)
    model.block("dark_grey", (0.62, 0.03, 0.71), (0, -0.67, 0.355), 0.006)
    model.block("white", (0.6, 0.42, 0.6), (0, 0.46, 0.41), 0.006)
    model.block("dark_grey", (0.54, 0.36, 0.11), (0, 0.46, 0.055), 0.006)
    for z in (0.22, 0.42, 0.61):
        model.look("light_grey", block((0.02, 0.38, 0.17), (0.305, 0.46, z), 0.006))
        model.look("dark_grey", block((0.02, 0.12, 0.015), (0.322, 0.46, z + 0.05), 0.005))
    return model


def office_chair() -> Model:
    model = Model(
        "office_chair", "Office chair", "A swivel chair that does not roll, 14 kg.", 14, 0.5
    )
    for k in range(5):
        angle = 2 * math.pi * k / 5
        x, y = 0.3 * math.cos(angle), 0.3 * math.sin(angle)
        model.look("dark_grey", rod((0, 0, 0.1), (x, y, 0.085), 0.03, 0.018, 8))
        model.look("black", ball(0.035, (x, y, 0.035), 10))
    model.cylinder(0.31, 0.11, (0, 0, 0.055))
    model.look("steel", rod((0, 0, 0.08), (0, 0, 0.42), 0.03))
    model.cylinder(0.03, 0.31, (0, 0, 0.265))
    model.block("blue", (0.48, 0.5, 0.08), (0, 0, 0.46), 0.035)
    model.look(
        "dark_grey",
        rod((-0.16, 0, 0.43), (-0.3, 0, 0.46), 0.02, 0, 8),
        rod((-0.29, 0, 0.45), (-0.28, 0, 0.75), 0.02, 0, 8),
    )
    model.look("blue", block((0.07, 0.44, 0.5), (-0.25, 0, 0.8), 0.034))
    model.box((0.1, 0.44, 0.52), (-0.26, 0, 0.79))
    for y in (0.28, -0.28):
        model.look(
            "dark_grey",
            rod((-0.05, y * 0.85, 0.43), (-0.05, y, 0.63), 0.016, 0, 8),
            block((0.26, 0.06, 0.03), (0, y, 0.64), 0.012),
        )
    return model


def stool() -> Model:
    model = Model("stool", "Stool", "A wooden stool, seat at 0.45 m, 3.5 kg.", 3.5)
    model.drum("light_wood", 0.17, 0.035, (0, 0, 0.4325), 0.01)
    for k in range(4):
        angle = math.pi / 4 + math.pi / 2 * k
        x, y = math.cos(angle), math.sin(angle)
        model.look(
            "wood", rod((0.17 * x, 0.17 * y, 0), (0.11 * x, 0.11 * y, 0.42), 0.016, 0.02, 10)
        )
    model.cylinder(0.16, 0.415, (0, 0, 0.2075))
    return model


def bookcase() -> Model:
    model = Model("bookcase", "Bookcase", "A bookcase with books, 0.9 x 0.3 x 1.8 m, 42 kg.", 42)
    for y in (0.4375, -0.4375):
        model.block("wood", (0.3, 0.025, 1.8), (0, y, 0.9), 0.004)
    model.block("light_wood", (0.012, 0.85, 1.76), (-0.144, 0, 0.9), 0.003)
    levels = (0.05, 0.4, 0.75, 1.1, 1.45, 1.787)
    for z in levels:
        model.block("wood", (0.288, 0.85, 0.025), (0.006, 0, z), 0.004)
    colors = ("red", "navy", "cream", "green", "orange", "teal", "white", "yellow", "dark_grey")
    for row, z in enumerate(levels[:-1]):
        y = -0.4
        for k in range(15 - 2 * (row % 3)):
            width, height = (
                0.028 + 0.004 * ((k * 7 + row) % 5),
                0.2 + 0.012 * ((k * 5 + row * 3) % 6),
            )
            model.look(
                colors[(k * 4 + row * 5) % len(colors)],
                block((0.2, width, height), (-0.03, y + width / 2, z + 0.0125 + height / 2), 0.003),
            )
            y += width + 0.002
    return model


def wardrobe() -> Model:
    model = Model("wardrobe", "Wardrobe", "A wardrobe of 1.2 x 0.6 x 2 m, 80 kg.", 80)
    model.block("light_wood", (0.56, 1.2, 1.94), (-0.02, 0, 1.03), 0.008)
    model.block("dark_grey", (0.5, 1.14, 0.06), (-0.02, 0, 0.03), 0.004)
    for y in (0.3, -0.3):
        model.look("white", block((0.02, 0.588, 1.9), (0.27, y, 1.03), 0.006))
        model.look("dark_grey", rod((0.3, y * 0.18, 0.9), (0.3, y * 0.18, 1.15), 0.008, 0, 8))
    model.box((0.02, 1.18, 1.9), (0.27, 0, 1.03))
    return model


def coffee_table() -> Model:
    model = Model(
        "coffee_table", "Coffee table", "A coffee table of 1 x 0.6 m at 0.42 m, 14 kg.", 14
    )
    model.look(
        "light_wood",
        loft([level(rounded(1.0, 0.6, 0.08), 0.385), level(rounded(1.0, 0.6, 0.08), 0.42)]),
    )
    model.box((1.0, 0.6, 0.035), (0, 0, 0.4025))
    for x in (0.42, -0.42):
        for y in (0.22, -0.22):
            model.look("dark_wood", rod((x, y, 0), (x * 0.92, y * 0.9, 0.39), 0.014, 0.022, 10))
            model.cylinder(0.02, 0.385, (x * 0.96, y * 0.95, 0.1925))
    return model


def dining_table() -> Model:
    model = Model(
        "dining_table", "Dining table", "A dining table of 1.8 x 0.9 m at 0.75 m, 38 kg.", 38
    )
    model.block("wood", (1.8, 0.9, 0.04), (0, 0, 0.73), 0.012)
    model.block("dark_wood", (1.5, 0.04, 0.07), (0, 0.36, 0.675), 0.006)
    model.block("dark_wood", (1.5, 0.04, 0.07), (0, -0.36, 0.675), 0.006)
    legs(model, "dark_wood", 0.81, 0.36, 0.71, 0.08)
    return model


def floor_lamp() -> Model:
    model = Model("floor_lamp", "Floor lamp", "A floor lamp, 1.6 m high, 6 kg.", 6)
    model.drum("dark_grey", 0.16, 0.03, (0, 0, 0.015), 0.008, 24)
    model.look("dark_grey", rod((0, 0, 0.03), (0, 0, 1.4), 0.012, 0, 8))
    model.cylinder(0.012, 1.27, (0, 0, 0.665))
    model.look(
        "light", lathe([(0.2, 0.0), (0.205, 0.005), (0.125, 0.295), (0.12, 0.3)], 24).moved(z=1.3)
    )
    model.cylinder(0.165, 0.3, (0, 0, 1.45))
    return model


def potted_plant() -> Model:
    model = Model("potted_plant", "Potted plant", "A plant in a terracotta pot, 1 m high, 9 kg.", 9)
    model.look(
        "terracotta",
        lathe(
            [
                (0.12, 0),
                (0.13, 0.01),
                (0.17, 0.27),
                (0.19, 0.27),
                (0.19, 0.32),
                (0.17, 0.32),
                (0.165, 0.3),
            ],
            20,
        ),
    )
    model.look("soil", lathe([(0.16, 0.28), (0.165, 0.302)], 20))
    model.cylinder(0.17, 0.32, (0, 0, 0.16))
    for k in range(16):
        angle, tier = k * 2.4, k / 16
        reach, height = 0.36 - 0.2 * tier, 0.5 + 0.5 * tier
        x, y = math.cos(angle), math.sin(angle)
        stem = (0.04 * x, 0.04 * y, 0.3)
        bend = (reach * 0.6 * x, reach * 0.6 * y, height)
        tip = (reach * x, reach * y, height - 0.12 + 0.1 * tier)
        model.look("dark_leaf", rod(stem, bend, 0.008, 0.006, 6))
        leaf = ball(1.0, sides=8).scaled(0.14, 0.055, 0.012).turned(0, 0.5 - 0.5 * tier, angle)
        middle = [(a + b) / 2 for a, b in zip(bend, tip)]
        model.look("leaf" if k % 2 else "dark_leaf", leaf.moved(*middle))
    return model


def screen_on_foot(model: Model, width: float, height: float, base: float) -> None:
    """A flat screen that faces +x, its lower edge at the height `base`."""
    z = base + height / 2
    model.block("black", (0.04, width, height), (0, 0, z), 0.008)
    model.look("screen", block((0.004, width - 0.03, height - 0.03), (0.02, 0, z), 0.001))
    model.block("dark_grey", (0.03, 0.1, base), (-0.015, 0, base / 2), 0.005)
    model.block("dark_grey", (0.22, width * 0.4, 0.015), (0, 0, 0.0075), 0.005)


def television() -> Model:
    model = Model(
        "television", "Television", "A flat television, 1.25 m wide, on its foot, 16 kg.", 16
    )
    screen_on_foot(model, 1.25, 0.72, 0.09)
    return model


def monitor() -> Model:
    model = Model("monitor", "Monitor", "A computer monitor, 0.6 m wide, 5 kg.", 5)
    screen_on_foot(model, 0.6, 0.36, 0.14)
    return model


def rug() -> Model:
    model = Model("rug", "Rug", "A rug of 2.4 x 1.6 m, 8 mm thick. It is static.")
    model.look(
        "red", loft([level(rounded(2.4, 1.6, 0.05), 0), level(rounded(2.4, 1.6, 0.05), 0.008)])
    )
    model.look(
        "cream",
        loft([level(rounded(2.1, 1.3, 0.04), 0.008), level(rounded(2.1, 1.3, 0.04), 0.009)]),
    )
    model.look(
        "navy", loft([level(rounded(1.9, 1.1, 0.03), 0.009), level(rounded(1.9, 1.1, 0.03), 0.01)])
    )
    model.box((2.4, 1.6, 0.008), (0, 0, 0.004))
    return model


def drawer_unit() -> Model:
    model = Model(
        "drawer_unit", "Drawer unit", "A unit of four drawers, 0.8 x 0.45 x 0.9 m, 36 kg.", 36
    )
    model.block("white", (0.43, 0.8, 0.84), (-0.01, 0, 0.48), 0.006)
    legs(model, "wood", 0.17, 0.35, 0.06, 0.05)
    for k in range(4):
        z = 0.165 + 0.205 * k
        model.look("light_wood", block((0.02, 0.78, 0.195), (0.215, 0, z), 0.005))
        model.look("dark_grey", ball(0.016, (0.236, 0.2, z), 8), ball(0.016, (0.236, -0.2, z), 8))
    return model
