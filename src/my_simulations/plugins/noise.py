"""Noise that a run repeats: drawn by sim time, keyed by seed and by the plugin that draws."""
from __future__ import annotations

import hashlib
import math
import struct
from typing import List


class WhiteNoise:
    """Gaussian noise without a mean. The draw at a sim time is the same in every run with the same
    seed, whatever was drawn before.

    Args:
        seed: of the world.
        who: identifies the plugin; each one draws different numbers.
        stddev: in the unit of what is measured; 0 draws zeros.
    """

    def __init__(self, seed: int, who: str, stddev: float) -> None:
        self._key = f"{seed}\0{who}".encode()
        self._stddev = stddev

    def draw(self, count: int, ns: int) -> List[float]:
        """Some numbers for a sim time (ns), by Box and Muller."""
        if self._stddev <= 0.0:
            return [0.0] * count
        found: List[float] = []
        while len(found) < count:
            digest = hashlib.blake2b(self._key, digest_size=16, salt=struct.pack(
                "=qQ", ns, len(found))).digest()
            one, other = (word / 2.0 ** 64 for word in struct.unpack("=QQ", digest))
            radius = self._stddev * math.sqrt(-2.0 * math.log(1.0 - one))
            found += [radius * math.cos(2.0 * math.pi * other),
                      radius * math.sin(2.0 * math.pi * other)]
        return found[:count]
