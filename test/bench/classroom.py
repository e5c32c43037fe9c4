#!/usr/bin/env python3
"""Prints how many students of a class one processor and one GB of memory carry.

usage: classroom.py [STUDENTS]   (default 6)

Starts a class with the room of the lab and its robot. Each student's editor has one client, which
reads all frames, as a page does, and drives the robot with 10 commands a second. The figures are
those of all processes of a student's world with its relay, for one second of sim time; the class
itself and the clients are not in them. Memory is the proportional set size. Nothing here fails on a
slow machine.
"""
from __future__ import annotations

import asyncio
import contextlib
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time
from typing import Any, Dict, Iterator, List, NamedTuple

from server import children, end, processor, proportional, wait

CLASS = [sys.executable, str(pathlib.Path(__file__).resolve().parents[2] / "scripts" / "class")]
STUDENTS, SETTLE_S, MEASURE_S, PERIOD_S, START_S = 6, 5.0, 30.0, 0.1, 120.0
ROBOT = "robo"


@contextlib.contextmanager
def running_class(count: int) -> Iterator["tuple[subprocess.Popen[str], str, List[str]]"]:
    """A class of so many students: its process, its file, and the addresses of the editors."""
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)   # students may be other users
        file = os.path.join(folder, "class.yaml")
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(f"class: bench\nstudents: {count}\nidle_minutes: 0\n"
                         "launch: my_simulations lab_room.launch\nargs: {robot: true}\n")
        process = subprocess.Popen([*CLASS, "start", file], stdout=subprocess.PIPE, text=True)
        try:
            assert process.stdout is not None
            lines = [process.stdout.readline().strip() for _ in range(count + 1)]
            wait(lambda: all(one["time"] > 0.0 for one in states(file)), START_S * count,
                 "running class")
            yield process, file, [line.split(": ", 1)[1] for line in lines[1:]]
        finally:
            end(process)


def states(file: str) -> List[Dict[str, Any]]:
    """What `class status` knows of each student."""
    done = subprocess.run([*CLASS, "status", file, "--json"], capture_output=True, text=True,
                          check=True)
    return list(json.loads(done.stdout)["students"])


async def drive(address: str, seconds: float) -> None:
    """Read the frames of an editor, and drive the robot back and forth, off the walls."""
    import aiohttp

    url, _, query = address.partition("?")
    async with aiohttp.ClientSession() as session, session.ws_connect(
            f"{url}ws?{query}", max_msg_size=0) as socket:
        await socket.send_json({"type": "hello", "id": 1, "version": 1})
        reading = asyncio.ensure_future(read_all(socket))
        for number in range(int(seconds / PERIOD_S)):
            await socket.send_json({
                "type": "drive", "id": 2 + number, "model": ROBOT,
                "linear": [0.2 * math.cos(PERIOD_S * number), 0.0, 0.0],
                "angular": [0.0, 0.0, math.sin(PERIOD_S * number)]})
            await asyncio.sleep(PERIOD_S)
        reading.cancel()


async def read_all(socket: Any) -> None:
    """Read what arrives; raises RuntimeError for a refused command."""
    async for message in socket:
        if message.type == 1 and '"ok":false' in message.data.replace(" ", ""):
            raise RuntimeError(message.data)


async def drive_all(addresses: List[str], seconds: float) -> None:
    """Be the clients of all editors."""
    await asyncio.gather(*(drive(address, seconds) for address in addresses))


class Used(NamedTuple):
    """Of one student: processor s for a second of sim time, MB, and sim time by wall time."""

    share: float
    memory: float
    factor: float


def measure(process: "subprocess.Popen[str]", file: str, count: int) -> Used:
    """The mean of all students."""
    pids = children(process.pid)
    used, begun, sim = processor(pids), time.perf_counter(), sim_times(file)
    time.sleep(MEASURE_S)   # the thing measured, not a wait for something
    passed = [after - before for before, after in zip(sim, sim_times(file))]
    took = time.perf_counter() - begun
    used = processor(pids) - used
    return Used(used / max(1e-3, sum(passed)), proportional(pids) / count,
                min(passed) / took)


def sim_times(file: str) -> List[float]:
    """The sim time of each student's world, s."""
    return [float(one["time"]) for one in states(file)]


def main() -> None:
    """Measure and print."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else STUDENTS
    with running_class(count) as (process, file, addresses):
        client = subprocess.Popen([sys.executable, __file__, "--clients", *addresses])
        try:
            time.sleep(SETTLE_S)
            found = measure(process, file, count)
        finally:
            client.kill()
            client.wait()
    print(f"{count} students: {found.share:.3f} processors and {found.memory:.0f} MB each, "
          f"slowest real-time factor {found.factor:.2f}")
    print(f"students for one processor: {1.0 / found.share:.1f}; for one GB: "
          f"{1000.0 / found.memory:.1f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--clients"]:
        asyncio.run(drive_all(sys.argv[2:], SETTLE_S + 2.0 * MEASURE_S))
    else:
        main()
