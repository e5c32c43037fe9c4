"""A master and a simulator for one measurement, on ports of their own."""
from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from typing import Dict, Iterator, List
from xmlrpc.client import ServerProxy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir, "unit",
                                "support"))

from free_ports import free_port


@contextlib.contextmanager
def master() -> Iterator[str]:
    """A roscore of our own; sets ROS_MASTER_URI for this process."""
    port = free_port()
    uri = f"http://127.0.0.1:{port}"
    os.environ.update(ROS_MASTER_URI=uri, ROS_IP="127.0.0.1")
    process = subprocess.Popen(["roscore", "-p", str(port)], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    try:
        wait(lambda: _answers(uri), 30, "roscore")
        yield uri
    finally:
        end(process)


def _answers(uri: str) -> bool:
    try:
        return ServerProxy(uri).getUri("/bench")[0] == 1 and bool(
            ServerProxy(uri).lookupNode("/bench", "/rosout")[0] == 1)
    except OSError:
        return False


def wait(condition, seconds: float, what: str) -> None:
    """Wait until `condition()` is true; raises TimeoutError."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(f"no {what} within {seconds:.0f} s")
        time.sleep(0.002)


def end(process: subprocess.Popen) -> None:
    """SIGINT, then SIGKILL."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(15)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


class Server:
    """A running gzserver. Use as a context manager."""

    def __init__(self, world: str, *arguments: str, environment: "Dict[str, str] | None" = None):
        self.file = tempfile.NamedTemporaryFile("w", suffix=".world", delete=False)
        self.file.write(world)
        self.file.close()
        program = subprocess.run(["catkin_find", "--first-only", "--libexec", "gazebo_ros",
                                  "gzserver"], stdout=subprocess.PIPE, text=True, check=True)
        self.started = time.perf_counter()
        self.process = subprocess.Popen(
            [program.stdout.strip(), self.file.name, "__name:=gazebo", *arguments],
            stdout=subprocess.DEVNULL, env={**os.environ, **(environment or {})})

    def __enter__(self) -> "Server":
        return self

    def __exit__(self, *_: object) -> None:
        end(self.process)
        os.unlink(self.file.name)

    def pids(self) -> List[int]:
        """The node's and its engine's process numbers."""
        return [self.process.pid, *children(self.process.pid)]


def children(pid: int) -> List[int]:
    """All descendants of a process."""
    found = []
    with contextlib.suppress(FileNotFoundError):
        for task in os.listdir(f"/proc/{pid}/task"):
            with open(f"/proc/{pid}/task/{task}/children", encoding="ascii") as stream:
                for child in map(int, stream.read().split()):
                    found += [child, *children(child)]
    return found


def resident(pids: List[int]) -> float:
    """Resident memory of some processes together, MB; what two share counts twice."""
    return _summed(pids, "status", "VmRSS:")


def proportional(pids: List[int]) -> float:
    """Memory of some processes together, MB; what processes share counts once in all (PSS)."""
    return _summed(pids, "smaps_rollup", "Pss:")


def _summed(pids: List[int], file: str, head: str) -> float:
    total = 0
    for pid in pids:
        with open(f"/proc/{pid}/{file}", encoding="ascii") as stream:
            total += next(int(line.split()[1]) for line in stream if line.startswith(head))
    return total * 1024 / 1e6


def processor(pids: List[int]) -> float:
    """Processor time some processes have had, s, with that of threads that have ended."""
    # The clock that clock_getcpuclockid(3) names; in ns, where /proc counts ticks of 10 ms.
    return sum(time.clock_gettime((~pid << 3) | 2) for pid in pids)
