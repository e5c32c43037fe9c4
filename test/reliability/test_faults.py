"""An engine that is killed and stopped at any moment: nothing is lost, and every answer is true."""
from __future__ import annotations

import os
import random
import signal
import time

from ledger import Crew
from proofs import scaled
from waiting import until

from my_simulations.simulator import supervisor


def test_nothing_is_lost_when_engines_die(record, monkeypatch):
    monkeypatch.setattr(supervisor, "_RAPID_S", 0.0)  # the world is not to blame for these deaths
    kills, most = scaled(8, 100), scaled(12, 25)
    chance = random.Random(16)
    slowest = 0.0
    with Crew(scaled(3, 8), most) as crew:
        simulator = crew.simulator
        for _ in range(kills):
            time.sleep(chance.uniform(0.0, 0.6))  # the moment is the point
            pid = simulator.engine_pid
            if chance.random() < 0.25:
                os.kill(pid, signal.SIGSTOP)
                time.sleep(0.2)
                os.kill(pid, signal.SIGCONT)
            began = time.monotonic()
            os.kill(pid, signal.SIGKILL)
            until(lambda gone=pid: simulator.engine_pid not in (gone, 0), "a new engine")
            done = crew.done
            until(lambda before=done: crew.done > before, "an answer of the new engine")
            slowest = max(slowest, time.monotonic() - began)
        crew.finish()
    record("engine killed and stopped", kills=kills, **crew.figures(),
           slowest_recovery_s=round(slowest, 1))
