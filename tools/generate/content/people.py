"""Standing, walking and sitting people. They face +x and are static."""

from __future__ import annotations

from typing import Iterator, Tuple

import numpy as np

from .meshes import Mesh, ball, block, joined, lathe, level, limb, loft, rounded
from .model import Model

Vec3 = Tuple[float, float, float]
KNEE, ANKLE = 0.48, 0.07


def models() -> Iterator[Model]:
    yield from (standing(), walking(), sitting(), worker(), child())


def both(mesh: Mesh) -> Mesh:
    """A mesh of the left side and its mirror image."""
    return joined([mesh, mesh.mirrored()])


def torso(model: Model, shirt: str, hips: str, base: float, lean: float = 0.0) -> None:
    """From the hips at the height `base` to the neck."""
    rings = [
        level(rounded(x, y, min(x, y) * 0.49, 4), z) + (lean * z, 0, 0)
        for x, y, z in (
            (0.17, 0.3, 0.1),
            (0.18, 0.3, 0.2),
            (0.22, 0.37, 0.4),
            (0.2, 0.4, 0.5),
            (0.13, 0.26, 0.56),
            (0.1, 0.12, 0.58),
        )
    ]
    model.look(shirt, loft(rings).moved(z=base))
    lower = [
        level(rounded(x, y, min(x, y) * 0.49, 4), z)
        for x, y, z in ((0.15, 0.26, -0.1), (0.19, 0.33, 0.0), (0.18, 0.31, 0.12))
    ]
    model.look(hips, loft(lower).moved(z=base))


def head(model: Model, at: Vec3, skin: str, hair: str = "hair") -> None:
    """A head with its neck, `at` the centre of the head."""
    x, y, z = at
    model.look(
        skin,
        ball(1.0, sides=16).scaled(0.095, 0.08, 0.12).moved(x + 0.008, y, z),
        limb((x - 0.015, y, z - 0.2), (x - 0.008, y, z - 0.08), 0.05, 0.045),
        ball(0.016, (x + 0.105, y, z - 0.012), 8),
        both(ball(0.02, (x - 0.005, 0.078, z - 0.01), 8)).moved(y=y),
    )
    model.look(hair, ball(1.0, sides=16).scaled(0.1, 0.088, 0.1).moved(x - 0.014, y, z + 0.038))
    model.look("black", both(ball(0.011, (x + 0.093, 0.033, z + 0.012), 6)).moved(y=y))


def leg(hip: Vec3, knee: Vec3, ankle: Vec3) -> Mesh:
    """Thigh and shin."""
    return joined([limb(hip, knee, 0.085, 0.06), limb(knee, ankle, 0.058, 0.045)])


def shoe(ankle: Vec3, pitch: float = 0.0) -> Mesh:
    return block((0.27, 0.095, 0.085), (0.055, 0, -0.028), 0.035).turned(0, pitch).moved(*ankle)


def arm(model: Model, shoulder: Vec3, elbow: Vec3, wrist: Vec3, sleeve: str, skin: str) -> None:
    """An arm with a short sleeve and a hand."""
    model.look(sleeve, limb(shoulder, elbow, 0.056, 0.046))
    reach = np.subtract(wrist, elbow)
    hand = np.add(wrist, reach / np.linalg.norm(reach) * 0.05)
    model.look(
        skin,
        limb(elbow, wrist, 0.041, 0.03),
        ball(1.0, sides=8).scaled(0.04, 0.028, 0.05).moved(*map(float, hand)),
    )


def standing() -> Model:
    model = Model(
        "person_standing", "Person, standing", "A person of 1.75 m who stands. It is static."
    )
    torso(model, "teal", "denim", 0.9)
    head(model, (0, 0, 1.63), "skin")
    model.look("denim", both(leg((0, 0.1, 0.86), (0.02, 0.105, KNEE), (-0.01, 0.105, 0.11))))
    model.look("black", both(shoe((0, 0.105, ANKLE))))
    for side in (1, -1):
        arm(
            model,
            (0, 0.21 * side, 1.38),
            (-0.02, 0.26 * side, 1.1),
            (0.05, 0.27 * side, 0.87),
            "teal",
            "skin",
        )
    model.cylinder(0.22, 0.9, (0, 0, 0.45))
    model.box((0.26, 0.52, 0.6), (0, 0, 1.2))
    model.sphere(0.13, (0, 0, 1.63))
    return model


