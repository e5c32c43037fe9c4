"""Runs the worlds of a class and the tutor's page."""
from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import socket
import time
from typing import Any, Callable, Dict, List, Optional

from ..errors import CommandError
from .class_plan import ClassPlan, Student
from .class_state import TUTOR, ClassState
from .container_world import ContainerWorld
from .local_world import LocalWorld
from .monitor import Monitor
from .tutor_page import TutorPage
from .world_states import ENDED, RUNNING, STARTING, STOPPED, World

_LOOK_S = 1.0
_STARTING_S = 90.0       # until the next world may start although this one has not
_AGAIN_S = 5.0           # between two starts of a world that ends
IDLE = "no browser was connected"


class MonitoredWorld:
    """A student's world with its monitor."""

    def __init__(self, world: World, monitor: Monitor) -> None:
        self.world = world
        self.monitor = monitor
        self.task: "Optional[asyncio.Task[None]]" = None
        self.waits = False       # for a browser, which starts the world
        self.started = float("-inf")


class ClassManager:
    """A class that runs; everything but `start` of a world happens in one event loop.

    Args:
        plan: the class.
        version: of the editor's protocol.
        tell: receives lines for the terminal.

    Raises:
        CommandError: the class runs already, or a port is in use.
    """

    def __init__(self, plan: ClassPlan, version: int, tell: Callable[[str], None]) -> None:
        self._plan, self._tell = plan, tell
        self._state = ClassState(plan)
        self._state.acquire_lock()
        tokens = self._state.tokens(plan)
        self._worlds = {student.name: MonitoredWorld(
            _world(plan, student, tokens[student.name]), Monitor(version))
            for student in plan.students}
        self._page = TutorPage(plan, tokens[TUTOR], self)
        self._ended: Optional[asyncio.Event] = None

    def run(self) -> None:
        """Run until SIGINT or SIGTERM; all worlds end then."""
        asyncio.run(self._run())

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        self._ended = asyncio.Event()
        for number in (signal.SIGINT, signal.SIGTERM):
            loop.add_signal_handler(number, self._ended.set)
        address = await self._page.start()
        self._state.store_address(address)
        self._tell(f"tutor: {address}")
        for monitored in self._worlds.values():
            self._tell(f"{monitored.world.student.name}: {self.link(monitored.world.student)}")
        starting = asyncio.ensure_future(self._start_all())
        try:
            while not self._ended.is_set():
                self._poll()
                with contextlib.suppress(asyncio.TimeoutError):
                    await asyncio.wait_for(self._ended.wait(), _LOOK_S)
        finally:
            starting.cancel()
            for monitored in self._worlds.values():
                self._unwait(monitored)
            await asyncio.gather(*(self._stop(monitored, "the class ended")
                                   for monitored in self._worlds.values()))
            await self._page.close()
            for monitored in self._worlds.values():
                if monitored.world.listening is not None:
                    monitored.world.listening.close()

    def link(self, student: Student) -> str:
        """Address of a student's editor, with its token."""
        token = self._worlds[student.name].world.token
        return f"http://{_shown_host(self._plan.host)}:{student.port}/?token={token}"

    # -- worlds ----------------------------------------------------------------------------------

    async def _start_all(self) -> None:
        """Start the worlds one after the other: each uses a whole processor until it runs."""
        for monitored in self._worlds.values():
            if monitored.world.state == STOPPED and not monitored.world.reason:
                self._start(monitored)
            until = time.monotonic() + _STARTING_S
            while monitored.world.state == STARTING and time.monotonic() < until:
                await asyncio.sleep(_LOOK_S / 4)

    def _start(self, monitored: MonitoredWorld) -> None:
        self._unwait(monitored)
        monitored.started = time.monotonic()
        monitored.monitor.error = ""
        monitored.world.start()
        monitored.task = asyncio.ensure_future(monitored.monitor.follow(monitored.world.monitor,
                                                                monitored.world.token))

    async def _stop(self, monitored: MonitoredWorld, reason: str) -> None:
        await asyncio.get_running_loop().run_in_executor(None, monitored.world.stop, reason)
        if monitored.task is not None:
            monitored.task.cancel()
            monitored.task = None

    def _poll(self) -> None:
        idle_s = 60.0 * self._plan.idle_minutes
        for monitored in self._worlds.values():
            world = monitored.world
            world.poll()
            if world.state == STARTING and monitored.monitor.is_connected:
                world.state, world.active = RUNNING, time.monotonic()
            if monitored.monitor.people:
                world.active = time.monotonic()
            if world.is_alive and idle_s and time.monotonic() > world.active + idle_s:
                asyncio.ensure_future(self._sleep(monitored))
            if world.state == ENDED or (world.state == STOPPED and world.reason == IDLE):
                if monitored.task is not None:
                    monitored.task.cancel()
                    monitored.task = None
                self._wait(monitored)

    async def _sleep(self, monitored: MonitoredWorld) -> None:
        await self._stop(monitored, IDLE)

    def _wait(self, monitored: MonitoredWorld) -> None:
        """Start the world again when a browser connects; the relay answers it then."""
        listening = monitored.world.listening
        if (listening is not None and not monitored.waits
                and time.monotonic() > monitored.started + _AGAIN_S):
            monitored.waits = True
            asyncio.get_running_loop().add_reader(listening.fileno(), self._start, monitored)

    def _unwait(self, monitored: MonitoredWorld) -> None:
        if monitored.waits and monitored.world.listening is not None:
            monitored.waits = False
            asyncio.get_running_loop().remove_reader(monitored.world.listening.fileno())

    # -- requests of the tutor's page ------------------------------------------------------------

    def tiles(self) -> List[Dict[str, Any]]:
        """What the page shows of each student."""
        return [_tile(monitored, self.link(monitored.world.student))
                for monitored in self._worlds.values()]

    def picture(self, name: str) -> str:
        """A picture of the world of a student, SVG. Raises CommandError: no such student."""
        return self._find_world(name).monitor.picture.svg()

    async def start_world(self, name: str) -> None:
        """Start the world of a student if it does not run. Raises CommandError: no such student."""
        monitored = self._find_world(name)
        if not monitored.world.is_alive:
            self._start(monitored)

    async def stop_world(self, name: str) -> None:
        """Stop the world of a student. Raises CommandError: no such student."""
        monitored = self._find_world(name)
        self._unwait(monitored)
        await self._stop(monitored, "stopped by the tutor")

    def _find_world(self, name: str) -> MonitoredWorld:
        monitored = self._worlds.get(name)
        if monitored is None:
            raise CommandError(f"there is no student {name!r}")
        return monitored


def _tile(monitored: MonitoredWorld, link: str) -> Dict[str, Any]:
    world, monitor = monitored.world, monitored.monitor
    return {"name": world.student.name, "state": world.state, "reason": world.reason,
            "world": monitor.world, "models": monitor.models, "factor": monitor.factor,
            "time": monitor.time, "paused": monitor.is_paused, "error": monitor.error,
            "people": monitor.people, "memory_mb": world.memory_mb,
            "processor_s": world.processor_s, "link": link}


def _world(plan: ClassPlan, student: Student, token: str) -> World:
    if plan.containers:
        return ContainerWorld(plan, student, token)
    return LocalWorld(plan, student, token, _listen(plan.host, student.port))


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        made = socket.create_server((host, port), family=family)
    except OSError as fault:
        raise CommandError(f"port {port} of {host} cannot be used: {os.strerror(fault.errno or 0)}"
                           ) from None
    made.setblocking(False)
    return made


def _shown_host(host: str) -> str:
    if host in ("0.0.0.0", "::"):
        return socket.gethostname()
    return f"[{host}]" if ":" in host else host
