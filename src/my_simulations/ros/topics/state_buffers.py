"""State messages, serialised in bulk.

rospy builds and packs one Pose and one Twist object per entity, about 2.3 microseconds each; at
1000 messages a second with 100 models that is a quarter of a core. A link's row in the ring has the
layout of a geometry_msgs/Pose followed by a Twist, so here the bytes are copied from the
ring, and the names, which rarely change, are packed once.
"""
from __future__ import annotations

import struct
from typing import List, Sequence, Tuple

from ...geometry import Pose, compose
from ...simulator.row_layout import FrameLocation

POSE_BYTES, TWIST_BYTES = 7 * 8, 6 * 8
ROW_BYTES = POSE_BYTES + TWIST_BYTES
"""Bytes of a row of the link table: position, orientation x, y, z, w, linear, angular."""

_COUNT = struct.Struct("<I")
_TIME = struct.Struct("<II")
_POSE = struct.Struct("<7d")
_STILL = bytes(TWIST_BYTES)


def pack_strings(names: Sequence[str]) -> bytes:
    parts: List[bytes] = [_COUNT.pack(len(names))]
    for name in names:
        data = name.encode("utf-8")
        parts.append(_COUNT.pack(len(data)))
        parts.append(data)
    return b"".join(parts)


def pack_time(nanoseconds: int) -> bytes:
    """Return the bytes of a `time` field, which are also those of a rosgraph_msgs/Clock."""
    return _TIME.pack(*divmod(nanoseconds, 1000000000))


class StatesBuffer:
    """The bytes of a ModelStates or LinkStates message; repacks only what has changed."""

    def __init__(self) -> None:
        self._revision = self._sequence = -1
        self._names = self._count = self._packed = b""
        self._at: List[int] = []
        self._special: List[Tuple[int, FrameLocation]] = []

    def pack(self, revision: int, sequence: int, names: Sequence[str],
             places: Sequence[FrameLocation], links: bytes) -> bytes:
        """The message of three parallel arrays.

        Args:
            revision: changes with names or places.
            sequence: changes with `links`.
            names: names of the entities.
            places: their locations, see `simulator.row_layout`.
            links: the link rows of a snapshot, as bytes.
        """
        if revision != self._revision:
            self._names, self._count = pack_strings(names), _COUNT.pack(len(names))
            self._at = [max(row, 0) * ROW_BYTES for row, _ in places]
            self._special = [(index, place) for index, place in enumerate(places)
                             if place[1] is not None]
        if revision != self._revision or sequence != self._sequence:
            self._packed = self._pack(links)
        self._revision, self._sequence = revision, sequence
        return self._packed

    def _pack(self, links: bytes) -> bytes:
        poses = [links[at:at + POSE_BYTES] for at in self._at]
        twists = [links[at + POSE_BYTES:at + ROW_BYTES] for at in self._at]
        for index, (row, frame) in self._special:
            pose = frame or Pose()
            if row < 0:
                twists[index] = _STILL
            else:
                n = _POSE.unpack(poses[index])
                pose = compose(Pose((n[0], n[1], n[2]), (n[3], n[4], n[5], n[6])), pose)
            poses[index] = _POSE.pack(*pose.position, *pose.orientation)
        return b"".join((self._names, self._count, *poses, self._count, *twists))
