import struct

import pytest

from my_simulations.geometry import Pose, compose, pose_from_xyzrpy
from my_simulations.ros.topics.state_buffers import (
    ROW_BYTES,
    StatesBuffer,
    pack_strings,
    pack_time,
)


def rows(*numbers):
    """Link rows of a snapshot, each thirteen numbers."""
    return b"".join(struct.pack("<13d", *row) for row in numbers)


FIRST = (1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0)
SECOND = tuple(-number for number in FIRST)


def arrays(packed, names):
    """The pose and twist arrays of a message, after its names."""
    assert packed.startswith(pack_strings(names))
    rest, count = packed[len(pack_strings(names)):], len(names)
    poses = struct.unpack_from(f"<I{count * 7}d", rest)
    twists = struct.unpack_from(f"<I{count * 6}d", rest, 4 + count * 56)
    assert poses[0] == twists[0] == count
    assert len(rest) == 8 + count * ROW_BYTES
    return ([poses[1 + 7 * n:8 + 7 * n] for n in range(count)],
            [twists[1 + 6 * n:7 + 6 * n] for n in range(count)])


def test_names_are_counted_utf8_strings():
    assert pack_strings(["a", "é"]) == (
        b"\x02\0\0\0" + b"\x01\0\0\0a" + b"\x02\0\0\0" + "é".encode())


def test_time_is_seconds_and_nanoseconds():
    assert pack_time(3000000007) == struct.pack("<II", 3, 7)


def test_rows_go_out_in_the_order_of_the_names():
    packed = StatesBuffer().pack(1, 1, ["a", "b"], [(1, None), (0, None)], rows(FIRST, SECOND))
    poses, twists = arrays(packed, ["a", "b"])
    assert poses == [SECOND[:7], FIRST[:7]]
    assert twists == [SECOND[7:], FIRST[7:]]


def test_a_frame_in_a_link_is_composed_and_keeps_the_links_twist():
    frame = pose_from_xyzrpy(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    packed = StatesBuffer().pack(1, 1, ["a"], [(0, frame)], rows(FIRST))
    (pose,), (twist,) = arrays(packed, ["a"])
    wanted = compose(Pose(FIRST[:3], FIRST[3:7]), frame)
    assert pose == pytest.approx((*wanted.position, *wanted.orientation))
    assert twist == FIRST[7:]


def test_a_model_without_links_stands_where_it_was_put():
    packed = StatesBuffer().pack(1, 1, ["a"], [(-1, Pose((1.0, 2.0, 3.0)))], b"")
    (pose,), (twist,) = arrays(packed, ["a"])
    assert pose == (1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0)
    assert twist == (0.0,) * 6


def test_an_empty_world_is_three_empty_arrays():
    assert StatesBuffer().pack(0, 0, [], [], b"") == b"\0" * 12


def test_changed_names_are_packed_again():
    buffer = StatesBuffer()
    buffer.pack(1, 1, ["a"], [(0, None)], rows(FIRST))
    assert buffer.pack(2, 1, ["b"], [(0, None)], rows(FIRST)).startswith(pack_strings(["b"]))


def test_an_unchanged_world_is_not_packed_again():
    buffer = StatesBuffer()
    first = buffer.pack(1, 7, ["a"], [(0, None)], rows(FIRST))
    assert buffer.pack(1, 7, ["a"], [(0, None)], rows(FIRST)) is first
    assert buffer.pack(1, 8, ["a"], [(0, None)], rows(SECOND)) != first
