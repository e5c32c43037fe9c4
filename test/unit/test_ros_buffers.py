import struct

from my_simulations.geometry import Pose, Twist
from my_simulations.ros.buffers import StatesBuffer, packed_strings, packed_time


def test_names_are_counted_utf8_strings():
    assert packed_strings(["a", "é"]) == (
        b"\x02\0\0\0" + b"\x01\0\0\0a" + b"\x02\0\0\0" + "é".encode())


def test_time_is_seconds_and_nanoseconds():
    assert packed_time(3000000007) == struct.pack("<II", 3, 7)


def test_arrays_are_position_orientation_then_linear_angular():
    pose = Pose((1.0, 2.0, 3.0), (0.0, 0.0, 0.6, 0.8))
    twist = Twist((4.0, 5.0, 6.0), (7.0, 8.0, 9.0))
    packed = StatesBuffer().pack(1, 1, ["a"], [pose], [twist])
    assert packed == (packed_strings(["a"])
                      + struct.pack("<I7d", 1, 1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8)
                      + struct.pack("<I6d", 1, *range(4, 10)))


def test_an_empty_world_is_three_empty_arrays():
    assert StatesBuffer().pack(0, 0, [], [], []) == b"\0" * 12


def test_changed_names_are_packed_again():
    buffer = StatesBuffer()
    buffer.pack(1, 1, ["a"], [Pose()], [Twist()])
    assert buffer.pack(2, 2, ["b"], [Pose()], [Twist()]).startswith(packed_strings(["b"]))


def test_an_unchanged_world_is_not_packed_again():
    buffer = StatesBuffer()
    first = buffer.pack(1, 7, ["a"], [Pose()], [Twist()])
    assert buffer.pack(1, 7, ["a"], [Pose()], [Twist()]) is first
    assert buffer.pack(1, 8, ["a"], [Pose((1.0, 0.0, 0.0))], [Twist()]) != first
