"""The snapshot ring: whole copies or none."""
from __future__ import annotations

import struct

from my_simulations.engine import ring
from my_simulations.engine.ring import Clock, Memory, RingReader, RingWriter, picoseconds


def _pair():
    memory = Memory(None)
    return RingWriter(memory=memory), RingReader(memory=memory)


def _links(*rows):
    return b"".join(struct.pack("=13d", *row) for row in rows)


CLOCK = Clock(0, 0, picoseconds(0.001))


def test_a_snapshot_is_read_back_whole():
    writer, reader = _pair()
    row = [float(n) for n in range(13)]
    sequence = writer.write(7, CLOCK, _links([0.0] * 13, row), struct.pack("=2d", 0.5, -1.0))
    snapshot = reader.read()
    assert (snapshot.sequence, snapshot.step, snapshot.sim_ns) == (sequence, 7, 7_000_000)
    pose, twist = snapshot.link(1)
    assert pose.position == (0.0, 1.0, 2.0) and pose.orientation == (3.0, 4.0, 5.0, 6.0)
    assert twist.linear == (7.0, 8.0, 9.0) and twist.angular == (10.0, 11.0, 12.0)
    assert snapshot.joint(0) == (0.5, -1.0)
    assert reader.link(1) == (pose, twist)


def test_a_writer_that_dies_in_the_middle_leaves_the_previous_snapshot():
    writer, reader = _pair()
    writer.write(1, CLOCK, _links([1.0] * 13), b"")
    # What the memory looks like when the writer was killed while it filled the next slot.
    slot = writer.memory.slot(2)
    writer.words[slot + ring.SEQ_BEGIN] = 2
    writer.words[slot + ring.SLOT_STEP] = 99
    assert reader.read().sequence == 1
    assert reader.read(2) is None
    assert RingWriter(memory=writer.memory).write(5, CLOCK, _links([2.0] * 13), b"") == 2
    assert reader.read().links[0] == 2.0


def test_links_of_earlier_snapshots_are_there_until_they_are_overwritten():
    writer, reader = _pair()
    for step in range(1, ring.SLOTS + 2):
        writer.write(step, CLOCK, _links([float(step)] * 13), b"")
    assert reader.earlier_links(1) is None
    for step in range(2, ring.SLOTS + 2):
        assert reader.earlier_links(step) == (step, _links([float(step)] * 13))
    assert reader.earlier_links(ring.SLOTS + 2) is None


def test_an_overwritten_snapshot_is_not_returned():
    writer, reader = _pair()
    for step in range(ring.SLOTS + 1):
        writer.write(step, CLOCK, _links([float(step)] * 13), b"")
    assert reader.read(1) is None
    assert reader.read(2).links[0] == 1.0


def test_a_copy_that_is_overtaken_is_thrown_away(monkeypatch):
    writer, reader = _pair()
    writer.write(1, CLOCK, _links([1.0] * 13), b"")
    whole = RingReader._is_whole
    calls = []

    def overtaken_once(self, slot, sequence):
        if not calls:
            calls.append(sequence)
            for step in range(ring.SLOTS):
                writer.write(2 + step, CLOCK, _links([2.0] * 13), b"")
        return whole(self, slot, sequence)

    monkeypatch.setattr(RingReader, "_is_whole", overtaken_once)
    assert reader.read().links[0] == 2.0


def test_the_clock_counts_steps_of_any_size_to_a_microsecond_an_hour():
    clock = Clock(1000, 1_000_000_000, picoseconds(1 / 240))
    an_hour_later = clock.sim_ns(1000 + 240 * 3600)
    assert abs(an_hour_later - 3_601_000_000_000) < 1000  # ns


def test_the_step_count_runs_ahead_of_the_states_while_nothing_moves():
    writer, reader = _pair()
    writer.write(1, CLOCK, _links([1.0] * 13), b"")
    writer.set_step(50)
    step, clock = reader.clock()
    assert (step, clock.sim_ns(step)) == (50, 50_000_000)


def test_a_snapshot_has_the_last_step_at_which_nothing_had_moved():
    writer, reader = _pair()
    writer.words[ring.STATUS] = ring.STATUS_RUNNING
    writer.write(1, CLOCK, _links([1.0] * 13), b"")
    writer.set_step(50)
    assert reader.read().step == 1
    writer.mark_unchanged(50)
    assert reader.read().step == 50
    writer.write_poses(60, CLOCK, _links([2.0] * 13))
    writer.mark_unchanged(70)   # of the poses
    assert reader.read().step == 1


def test_newer_poses_are_seen_beside_the_last_snapshot_until_the_next_one():
    writer, reader = _pair()
    writer.write(1, CLOCK, _links([1.0] * 13), b"")
    assert reader.raw_poses()[2] == _links([1.0] * 13)
    for step in range(2, 2 + 3 * ring.POSE_SLOTS):
        before = reader.changes
        writer.write_poses(step, CLOCK, _links([float(step)] * 13))
        assert reader.raw_poses()[2] == _links([float(step)] * 13)
        assert reader.changes > before and reader.step == step
    assert reader.raw_links() == (1, _links([1.0] * 13))
    writer.write(99, CLOCK, _links([99.0] * 13), b"")
    assert reader.raw_poses()[2] == _links([99.0] * 13)


def test_poses_come_with_the_step_and_the_clock_at_which_they_were_so():
    writer, reader = _pair()
    writer.write(10, CLOCK, _links([1.0] * 13), b"")
    writer.set_step(50)
    assert reader.raw_poses()[:2] == (10, CLOCK)
    writer.mark_unchanged(50)
    assert reader.raw_poses()[0] == 50
    writer.write_poses(60, CLOCK, _links([2.0] * 13))
    writer.set_step(70)
    assert reader.raw_poses()[:2] == (60, CLOCK)
    again = Clock(0, 0, picoseconds(0.002))
    writer.write(0, again, _links([3.0] * 13), b"")
    assert reader.raw_poses()[:2] == (0, again)


def test_poses_whose_writer_died_in_the_middle_are_not_seen():
    writer, reader = _pair()
    writer.write(1, CLOCK, _links([1.0] * 13), b"")
    writer.write_poses(2, CLOCK, _links([2.0] * 13))
    slot = writer.memory.pose_slot(2)
    writer.words[slot + ring.SEQ_BEGIN] = 2
    assert reader.raw_poses()[2] == _links([2.0] * 13)
