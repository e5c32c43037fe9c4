"""Law: what an engine does not use it does not keep."""
from __future__ import annotations

import json
import subprocess
import sys

_CODE = """
import sys
from my_simulations.engine.spare_memory import made_without_zero_pages
from my_simulations.engine.bullet.backend import BulletBackend

def resident():
    with open("/proc/self/status") as stream:
        return next(int(line.split()[1]) for line in stream if line.startswith("VmRSS:"))

before = resident()
backend = made_without_zero_pages(BulletBackend) if sys.argv[1] == "sparingly" else BulletBackend()
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


_ZEROS = """
import ctypes, json, mmap
from my_simulations.engine.spare_memory import made_without_zero_pages

SIZE = 8 << 20
malloc = ctypes.CDLL(None).malloc
malloc.argtypes, malloc.restype = (ctypes.c_size_t,), ctypes.c_void_p

def resident(address):
    counts = (ctypes.c_ubyte * (SIZE // mmap.PAGESIZE))()
    first = -(-address // mmap.PAGESIZE) * mmap.PAGESIZE
    mincore = ctypes.CDLL(None).mincore
    mincore.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)
    assert mincore(first, SIZE - mmap.PAGESIZE, ctypes.byref(counts)) == 0
    return sum(one & 1 for one in counts)

def blocks():
    mapped = mmap.mmap(-1, SIZE, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)  # as an arena of Python
    kept = (ctypes.c_char * SIZE).from_buffer(mapped)
    allocated = malloc(SIZE)
    for address in (ctypes.addressof(kept), allocated):
        ctypes.memset(address, 0, SIZE)
    return mapped, kept, ctypes.addressof(kept), allocated

made = made_without_zero_pages(blocks)
print(json.dumps([resident(address) for address in made[2:]]))
"""


def test_zeros_that_others_have_mapped_are_not_given_back() -> None:
    done = subprocess.run([sys.executable, "-c", _ZEROS], stdout=subprocess.PIPE, text=True,
                          check=True, timeout=60)
    mapped, allocated = json.loads(done.stdout)
    assert mapped > 2000    # of 2048 pages
    assert allocated < 50
