"""Pictures through wide-angle lenses against the lenses' formulas."""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from sensing_scene import body, table

from my_simulations.appearance.looks import Look
from my_simulations.description.shapes import Box, Sphere
from my_simulations.description.surroundings import Scene
from my_simulations.geometry import Pose, compose, quat_from_rpy
from my_simulations.sensing.api import DEPTH, LABELS, NO_ROW, RGB, CameraSpec, WideLens
from my_simulations.sensing.camera.renderer import Renderer
from my_simulations.sensing.poses import matrix

EYE = Pose((3.0, -1.0, 2.0), quat_from_rpy(0.2, -0.3, 0.9))
FUNCTIONS = {"tan": math.tan, "sin": math.sin, "id": float}
LENSES = {
    "gnomonical": WideLens(1.0 / math.tan(0.6), 1.0, 0.0, "tan", math.pi, 1024),
    "stereographic": WideLens(1.0 / math.tan(0.7), 2.0, 0.0, "tan", math.pi, 1024),
    "equidistant": WideLens(1.0 / math.pi, 1.0, 0.0, "id", math.pi, 1024),
    "equisolid_angle": WideLens(1.0, 2.0, 0.0, "sin", math.pi, 1024),
    "orthographic": WideLens(1.0, 1.0, 0.0, "sin", math.pi, 1024),
    "custom": WideLens(2.0, 4.0, 0.1, "tan", math.pi, 1024),
}
SPEC = CameraSpec(400, 300, 2.0, near=0.02)


@pytest.fixture(scope="module")
def renderer():
    made = Renderer(lambda text: None)
    made.set_lights([], Scene(ambient=(1.0, 1.0, 1.0, 1.0), background=(0.0, 0.0, 0.5, 1.0)))
    return made


@pytest.fixture
def see(renderer):
    def look(shape, pose, lens, outputs, spec=SPEC):
        renderer.add(body("b", shape, 0, Look(diffuse=(1.0, 0.0, 0.0, 1.0), lit=False)))
        return renderer.render(replace(spec, lens=lens), matrix(EYE), table([compose(EYE, pose)]),
                               outputs)

    yield look
    renderer.remove("b")


def towards(angle, about, distance=4.0):
    """At an angle to the optical axis; `about` it from the right, clockwise in the picture."""
    out = distance * math.sin(angle)
    return Pose((distance * math.cos(angle), -out * math.cos(about), -out * math.sin(about)))


def place_of(lens, angle, about):
    """Column and row."""
    away = lens.scale * FUNCTIONS[lens.fun](angle / lens.c2 + lens.c3) * 200.0
    return 199.5 + away * math.cos(about), 149.5 + away * math.sin(about)


def cases():
    """What each lens sees within the picture."""
    for name, lens in LENSES.items():
        most = math.pi / 2.0 * lens.c2
        for angle in (0.0, 0.3, 0.62, 0.8, 1.3, 2.0, 2.8):
            for about in (0.4, 2.0, -2.6):
                column, row = place_of(lens, angle, about)
                blind = lens.c3 * lens.c2 + 0.2 if lens.c3 else 0.0
                if blind <= angle < most and 9.0 < column < 390.0 and 9.0 < row < 290.0:
                    yield name, angle, about


@pytest.mark.parametrize(("name", "angle", "about"), list(cases()))
def test_a_point_falls_where_the_lens_puts_it(see, name, angle, about):
    found = see(Sphere(0.08), towards(angle, about), LENSES[name], (LABELS,)).labels == 0
    rows, columns = np.nonzero(found)
    assert (columns.mean(), rows.mean()) == pytest.approx(place_of(LENSES[name], angle, about),
                                                          abs=0.7)


def test_the_colours_are_those_of_the_pinhole_pictures_without_seams(see):
    """A wall before the camera fills the rays that point forward; the others see the sky."""
    spec = CameraSpec(200, 200, 2.0, near=0.02)
    lens = WideLens(1.0 / math.pi, 1.0, 0.0, "id", math.pi, 128)
    seen = see(Box((0.1, 40.0, 40.0)), Pose((2.0, 0.0, 0.0)), lens, (RGB, DEPTH, LABELS), spec)
    row, column = np.mgrid[:200, :200]
    angle = np.hypot(column - 99.5, row - 99.5) / 100.0 * math.pi
    wall = angle < math.atan(15.0 / 1.95)
    assert (seen.labels[wall] == 0).all()
    assert (seen.rgb[wall] == seen.rgb[99, 99]).all()
    assert seen.depth[wall] == pytest.approx(1.95, abs=1e-3)     # along the camera's axis
    sky = (angle > math.pi / 2 + 0.05) & (angle < math.pi - 0.05)
    assert (seen.labels[sky] == NO_ROW).all()
    assert (seen.rgb[sky] == seen.rgb[100, 30]).all()
    assert seen.rgb[100, 30].tolist() != [0, 0, 0]
    outside = angle > math.pi + 0.01
    assert (seen.rgb[outside] == 0).all()
    assert np.isinf(seen.depth[outside]).all()


def test_rays_beyond_the_cutoff_are_black(see):
    lens = replace(LENSES["equidistant"], cutoff=1.0)
    seen = see(Sphere(0.1), towards(0.5, 0.0), lens, (RGB,)).rgb
    row, column = np.mgrid[:300, :400]
    angle = np.hypot(column - 199.5, row - 149.5) / 200.0 * math.pi
    assert (seen[angle > 1.01] == 0).all()
    assert (seen[angle < 0.99].max(axis=1) > 0).all()
