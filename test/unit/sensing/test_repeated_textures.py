"""Textures of one size on all faces of a box, as on walls of buildings."""
from __future__ import annotations

import math

import numpy as np
import pytest

from my_simulations.description.picture_size import picture_size_of, picture_size_xml
from my_simulations.description.shapes import Box, Cylinder, Visual
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.sensing.surfaces import pieces_of

SIZE = (4.0, 0.2, 2.5)


def face(visual, axis, sign):
    """Places and texture coordinates of the corners of one face."""
    [piece] = pieces_of(visual, None)
    rows = piece.rows[piece.rows[:, 3 + axis] == sign]
    return rows[:, :3], rows[:, 6:]


def wall(size=0.5, pose=Pose()):
    return Visual("wall", Box(SIZE), pose, extra=[picture_size_xml(size)])


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", (1, -1))
def test_a_picture_has_one_size_on_all_faces_and_is_upright(axis, sign):
    at, uv = face(wall(), axis, sign)
    edges = [SIZE[n] for n in range(3) if n != axis]
    if axis == 0:
        assert np.ptp(uv, axis=0) == pytest.approx([SIZE[1] / 0.5, SIZE[2] / 0.5])
    else:
        assert np.ptp(uv, axis=0) == pytest.approx([SIZE[0] / 0.5, edges[1] / 0.5])
    if axis != 2:
        assert uv[:, 1] == pytest.approx(at[:, 2] / 0.5)
    # Not mirrored: seen from outside, u, v and the normal are right-handed.
    u, v = (np.linalg.lstsq(np.delete(at, axis, 1), uv[:, n] - uv[0, n], rcond=None)[0]
            for n in (0, 1))
    a, b = (n for n in range(3) if n != axis)
    across, up = np.zeros(3), np.zeros(3)
    across[[a, b]], up[[a, b]] = u, v
    assert np.cross(across, up)[axis] * sign > 0


def test_pictures_of_two_parts_of_a_wall_meet():
    left = wall(pose=Pose((-2.0, 0.0, 1.25)))
    right = wall(pose=Pose((2.0, 0.0, 1.25)))
    (_, uv), (_, theirs) = face(left, 1, -1), face(right, 1, -1)
    assert max(uv[:, 0]) == pytest.approx(min(theirs[:, 0])) == pytest.approx(0.0)
    assert min(uv[:, 1]) == pytest.approx(0.0)


def test_a_turned_part_begins_at_the_origin_of_its_link_too():
    turned = wall(pose=Pose((0.0, 3.0, 0.0), quat_from_rpy(0.0, 0.0, math.pi / 2)))
    _, uv = face(turned, 1, -1)
    assert [min(uv[:, 0]), max(uv[:, 0])] == pytest.approx([1.0 / 0.5, 5.0 / 0.5])


def test_other_shapes_and_unusable_sizes_keep_one_picture_a_face():
    assert np.ptp(face(Visual("v", Box(SIZE)), 1, 1)[1], axis=0) == pytest.approx([1.0, 1.0])
    for text in ("0", "nan", "inf", "-1", "wide"):
        odd = Visual("v", Box(SIZE), extra=[picture_size_xml(1.0).replace(">1<", f">{text}<")])
        assert picture_size_of(odd) is None
    round_one = Visual("v", Cylinder(0.5, 1.0), extra=[picture_size_xml(0.1)])
    [piece] = pieces_of(round_one, None)
    assert piece.rows[:, 6:].max() == pytest.approx(1.0)
