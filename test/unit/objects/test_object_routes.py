from __future__ import annotations

import math

import pytest

from my_simulations.errors import InputError
from my_simulations.objects.motion_path import Circle, Polygon, parse_numbers, parse_points


def test_a_polygon_is_closed_and_heads_along_its_edges():
    route = Polygon([(0, 0), (4, 0), (4, 3)])
    assert route.length == pytest.approx(12.0)
    assert route.at(1.0) == pytest.approx((1.0, 0.0, 0.0))
    assert route.at(5.5) == pytest.approx((4.0, 1.5, math.pi / 2))
    assert route.at(12.0) == pytest.approx((0.0, 0.0, 0.0))
    assert route.at(9.5)[2] == pytest.approx(math.atan2(-3, -4))


def test_a_blocked_polygon_begins_its_edge_again():
    route = Polygon([(0, 0), (4, 0), (4, 3)])
    assert route.restart(5.5) == pytest.approx(4.0)
    assert route.restart(12.0 + 5.5) == pytest.approx(16.0)


def test_equal_neighbours_of_a_polygon_do_not_matter():
    route = Polygon([(0, 0), (0, 0), (2, 0)])
    assert route.length == pytest.approx(4.0)
    assert route.at(3.0) == pytest.approx((1.0, 0.0, math.pi))


def test_a_circle_keeps_its_radius_and_heads_along_its_tangent():
    route = Circle((1.0, 2.0), 0.5)
    assert route.at(0.0) == pytest.approx((1.0, 2.5, 0.0))
    for distance in (0.3, 1.0, 2.9, 7.7):
        here, ahead = route.at(distance), route.at(distance + 1e-6)
        assert math.hypot(here.x - 1.0, here.y - 2.0) == pytest.approx(0.5)
        heading = math.atan2(ahead.y - here.y, ahead.x - here.x)
        assert math.remainder(heading - here.yaw, 2 * math.pi) == pytest.approx(0.0, abs=1e-4)


def test_a_blocked_circle_begins_at_angle_zero_again():
    route = Circle((0.0, 0.0), 1.0)
    assert route.at(route.restart(2 * math.pi + 1.0)) == pytest.approx((0.0, 1.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("corners", [[], [(1, 1)], [(1, 1), (1, 1)]])
def test_a_polygon_without_a_way_to_go_is_refused(corners):
    with pytest.raises(InputError):
        Polygon(corners)


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan, math.inf])
def test_a_circle_without_a_radius_is_refused(radius):
    with pytest.raises(InputError):
        Circle((0, 0), radius)


def test_lists_are_read_as_values():
    assert parse_numbers("[1, 2.5, -3e-2]", 3, "-i") == [1.0, 2.5, -0.03]
    assert parse_points(" [[0,0],(1, 2)] ", "-p") == [(0.0, 0.0), (1.0, 2.0)]


@pytest.mark.parametrize("text", [
    "[1, 2]", "[1, 2, 3, 4]", "1", "[1, 2, 'x']", "[1, 2, True]", "[1, 2, 1e999]", "[1, 2, nan]",
    "__import__('os').getcwd()", "[1, 2, ", "", "[" * 500])
def test_anything_but_a_list_of_numbers_is_refused_and_never_run(text):
    with pytest.raises(InputError) as caught:
        parse_numbers(text, 3, "-i")
    assert "-i" in caught.value.issues[0].message


@pytest.mark.parametrize("text", ["[]", "[1, 2]", "[[1, 2], [3]]", "{}", "[[1, 'y']]"])
def test_anything_but_a_list_of_points_is_refused(text):
    with pytest.raises(InputError):
        parse_points(text, "-p")
