"""Signs and lamps of streets and halls. They face +x, unless their docstring differs."""

from __future__ import annotations

import math
from typing import Iterator, List, Sequence, Tuple

from .meshes import Mesh, ball, block, lathe, level, loft, plate, rod, standing
from .model import Model


def models() -> Iterator[Model]:
    yield from (
        stop_sign(),
        yield_sign(),
        speed_limit_sign(),
        parking_sign(),
        arrow_sign(),
        wet_floor_sign(),
        traffic_light(),
        street_lamp(),
        marker_board(),
    )


def regular(corners: int, radius: float, turn: float = 0.0) -> List[Tuple[float, float]]:
    """A regular polygon, counter-clockwise."""
    return [
        (
            radius * math.cos(turn + 2 * math.pi * k / corners),
            radius * math.sin(turn + 2 * math.pi * k / corners),
        )
        for k in range(corners)
    ]


def facing(outline: Sequence[Tuple[float, float]], thickness: float, x: float, z: float) -> Mesh:
    """An outline seen from +x (first axis to the left of the sign's back) with its front at x."""
    mesh = standing(plate([(-a, b) for a, b in reversed(list(outline))], thickness))
    return mesh.turned(0, 0, math.pi / 2).moved(x - thickness / 2, 0, z)


def stroke(points: Sequence[Tuple[float, float]], width: float) -> List[List[Tuple[float, float]]]:
    """Rectangles along a path, for simple letters."""
    made = []
    for (ax, ay), (bx, by) in zip(points, points[1:]):
        length = math.hypot(bx - ax, by - ay)
        nx, ny = (ay - by) / length * width / 2, (bx - ax) / length * width / 2
        ex, ey = (bx - ax) / length * width / 2, (by - ay) / length * width / 2
        made.append(
            [
                (ax - ex - nx, ay - ey - ny),
                (bx + ex - nx, by + ey - ny),
                (bx + ex + nx, by + ey + ny),
                (ax - ex + nx, ay - ey + ny),
            ]
        )
    return made


LETTERS = {
    "S": [(0.5, 0.9), (0.1, 0.9), (0.1, 0.5), (0.5, 0.5), (0.5, 0.1), (0.1, 0.1)],
    "T": [(0.3, 0.1), (0.3, 0.9), (0.05, 0.9), (0.55, 0.9)],
    "O": [(0.1, 0.1), (0.5, 0.1), (0.5, 0.9), (0.1, 0.9), (0.1, 0.1)],
    "P": [(0.1, 0.1), (0.1, 0.9), (0.5, 0.9), (0.5, 0.5), (0.1, 0.5)],
    "3": [(0.1, 0.9), (0.5, 0.9), (0.5, 0.5), (0.2, 0.5), (0.5, 0.5), (0.5, 0.1), (0.1, 0.1)],
    "0": [(0.1, 0.1), (0.5, 0.1), (0.5, 0.9), (0.1, 0.9), (0.1, 0.1)],
}


def lettering(text: str, height: float, x: float, z: float) -> List[Mesh]:
    """Letters of strokes, readable from +x, centred at (x, 0, z)."""
    made = []
    for k, letter in enumerate(text):
        left = (k - len(text) / 2) * 0.62
        path = [((left + a) * height, (b - 0.5) * height) for a, b in LETTERS[letter]]
        made += [
            facing([(-a, b) for a, b in reversed(rectangle)], 0.002, x, z)
            for rectangle in stroke(path, 0.13 * height)
        ]
    return made


def post(model: Model, height: float) -> None:
    """A steel post with a plate at its foot."""
    model.look("steel", rod((0, 0, 0), (0, 0, height), 0.03))
    model.look("dark_grey", lathe([(0.14, 0), (0.13, 0.03), (0.05, 0.04)], 20))
    model.cylinder(0.03, height, (0, 0, height / 2))
    model.cylinder(0.14, 0.03, (0, 0, 0.015))


def board(model: Model, size: float, z: float) -> None:
    """What a sign of this size collides with."""
    model.box((0.02, size, size), (0.04, 0, z))


def stop_sign() -> Model:
    model = Model("stop_sign", "Stop sign", "A stop sign on a post, 2.4 m high. It is static.")
    post(model, 2.3)
    model.look("white", facing(regular(8, 0.42, math.pi / 8), 0.015, 0.045, 2.05))
    model.look("red", facing(regular(8, 0.395, math.pi / 8), 0.004, 0.049, 2.05))
    model.look("white", *lettering("STOP", 0.26, 0.051, 2.05))
    board(model, 0.78, 2.05)
    return model


def yield_sign() -> Model:
    model = Model("yield_sign", "Yield sign", "A yield sign on a post, 2.4 m high. It is static.")
    post(model, 2.2)
    model.look("red", facing(regular(3, 0.5, -math.pi / 2), 0.015, 0.045, 2.1))
    model.look("white", facing(regular(3, 0.36, -math.pi / 2), 0.004, 0.049, 2.1))
    board(model, 0.7, 2.1)
    return model


def speed_limit_sign() -> Model:
    """It faces -y and its mesh is a tenth of it, as in Gazebo: saved worlds scale that file."""
    model = Model(
        "speed_limit_sign",
        "Speed limit 30",
        "A speed limit of 30 km/h on a post. It is static.",
        mesh_scale=10.0,
    )
    post(model, 2.06)
    for color, meshes in (
        ("red", [facing(regular(32, 0.32), 0.015, 0.045, 2.04)]),
        ("white", [facing(regular(32, 0.25), 0.004, 0.049, 2.04)]),
        ("black", lettering("30", 0.24, 0.051, 2.04)),
    ):
        model.look(color, *(mesh.turned(0, 0, -math.pi / 2) for mesh in meshes))
    model.box((0.6, 0.02, 0.6), (0, -0.04, 2.04))
    return model


