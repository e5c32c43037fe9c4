"""Skins of actors: how bones move and what they carry, against closed forms."""
from __future__ import annotations

import math

import numpy as np
import pytest
from walking_figures import BVH, QUARTER, RAISED, STILL, animation, rod, swinging

from my_simulations.formats.mesh.figures import read_figure, read_movement
from my_simulations.formats.mesh.part import MeshError
from my_simulations.sensing.actors.skeleton import Borrowed, Skeleton


@pytest.fixture
def read(tmp_path):
    def of(text, name="skin.dae"):
        (tmp_path / name).write_text(text)
        return read_figure(str(tmp_path / name))
    return of


@pytest.fixture
def movement(tmp_path):
    def of(text):
        (tmp_path / "mover.dae").write_text(text)
        return read_movement(str(tmp_path / "mover.dae"))
    return of


def corners(skeleton, at, on_path=False):
    """(24, 3) m: the places of the skin's vertices, in their order in the file."""
    part = skeleton._figure.parts[0].part
    [(vertices, _)] = skeleton.surfaces(at, on_path)
    rest = part.vertices
    _, first = np.unique(rest, axis=0, return_index=True)
    order = {tuple(rest[n]): vertices[n] for n in first}
    found = []
    for x, y, z in (((-10, 10), (-10, 10), (0, 90)), ((-10, 10), (-10, 10), (110, 200)),
                    ((20, 30), (-5, 5), (95, 105))):
        found += [order[float(a), float(b), float(c)] for a in x for b in y for c in z]
    return np.array(found)


def swung(points, angle):
    """Turned about x, 1 m up."""
    c, s = math.cos(angle), math.sin(angle)
    up = points - (0.0, 0.0, 1.0)
    return up @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T + (0.0, 0.0, 1.0)


@pytest.mark.parametrize("at", [None, 0.0, 0.5, 1.0, 1.9])
def test_vertices_are_where_their_bones_carry_them_by_weight(read, at):
    skeleton = Skeleton(read(swinging(seconds=2.0)), 1.0)
    rest, found = corners(skeleton, None), corners(skeleton, at)
    there = swung(rest, math.pi / 4 * (at or 0.0))
    assert rest[0] == pytest.approx((-0.1, -0.1, 0.0)) and rest[15, 2] == pytest.approx(2.0)
    assert np.allclose(found[:8], rest[:8])
    assert np.allclose(found[8:16], there[8:16])
    assert np.allclose(found[16:], 0.25 * rest[16:] + 0.75 * there[16:])


def test_normals_turn_with_their_bones_and_the_scale_is_that_of_the_actor(read):
    figure = read(swinging(seconds=2.0))
    [(vertices, normals)] = Skeleton(figure, 2.0).surfaces(1.0)
    rest = figure.parts[0].part
    upper = (rest.vertices[:, 2] > 109.0) & (rest.normals[:, 2] > 0.9)
    half = math.sqrt(0.5)
    assert upper.any() and np.allclose(normals[upper], (0.0, -half, half), atol=1e-6)
    lower = rest.vertices[:, 2] < 91.0
    assert np.allclose(vertices[lower], rest.vertices[lower] * 0.02)


def test_the_four_strongest_bones_of_a_vertex_share_it(read):
    # 0.1, 0.75, 0.25, 0.25, 0.1, 0.75: the four strongest are 0.75 up, 0.75 and 0.25 down, 0.25 up.
    many = ((0, 3), (1, 2), (0, 1), (1, 1), (1, 3), (0, 2))
    moves = animation((0.0, 2.0), (RAISED, QUARTER))
    skeleton = Skeleton(read(rod(moves=moves, blended=many)), 1.0)
    rest, found = corners(skeleton, None), corners(skeleton, 1.0)
    assert np.allclose(found[16:], 0.5 * rest[16:] + 0.5 * swung(rest, math.pi / 4)[16:])


def test_a_vertex_that_nothing_holds_follows_its_first_bone(read):
    skeleton = Skeleton(read(swinging().replace("1 0.25 0.75 0.1", "1 0 0 0")), 1.0)
    assert np.allclose(corners(skeleton, 1.0)[16:], corners(skeleton, None)[16:])


def test_keys_hold_before_the_first_and_after_the_last(read):
    skeleton = Skeleton(read(rod(moves=animation((1.0, 2.0), (RAISED, QUARTER)))), 1.0)
    rest = corners(skeleton, None)
    assert skeleton.duration == 2.0
    for at, angle in ((0.5, 0.0), (1.5, math.pi / 4), (2.0, math.pi / 2), (9.0, math.pi / 2)):
        assert np.allclose(corners(skeleton, at)[8:16], swung(rest, angle)[8:16]), at


PLACINGS = ('<translate sid="place">0 0 100</translate><rotate sid="rx">1 0 0 0</rotate>'
            '<scale sid="size">1 1 1</scale>')


