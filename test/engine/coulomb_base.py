"""A skid-steered base on a slope by Coulomb's law: the equations of motion in the plane."""
from __future__ import annotations

import math
from typing import Tuple

import numpy as np
from mobile_bases import SKID, G

POINTS = 8        # of each wheel, along its width
RESTS = 2e-3      # m/s: friction is in proportion to slower slips
SETTLES = 0.1     # share by which the loads follow the forces in a step
STEP = 5e-4       # s


def skid_steered_path(degrees: float, heading: float, mu: float, turn: float, before: float,
                      seconds: float) -> Tuple[float, float, float]:
    """Return the way, m, and turn, rad, on a slope that rises along x, of `skid_steered`.

    It begins at rest, and its wheels have the rates of a turn in place at once. The way is that
    from `before`, s, on, and lasts `seconds`. Wheels load lines on the ground; the load is a linear
    function of the position.
    """
    mass = SKID.mass + 4.0 * SKID.wheel_mass
    high = (SKID.mass * (SKID.radius - SKID.low) + 4.0 * SKID.wheel_mass * SKID.radius) / mass
    corners = np.array([(a, b) for a in (1.0, -1.0) for b in (1.0, -1.0)])
    inertia = SKID.inertia + 4.0 * SKID.wheel_mass * (
        SKID.front ** 2 + SKID.aside ** 2 + (3 * SKID.radius ** 2 + SKID.width ** 2) / 12)
    along = SKID.width * ((np.arange(POINTS) + 0.5) / POINTS - 0.5)
    x = np.repeat(corners[:, 0] * SKID.front, POINTS)
    y = (corners[:, 1, None] * SKID.aside + along).ravel()
    rims = np.repeat(-corners[:, 1] * turn * SKID.aside, POINTS)
    angle = math.radians(degrees)
    pull, total = mass * G * math.sin(angle), mass * G * math.cos(angle)
    place, speed, rate = np.zeros(2), np.zeros(2), 0.0
    felt, start = np.zeros(2), (0.0, 0.0, heading)
    for step in range(round((before + seconds) / STEP)):
        if step == round(before / STEP):
            start = (*place, heading)
        cos, sin = math.cos(heading), math.sin(heading)
        loads = total / len(x) - high / len(x) * (felt[0] * x / np.mean(x ** 2)
                                                  + felt[1] * y / np.mean(y ** 2))
        slip = np.stack([speed[0] - rate * y - rims, speed[1] + rate * x])
        friction = -mu * loads * slip / np.maximum(np.hypot(*slip), RESTS)
        force = friction.sum(axis=1)
        felt = felt + SETTLES * (force - felt)
        speed = speed + STEP * ((force - pull * np.array([cos, -sin])) / mass
                                + rate * np.array([speed[1], -speed[0]]))
        rate += STEP * float((x * friction[1] - y * friction[0]).sum()) / inertia
        heading += STEP * rate
        place = place + STEP * np.array([speed[0] * cos - speed[1] * sin,
                                         speed[0] * sin + speed[1] * cos])
    return float(place[0] - start[0]), float(place[1] - start[1]), heading - start[2]