def parking_sign() -> Model:
    model = Model("parking_sign", "Parking sign", "A parking sign on a post. It is static.")
    post(model, 2.3)
    model.look("white", block((0.015, 0.62, 0.62), (0.04, 0, 2.05), 0.004))
    model.look("blue", block((0.004, 0.57, 0.57), (0.049, 0, 2.05), 0.001))
    model.look("white", *lettering("P", 0.44, 0.053, 2.05))
    board(model, 0.62, 2.05)
    return model


def arrow_sign() -> Model:
    model = Model(
        "arrow_sign",
        "Arrow sign",
        "A round blue sign with an arrow to the right of who faces it. It is static.",
    )
    post(model, 2.3)
    model.look("white", facing(regular(32, 0.32), 0.015, 0.045, 2.1))
    model.look("blue", facing(regular(32, 0.3), 0.004, 0.049, 2.1))
    arrow = [
        (-0.2, -0.035),
        (0.05, -0.035),
        (0.05, -0.11),
        (0.21, 0.0),
        (0.05, 0.11),
        (0.05, 0.035),
        (-0.2, 0.035),
    ]
    model.look("white", facing([(-a, b) for a, b in reversed(arrow)], 0.002, 0.051, 2.1))
    board(model, 0.6, 2.1)
    return model


def wet_floor_sign() -> Model:
    model = Model(
        "wet_floor_sign", "Wet floor sign", "A folding warning sign, 0.62 m high, 1.2 kg.", 1.2, 0.7
    )
    for side in (1, -1):
        panel = standing(plate([(-0.15, 0), (0.15, 0), (0.11, 0.63), (-0.11, 0.63)], 0.012, 0.003))
        model.look(
            "yellow", panel.turned(0, 0, math.pi / 2).turned(0, -0.25 * side).moved(x=0.155 * side)
        )
        mark = facing(regular(3, 0.075, math.pi / 2), 0.002, 0.007, 0.0)
        model.look(
            "red",
            (mark if side > 0 else mark.turned(0, 0, math.pi))
            .turned(0, -0.25 * side)
            .moved(0.065 * side, 0, 0.38),
        )
        model.box((0.014, 0.27, 0.62), (0.079 * side, 0, 0.304), (0, -0.25 * side, 0))
    return model


def traffic_light() -> Model:
    model = Model(
        "traffic_light",
        "Traffic light",
        "A traffic light on a post, 3.1 m high, on red. It is static.",
    )
    post(model, 3.0)
    model.block("black", (0.22, 0.32, 0.95), (0.12, 0, 2.55), 0.04)
    for color, z in (("red", 2.85), ("dark_wood", 2.55), ("dark_leaf", 2.25)):
        model.look(color, ball(1.0, sides=14).scaled(0.03, 0.105, 0.105).moved(0.23, 0, z))
        hood = lathe([(0.125, 0), (0.125, 0.13), (0.115, 0.13), (0.115, 0.01)], 18)
        model.look("dark_grey", hood.turned(0, math.pi / 2).moved(0.225, 0, z))
    return model


def street_lamp() -> Model:
    model = Model("street_lamp", "Street lamp", "A street lamp, 4.5 m high. It is static.")
    model.look(
        "dark_grey",
        lathe([(0.12, 0), (0.12, 0.5), (0.07, 0.6), (0.045, 4.3)], 16),
        rod((0, 0, 4.28), (0.9, 0, 4.5), 0.035, 0.03),
        block((0.6, 0.24, 0.09), (1.05, 0, 4.52), 0.03),
    )
    model.look("light", block((0.5, 0.18, 0.02), (1.05, 0, 4.47), 0.006))
    model.cylinder(0.12, 0.55, (0, 0, 0.275))
    model.cylinder(0.06, 3.75, (0, 0, 2.425))
    model.box((1.4, 0.24, 0.1), (0.68, 0, 4.46), (0, -0.15, 0))
    return model


MARKER = (
    "00000000",
    "01101010",
    "01001110",
    "00110100",
    "01011010",
    "00101110",
    "01110010",
    "00000000",
)
"""Black is 0: a marker that a robot can recognise, of 6 x 6 cells in a black frame."""


def marker_board() -> Model:
    model = Model(
        "marker_board",
        "Marker board",
        "A square marker of 0.4 m on a stand, for cameras. It is static.",
    )
    model.block("white", (0.02, 0.6, 0.6), (0, 0, 0.9), 0.004)
    cell = 0.05
    for row, cells in enumerate(MARKER):
        for column, value in enumerate(cells):
            if value == "0":
                model.look(
                    "black",
                    block(
                        (0.002, cell, cell),
                        (0.0105, (3.5 - column) * cell, 0.9 + (3.5 - row) * cell),
                        0.0,
                    ),
                )
    model.block("dark_grey", (0.04, 0.06, 0.6), (-0.02, 0, 0.3), 0.006)
    model.look("dark_grey", loft([level(regular(20, 0.2), 0.0), level(regular(20, 0.19), 0.03)]))
    model.cylinder(0.2, 0.03, (0, 0, 0.015))
    return model
