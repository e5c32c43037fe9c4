"""Convex solids whose faces move inwards."""
from __future__ import annotations

import itertools

import numpy as np
import pytest

from my_simulations.engine.convex.hull_points import shrunk

CORNERS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
FACES = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7),
                  (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
SIZE = np.array((1.0, 0.2, 0.05))


@pytest.mark.parametrize("faces", [FACES, FACES[:, ::-1]])
def test_all_faces_of_a_box_move_inwards(faces):
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    made = shrunk((CORNERS * SIZE) @ turn + (1, 2, 3), faces, 0.001)
    assert made == pytest.approx((CORNERS * (SIZE - 0.002)) @ turn + (1, 2, 3), abs=1e-9)


def test_corners_that_every_triangle_has_for_itself_move_together():
    made = shrunk((CORNERS * SIZE)[FACES].reshape(-1, 3), np.arange(36).reshape(-1, 3), 0.001)
    assert np.ptp(made, axis=0) == pytest.approx(SIZE - 0.002)


def test_what_is_too_thin_stays():
    thin = CORNERS * (1.0, 1.0, 0.002)
    assert (shrunk(thin, FACES, 0.001) == thin).all()


def test_a_sharp_corner_moves_only_so_far():
    needle = np.array([(0, 0, 0), (0, 0.02, 0), (0, 0, 0.02), (2.0, 0, 0)])
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    made = shrunk(needle, faces, 0.001)
    assert np.linalg.norm(made - needle, axis=1).max() <= 0.003 + 1e-12
