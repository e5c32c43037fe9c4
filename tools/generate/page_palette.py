#!/usr/bin/env python3
"""Write web/js/palette.ts, the page's copy of my_simulations.appearance.palette."""
from __future__ import annotations

import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
MODULE = REPOSITORY / "web" / "js" / "palette.ts"
HEAD = """/**
 * Numbers of looks that the page and the cameras share. Written by tools/generate/page_palette.py
 * from src/my_simulations/appearance/palette.py: edit that file, not this one.
 */

"""


def module() -> str:
    """The text of the page's module."""
    from my_simulations.appearance import palette

    lines = [f"export const GREY = [{', '.join(f'{part:g}' for part in palette.GREY)}];"]
    lines += [f"export const {name} = {getattr(palette, name):g};"
              for name in ("GROUND", "DULLEST", "SHININESS")]
    shapes = [f"  {name}: [{', '.join(f'{part:g}' for part in color)}],"
              for name, color in palette.SHAPE_COLORS.items()]
    lines += ["", "/** Of the shapes that the editor inserts, r, g, b, a. */",
              "export const SHAPE_COLORS: Record<string, number[]> = Object.freeze({",
              *shapes, "});"]
    sky = [f"  {name}: 0x{value:06x}," for name, value in palette.SKY._asdict().items()]
    lines += ["", "export const SKY = Object.freeze({", *sky, "});", "",
              "/** GLSL: the colour of the sky, linear, in a direction. */",
              f"export const SKY_COLOR = `{palette.SKY_COLOR}`;", "",
              "export interface Pattern {",
              "  painter: string; colors: string[]; count: number; grain: number;", "}", "",
              "export const PATTERNS: Record<string, Pattern> = Object.freeze({"]
    for name, one in palette.PATTERNS.items():
        colors = ", ".join(f"'#{color:06x}'" for color in one.colors)
        lines.append(f"  {name}: {{painter: '{one.painter}', colors: [{colors}], count: "
                     f"{one.count}, grain: {one.grain}}},")
    return HEAD + "\n".join([*lines, "});", ""])


if __name__ == "__main__":
    sys.path.insert(0, str(REPOSITORY / "src"))
    MODULE.write_text(module(), encoding="utf-8")
