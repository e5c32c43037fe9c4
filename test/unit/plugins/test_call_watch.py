"""What a plugin that was left behind leaves to the rest of the process."""
from __future__ import annotations

import subprocess
import sys
import threading
import time

import pytest
from waiting import until

from my_simulations.plugins.call_watch import (
    CallLimits,
    CallOverdue,
    CallWatch,
    ThreadAbandoned,
)

TRACED = """
import sys, threading
from my_simulations.plugins.call_watch import CallLimits, CallWatch, ThreadAbandoned

left, back = threading.Event(), threading.Event()
watch = CallWatch(lambda subject, why: left.set())

def call():
    try:
        watch.run("plugin", CallLimits(0.1, 0.1), back.wait)
    except ThreadAbandoned as abandoned:
        print("ended:", abandoned)

thread = threading.Thread(target=call)
thread.start()
left.wait(60.0)
watch.stop()
watch._watcher.join(60.0)
sys.settrace(lambda *_: None)
(lambda: None)()
sys.settrace(None)
back.set()
thread.join(60.0)
print("traced")
"""


def test_functions_can_be_traced_after_a_thread_was_left_behind():
    done = subprocess.run([sys.executable, "-c", TRACED], stdout=subprocess.PIPE, text=True,
                          timeout=120, check=True)
    told, traced = done.stdout.splitlines()
    assert told.startswith("ended: it waited for more than 0.1 s")
    assert traced == "traced"


def in_a_thread(watch, call):
    """What `watch.run` raises in a thread of its own, once the thread has ended."""
    raised = []

    def run():
        try:
            watch.run("plugin", CallLimits(0.1, 0.1), call)
        except BaseException as one:  # the thread of a host sees all of them
            raised.append(type(one))

    thread = threading.Thread(target=run)
    thread.start()
    thread.join(60.0)
    assert not thread.is_alive()
    watch.stop()
    return raised


@pytest.mark.parametrize("fault", [None, ValueError, SystemExit, CallOverdue])
def test_a_call_that_returns_while_its_thread_is_abandoned_ends_the_thread(fault):
    """Another thread takes over: this one must not call further plugins, however the call ends."""
    back = threading.Event()

    def abandon(subject, why):
        back.set()
        until(lambda: not thread_of_call[0].is_alive())

    def call():
        thread_of_call.append(threading.current_thread())
        back.wait()
        if fault is not None:
            raise fault

    thread_of_call = []
    assert in_a_thread(CallWatch(abandon), call) == [ThreadAbandoned]


def test_a_call_that_waits_is_not_charged_for_calls_inside_its_wait_and_is_watched_again():
    watch = CallWatch(lambda subject, why: None)
    inside = []

    def compute(until_s):
        while time.thread_time() < until_s:
            pass

    def turn():
        inside.append("begun")
        watch.run("other", CallLimits(60.0, 60.0), compute, time.thread_time() + 0.6)
        compute(time.thread_time() + 0.3)   # no call of a plugin
        inside.append("ended")

    def wait():
        watch.run_inside(turn)
        while True:
            pass

    assert in_a_thread(watch, wait) == [CallOverdue]
    assert inside == ["begun", "ended"]
