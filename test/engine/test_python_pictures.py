"""Pictures that a Python program takes of a world."""
from __future__ import annotations

import math
import os
import signal

import numpy as np
import pytest
from walking_figures import rod

import my_simulations
from my_simulations.errors import CommandError
from my_simulations.python_api.world_pictures import camera_pose

RED_BOX = """<sdf version="1.7"><model name="box"><static>1</static><link name="link">
<visual name="v"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
<material><ambient>1 0 0 1</ambient><diffuse>1 0 0 1</diffuse></material></visual>
</link></model></sdf>"""
CART = """<sdf version="1.7"><model name="cart"><pose>0 0 0.5 0 0 0</pose><link name="base">
<inertial><mass>1</mass></inertial></link></model></sdf>"""


@pytest.fixture
def world():
    with my_simulations.open_world() as opened:
        opened.spawn(RED_BOX, pose=[2, 0, 0.5])
        yield opened


def test_a_box_is_where_it_projects_to_in_colour_depth_and_labels(world):
    seen = world.render([0, 0, 0.5], width=200, height=100, hfov=math.pi / 2,
                        outputs=("rgb", "depth", "labels"))
    assert seen.rgb.shape == (100, 200, 3) and seen.depth.shape == (100, 200)
    assert seen.depth[50, 100] == pytest.approx(1.9, abs=1e-3)
    red, green, _ = (int(value) for value in seen.rgb[50, 100])
    assert red > 2 * green
    box = seen.labels == seen.names.index("box::link")
    rows, columns = np.nonzero(box)
    half = 100.0 * 0.1 / 1.9  # focal length 100 pixels, the near side of the box
    assert columns.max() - columns.min() + 1 == pytest.approx(2 * half, abs=1.1)
    assert columns.mean() == pytest.approx(99.5, abs=0.6)
    assert rows.mean() == pytest.approx(49.5, abs=0.6)
    assert seen.labels[0, 0] == -1 and np.isinf(seen.depth[0, 0])


def test_a_camera_looks_at_a_point_and_rides_on_a_link(world):
    above = world.render([2, 0, 3], look_at=[2, 0, 0.5], width=33, height=33, outputs=("labels",))
    assert above.names[above.labels[16, 16]] == "box::link" and above.rgb is None
    world.spawn(CART)
    world.set_pose("cart", [2, -1.5, 0.5, 0, 0, math.pi / 2])
    ahead = world.render([0, 0, 0], frame="cart::base", width=33, height=33, outputs=("depth",))
    assert ahead.depth[16, 16] == pytest.approx(1.4, abs=1e-3)


def test_a_requested_picture_shows_the_world_of_its_request(world):
    before = world.render([0, 0, 0.5], outputs=("rgb", "labels"))
    requested = world.request_picture([0, 0, 0.5], outputs=("rgb", "labels"))
    world.remove("box")
    world.step(10)
    seen = requested.result()
    assert (seen.rgb == before.rgb).all() and (seen.labels == before.labels).all()
    assert seen.time == 0.0 and "box::link" in seen.names
    assert requested.result().time == 0.0   # it can be read again
    assert "box::link" not in world.render([0, 0, 0.5]).names


def test_a_requested_picture_of_a_world_that_was_closed_is_refused():
    with my_simulations.open_world() as world:
        world.render([0, 0, 0.5])
        os.kill(world._scene._processes[1].pid, signal.SIGSTOP)
        requested = world.request_picture([0, 0, 1.5])
    with pytest.raises(CommandError, match="no picture"):
        requested.result()


def test_the_same_world_gives_the_same_picture_after_a_reset(world):
    first = world.render([0, -1, 1], look_at=[2, 0, 0.5])
    world.step(100)
    world.reset()
    world.spawn(RED_BOX, pose=[2, 0, 0.5])
    again = world.render([0, -1, 1], look_at=[2, 0, 0.5])
    assert (again.rgb == first.rgb).all() and again.time == first.time == 0.0


def test_an_actor_is_where_it_is_at_the_time_of_the_picture(tmp_path):
    (tmp_path / "rod.dae").write_text(rod())
    (tmp_path / "walk.world").write_text(
        "<sdf version='1.6'><world name='w'><actor name='man'><skin><filename>rod.dae</filename>"
        "</skin><script><loop>0</loop><trajectory id='0' type='walk'><waypoint><time>0</time>"
        "<pose>0 -2 0 0 0 0</pose></waypoint><waypoint><time>2</time><pose>0 2 0 0 0 0</pose>"
        "</waypoint></trajectory></script></actor></world></sdf>")
    with my_simulations.open_world(str(tmp_path / "walk.world")) as world:
        def column():
            seen = world.render([-5, 0, 0.5], width=200, height=20, hfov=math.pi / 2)
            red = (seen.rgb[10] == (255, 0, 0)).all(axis=1)
            return seen.time, np.nonzero(red)[0].mean()

        found = []
        for _ in range(3):
            found.append(column())
            world.step(500)
        for time, middle in found:
            u = time / 2.0    # along Gazebo's spline through two points
            left = -2.0 + 4.0 * (0.5 * u + 1.5 * u ** 2 - u ** 3)
            assert middle == pytest.approx(99.5 - 100.0 * left / 4.9, abs=1.2)
        world.reset()
        assert column() == found[0]


@pytest.mark.parametrize(("change", "message"), [
    ({"width": 0}, "width and height"), ({"hfov": 4.0}, "hfov"),
    ({"near": 2.0, "far": 1.0}, "near"),
    ({"outputs": ("colour",)}, "there is no 'colour'"), ({"frame": "nobody"}, "nobody"),
    ({"look_at": [0, 0, 0]}, "cannot look")])
def test_what_cannot_be_rendered_is_refused_in_one_sentence(world, change, message):
    with pytest.raises(CommandError, match=message):
        world.render([0, 0, 0], **change)


def test_a_camera_that_looks_at_a_point_is_level():
    turn = camera_pose((0, 0, 1), (1, 1, 0)).orientation
    x, y, z, w = turn
    assert 2 * (y * z + w * x) == pytest.approx(0.0, abs=1e-12)  # its left side has no height
