"""A tf message that is serialised without a message object for each transform."""
from __future__ import annotations

import struct
from functools import lru_cache
from typing import Any, Sequence

from tf2_msgs.msg import TFMessage

from ...plugins.graph import TransformOf

_COUNT = struct.Struct("<I")
_STAMP = struct.Struct("<III")   # seq, seconds, nanoseconds
_POSE = struct.Struct("<7d")     # translation, rotation x, y, z, w


class PackedTransforms(TFMessage):
    """Transforms as of one sim time (ns), in the layout of geometry_msgs/TransformStamped."""

    __slots__ = ["_packed"]

    def __init__(self, transforms: Sequence[TransformOf], ns: int) -> None:
        # The fields stay empty: `_packed` holds the message.
        stamp = _STAMP.pack(0, *divmod(ns, 10 ** 9))
        parts = [_COUNT.pack(len(transforms))]
        for parent, child, pose in transforms:
            parts += (stamp, _frames(parent, child), _POSE.pack(*pose.position, *pose.orientation))
        self._packed = b"".join(parts)

    def serialize(self, buff: Any) -> None:
        """Write what a TFMessage with these transforms writes."""
        buff.write(self._packed)


@lru_cache(maxsize=4096)
def _frames(parent: str, child: str) -> bytes:
    """`frame_id` and `child_frame_id`, one after the other."""
    return b"".join(_COUNT.pack(len(name)) + name
                    for name in (parent.encode(), child.encode()))
