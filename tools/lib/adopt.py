"""Run a command and wait for all programs that it leaves behind: their processor time counts then.

A browser's processes are not children of the test that started it. When the test ends, init would
adopt them, and no sum would include their processor time.
"""

import ctypes
import os
import signal
import sys
import time
from typing import List

PR_SET_CHILD_SUBREAPER = 36   # prctl(2)
#: What still runs so long after the command is left to the caller, which ends it and says so.
PATIENCE_S = 2.0
PAUSE_S = 0.02


def reap_others(until: float) -> None:
    """Wait for children that end before the clock of time.monotonic() shows `until` [s]."""
    while time.monotonic() < until:
        try:
            process, _ = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return
        if process == 0:
            time.sleep(PAUSE_S)


def main(command: List[str]) -> int:
    """Run `command`; returns its exit status, 128 and the signal's number if one ended it."""
    if ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "prctl")
    environment = dict(os.environ, MY_SIMULATIONS_ADOPTER=str(os.getpid()))
    # Not subprocess.Popen: an object that is dropped waits for its process if that has ended.
    started = os.posix_spawnp(command[0], command, environment,
                              setsigdef=[signal.SIGPIPE, signal.SIGXFSZ])  # Python ignores these
    process = 0
    while process != started:
        process, status = os.waitpid(-1, 0)
    reap_others(time.monotonic() + PATIENCE_S)
    return os.WEXITSTATUS(status) if os.WIFEXITED(status) else 128 + os.WTERMSIG(status)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
