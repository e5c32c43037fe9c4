"""Binary frames of poses: what moved since a client's last one.

Layout: `frames` of `web/protocol.json`.
"""
from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any, Iterable, Optional

LIVE, LOG = 1, 2

HEAD = (("kind", "u32"), ("revision", "u32"), ("step", "u64"), ("sim_time", "f64"),
        ("real_time", "f64"), ("count", "u32"), ("zero", "u32"))
"""Fields of a frame's head and their types; a test compares them with the protocol file."""

RECORD = (("id", "u32"), ("px", "f32"), ("py", "f32"), ("pz", "f32"), ("qx", "f32"),
          ("qy", "f32"), ("qz", "f32"), ("qw", "f32"))
"""As `HEAD`, of the record of a link; one for each that moved follows the head."""

_CODES = {"u32": "I", "u64": "Q", "f64": "d", "f32": "f"}
_HEAD = struct.Struct("<" + "".join(_CODES[kind] for _, kind in HEAD))
HEAD_BYTES = _HEAD.size
RECORD_STRUCT = struct.Struct("<" + "".join(_CODES[kind] for _, kind in RECORD))
RECORD_BYTES = RECORD_STRUCT.size
_TOLERANCE = 1e-5
"""m, and of a quaternion's parts: a body that trembles less than that stays where it was sent."""


@dataclass(frozen=True)
class Poses:
    """Where links are at one moment.

    Attributes:
        ids: uint32 array (n,).
        values: float32 array (n, 7): positions in m, quaternions x, y, z, w; world axes.
        step: step count; `sim_time`, `real_time` s.
    """

    ids: Any
    values: Any
    step: int
    sim_time: float
    real_time: float


def record_type() -> Any:
    """NumPy's type of one record: the position and quaternion of `RECORD` as one field `pose`."""
    import numpy as np

    return np.dtype([("id", "<u4"), ("pose", "<f4", 7)])


class SentPoses:
    """What one client has; makes the next frame for it.

    Attributes:
        late: it has not got the newest poses.
    """

    def __init__(self) -> None:
        self.late = False
        self._sent: Optional[Any] = None

    def forget(self, ids: Optional[Iterable[int]] = None) -> None:
        """These links (None: all) go into the next frame whether or not they move."""
        if ids is None or self._sent is None:
            self._sent = None
            return
        import numpy as np

        rows = np.fromiter(ids, dtype=np.int64)
        self._sent[rows[rows < len(self._sent)]] = np.nan

    def frame(self, kind: int, revision: int, poses: Poses) -> bytes:
        """The frame of what moved; b"" when nothing did."""
        import numpy as np

        sent = self._grow_buffer(int(poses.ids.max()) + 1 if len(poses.ids) else 0)
        with np.errstate(invalid="ignore"):
            still = (np.abs(poses.values - sent[poses.ids]) <= _TOLERANCE).all(axis=1)
        moved = np.nonzero(~still)[0]
        if not len(moved):
            return b""
        records = np.empty(len(moved), dtype=record_type())
        records["id"] = poses.ids[moved]
        records["pose"] = poses.values[moved]
        sent[poses.ids[moved]] = poses.values[moved]
        head = _HEAD.pack(kind, revision & 0xFFFFFFFF, max(0, poses.step), poses.sim_time,
                          poses.real_time, len(moved), 0)
        return head + records.tobytes()

    def _grow_buffer(self, size: int) -> Any:
        import numpy as np

        old = self._sent
        if old is None or len(old) < size:
            new = np.full((max(size, 64, 2 * (len(old) if old is not None else 0)), 7), np.nan,
                          dtype=np.float32)
            if old is not None:
                new[:len(old)] = old
            self._sent = new
        return self._sent
