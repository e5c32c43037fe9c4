"""What a plugin that was left behind leaves to the rest of the process."""
from __future__ import annotations

import subprocess
import sys

TRACED = """
import sys, threading
from my_simulations.plugins.call_watch import CallOverdue, CallWatch, Patience

left, back = threading.Event(), threading.Event()
watch = CallWatch(lambda subject, why: left.set())

def call():
    try:
        watch.run("plugin", Patience(0.1, 0.1), back.wait)
    except CallOverdue as overdue:
        print("ended:", overdue)

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
