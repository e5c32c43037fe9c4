"""BVH files, which move actors, against closed forms."""
from __future__ import annotations

import math

import numpy as np
import pytest
from walking_figures import BVH

from my_simulations.formats.mesh.bvh import read_bvh
from my_simulations.formats.mesh.part import MeshError

HALF = math.sqrt(0.5)


def test_joints_and_frames_are_read_and_end_sites_are_no_joints():
    bones, clip = read_bvh(BVH.encode())
    assert (bones.names, bones.parents, clip.duration) == (["hip", "chest"], [-1, 0], 1.5)
    [keys] = clip.keys
    assert np.allclose(keys.times, (0.0, 0.5, 1.0, 1.5))
    # A position takes the place of its part of the offset.
    assert np.allclose(keys.places[3], [(0.2, 0.0, 0.5), (0.0, 0.0, 1.0)])


def test_turns_follow_each_other_in_the_order_of_their_channels():
    [keys] = read_bvh(BVH.encode())[1].keys
    assert np.allclose(keys.turns[1], [(0, 0, 0, 1), (HALF, 0, 0, HALF)])
    # About z by a quarter, then about the new x by one: x becomes y, z becomes x.
    assert np.allclose(keys.turns[2, 0], (0.5, 0.5, 0.5, 0.5))


def test_channels_that_nobody_knows_say_nothing():
    text = BVH.replace("CHANNELS 6 Xposition", "CHANNELS 9 Wposition Wrotation zrotation Xposition")
    rows = text.splitlines()
    text = "\n".join(rows[:-4] + [f"7 50 30 {row}" for row in rows[-4:]])
    [keys], [plain] = read_bvh(text.encode())[1].keys, read_bvh(BVH.encode())[1].keys
    assert np.allclose(keys.places, plain.places) and np.allclose(keys.turns, plain.turns)


@pytest.mark.parametrize("end", ["\r\n", "\r"])
def test_any_ends_of_lines_and_an_unfinished_last_frame_are_read(end):
    text = BVH.replace("Frames: 4", "Frames: 5") + "0 0 1\n"
    assert len(read_bvh(text.replace("\n", end).encode())[1].keys[0].times) == 4


@pytest.mark.parametrize(("wrong", "right", "line", "message"), [
    ("HIERARCHY", "SOLID", 1, "does not begin with HIERARCHY"),
    ("OFFSET 0.0 0.0 1.0", "OFFSET 0.0 up 1.0", 8, "expected 3 numbers"),
    ("CHANNELS 3", "CHANNELS 4", 9, "CHANNELS says 4, and names 3"),
    ("MOTION", "MOVES", 16, "expected a joint or MOTION"),
    ("Frame Time: 0.5", "Frame Time: 0", 18, "Frame Time must be above 0"),
    ("Frames: 4", "Frames: 0", 18, "no whole frame"),
    ("0 0 0 0 0 0 0 90 0", "0 0 0 0 0 0 0 nan 0", 20, "expected 9 numbers"),
])
def test_faults_are_told_with_their_line(wrong, right, line, message):
    assert wrong in BVH
    with pytest.raises(MeshError, match=message) as fault:
        read_bvh(BVH.replace(wrong, right, 1).encode())
    assert fault.value.line == line
