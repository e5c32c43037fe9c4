"""Recording a state log from the start of a world, without pages and browsers."""
from __future__ import annotations

import contextlib
import itertools
import os
import threading
import time
from typing import Callable, Optional, Sequence

from ...errors import CommandError, Issue, error
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ..scene.scene_changes import Mirror
from ..scene.scene_json import Documents
from ..topic_source import TopicSource
from ..transport.pose_reader import PoseReader
from .log_channels import log_channels_of
from .state_log import FILE, LogWriter, new_name

_DEFAULT_HZ = 60.0
_MOST_HZ = 1000.0
_FLUSH_S = 1.0
_DOCUMENT_SHARE = 0.1
_STOP_S = 2.0
_DEMAND = "recording"


def path_of(folder: str, logs: str) -> str:
    """The file for a new log, which is not there yet.

    Args:
        folder: where it was asked for; "" for one of its own, named after date and time, in `logs`.
        logs: the folder of all logs.

    Returns:
        `FOLDER/state.log` as Gazebo has it; below a folder named after date and time when there is
        a log in `folder` already.
    """
    if folder:
        wanted = os.path.join(os.path.abspath(os.path.expanduser(folder)), FILE)
        if not os.path.lexists(wanted):
            return wanted
        logs = os.path.dirname(wanted)
    name = new_name()
    names = itertools.chain([name], (f"{name}-{n}" for n in itertools.count(2)))
    return next(path for path in (os.path.join(logs, one, FILE) for one in names)
                if not os.path.lexists(os.path.dirname(path)))


class Recorder:
    """Writes a log from a thread of its own; its first state is there when this is made.

    Args:
        simulator, resolver: the world.
        path: the file, which must not be there.
        period: least sim time between states, s; 0 or less for 60 states in a second of wall time.
        report: called if the log ends before the world.
        source: the ROS topics; None if there are none.
        topics: names of topics whose messages are recorded.

    Raises:
        CommandError: it cannot be written.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, path: str, period: float,
                 report: Callable[[Issue], None], source: Optional[TopicSource] = None,
                 topics: Sequence[str] = ()) -> None:
        self.path = path
        self._simulator = simulator
        self._period = max(0.0, period)
        self._report = report
        self._mirror = Mirror(simulator, Documents(resolver))
        self._reader = PoseReader(simulator)
        self._channels = log_channels_of(simulator, source, topics)
        self._revision = self._sequence = -1
        self._turn = -1
        self._described = float("-inf")
        self._pause = 0.0
        self._flushed = time.monotonic()
        self._ended = threading.Event()
        self._hz = min(max(_DEFAULT_HZ, 1.0 / self._period if self._period else 0.0), _MOST_HZ)
        self._writer: Optional[LogWriter] = self._begin(path)
        simulator.feed.request(_DEMAND, poses_hz=self._hz)
        self._thread = threading.Thread(target=self._run, name="state log", daemon=True)
        self._thread.start()

    def _begin(self, path: str) -> LogWriter:
        writer = LogWriter(path)
        try:
            self._write_state(writer)
            writer.flush()
        except CommandError:
            with contextlib.suppress(CommandError):  # that is what is raised
                writer.close()
            raise
        return writer

    def stop(self) -> None:
        """Finish the log. Raises CommandError when not all of it could be written."""
        self._ended.set()
        self._thread.join(_STOP_S)
        writer, self._writer = self._writer, None
        if writer is None or self._thread.is_alive():
            return
        # The last state is written whether or not its time has come, or anything has moved.
        self._turn = self._sequence = -1
        try:
            self._write_state(writer)
        finally:
            writer.close()
            for channel in self._channels:
                channel.close()

    def _run(self) -> None:
        writer = self._writer
        while writer is not None and not self._ended.wait(1.0 / self._hz):
            try:
                self._write_state(writer)
                self._flush(writer)
            except CommandError as fault:
                self._fail(writer, str(fault))
                return
            except Exception as defect:  # the world must not lose more than its log
                self._fail(writer, f"{type(defect).__name__}: {defect}")
                return

    def _write_state(self, writer: LogWriter) -> None:
        """Write what has changed. Raises CommandError."""
        if self._simulator.models.revision != self._revision and not self._describe(writer):
            return
        turn = int(self._now() / self._period + 1e-6) if self._period else -1
        sequence = self._simulator.feed.changes
        if sequence == self._sequence or (self._period and turn == self._turn):
            return
        poses = self._reader.read(self._revision, 0.0)
        if poses is not None:
            self._sequence, self._turn = sequence, turn
            writer.poses(poses)
            for channel in self._channels:
                channel.write(writer, poses.sim_time)

    def _describe(self, writer: LogWriter) -> bool:
        """Write the world's description, unless the last one was but now and took long."""
        started = time.monotonic()
        if started < self._described + self._pause and not self._ended.is_set():
            return False
        try:
            message = self._mirror.world_push()
        except CommandError:  # the engine is being started again
            return False
        writer.document(self._now(), message["document"])
        self._revision, self._sequence, self._turn = message["revision"], -1, -1
        self._described = time.monotonic()
        self._pause = (self._described - started) / _DOCUMENT_SHARE
        return True

    def _flush(self, writer: LogWriter) -> None:
        if time.monotonic() > self._flushed + _FLUSH_S:
            writer.flush()
            self._flushed = time.monotonic()

    def _fail(self, writer: LogWriter, reason: str) -> None:
        self._writer = None
        self._simulator.feed.request(_DEMAND)
        with contextlib.suppress(CommandError):  # this fault is reported below
            writer.close()
        self._report(error("log", f"the state log ends here, the world goes on: {reason}"))

    def _now(self) -> float:
        return self._simulator.clock.sim_ns * 1e-9
