"""Runs the world of a student in namespaces of its own, with a relay to its editor.

    python3 -I student_box.py < SPECIFICATION

SPECIFICATION is JSON:
    parent         process id of the process that started this one; the box ends with it
    home           home folder of the student
    class_folder   folder of all homes and of the state of the class; only `home` is seen of it
    needed         files and folders that the programs must reach, also below folders of others
    command, environment, input   the last one is the standard input
    user           user id that the programs get where the system permits it
    processors     numbers of the processors that they may use
    bytes, memory_bytes, processor_seconds, processes   limits of each process; null for none
    relay          command line of the relay
    relay_user     its user id
    descriptors    file descriptors that the relay inherits

Run as a file, it imports the standard library alone, and cell.py and box.py of the grading. The
programs see no processes, sockets and home folders of other students; the network is a loopback
interface. SIGTERM interrupts the command as Ctrl-C does. The variable BOX_ISOLATION of the
command names what works.
"""
from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import signal
import subprocess
import sys
import tempfile
from types import FrameType
from typing import Any, Dict, List, Optional

_PR_SET_PDEATHSIG = 1
_OOM_SCORE = "500"   # of -1000 to 1000; a student cannot lower it below that of the class
_GRADING = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "grading")


def _module(name: str) -> Any:
    """A module of the grading, without importing the package."""
    spec = importlib.util.spec_from_file_location(name, os.path.join(_GRADING, f"{name}.py"))
    if spec is None or spec.loader is None:
        raise ImportError(name)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main() -> int:
    """Run the specification of the standard input; returns the exit status."""
    spec: Dict[str, Any] = json.load(sys.stdin)
    box, cell = _module("box"), _module("cell")
    box.LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != spec["parent"]:
        return 128 + signal.SIGKILL
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})   # until there is a handler
    os.sched_setaffinity(0, spec["processors"])
    sockets = box.unix_sockets()
    if not box.unshare_all():
        sys.stderr.write("this system does not permit namespaces\n")
        return 1
    ready, told = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(told)
        box.LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        os.read(ready, 1)
        os._exit(_inside(spec, sockets, box, cell))
    os.close(ready)
    os.write(told, b".")
    _forward(child)
    status: int = box.status_of(os.waitpid(child, 0)[1])
    return status


def _forward(process: int) -> None:
    """Send SIGTERM on to a process."""
    def on_signal(_number: int, _frame: Optional[FrameType]) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, signal.SIGTERM)

    signal.signal(signal.SIGTERM, on_signal)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})


def _inside(spec: Dict[str, Any], sockets: List[str], box: Any, cell: Any) -> int:
    """Prepare the namespaces, and run relay and command; returns the exit status."""
    _prepare(spec, box, cell)
    box.hide_sockets(sockets)
    relay = subprocess.Popen(spec["relay"], stdin=subprocess.DEVNULL, env={"PATH": os.defpath},
                             cwd="/", pass_fds=spec["descriptors"],
                             preexec_fn=lambda: _become(spec["relay_user"], box, cell))
    for descriptor in spec["descriptors"]:
        os.close(descriptor)

    def start() -> None:
        cell.limit_resources(spec)
        with contextlib.suppress(OSError):   # if memory runs out, the kernel ends students first
            with open("/proc/self/oom_score_adj", "w", encoding="ascii") as stream:
                stream.write(_OOM_SCORE)
        _become(spec["user"], box, cell)

    with tempfile.TemporaryFile() as text:
        text.write(spec["input"].encode())
        text.seek(0)
        process = subprocess.Popen(spec["command"], env=spec["environment"], cwd=spec["home"],
                                   stdin=text, start_new_session=True, preexec_fn=start)

    def on_signal(_number: int, _frame: Optional[FrameType]) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process.pid, signal.SIGINT)

    signal.signal(signal.SIGTERM, on_signal)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    while True:
        pid, status = os.wait()
        if pid in (process.pid, relay.pid):
            code: int = box.status_of(status)
            return code


def _become(user: int, box: Any, cell: Any) -> None:
    """Give up all rights, in a process before it starts a program."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    with contextlib.suppress(OSError):
        os.setgroups([])
    with contextlib.suppress(OSError):
        os.setgid(user)
        os.setuid(user)
    cell.drop_capabilities(box.LIBC)


def _prepare(spec: Dict[str, Any], box: Any, cell: Any) -> None:
    """Hide what belongs to others. Raises OSError."""
    class_folder, home = spec["class_folder"], spec["home"]
    needed = [*map(os.path.realpath, filter(os.path.exists, spec["needed"])), class_folder]
    cell.hide_folders([], needed, box)
    for folder in ("/tmp", "/var/tmp"):
        if os.path.isdir(folder):
            _replace(folder, needed, spec["bytes"], box, cell)
    _replace(class_folder, [home], 1 << 20, box, cell)
    box.mount("proc", "/proc", "proc", box.MS_NOSUID | box.MS_NODEV)
    if not box.switch_loopback_on():
        raise OSError("the loopback interface cannot be switched on")


def _replace(folder: str, kept: List[str], size: int, box: Any, cell: Any) -> None:
    """Put an empty folder of a size in bytes in the place of another; it holds `kept` only."""
    below = sorted(path for path in kept if path.startswith(folder.rstrip("/") + "/"))
    tops = [path for path in below if not any(path.startswith(other + "/") for other in below)]
    held = {path: os.open(path, os.O_PATH | os.O_NOFOLLOW) for path in tops}
    box.tmpfs(folder, size)
    cell.show_held(held, box)


if __name__ == "__main__":
    sys.exit(main())