def of_placings(target, values, stride=1):
    """The rod, its upper bone placed by parts, one of which is animated within 2 s."""
    moves = animation((0.0, 2.0), (STILL, STILL)).replace("upper/transform", target)
    numbers = " ".join(map(str, values))
    moves = moves.replace(f"{STILL} {STILL}", numbers)
    moves = moves.replace('count="32"', f'count="{2 * stride}"')
    text = rod(moves=moves)
    return text.replace(f'<matrix sid="transform">{RAISED}</matrix>', PLACINGS)


@pytest.mark.parametrize(("target", "values", "expected"), [
    ("upper/rx.ANGLE", (0, 90), lambda rest: swung(rest, math.pi / 4)),
    ("upper/place.Z", (100, 140), lambda rest: rest + (0.0, 0.0, 0.2)),
    ("upper/place", (0, 0, 100, 0, 40, 100), lambda rest: rest + (0.0, 0.2, 0.0)),
    ("upper/place(1)", (0, 40), lambda rest: rest + (0.0, 0.2, 0.0)),
    ("upper/size.Z", (1, 3), lambda rest: rest * (1, 1, 2) - (0.0, 0.0, 1.0)),
])
def test_parts_of_a_bone_s_place_are_animated_by_themselves(read, target, values, expected):
    skeleton = Skeleton(read(of_placings(target, values, len(values) // 2)), 1.0)
    rest = corners(skeleton, None)
    assert np.allclose(corners(skeleton, 1.0)[8:16], expected(rest)[8:16])


def test_another_file_says_where_bones_are_and_for_how_long(read, movement):
    higher = QUARTER.replace("100", "120")   # as Gazebo has it: its bones take their places
    mover = movement(rod(moves=animation((0.0, 4.0), (RAISED, higher))))
    skeleton = Skeleton(read(rod()), 1.0, Borrowed(mover))
    rest = corners(skeleton, None)
    assert skeleton.duration == 4.0
    assert np.allclose(corners(skeleton, 2.0)[8:16], swung(rest, math.pi / 4)[8:16] + (0, 0, 0.1))


def at_height(*heights):
    return [RAISED.replace("100", str(height)) for height in heights]


@pytest.mark.parametrize(("unit", "scale"), [("0.01", 1.0), ("0.02", 0.5), ("0.0025", 4.0)])
def test_another_file_moves_the_hips_in_its_unit_and_scale(read, movement, unit, scale):
    standing, sitting = at_height(100, 50)
    moves = animation((0.0, 2.0), (standing, sitting), "lower")
    mover = movement(rod(moves=moves, root=standing).replace('meter="0.01"', f'meter="{unit}"'))
    skeleton = Skeleton(read(rod(root=standing)), 1.0, Borrowed(mover, scale))
    rest = corners(skeleton, None)
    assert rest[0] == pytest.approx((-0.1, -0.1, 1.0))
    assert np.allclose(corners(skeleton, 2.0), rest - (0.0, 0.0, 0.5))


def test_a_borrowed_movement_is_for_a_skin_of_any_scale(read, movement):
    standing, sitting = at_height(100, 50)
    mover = movement(rod(moves=animation((0.0, 2.0), (standing, sitting), "lower"), root=standing))
    skeleton = Skeleton(read(rod(root=standing)), 2.0, Borrowed(mover, 2.0))
    assert corners(skeleton, 2.0)[0] == pytest.approx((-0.2, -0.2, 1.0))


def renamed(text):
    return text.replace('sid="high"', 'sid="arm"').replace("low high", "low arm")


def test_bones_are_paired_by_their_order_whatever_they_are_called(read, movement):
    skeleton = Skeleton(read(rod()), 1.0, Borrowed(movement(renamed(swinging()))))
    rest = corners(skeleton, None)
    assert np.allclose(corners(skeleton, 1.0)[8:16], swung(rest, math.pi / 4)[8:16])


HAND = '<node id="hand" sid="hand" name="hand" type="JOINT"/>'


def handed(text):
    """With a third bone."""
    return text.replace("</node></node>", f"{HAND}</node></node>", 1)


def test_bones_of_skeletons_that_branch_otherwise_are_paired_by_name(read, movement):
    skeleton = Skeleton(read(rod()), 1.0, Borrowed(movement(handed(swinging()))))
    rest = corners(skeleton, None)
    assert np.allclose(corners(skeleton, 1.0)[8:16], swung(rest, math.pi / 4)[8:16])


def test_a_bvh_file_moves_the_bones_of_a_skin_in_its_scale(read, tmp_path):
    (tmp_path / "fall.bvh").write_text(BVH)
    fall = read_movement(str(tmp_path / "fall.bvh"))
    skeleton = Skeleton(read(rod()), 1.0, Borrowed(fall))
    rest = corners(skeleton, None)
    assert skeleton.duration == 1.5
    assert np.allclose(corners(skeleton, 0.25)[8:16], swung(rest, math.pi / 4)[8:16])
    half = Skeleton(read(rod()), 1.0, Borrowed(fall, 0.5))
    assert corners(half, 1.5)[0, 0] == pytest.approx(0.1 - 0.1)


@pytest.mark.parametrize("mover", [rod(), handed(renamed(swinging()))])
def test_a_file_without_movement_for_these_bones_moves_nothing(read, movement, mover):
    skeleton = Skeleton(read(swinging()), 1.0, Borrowed(movement(mover)))
    assert skeleton.duration is None


def test_on_a_path_the_root_does_not_go_along_x(read):
    away, further = (STILL.replace("1 0 0 0", f"1 0 0 {x}", 1) for x in (30, 90))
    text = rod(moves=animation((0.0, 2.0), (away, further), "lower"), root=away)
    skeleton = Skeleton(read(text), 1.0)
    assert corners(skeleton, 1.0)[0] == pytest.approx((0.5, -0.1, 0.0))
    assert corners(skeleton, 1.0, on_path=True)[0] == pytest.approx((-0.1, -0.1, 0.0))
    assert np.allclose(corners(skeleton, None, on_path=True), corners(skeleton, None))


def walking(*places):
    """Keys 0.5 s apart with the root there along x, cm."""
    return animation([0.5 * n for n in range(len(places))],
                     [STILL.replace("1 0 0 0", f"1 0 0 {x}", 1) for x in places], "lower")


def test_a_movement_is_as_far_as_its_root_and_begins_anew_at_its_end(read, movement):
    # Gazebo's rule: less than the first place is the first, more than the last begins from 0.
    own = Skeleton(read(rod(moves=walking(10, 30, 70))), 2.0)
    far = {0.0: 0.0, 0.2: 0.0, 0.4: 0.25, 0.6: 0.5, 1.0: 0.75, 1.4: 1.0, 1.6: 0.0, 2.0: 0.5}
    assert {one: own.time_at(one) for one in far} == pytest.approx(far)
    borrowed = Skeleton(read(rod()), 3.0, Borrowed(movement(rod(moves=walking(10, 30, 70))), 2.0))
    assert {one: borrowed.time_at(one) for one in far} == pytest.approx(far)


@pytest.mark.parametrize("places", [(0, 50, 0), (0, -50), (0, 0)])
def test_a_movement_that_does_not_bring_its_root_on_has_no_time_for_a_distance(read, places):
    assert Skeleton(read(rod(moves=walking(*places))), 1.0).time_at(0.1) is None
    assert Skeleton(read(rod(moves=animation((0.0, 2.0), (RAISED, QUARTER)))), 1.0
                    ).time_at(0.1) is None


def test_what_hangs_on_a_node_goes_with_it(read):
    body = '<node id="body" name="body" type="NODE">'
    stuck = body + (f'<matrix sid="transform">{RAISED}</matrix><instance_geometry url="#g"/></node>'
                    '<node id="other" type="NODE">')
    moves = animation((0.0, 2.0), (RAISED, QUARTER), "body")
    figure = read(rod(moves=moves).replace(body, stuck))
    [rigid, _] = Skeleton(figure, 1.0).surfaces(2.0)
    rest = figure.parts[0].part.vertices * 0.01
    assert np.allclose(rigid[0], rest @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
                       + (0.0, 0.0, 1.0))


def test_all_keys_of_a_file_are_played_whatever_clips_it_names(read):
    moves = animation((0.0, 2.0), (RAISED, QUARTER)) + (
        "<library_animation_clips><animation_clip id='k' start='1' end='4'>"
        "<instance_animation url='#a'/></animation_clip></library_animation_clips>")
    skeleton = Skeleton(read(rod(moves=moves)), 1.0)
    rest = corners(skeleton, None)
    assert skeleton.duration == 2.0
    assert np.allclose(corners(skeleton, 1.0)[8:16], swung(rest, math.pi / 4)[8:16])


@pytest.mark.parametrize(("wrong", "right", "message"), [
    ("low high", "low arm", "joint 'arm', which no node is"),
    ("low high", "low high low", "not a matrix for each joint"),
    ("<vcount>1", "<vcount>2", "do not fit"), ("<v>0 0", "<v>7 0", "do not fit"),
    ("<skin source", "<morph source", "not a skin"), ("#w\"", "#nothing\"", "cannot be read"),
])
def test_faults_of_a_skin_are_told(read, wrong, right, message):
    text = rod().replace(wrong, right, 1)
    with pytest.raises(MeshError, match=message):
        read(text.replace("</skin>", "</morph>") if right.startswith("<morph") else text)


def test_a_file_is_read_once_until_it_changes_and_its_xml_is_given_back(read, tmp_path):
    first = read(rod())
    assert read_figure(str(tmp_path / "skin.dae")) is first and first.clip is None
    assert not first.tree.elements and not first.tree.by_id
    assert read(swinging()).clip is not None


def test_other_files_have_no_figure(read):
    assert read("solid", "skin.stl") is None
    assert read(rod().replace('<instance_controller url="#c">', "<b>").replace(
        "</instance_controller>", "</b>")) is None
