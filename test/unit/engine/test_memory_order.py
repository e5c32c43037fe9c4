"""Snapshots are whole where stores of another process become visible in any order."""
from __future__ import annotations

import array
import random

import pytest

from my_simulations.engine import memory_fence, ring, step_records
from my_simulations.engine.ring import LINK_WIDTH, Clock, Memory, RingReader, RingWriter

CLOCK = Clock(0, 0, 10 ** 9)
ROWS = 3


class Reordered:
    """Stores of a writer that become visible in any order, except across a fence.

    `words` and `buffer` stand for those of the memory: loads see the writer's own stores.
    """

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        self._epochs, self._is_writing = [[]], True
        self.words, self.buffer = _Stores(self, memory.words), _Stores(self, memory.buffer)
        self.slot, self.pose_slot = memory.slot, memory.pose_slot

    def add(self, target, key, value) -> None:
        self._epochs[-1].append((target, key, value))

    def fence(self) -> None:
        if self._is_writing:   # else it is one of the reader's
            self._epochs.append([])

    def publish(self, draw: random.Random, seen) -> None:
        """Make the stores visible one by one; `seen` is called after each."""
        self._is_writing = False
        for epoch in self._epochs:
            draw.shuffle(epoch)
            for target, key, value in epoch:
                target[key] = value
                seen()
        self._epochs, self._is_writing = [[]], True


class _Stores:
    def __init__(self, memory: Reordered, target) -> None:
        self._memory, self._target = memory, target
        self._own = {}

    def __setitem__(self, key, value) -> None:
        if isinstance(key, slice):   # of the body, byte by byte in groups of a row
            data = bytes(value)
            for at in range(0, len(data), LINK_WIDTH * 8):
                part = data[at:at + LINK_WIDTH * 8]
                begin = key.start + at
                self._memory.add(self._target, slice(begin, begin + len(part)), part)
            return
        self._own[key] = value
        self._memory.add(self._target, key, value)

    def __getitem__(self, key):
        return self._own.get(key, self._target[key])


def torn(monkeypatch, with_fences: bool) -> int:
    """How many reads mixed two snapshots, of many in which stores are visible in part."""
    memory = Memory(None)
    weak = Reordered(memory)
    monkeypatch.setattr(ring, "keep_order", weak.fence if with_fences else lambda: None)
    writer, reader = RingWriter(memory=weak), RingReader(memory=memory)
    draw, found = random.Random(7), 0

    def look() -> None:
        nonlocal found
        newest = memory.words[ring.LATEST]
        for sequence in range(max(1, newest - ring.SLOTS), newest + 3):
            snapshot = reader.read(sequence)
            if snapshot is not None and list(snapshot.links) != [float(sequence)] * len(
                    snapshot.links) or snapshot is not None and not len(snapshot.links):
                found += 1
        if newest:
            held = reader.earlier_links(newest)
            found += held is not None and set(array.array("d", held[1])) != {float(newest)}

    for number in range(1, 40):
        values = array.array("d", [float(number)] * (ROWS * LINK_WIDTH)).tobytes()
        assert writer.write(number, CLOCK, values, b"") == number
        weak.publish(draw, look)
    return found


def test_a_snapshot_is_whole_whatever_order_stores_become_visible_in(monkeypatch):
    assert torn(monkeypatch, with_fences=True) == 0


def test_without_fences_torn_snapshots_are_found(monkeypatch):
    assert torn(monkeypatch, with_fences=False) > 0


def test_a_record_is_visible_before_its_number(monkeypatch):
    order = []
    memory = Memory(None)

    class Source:
        def read_rows(self, rows):
            return array.array("d", [1.0] * LINK_WIDTH).tobytes()

    class Words:
        def __setitem__(self, key, value):
            order.append("number" if key == ring.RECORDS_WRITTEN else "record")
            memory.words[key] = value

        def __getitem__(self, key):
            return memory.words[key]

    monkeypatch.setattr(step_records, "keep_order", lambda: order.append("fence"))
    writer = step_records.RecordWriter(memory, Source())
    writer._words = Words()
    rule = step_records.RecordRule(1, step_records.Rate(0.0), link_rows=(0,))
    writer.set_rules((rule,), 0, CLOCK)
    assert writer.write(writer.next_step, 1, CLOCK)
    last = order.index("number")
    assert order[last - 1] == "fence" and "record" not in order[last:]
    # What is overwritten has been read: the number of released records is loaded before a store.
    assert order[0] == "fence"


@pytest.mark.parametrize("machine", ["aarch64", "x86_64"])
def test_only_processors_that_reorder_pay_for_fences(monkeypatch, machine):
    import importlib
    import platform
    monkeypatch.setattr(platform, "machine", lambda: machine)
    try:
        module = importlib.reload(memory_fence)
        assert (module.keep_order is module.fence) is (machine == "aarch64")
        module.fence()
    finally:
        monkeypatch.undo()
        importlib.reload(memory_fence)
