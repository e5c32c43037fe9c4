"""Life cycle of the server process: engine, world, node, shutdown.

Slow phases run in parallel: the engine process starts before anything else is imported, a thread
reads and loads the world, and meanwhile rospy is imported and registered.
"""
from __future__ import annotations

import gc
import logging
import os
import signal
import sys
import threading
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence

from ...errors import CommandError, InputError, error
from ...simulator.issue_log import IssueLog
from . import master_api, old_python
from .abandoned import Abandonment
from .engine_supply import EngineSupply
from .launch_info import Launch
from .light_imports import import_genpy
from .server_options import ServerOptions
from .start_profile import StartProfile

if TYPE_CHECKING:
    from .editor_launcher import AwaitWorld, EditorLauncher, StartEditor
    from .log_recorder import RunningRecorder, StartRecording

NODE = "gazebo"
END_SECONDS = 10.0
"""Wall seconds after which a shutdown that hangs in a network call is forced. A busy machine takes
seconds to end all that was started; roslaunch waits for 15 s before it asks again."""

UPKEEP_SECONDS = 1.0
EARLY_SECONDS = 1.0
"""Wall seconds after which the editor's page is served before the world is there."""

POLL_SECONDS = 0.05
"""Wall seconds after which a signal interrupts the wait for the world."""

FALLBACK = "worlds/empty.world"
"""The world that replaces one whose file does not exist, as in Gazebo 11."""

CLOCK_QUEUE = 1000
"""Queue length of `/clock`: one second at 1000 Hz."""

OK, FAILED = 0, 1

Say = Callable[[str], None]
MakeNode = Callable[..., Any]
"""Creates the `ros.node.Node` with its arguments; imports it, which takes start-up time."""


