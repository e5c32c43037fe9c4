"""The life of the server process: engine, world, node, end.

What costs time is done at once and side by side: the engine process starts before anything else is
imported, the world is read and loaded in a thread, and meanwhile rospy is imported and registered.
"""
from __future__ import annotations

import os
import signal
import threading
from typing import Any, Callable, List, Optional, Sequence

from ..engine.api import Engine
from ..errors import InputError, Issue
from . import master
from .options import ServerOptions
from .profile import StartProfile

NODE = "gazebo"
END_SECONDS = 3.0
"""Longest orderly end; a thread that is stuck in a network call does not keep the process."""

OK, FAILED = 0, 1

Say = Callable[[str], None]


class EngineSupply:
    """Makes engines for the simulator; the first is on its way before it is asked for."""

    def __init__(self, make: Callable[[], Engine]) -> None:
        self._make = make
        self._first: Optional[Engine] = make()
        self._current: Optional[Engine] = self._first
        self._hear: Callable[[int], None] = lambda pid: None

    def __call__(self) -> Engine:
        """The next engine; the simulator calls this again after a crash."""
        engine, self._first = self._first or self._make(), None
        self._current = engine
        self._hear(self.pid)
        return engine

    @property
    def pid(self) -> int:
        """Process id of the newest engine; 0 for one without a process."""
        return int(getattr(self._current, "pid", 0) or 0)

    def on_new(self, hear: Callable[[int], None]) -> None:
        """Tell `hear` the process id, now and for every engine to come."""
        self._hear = hear
        hear(self.pid)

    def close(self) -> None:
        """End an engine that nobody took."""
        if self._first is not None:
            self._first.close()


