"""The sensing process: `python -m my_simulations.sensing REQUESTS RING` (descriptors)."""
from __future__ import annotations

import os
import signal
import socket
import sys
from typing import List, Optional

from ..child_process import die_with_parent
from ..engine.message_pipe import Wire
from ..engine.ring import Memory, RingReader

_SWITCH_S = 2e-4  # rays must not wait long for a thread that draws


def main(argv: List[str]) -> int:
    """Work until the parent hangs up or dies."""
    # The parent decides when to end, as with the engine.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    die_with_parent()
    sys.setswitchinterval(_SWITCH_S)
    _leave_a_core()
    from .service import Service

    requests, ring_fd = (int(word) for word in argv[1:3])
    ring: Optional[RingReader] = None
    if ring_fd >= 0:
        ring = RingReader(memory=Memory(ring_fd, read_only=True))
    service = Service(Wire(socket.socket(fileno=requests)), ring)
    service.run()
    return 0


def _leave_a_core() -> None:
    """Limit Mesa's software renderer to all cores but one."""
    cores = len(os.sched_getaffinity(0))
    os.environ.setdefault("LP_NUM_THREADS", str(min(max(cores - 1, 1), 8)))


if __name__ == "__main__":
    code = main(sys.argv)
    sys.stderr.flush()
    os._exit(code)  # OpenGL's and Embree's own ends take time, and have nothing to save
