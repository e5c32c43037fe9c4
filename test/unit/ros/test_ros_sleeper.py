"""Threads that sleep until they are woken."""
from __future__ import annotations

import threading

from my_simulations.ros.topics.worker_thread import WorkerThread


class Counter(WorkerThread):
    """Counts how often it was woken."""

    def __init__(self):
        super().__init__("counter")
        self.count = 0
        self.woken = threading.Event()

    def wake(self):
        self._wake.set()

    def _run(self):
        while not self._stop.is_set():
            self._sleep()
            self.count += 1
            self.woken.set()


def test_it_works_when_woken_only_and_ends_when_told_to():
    counter = Counter()
    counter.start()
    thread = next(one for one in threading.enumerate() if one.name == "counter")
    assert not counter.woken.wait(0.05)
    counter.wake()
    assert counter.woken.wait(60.0)
    assert counter.count == 1
    counter.stop()
    assert not thread.is_alive()


def test_one_that_was_never_started_can_be_stopped():
    Counter().stop()


def test_what_woke_it_before_it_slept_is_not_lost():
    counter = Counter()
    counter.wake()
    counter.start()
    assert counter.woken.wait(60.0)
    counter.stop()
