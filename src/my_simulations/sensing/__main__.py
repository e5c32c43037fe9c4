"""The sensing process: `python -m my_simulations.sensing REQUESTS` (a descriptor)."""
from __future__ import annotations

import os
import signal
import socket
import sys
from typing import List

from ..child_process import die_with_parent
from ..engine.message_pipe import Wire


def main(argv: List[str]) -> int:
    """Work until the parent hangs up or dies."""
    # The parent decides when to end, as with the engine.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    die_with_parent()
    _leave_a_core()
    from .service import Service

    Service(Wire(socket.socket(fileno=int(argv[1])))).run()
    return 0


def _leave_a_core() -> None:
    """Limit Mesa's software renderer to all cores but one."""
    cores = len(os.sched_getaffinity(0))
    os.environ.setdefault("LP_NUM_THREADS", str(min(max(cores - 1, 1), 8)))


if __name__ == "__main__":
    code = main(sys.argv)
    sys.stderr.flush()
    os._exit(code)  # OpenGL's and Embree's own ends take time, and have nothing to save