class WorldLoader:
    """Reads the world file and starts its simulator, paused, in a thread of its own.

    Attributes:
        simulator, resolver: set on success.
        fault: the error of the user's input, else None.
        defect: an internal error, else None.
    """

    def __init__(self, options: ServerOptions, engines: EngineSupply, log: IssueLog,
                 profile: StartProfile, on_fault: Callable[[], None], caller: str) -> None:
        self.simulator: Any = None
        self.resolver: Any = None
        self.fault: Optional[InputError] = None
        self.defect: Optional[Exception] = None
        self._given = (options, engines, log, caller)
        self._profile = profile
        self._on_fault = on_fault
        self._under_way = ("", "", 0, 0)
        self._tell: Callable[[str, str, int, int], None] = lambda *_news: None
        self._thread = threading.Thread(target=self._run, name="world loader", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            self._load()
        except InputError as fault:
            self.fault = fault
            self._on_fault()
        except CommandError as fault:
            self.fault = InputError([error("world-not-started", str(fault))])
            self._on_fault()
        except Exception as defect:  # raised again in the main thread, by `wait`
            self.defect = defect
            self._on_fault()

    def _load(self) -> None:
        options, engines, log, caller = self._given
        from ...engine.commands import FOREVER
        from ...resources.database.download_notes import DownloadNotes
        from ...resources.resolver import Resolver
        from ...simulator.world_loading import start_world

        self._profile.mark("readers imported")
        self.resolver = Resolver.from_environment(DownloadNotes(log))

        def start(world: str) -> Any:
            return start_world(
                world, self.resolver, engines, log, seed=options.seed or 0,
                profile=options.profile, steps=options.iterations or FOREVER, caller=caller,
                read=lambda: self._profile.mark("world read"), progress=self._progress)

        try:
            self.simulator = start(options.world)
        except InputError as fault:
            if not all(issue.code == "world-not-found" for issue in fault.issues):
                raise
            for issue in fault.issues:
                log(replace(issue, message=f"{issue.message}; {FALLBACK} is loaded instead"))
            self.simulator = start(FALLBACK)
        self._profile.mark("world loaded into the engine")

    @property
    def busy(self) -> bool:
        """Whether the world is still being loaded."""
        return self._thread.is_alive()

    def _progress(self, title: str, text: str, done: int, of: int) -> None:
        self._under_way = (title, text, done, of)
        self._tell(title, text, done, of)

    def set_progress_listener(self, listener: Callable[[str, str, int, int], None]) -> None:
        """Set the listener of progress: a title, a text, the work done, and all work."""
        self._tell = listener
        listener(*self._under_way)

    def wait(self, stop: threading.Event, slow: Callable[[], None] = lambda: None) -> None:
        """Wait until it is done or `stop` is set; raises an internal error.

        `slow` is called once when that takes longer than `EARLY_SECONDS`.
        """
        until = time.monotonic() + EARLY_SECONDS
        told = False
        while self.busy and not stop.is_set():
            self._thread.join(POLL_SECONDS)
            if not told and time.monotonic() > until:
                told = True
                slow()
        if self.defect is not None:
            raise self.defect


class Server:
    """Runs the node until a signal, a shutdown request or an error."""

    def __init__(self, options: ServerOptions, argv: Sequence[str], say: Say,
                 engines: EngineSupply, profile: StartProfile, make_node: MakeNode,
                 start_editor: "Optional[StartEditor]" = None, gui: bool = False,
                 start_recording: "Optional[StartRecording]" = None,
                 await_world: "Optional[AwaitWorld]" = None) -> None:
        """Continue a start whose engine process is already starting.

        Args:
            options: the parsed command line.
            argv: the whole command line, for rospy.
            say: prints a line while rospy cannot log yet.
            engines: supplies the engine.
            profile: records the phases of the start.
            make_node: creates the node, once rospy is initialised and the world is loaded.
            start_editor: starts the world editor; None for no editor.
            gui: start the editor with the node, whatever the parameter `~gui` says.
            start_recording: starts the state log of the options.
            await_world: serves the editor's page while the world is being loaded.
        """
        self._await_world = await_world
        self._start_recording = start_recording
        self._recorder: "Optional[RunningRecorder]" = None
        self._start_editor, self._gui = start_editor, gui
        self._editor_launcher: "Optional[EditorLauncher]" = None
        self._options, self._argv, self._say = options, list(argv), say
        self._engines, self._profile = engines, profile
        self._make_node = make_node
        self._launch = Launch.of(argv)
        self._ended = threading.Event()
        self._settled = threading.Event()
        self._clock: Any = None
        self._log = IssueLog()
        self._name = master_api.node_name(argv, NODE)
        self._master = master_api.master_uri(argv)

    def run(self) -> int:
        """Exit status: 0 after a signal, 1 when the node could not start."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)
        gc.disable()  # what imports make stays: to look for garbage takes 5 % of a start
        import_genpy()
        old_python.prepare_threads()
        self._profile.mark("messages imported")
        loader = WorldLoader(self._options, self._engines, self._log, self._profile,
                             self._settled.set, self._launch.folder)
        node: Any = None
        try:
            if not self._may_register(loader):
                return OK if self._ended.is_set() else FAILED
            self._init_node()
            # Opened early: loading a world may take long and logs its progress.
            self._start_logging()
            launcher = self._make_editor_launcher()
            loader.wait(self._ended, lambda: self._open_page_early(launcher, loader))
            if self._ended.is_set():
                return OK
            if loader.fault is not None:
                return self._refuse(loader.fault)
            node = self._start_node(loader, launcher)
            abandonment = Abandonment(self._master, self._name, self._launch, node.master_timeout())
            while not self._ended.wait(UPKEEP_SECONDS):
                node.refresh()
                reason = abandonment.reason()
                if reason:
                    self._say(f"{reason}; shutting down (parameter ~master_timeout, 0 to disable)")
                    return FAILED
            return OK
        except OSError as fault:
            if not self._ended.is_set():
                self._say(f"the ROS master at {self._master} stopped responding: {fault}")
            return OK if self._ended.is_set() else FAILED
        finally:
            self._end(node, loader)

    def _on_signal(self, _number: int, _frame: Any) -> None:
        if self._ended.is_set():
            os._exit(OK)
        self._ended.set()
        self._settled.set()

    def _may_register(self, loader: WorldLoader) -> bool:
        """Whether a master without a running node of our name exists; prints why not."""
        try:
            there = master_api.wait_for_master(self._master, self._name, self._settled, self._say)
            if not there:
                self._report_world_errors(loader)
                return False
            other = master_api.running_node(self._master, self._name)
        except OSError as fault:
            self._say(f"the ROS master at {self._master} stopped responding: {fault}")
            return False
        if other is not None:
            self._say(f"a node {self._name} is already running on {self._master} ({other[0]}, "
                      f"process {other[1]}); stop it, or rename this node with "
                      "__name:=NAME or __ns:=NAMESPACE")
            return False
        self._profile.mark("master asked")
        return True

    def _report_world_errors(self, loader: WorldLoader) -> None:
        loader.wait(self._ended)
        if self._ended.is_set():
            return
        if loader.fault is not None:
            for issue in loader.fault.issues:
                self._say(str(issue))

    def _init_node(self) -> None:
        import rospy

        from ..prompt_end import end_promptly
        from ..registration import advertise_topic
        from .debug_filter import RospyDebugFilter

        self._profile.mark("rospy imported")
        logging.getLogger("rosout").addFilter(RospyDebugFilter())
        threading.Thread(target=self._break_off, daemon=True).start()
        imports = threading.Thread(target=_import_interface, daemon=True)
        imports.start()
        level = rospy.DEBUG if self._options.verbose else rospy.INFO
        try:
            rospy.init_node(NODE, argv=self._argv, disable_rostime=True, disable_signals=True,
                            log_level=level)
        except rospy.ROSInitException as fault:
            raise OSError(str(fault)) from fault
        end_promptly()
        rospy.on_shutdown(self._ended.set)
        # Advertised early: subscribers need time to connect.
        self._clock = advertise_topic("/clock", queue_size=CLOCK_QUEUE, tcp_nodelay=True)
        self._profile.mark("node registered")
        imports.join()
        gc.enable()
        self._profile.mark("interface imported")

    def _break_off(self) -> None:
        """Make `rospy.init_node` return when a shutdown comes while it waits for the master."""
        import rospy

        self._ended.wait()
        if not rospy.core.is_initialized():
            rospy.signal_shutdown("shutdown requested")

    def _start_logging(self) -> None:
        """Log the notices on the options and all issues so far; later issues at once."""
        import rospy

        from ..issue_logging import log_issue

        for notice in self._options.notices:
            rospy.loginfo("%s", notice)
        self._log.open(log_issue)

    def _open_page_early(self, launcher: "Optional[EditorLauncher]", loader: WorldLoader) -> None:
        """A world that takes long to load has an address and a page already."""
        if launcher is None or self._await_world is None:
            return
        if self._gui or launcher.wanted():
            page = launcher.open_early(self._await_world)
            if page is not None:
                loader.set_progress_listener(page.show)

    def _start_node(self, loader: WorldLoader, launcher: "Optional[EditorLauncher]") -> Any:
        import rospy

        rospy.loginfo("the world file is %s", loader.simulator.world.file)
        if launcher is not None:
            launcher.world = (loader.simulator, loader.resolver)
        node = self._make_node(
            loader.simulator, loader.resolver, self._clock,
            None if launcher is None else launcher.open, self._master,
            (lambda: None) if launcher is None else launcher.announce, self._launch)
        if launcher is not None:
            launcher.topics, launcher.plugins = node.topic_graph, node.plugin_states
        node.advertise()
        self._profile.mark("services and topics registered")
        node.start_publishing()
        node.spawn_robot()
        self._record(loader, node)
        if not self._options.paused:
            loader.simulator.clock.unpause()
        self._profile.mark("running")
        node.advertise_late()
        # Objects of the start live as long as the node; full collections need not visit them.
        gc.freeze()
        if launcher is not None and (self._gui or launcher.wanted()):
            launcher.open_in_background()
        self._profile.mark("all offered")
        for line in self._profile.lines():
            self._say(line)
        return node

    def _record(self, loader: WorldLoader, node: Any) -> None:
        """Start the state log; the clock is published by now, and the world is still paused."""
        wanted = self._options.recording
        if self._start_recording is None or not wanted.on:
            return
        from .log_recorder import start_log

        self._recorder = start_log(self._start_recording, loader.simulator, loader.resolver, wanted,
                                   node.topic_graph() if wanted.topics else None)
        self._profile.mark("state log begun")

    def _make_editor_launcher(self) -> "Optional[EditorLauncher]":
        if self._start_editor is None:
            return None
        from .editor_launcher import EditorLauncher

        self._editor_launcher = EditorLauncher(self._start_editor, self._log.add_receiver,
                                               self._launch.folder)
        return self._editor_launcher

    def _refuse(self, fault: InputError) -> int:
        from ..issue_logging import log_fatal

        log_fatal([str(issue) for issue in fault.issues] or [str(fault)],
                  master_api.other_subscribers(self._master, self._name, "/rosout"))
        return FAILED

    def _end(self, node: Any, loader: WorldLoader) -> None:
        status = OK if self._ended.is_set() else FAILED
        watchdog = threading.Timer(END_SECONDS, os._exit, (status,))
        watchdog.daemon = True
        watchdog.start()
        self._ended.set()
        if self._editor_launcher is not None:
            self._editor_launcher.close()
        if node is not None:
            node.stop()
        if self._recorder is not None:
            from .log_recorder import close_log

            close_log(self._recorder)
        if loader.simulator is not None:
            loader.simulator.close()
        self._engines.close()
        rospy = sys.modules.get("rospy")
        if rospy is not None and rospy.core.is_initialized():
            rospy.signal_shutdown("the server is shutting down")
        if loader.busy:  # not waited for; its child processes end with this one
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
        watchdog.cancel()


def _import_interface() -> None:
    """Import services and topics while `rospy.init_node` waits for its registration."""
    from ..topics import state_publishers  # noqa: F401
