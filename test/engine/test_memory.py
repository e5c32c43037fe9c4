"""Law: what an engine does not use it does not keep."""
from __future__ import annotations

import subprocess
import sys

_CODE = """
import sys
from my_simulations.engine.spare_memory import made_sparingly
from my_simulations.engine.bullet.backend import BulletBackend

def resident():
    with open("/proc/self/status") as stream:
        return next(int(line.split()[1]) for line in stream if line.startswith("VmRSS:"))

before = resident()
backend = made_sparingly(BulletBackend) if sys.argv[1] == "sparingly" else BulletBackend()
print(resident() - before)
backend.step(0, 10)
backend.close()
"""


def grown(how: str) -> int:
    """How many kB a process grows by when it makes an engine."""
    done = subprocess.run([sys.executable, "-c", _CODE, how], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=True, timeout=60)
    return int(done.stdout.splitlines()[-1])


def test_buffers_of_zeros_take_no_memory() -> None:
    assert grown("sparingly") < grown("freely") - 15_000