def stride(model: Model, shirt: str, trousers: str, skin: str) -> None:
    """A body in the middle of a step."""
    torso(model, shirt, trousers, 0.88, 0.06)
    head(model, (0.05, 0, 1.61), skin)
    model.look(
        trousers,
        leg((0.02, 0.1, 0.84), (0.25, 0.1, 0.5), (0.33, 0.1, 0.12)),
        leg((0, -0.1, 0.84), (-0.05, -0.1, 0.45), (-0.38, -0.1, 0.22)),
    )
    model.look("dark_grey", shoe((0.35, 0.1, ANKLE), -0.05), shoe((-0.38, -0.1, 0.15), 0.75))
    arm(model, (0.02, 0.21, 1.36), (-0.16, 0.25, 1.13), (-0.1, 0.26, 0.88), shirt, skin)
    arm(model, (0.02, -0.21, 1.36), (0.16, -0.25, 1.12), (0.33, -0.23, 0.98), shirt, skin)
    model.box((0.9, 0.34, 0.84), (-0.02, 0, 0.42))
    model.box((0.5, 0.54, 0.6), (0.06, 0, 1.16))
    model.sphere(0.13, (0.06, 0, 1.61))


def walking() -> Model:
    model = Model(
        "person_walking", "Person, walking", "A person of 1.73 m in a step. It is static."
    )
    stride(model, "red", "dark_grey", "brown_skin")
    return model


def sitting() -> Model:
    model = Model(
        "person_sitting",
        "Person, sitting",
        "A person who sits on a seat of 0.46 m; the origin is below the seat. It is static.",
    )
    torso(model, "orange", "navy", 0.55)
    head(model, (0.02, 0, 1.28), "skin")
    model.look("navy", both(leg((0, 0.1, 0.53), (0.42, 0.11, 0.52), (0.42, 0.11, 0.12))))
    model.look("black", both(shoe((0.43, 0.11, ANKLE))))
    for side in (1, -1):
        arm(
            model,
            (0, 0.21 * side, 1.03),
            (0.03, 0.25 * side, 0.77),
            (0.26, 0.16 * side, 0.66),
            "orange",
            "skin",
        )
    model.box((0.26, 0.52, 0.7), (0, 0, 0.81))
    model.box((0.5, 0.36, 0.16), (0.3, 0, 0.54))
    model.box((0.32, 0.34, 0.46), (0.48, 0, 0.23))
    model.sphere(0.13, (0.02, 0, 1.28))
    return model


def worker() -> Model:
    model = Model(
        "person_worker", "Worker", "A worker with a helmet and a safety vest. It is static."
    )
    stride(model, "orange", "navy", "skin")
    model.look(
        "yellow",
        lathe([(0.118, 0), (0.112, 0.02), (0.108, 0.06), (0.075, 0.11), (0.0, 0.125)], 16).moved(
            0.045, 0, 1.65
        ),
        block((0.11, 0.17, 0.012), (0.15, 0, 1.655), 0.005),
    )
    for z, x, y in ((1.09, 0.222, 0.36), (1.22, 0.232, 0.39)):
        model.look(
            "light",
            loft(
                [
                    level(rounded(x, y, x * 0.49, 4), z) + (0.06 * (z - 0.88), 0, 0),
                    level(rounded(x, y, x * 0.49, 4), z + 0.045) + (0.06 * (z - 0.84), 0, 0),
                ]
            ),
        )
    return model


def child() -> Model:
    small = Model("person_child", "Child", "A child of 1.15 m who stands. It is static.")
    adult = standing()
    small.parts = [
        ({"teal": "yellow", "denim": "green"}.get(color, color), mesh.scaled(0.68, 0.7, 0.64))
        for color, mesh in adult.parts
        if mesh.vertices[:, 2].min() < 1.4
    ]
    head(small, (0, 0, 1.04), "skin", "wood")
    small.cylinder(0.16, 0.58, (0, 0, 0.29))
    small.box((0.2, 0.37, 0.38), (0, 0, 0.77))
    small.sphere(0.125, (0, 0, 1.04))
    return small
