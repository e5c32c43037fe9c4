"""Pictures of students' worlds."""
from __future__ import annotations

import re
import struct

import pytest
from lxml import etree

from my_simulations.classroom.monitor import Monitor
from my_simulations.classroom.world_picture import WorldPicture
from my_simulations.editor.transport.pose_messages import HEAD_BYTES

IDENTITY = [0, 0, 0, 0, 0, 0, 1]


def model(size=(1, 1, 1), at=(0, 0, 0), number=7, static=False, **shape):
    visual = {"pose": IDENTITY, "material": {"diffuse": [1, 0, 0, 1]},
              "geometry": {"type": "box", "size": list(size)}, **shape}
    return {"pose": [*at, 0, 0, 0, 1], "static": static,
            "links": [{"id": number, "pose": IDENTITY, "visuals": [visual], "collisions": [],
                       "inertial": {"pose": IDENTITY}}]}


def polygons(picture):
    root = etree.fromstring(picture.svg())
    return [([tuple(map(float, point.split(","))) for point in one.get("points").split()],
             one.get("fill")) for one in root]


def moved(number, *pose):
    return b"\1\0\0\0".ljust(HEAD_BYTES, b"\0") + struct.pack("<I7f", number, *pose)


def test_a_box_shows_three_faces_in_its_colour_inside_of_the_picture():
    picture = WorldPicture()
    assert polygons(picture) == []
    picture.update_models({"box": model()})
    found = polygons(picture)
    assert len(found) == 3 and all(re.match("#[0-9a-f]{2}0000$", fill) for _, fill in found)
    assert all(0 <= x <= 320 and 0 <= y <= 200 for points, _ in found for x, y in points)
    assert "#ff0000" in [fill for _, fill in found]     # the upper face


def test_poses_move_links_and_only_known_ones():
    picture = WorldPicture()
    picture.update_models({"floor": model((10, 10, 0.1), number=1, static=True), "box": model()})
    before = polygons(picture)
    picture.update_poses(moved(99, 3, 3, 0, 0, 0, 0, 1))
    assert polygons(picture) == before
    picture.update_poses(moved(7, 2, 0, 0.5, 0, 0, 0, 1))
    after = polygons(picture)
    assert len(after) == len(before) and after != before
    x = [max(x for points, _ in found[-3:] for x, _ in points) for found in (before, after)]
    assert x[1] > x[0]      # to the east
    picture.update_models({"box": None})
    assert len(polygons(picture)) == 3


def test_walls_hide_nothing_and_ceilings_are_left_out():
    picture = WorldPicture()
    picture.update_models({"wall": model((5, 0.1, 4), (0, 0, 2), 1, static=True),
                         "ceiling": model((5, 5, 0.1), (0, 0, 4), 2, static=True)})
    (points, _), *rest = polygons(picture)
    assert len(rest) == 2
    picture.update_models({"wall": model((5, 0.1, 1), (0, 0, 0.5), 1, static=True)})
    assert polygons(picture)[0][0] == points


@pytest.mark.parametrize("geometry", [
    {"type": "sphere", "radius": 1.0}, {"type": "cylinder", "radius": 1.0, "length": 2.0},
    {"type": "capsule", "radius": 1.0, "length": 2.0}, {"type": "ellipsoid", "radii": [1, 1, 2]},
    {"type": "polyline", "loops": [[[0, 0], [1, 0], [1, 1]]], "height": 1.0}, {"type": "mesh"}])
def test_shapes_and_meshes_are_boxes(geometry):
    picture = WorldPicture()
    picture.update_models({"one": model(geometry=geometry)})
    assert len(polygons(picture)) == 3


@pytest.mark.parametrize("more", [
    {"size": (1e300, 1, 1)}, {"size": (float("nan"), 1, 1)}, {"at": (float("inf"), 0, 0)},
    {"at": (1e5, 0, 0)}, {"geometry": {"type": "plane"}}, {"geometry": {"type": "<script>"}}])
def test_what_cannot_be_drawn_is_left_out(more):
    picture = WorldPicture()
    picture.update_models({"one": model(**more), "two": model(number=8)})
    assert len(polygons(picture)) == 3


def test_a_student_can_neither_fill_the_memory_nor_insert_text():
    monitor = Monitor(1)
    picture = monitor.picture
    for number in range(3000):
        picture.update_models({f"<script>{number}": model(
            at=(number % 50, number // 50, 0), number=number,
            material={"diffuse": ["1", 0, 0, "0"]})})
    assert len(polygons(picture)) == 900 and "script" not in picture.svg()
    picture.update_poses(moved(7, *[float("nan")] * 7))
    assert "nan" not in picture.svg()
    assert len(polygons(picture)) == 897
