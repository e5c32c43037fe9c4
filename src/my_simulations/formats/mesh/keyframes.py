"""Animations of COLLADA files: where nodes are at some times, and in between."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from .node_tree import Array, NodeTree, Placing, floats, local_matrix, placings_of

_MEMBERS = {"X": 0, "Y": 1, "Z": 2, "ANGLE": 3}


@dataclass(frozen=True)
class Keys:
    """Nodes that have keys at the same times.

    Attributes:
        times: (k,) s, ascending.
        nodes: (m,) their numbers.
        places: (k, m, 3), in the file's unit; turns: (k, m, 4) quaternions x, y, z, w;
            scales: (k, m, 3); all parent from node.
    """

    times: Array
    nodes: Array
    places: Array
    turns: Array
    scales: Array

    def at(self, time: float) -> Tuple[Array, Array, Array]:
        """Places, turns and scales at a time: even between keys, still before and after them."""
        last = len(self.times) - 1
        after = int(np.searchsorted(self.times, time, side="right"))
        a, b = max(after - 1, 0), min(after, last)
        span = self.times[b] - self.times[a]
        part = float((time - self.times[a]) / span) if span > 0.0 else 0.0
        return (self.places[a] + (self.places[b] - self.places[a]) * part,
                _slerp(self.turns[a], self.turns[b], part),
                self.scales[a] + (self.scales[b] - self.scales[a]) * part)


@dataclass(frozen=True)
class Clip:
    """A movement of `duration` s."""

    keys: List[Keys]
    duration: float


def clip_of(root: Any, tree: NodeTree) -> Optional[Clip]:
    """All animations of a file at once; None for none.

    Gazebo ignores `<animation_clip>`: a movement lasts until the last key. Between keys it is
    linear, whatever `INTERPOLATION` says. Raises ValueError, LookupError: numbers that do not fit
    each other.
    """
    channels: Dict[int, List[_Channel]] = {}
    for animation in root.findall("{*}library_animations/{*}animation"):
        for channel in animation.iter("{*}channel"):
            made = _Channel(channel, tree)
            if made.node >= 0 and len(made.times):
                channels.setdefault(made.node, []).append(made)
    groups: Dict[bytes, List[_NodeKeys]] = {}
    for node, found in channels.items():
        keys = _NodeKeys(node, found, placings_of(tree.elements[node]))
        groups.setdefault(keys.times.tobytes(), []).append(keys)
    if not groups:
        return None
    keys_of_all = [_join_keys(group) for group in groups.values()]
    return Clip(keys_of_all, max(float(keys.times[-1]) for keys in keys_of_all))


def _join_keys(group: "List[_NodeKeys]") -> Keys:
    matrices = np.array([one.matrices for one in group]).swapaxes(0, 1)
    if not (np.isfinite(matrices).all() and np.isfinite(group[0].times).all()):
        raise ValueError("keys that are not finite numbers")
    places, turns, scales = decompose_matrices(matrices)
    return Keys(group[0].times, np.array([one.node for one in group]), places, turns, scales)


class _Channel:
    """A `<channel>`: keys of a placing of a node, or of one of its numbers."""

    def __init__(self, element: Any, tree: NodeTree) -> None:
        name, _, sid = (element.get("target") or "").partition("/")
        self.sid: str = sid
        self.node = tree.numbers.get(name, -1) if name else -1
        self.member: Optional[int] = None
        self.times = self.values = np.zeros(0)
        if "." in self.sid:
            self.sid, _, member = self.sid.partition(".")
            self.member = _MEMBERS.get(member)
            if self.member is None:
                self.node = -1
        elif "(" in self.sid:
            self.sid, *numbers = self.sid.replace(")", "").split("(")
            first, second = ([int(one) for one in numbers] + [0])[:2]
            self.member = first + 4 * second if len(numbers) > 1 else first
        sampler = tree.by_id.get((element.get("source") or "#")[1:])
        if self.node < 0 or sampler is None:
            return
        sources = {one.get("semantic"): tree.by_id[one.get("source")[1:]]
                   for one in sampler.iterchildren("{*}input")}
        times = floats(sources["INPUT"].find("{*}float_array"))
        values = floats(sources["OUTPUT"].find("{*}float_array")).reshape(len(times), -1)
        order = np.argsort(times, kind="stable")
        self.times, self.values = times[order], values[order]

    def at(self, time: float) -> Array:
        return np.array([np.interp(time, self.times, column) for column in self.values.T])


class _NodeKeys:
    """All keys of a node: (k, 4, 4) matrices at (k,) times."""

    def __init__(self, node: int, channels: List[_Channel], rest: List[Placing]) -> None:
        self.node = node
        self.times = np.unique(np.concatenate([one.times for one in channels]))
        if len(channels) == len(rest) == 1 and rest[0][:2] == (channels[0].sid, "matrix") \
                and channels[0].member is None and len(channels[0].times) == len(self.times):
            self.matrices = channels[0].values.reshape(-1, 4, 4)  # as nearly all files have it
            return
        made = []
        for time in self.times:
            placings = [(sid, kind, values.copy()) for sid, kind, values in rest]
            for channel in channels:
                for sid, _, values in placings:
                    if sid == channel.sid and channel.member is None:
                        values[:] = channel.at(time)
                    elif sid == channel.sid:
                        values[channel.member] = channel.at(time)[0]
            made.append(local_matrix(placings))
        self.matrices = np.array(made)


def decompose_matrices(matrices: Array) -> Tuple[Array, Array, Array]:
    """Split (..., 4, 4) matrices into positions (..., 3), quaternions (..., 4), scales (..., 3).

    Shear is lost.
    """
    scales = np.linalg.norm(matrices[..., :3, :3], axis=-2)
    mirrored = np.linalg.det(matrices[..., :3, :3]) < 0.0
    scales[..., 0] = np.where(mirrored, -scales[..., 0], scales[..., 0])
    turns = matrices[..., :3, :3] / np.where(scales == 0.0, 1.0, scales)[..., None, :]
    return matrices[..., :3, 3].copy(), _quaternions(turns), scales


def compose_matrices(places: Array, turns: Array, scales: Array) -> Array:
    """Return the (n, 4, 4) matrices of positions, quaternions and scales."""
    x, y, z, w = turns.T
    made = np.zeros((len(places), 4, 4))
    made[:, :3, :3] = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1) * scales[:, None, :]
    made[:, :3, 3] = places
    made[:, 3, 3] = 1.0
    return made


def _quaternions(turns: Array) -> Array:
    """(..., 4) of rotation matrices: each from the largest of its parts (Shepperd's method)."""
    m = turns
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz],
                       axis=-1)
    products = np.empty((*m.shape[:-2], 4, 4))   # 4 q_i q_j
    for i in range(4):
        products[..., i, i] = squares[..., i]
    for i, j, value in ((0, 1, m[..., 1, 0] + m[..., 0, 1]), (0, 2, m[..., 0, 2] + m[..., 2, 0]),
                        (1, 2, m[..., 2, 1] + m[..., 1, 2]), (0, 3, m[..., 2, 1] - m[..., 1, 2]),
                        (1, 3, m[..., 0, 2] - m[..., 2, 0]), (2, 3, m[..., 1, 0] - m[..., 0, 1])):
        products[..., i, j] = products[..., j, i] = value
    largest = np.argmax(squares, axis=-1)[..., None, None]
    rows = np.take_along_axis(products, largest, axis=-2)[..., 0, :]
    unit: Array = rows / np.linalg.norm(rows, axis=-1, keepdims=True)
    return unit


def _slerp(a: Array, b: Array, part: float) -> Array:
    """(m, 4) at a part of the shorter way between (m, 4) quaternions."""
    cosine = (a * b).sum(axis=1)
    sign = np.where(cosine < 0.0, -1.0, 1.0)
    angle = np.arccos(np.minimum(np.abs(cosine), 1.0))
    sine = np.sin(angle)
    near = sine < 1e-6
    below = np.where(near, 1.0, sine)
    start = np.where(near, 1.0 - part, np.sin((1.0 - part) * angle) / below)
    end = np.where(near, part, np.sin(part * angle) / below) * sign
    mixed = a * start[:, None] + b * end[:, None]
    unit: Array = mixed / np.linalg.norm(mixed, axis=1, keepdims=True)
    return unit
