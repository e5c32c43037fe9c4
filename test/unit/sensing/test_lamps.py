"""Which lights a picture is drawn under."""
from __future__ import annotations

import numpy as np

from my_simulations.description.light import Light
from my_simulations.geometry import Pose
from my_simulations.sensing.api import CameraSpec
from my_simulations.sensing.camera.lamps import chosen_lights
from my_simulations.sensing.camera.shaders import MOST_LIGHTS

# From a camera at the origin that looks along x to its view frame.
VIEW = np.array([[0.0, -1, 0, 0], [0, 0, 1, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])


def lamp(x, kind="point"):
    return Light(f"{kind} at {x}", kind, Pose((float(x), 0.0, 0.0)), range=5.0)


def names(lights):
    return {light.name for light in chosen_lights(lights, VIEW, CameraSpec(64, 48))}


def test_of_few_lights_all_count_in_their_order():
    lights = [lamp(x) for x in range(-40, 0, 5)]
    assert chosen_lights(lights, VIEW, CameraSpec(64, 48)) is lights


def test_of_many_lights_count_those_from_afar_what_the_camera_sees_lit_and_near_ones():
    behind = [lamp(-x) for x in (8, 7, 9, 10, 11, 12)]
    ahead = [lamp(x, kind) for x, kind in ((60, "point"), (20, "spot"), (40, "point"))]
    sun = lamp(-1000, "directional")
    many = [*behind, *ahead, sun]
    assert names(many) == {one.name for one in [sun, *ahead, *behind[:4]]}
    row = [lamp(10 * x) for x in range(20, 0, -1)]
    assert names(row) == {f"point at {10 * x}" for x in range(1, MOST_LIGHTS + 1)}