class IssueLog:
    """Keeps issues until there is a node to log them through."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: List[Issue] = []
        self._sink: Optional[Callable[[Issue], None]] = None

    def __call__(self, issue: Issue) -> None:
        with self._lock:
            sink = self._sink
            if sink is None:
                self._kept.append(issue)
        if sink is not None:
            sink(issue)

    def open(self, sink: Callable[[Issue], None]) -> None:
        """From now on, and for what was kept, use `sink`."""
        with self._lock:
            self._sink, kept, self._kept = sink, self._kept, []
        for issue in kept:
            sink(issue)


class WorldLoader:
    """Reads the world file and starts its simulator, paused, in a thread of its own.

    Attributes:
        simulator, resolver: set when it went well.
        fault: why it did not.
    """

    def __init__(self, world: str, engines: EngineSupply, log: IssueLog, profile: StartProfile,
                 on_fault: Callable[[], None]) -> None:
        self.simulator: Any = None
        self.resolver: Any = None
        self.fault: Optional[InputError] = None
        self.defect: Optional[Exception] = None
        self._given = (world, engines, log)
        self._profile = profile
        self._on_fault = on_fault
        self._thread = threading.Thread(target=self._run, name="world loader", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            self._load()
        except InputError as fault:
            self.fault = fault
            self._on_fault()
        except Exception as defect:  # raised again in the main thread, by `wait`
            self.defect = defect
            self._on_fault()

    def _load(self) -> None:
        world_file, engines, log = self._given
        from ..formats.load import read_world
        from ..resources.resolver import Resolver
        from ..simulator.simulator import Simulator

        self._profile.mark("readers imported")
        self.resolver = Resolver.from_environment()
        world, issues = read_world(world_file, self.resolver)
        for issue in issues:
            log(issue)
        self._profile.mark("world read")
        simulator = Simulator(world, engine_factory=engines, paused=True, log=log)
        simulator.start()
        self.simulator = simulator
        self._profile.mark("world loaded into the engine")

    def wait(self) -> None:
        """Wait for the end; a defect of the program is raised here."""
        self._thread.join()
        if self.defect is not None:
            raise self.defect


class Server:
    """Runs the node until a signal, a shutdown request or a fault ends it."""

    def __init__(self, options: ServerOptions, argv: Sequence[str], say: Say) -> None:
        """Args: the parsed options, the whole command line, and where words go before rospy."""
        self._options, self._argv, self._say = options, list(argv), say
        self._profile = StartProfile()
        self._ended = threading.Event()
        self._settled = threading.Event()
        self._log = IssueLog()
        self._name = master.node_name(argv, NODE)
        self._master = master.uri(argv)

    def run(self) -> int:
        """Exit status: 0 after a signal, 1 when the node could not start."""
        from ..engine.process import ProcessEngine

        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)
        self._profile.mark("command line read")
        engines = EngineSupply(ProcessEngine)
        self._profile.mark("engine process started")
        loader = WorldLoader(self._options.world, engines, self._log, self._profile,
                             self._settled.set)
        node: Any = None
        try:
            if not self._may_register(loader):
                return OK if self._ended.is_set() else FAILED
            self._init_node()
            loader.wait()
            if loader.fault is not None:
                return self._refuse(loader.fault)
            node = self._start_node(loader, engines)
            self._ended.wait()
            return OK
        finally:
            self._end(node, loader, engines)

    def _on_signal(self, _number: int, _frame: Any) -> None:
        if self._ended.is_set():
            os._exit(OK)
        self._ended.set()
        self._settled.set()

    def _may_register(self, loader: WorldLoader) -> bool:
        """True when there is a master without a node of our name; else everything was said."""
        try:
            there = master.wait(self._master, self._name, self._settled, self._say)
            if not there:
                self._say_why_not(loader)
                return False
            other = master.living_node(self._master, self._name)
        except OSError as fault:
            self._say(f"the ROS master at {self._master} stopped answering: {fault}")
            return False
        if other is not None:
            self._say(f"a node {self._name} already runs on {self._master} ({other[0]}, process "
                      f"{other[1]}); end it first, or give this one another name with "
                      "__name:=NAME or __ns:=NAMESPACE")
            return False
        self._profile.mark("master asked")
        return True

    def _say_why_not(self, loader: WorldLoader) -> None:
        if self._ended.is_set():
            return
        loader.wait()
        if loader.fault is not None:
            for issue in loader.fault.issues:
                self._say(str(issue))

    def _init_node(self) -> None:
        import rospy

        self._profile.mark("rospy imported")
        watcher = threading.Thread(target=self._break_off, daemon=True)
        watcher.start()
        level = rospy.DEBUG if self._options.verbose else rospy.INFO
        rospy.init_node(NODE, argv=self._argv, disable_rostime=True, disable_signals=True,
                        log_level=level)
        rospy.on_shutdown(self._ended.set)
        self._profile.mark("node registered")

    def _break_off(self) -> None:
        """Make `rospy.init_node` give up when the end comes while it waits for the master."""
        import rospy

        self._ended.wait()
        if not rospy.core.is_initialized():
            rospy.signal_shutdown("ended")

    def _start_node(self, loader: WorldLoader, engines: EngineSupply) -> Any:
        import rospy

        from .log import log_issue
        from .node import Node

        self._log.open(log_issue)
        for notice in self._options.notices:
            rospy.logwarn("%s", notice)
        node = Node(loader.simulator, loader.resolver)
        self._profile.mark("interface imported")
        node.advertise()
        self._profile.mark("services and topics registered")
        node.start_publishing()
        node.spawn_robot()
        if not self._options.paused:
            loader.simulator.unpause()
        self._profile.mark("running")
        engines.on_new(lambda pid: rospy.set_param("~my_simulations/engine_pid", pid))
        for line in self._profile.lines():
            self._say(line)
        return node

    def _refuse(self, fault: InputError) -> int:
        from .node import fail

        fail([str(issue) for issue in fault.issues] or [str(fault)])
        return FAILED

    def _end(self, node: Any, loader: WorldLoader, engines: EngineSupply) -> None:
        watchdog = threading.Timer(END_SECONDS, os._exit, (OK,))
        watchdog.daemon = True
        watchdog.start()
        self._ended.set()
        if node is not None:
            node.stop()
        if loader.simulator is not None:
            loader.simulator.close()
        engines.close()
        import rospy

        if rospy.core.is_initialized():
            rospy.signal_shutdown("the server ends")
        watchdog.cancel()
