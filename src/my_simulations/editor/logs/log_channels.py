"""The records of a state log besides states: contacts, and messages of chosen topics."""
from __future__ import annotations

import contextlib
import json
import math
import threading
import time as wall
from typing import Any, Callable, Dict, List, Optional, Protocol, Sequence, Tuple

from ...errors import EngineLostError, SimulationError
from ...simulator.simulator import Simulator
from ..topic_source import ListedTopic, Subscription, TopicSource
from ..topics.message_views import Viewer
from ..topics.topic_frame import document_of, encode_frame
from .state_log import CONTACTS, MESSAGE, TOPICS, LogWriter

CONTACTS_HZ = 30.0
"""Most readings of contacts for each second of sim time."""

MESSAGES_HZ = 15.0
"""Most messages of a topic for each second of sim time."""

_SEARCH_S = 0.5   # wall time between two searches for topics that do not exist yet
_DECIMALS = 4     # of positions and depths, m, and of normals


class LogChannel(Protocol):
    """Writes additional records to a log, after each state."""

    def write(self, writer: LogWriter, time: float) -> None:
        """Add what is new; s of sim time. Raises CommandError: the log cannot be written."""

    def close(self) -> None:
        """Stop."""


class ContactChannel:
    """Adds the contacts of a world."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._next = float("-inf")

    def write(self, writer: LogWriter, time: float) -> None:
        """Add the contacts if they are due and have changed; s of sim time."""
        if time >= self._next - 1e-9 or time < self._next - 1.0:   # the latter: time was reset
            self._next = time + 1.0 / CONTACTS_HZ
            try:
                found = self._simulator.states.contacts()
            except EngineLostError:
                return   # it starts again, without contacts
            rows = [{"a": a, "b": b, "position": _round_values(one.position),
                     "normal": _round_values(one.normal), "depth": round(one.depth, _DECIMALS),
                     "force": float(f"{one.force:.3g}")} for a, b, one in found]
            writer.add_record(CONTACTS, time, json.dumps(rows, separators=(",", ":")).encode())

    def close(self) -> None:
        """Nothing is open."""


class TopicChannel:
    """Adds messages of topics, as pages show them.

    Args:
        source: the topics.
        names: names of topics, with a leading slash; they need not exist yet.
        now: sim time, s.
        most_bytes: of all messages; those that follow are left out.
    """

    def __init__(self, source: TopicSource, names: Sequence[str],
                 now: Callable[[], float], most_bytes: float = math.inf) -> None:
        self._source = source
        self._now = now
        self._left_bytes = most_bytes
        self._missing: List[str] = list(dict.fromkeys(names))
        self._recorded: Dict[str, "_RecordedTopic"] = {}
        self._listed: List[Dict[str, Any]] = []
        self._searched = float("-inf")

    def write(self, writer: LogWriter, time: float) -> None:
        """Add the newest message of each topic that is due; s of sim time."""
        self._search()
        writer.add_record(TOPICS, time, json.dumps(self._listed, separators=(",", ":")).encode())
        for topic in self._recorded.values():
            frame = topic.frame(time)
            self._left_bytes -= len(frame)
            if frame and self._left_bytes >= 0:
                writer.add_record(MESSAGE, time, frame)

    def close(self) -> None:
        for topic in self._recorded.values():
            topic.subscription.close()

    def _search(self) -> None:
        """Subscribe to topics that have come to exist."""
        if not self._missing or wall.monotonic() < self._searched + _SEARCH_S:
            return
        self._searched = wall.monotonic()
        with contextlib.suppress(OSError):   # the master does not respond: searched again
            listed = {one.name: one for one in self._source.topics()}
            for name in list(self._missing):
                one = listed.get(name)
                if one is not None and one.kind not in ("", "*"):
                    self._recorded[name] = _RecordedTopic(self._source, one, self._now)
                    self._listed.append(document_of(one))
                    self._missing.remove(name)


class _RecordedTopic:
    def __init__(self, source: TopicSource, topic: ListedTopic, now: Callable[[], float]) -> None:
        self._name = topic.name
        self._viewer = Viewer(topic.kind, now)
        self._lock = threading.Lock()
        self._is_new = False
        self._next = float("-inf")
        self.subscription: Subscription = source.receive(topic.name, topic.kind, self._receive)

    def _receive(self, message: Any) -> None:
        with self._lock:
            self._viewer.receive(message)
            self._is_new = True

    def frame(self, time: float) -> bytes:
        """The frame of the newest message; b"" if there is none or it is not due."""
        with self._lock:
            if not self._is_new or self._next - 1.0 < time < self._next - 1e-9:
                return b""
            self._is_new = False
            self._next = time + 1.0 / MESSAGES_HZ
            try:
                frame, stamp, (fields, payload) = self._viewer.view()
            except SimulationError:
                return b""   # pages cannot show such messages
        return encode_frame({"topic": self._name, "frame": frame, "stamp": stamp, "view": fields},
                        payload)


def log_channels_of(simulator: Simulator, source: Optional[TopicSource],
             names: Sequence[str]) -> Tuple[LogChannel, ...]:
    """The channels of a log: contacts, and topics if there is a source of them."""
    contacts = ContactChannel(simulator)
    if source is None or not names:
        return (contacts,)
    return (contacts, TopicChannel(source, names, lambda: simulator.clock.sim_ns * 1e-9))


def _round_values(values: Sequence[float]) -> List[float]:
    return [round(float(value), _DECIMALS) for value in values]
