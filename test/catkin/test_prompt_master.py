"""The ROS master of the grading: its threads wait for tasks, and never for a time to pass."""
from __future__ import annotations

import threading

import pytest
import rosmaster.threadpool

from my_simulations.grading.held_notices import HeldNotices
from my_simulations.grading.prompt_master import PromptThreadPool

SECONDS = 60.0


@pytest.fixture
def pool(monkeypatch):
    def refused(seconds):
        raise AssertionError(f"a thread sleeps for {seconds} s")

    monkeypatch.setattr(rosmaster.threadpool, "sleep", refused)
    return PromptThreadPool(3)


def test_tasks_run_as_soon_as_they_are_added(pool):
    threads = [threading.Event() for _ in range(20)]
    for number, done in enumerate(threads):
        assert pool.queue_task(f"node{number % 2}", done.set, ())
    assert all(done.wait(SECONDS) for done in threads)


def test_tasks_of_one_node_run_one_after_the_other(pool):
    first_runs, may_end, second_ran = (threading.Event() for _ in range(3))

    def first():
        first_runs.set()
        assert may_end.wait(SECONDS) and not second_ran.is_set()

    other = threading.Event()
    pool.queue_task("a", first, ())
    pool.queue_task("a", second_ran.set, ())
    pool.queue_task("b", other.set, ())
    assert first_runs.wait(SECONDS) and other.wait(SECONDS) and not second_ran.is_set()
    may_end.set()
    assert second_ran.wait(SECONDS)


def test_held_tasks_run_in_their_order_once_they_are_permitted(pool):
    notices = HeldNotices()
    held = PromptThreadPool(3, notices.descriptors)
    assert not notices.permit()
    ran, done = [], threading.Event()
    held.queue_task("a", ran.append, (1,))
    held.queue_task("a", ran.append, (2,))
    held.queue_task("a", done.set, ())
    assert not done.wait(0.2) and ran == []
    assert notices.permit() and done.wait(SECONDS)
    assert ran == [1, 2] and not notices.permit()
    done.clear()
    held.queue_task("a", done.set, ())
    assert notices.permit() and done.wait(SECONDS)
    notices.close()
