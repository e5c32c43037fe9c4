"""Reads BVH files: a skeleton and its movement, as they come from motion capture.

Numbers are lengths of no unit, taken for metres, and degrees; no axis is turned (Gazebo behaviour).
"""
from __future__ import annotations

from typing import List, NamedTuple, Tuple

import numpy as np

from .keyframes import Clip, Keys
from .node_tree import MOST_NODES, Array, Bones
from .part import MeshError
from .plain_text import text_of

_AXES = {"X": 0, "Y": 1, "Z": 2}


class _Joint(NamedTuple):
    offset: List[float]
    channels: List[str]


def read_bvh(data: bytes) -> Tuple[Bones, Clip]:
    """The joints of a file, and their movement.

    Raises MeshError: it is not BVH, or has no whole frame.
    """
    reader = _Reader(text_of(data))
    joints = reader.joints()
    frames, step = reader.frames(sum(len(one.channels) for one in joints))
    places = np.empty((len(frames), len(joints), 3))
    turns = np.zeros((len(frames), len(joints), 4))
    turns[..., 3] = 1.0
    column = 0
    for n, joint in enumerate(joints):
        places[:, n] = joint.offset
        for channel in joint.channels:
            axis, kind = _AXES.get(channel[:1], -1), channel[1:]
            if axis >= 0 and kind == "position":
                places[:, n, axis] = frames[:, column]
            elif axis >= 0 and kind == "rotation":
                turns[:, n] = _rotate_about_axis(turns[:, n], axis, np.radians(frames[:, column]))
            column += 1
    keys = Keys(np.arange(len(frames)) * step, np.arange(len(joints)), places, turns,
                np.ones_like(places))
    return reader.bones, Clip([keys], float(keys.times[-1]))


def _rotate_about_axis(turns: Array, axis: int, angles: Array) -> Array:
    """Quaternions (k, 4), turned on about one of their own axes."""
    other = [(axis + 1) % 3, (axis + 2) % 3]
    sine, cosine = np.sin(angles / 2.0), np.cos(angles / 2.0)
    made = turns * cosine[:, None]
    made[:, axis] += turns[:, 3] * sine
    made[:, 3] -= turns[:, axis] * sine
    made[:, other[0]] += turns[:, other[1]] * sine
    made[:, other[1]] -= turns[:, other[0]] * sine
    return made


class _Reader:
    """Goes through the words of a file, which lines only part."""

    def __init__(self, text: str) -> None:
        self._rows = [row.split() for row in text.split("\n")]
        self._row = 0
        self.bones = Bones()

    def _next(self) -> List[str]:
        """The next row that has words; none at the end."""
        while self._row < len(self._rows):
            self._row += 1
            if self._rows[self._row - 1]:
                return self._rows[self._row - 1]
        return []

    def _fault(self, message: str) -> MeshError:
        return MeshError(message, self._row)

    def _numbers(self, words: List[str], count: int) -> List[float]:
        try:
            found = [float(word) for word in words[:count]]
        except ValueError:
            found = []
        if len(found) < count or not np.isfinite(found).all():
            raise self._fault(f"expected {count} numbers, found {' '.join(words)!r}")
        return found

    def joints(self) -> List[_Joint]:
        """Return the joints of `HIERARCHY`, without end sites."""
        if self._next()[:1] != ["HIERARCHY"]:
            raise self._fault("it is not BVH: it does not begin with HIERARCHY")
        found: List[_Joint] = []
        above: List[int] = []   # numbers of the joints that are open, -1 for an end site
        begun = -1
        while True:
            words = self._next()
            kind = words[0] if words else ""
            if kind in ("ROOT", "JOINT"):
                begun = self._begin(" ".join(words[1:]), above[-1] if above else -1)
                found.append(_Joint([0.0, 0.0, 0.0], []))
            elif kind == "End":
                begun = -1
            elif kind == "{":
                above.append(begun)
            elif kind == "}" and above:
                above.pop()
            elif kind in ("OFFSET", "CHANNELS") and above:
                if above[-1] >= 0:
                    self._describe(found[above[-1]], words)
            elif kind == "MOTION" and found and not above:
                return found
            else:
                raise self._fault(f"expected a joint or MOTION, found {' '.join(words)!r}")

    def _begin(self, name: str, parent: int) -> int:
        if len(self.bones.names) >= MOST_NODES:
            raise self._fault(f"it has more than {MOST_NODES} joints")
        return self.bones.add(name, True, parent)

    def _describe(self, joint: _Joint, words: List[str]) -> None:
        if words[0] == "OFFSET":
            joint.offset[:] = self._numbers(words[1:], 3)
            return
        if self._numbers(words[1:], 1)[0] != len(words) - 2:
            raise self._fault(f"CHANNELS says {words[1]}, and names {len(words) - 2}")
        joint.channels[:] = words[2:]

    def frames(self, width: int) -> Tuple[Array, float]:
        """The frames (k, width), and s between two of them; an unfinished last one is left out."""
        count = self._after("Frames:", 1)
        step = self._after("Frame", 2)
        if step <= 0.0:
            raise self._fault("Frame Time must be above 0")
        found: List[List[float]] = []
        while len(found) < count:
            words = self._next()
            if not words or (len(words) < width and not any(self._rows[self._row:])):
                break
            found.append(self._numbers(words, width))
        if not found:
            raise self._fault("it has no whole frame")
        return np.array(found).reshape(len(found), width), step

    def _after(self, key: str, words: int) -> float:
        row = self._next()
        if row[:1] != [key]:
            raise self._fault(f"expected {key}, found {' '.join(row)!r}")
        return self._numbers(row[words:], 1)[0]
