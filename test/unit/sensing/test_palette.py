"""Looks of the page and of cameras come from one table."""
from __future__ import annotations

import pathlib
import re
import sys

import pytest

from my_simulations.appearance.gazebo_materials import BUILT_IN
from my_simulations.appearance.materials import Materials
from my_simulations.appearance.palette import GROUND, PATTERNS
from my_simulations.appearance.textures import TextureFiles
from my_simulations.description.shapes import Box, Material, Plane, Visual
from my_simulations.resources.resolver import Resolver
from my_simulations.sensing.camera.pictures import draw_pattern
from my_simulations.sensing.surfaces import pieces_of

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]


def test_the_page_has_the_present_palette():
    sys.path.insert(0, str(REPOSITORY / "tools" / "generate"))
    import page_palette

    assert page_palette.MODULE.read_text(encoding="utf-8") == page_palette.module(), \
        "run tools/generate/page_palette.py"


def test_nobody_has_colours_of_the_sky_or_of_patterns_beside_it():
    for name in ("environment.ts", "builtin_textures.ts", "materials.ts"):
        text = (REPOSITORY / "web" / "js" / "view" / name).read_text(encoding="utf-8")
        assert not re.search(r"0x[0-9a-f]{6}|'#[0-9a-f]{3,6}'", text), name


def test_each_pattern_of_gazebos_materials_can_be_drawn():
    named = {paint.pattern for paint in BUILT_IN.values() if paint.pattern}
    assert named <= set(PATTERNS) and all(draw_pattern(name) is not None for name in named)


@pytest.fixture
def look():
    resolver = Resolver()
    return Materials(resolver, TextureFiles(resolver)).resolve


def test_the_alpha_of_a_colour_counts_once(look):
    glass = look(Material(diffuse=(0.2, 0.3, 0.4, 0.25)))
    assert glass.transparency == pytest.approx(0.75)
    (piece,) = pieces_of(Visual("v", Box()), glass)
    assert piece.surface.opacity == pytest.approx(0.25)
    (piece,) = pieces_of(Visual("v", Box(), transparency=0.5), glass)
    assert piece.surface.opacity == pytest.approx(0.125)


def test_planes_are_darker_than_what_stands_on_them(look):
    grey = look(Material(script_name="Gazebo/Grey"))
    (plane,), (box,) = pieces_of(Visual("v", Plane()), grey), pieces_of(Visual("v", Box()), grey)
    assert (plane.surface.brightness, box.surface.brightness) == (GROUND, 1.0)
    assert plane.surface.diffuse == box.surface.diffuse
