"""What is built of loose pieces stands: a wall of bricks, an arch, a row of dominoes falls."""
from __future__ import annotations

import math
from typing import List, Tuple

import pytest
import structures
from conftest import Lab, ground
from laws import Laws


def _built(lab: Lab, pieces: List[structures.Piece]) -> List[Tuple[int, structures.Piece]]:
    lab.load(ground())
    return structures.load(lab, pieces)


def test_a_wall_of_two_hundred_bricks_stands(lab: Lab, laws: Laws):
    wall = _built(lab, structures.wall())
    lab.seconds(1)
    for number, brick in wall:
        laws.near("a wall of 200 bricks, awake, for 1 s: off their place, m",
                  lab.pose(number).position, brick.position, abs=2e-3)


@pytest.mark.parametrize("seconds", [10, pytest.param(60, marks=pytest.mark.long)])
def test_an_arch_stands(lab: Lab, laws: Laws, seconds: int):
    arch = _built(lab, structures.arch())
    lab.seconds(seconds)
    for number, stone in arch:
        laws.near(f"an arch of 11 stones, awake, for {seconds} s: off their place, m",
                  lab.pose(number).position, stone.position, abs=5e-3)


def test_dominoes_fall_one_after_the_other(lab: Lab):
    row = _built(lab, structures.dominoes())
    lab.seconds(4)
    for number, piece in row:
        if piece.name != "pusher":
            x, y = lab.pose(number).orientation[:2]
            assert math.degrees(2 * math.asin(math.hypot(x, y))) > 20, piece.name
