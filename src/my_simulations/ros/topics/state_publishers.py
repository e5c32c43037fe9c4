"""`/clock`, `model_states` and `link_states`, published from the ring by one thread.

Everything here is paced by the wall clock and by the engine's steps: waiting on ROS time would be
waiting on what this thread publishes.
"""
from __future__ import annotations

import threading
import time
from typing import Any, Callable, List, Optional, Tuple

import rospy
from gazebo_msgs.msg import LinkStates, ModelStates
from rosgraph_msgs.msg import Clock

from ...simulator.row_layout import Layout, Place
from ...simulator.simulator import Simulator
from ..registration import publisher
from .publish_pacing import StateGate, StepSelector, TokenBucket
from .state_buffers import StatesBuffer, packed_time
from .subscriber_events import SubscriberEvents
from .worker_thread import WorkerThread

LOOK_SECONDS = 0.001
"""Between two looks at a world that makes many steps in that time."""

FEW_STEPS = 2
"""As many as a world in real time makes between two looks, one of them a little late."""

PAUSED_LOOK_SECONDS = 0.05
"""Between two looks at a world that does not step."""

STATES_QUEUE = 50

PASSED_BY = 12
"""Steps and snapshots that a late look goes back; the ring holds four snapshots more."""

STATES_PER_SECOND = 1000.0
"""State messages a wall second up to which a late look goes back at all."""


class _PackedClock(Clock):
    """A Clock that is already bytes."""

    __slots__ = ["packed"]

    def serialize(self, buff: Any) -> None:
        buff.write(self.packed)


class _PackedModelStates(ModelStates):
    """A ModelStates that is already bytes."""

    __slots__ = ["packed"]

    def serialize(self, buff: Any) -> None:
        buff.write(self.packed)


class _PackedLinkStates(LinkStates):
    """A LinkStates that is already bytes."""

    __slots__ = ["packed"]

    def serialize(self, buff: Any) -> None:
        buff.write(self.packed)


class Channel:
    """One state topic: its publisher, whether a message is owed, and when one is due."""

    def __init__(self, topic: str, packed_class: Any,
                 entities: Callable[[Layout], Tuple[List[str], List[Place]]], rate: float,
                 wake: threading.Event) -> None:
        self._entities = entities
        self._gate = StateGate(rate)
        self._buffer = StatesBuffer()
        self._message = packed_class()
        self._owed = threading.Event()
        self._wake = wake
        self.publisher = publisher(topic, queue_size=STATES_QUEUE, tcp_nodelay=True,
                                   subscriber_listener=SubscriberEvents(self._hear))

    def _hear(self) -> None:
        self._owed.set()
        self._wake.set()

    @property
    def wanted(self) -> bool:
        """True while anybody listens."""
        return self.publisher.get_num_connections() > 0

    def is_due(self, step: int, sim_ns: int,
               standing: Callable[[], Optional[Tuple[int, int]]]) -> bool:
        """True when a message shall go out now; see `StateGate.due`."""
        owed = self._owed.is_set()
        self._owed.clear()
        return self._gate.due(step, sim_ns, owed, standing)

    def send(self, layout: Layout, sequence: int, links: bytes) -> None:
        """Publish what `StateFeed.states` gave."""
        names, places = self._entities(layout)
        self._message.packed = self._buffer.pack(layout.revision, sequence, names, places, links)
        self.publisher.publish(self._message)
        self._gate.sent((layout.revision, sequence))


class Publishers(WorkerThread):
    """The thread behind the three topics."""

    def __init__(self, simulator: Simulator, clock: rospy.Publisher, *, clock_hz: float = 0.0,
                 states_hz: float = 0.0, states: bool = True) -> None:
        """Advertise the state topics.

        Args:
            simulator: what to publish; started later than this.
            clock: the advertised `/clock`.
            clock_hz: at most this many `/clock` a second of sim time; 0 for one a step.
            states_hz: likewise for the state topics.
            states: False leaves the state topics out.
        """
        super().__init__("publishers")
        self._simulator = simulator
        self._clock_period_ns = round(1e9 / clock_hz) if clock_hz > 0.0 else 0
        self._states_hz = states_hz
        self._demand = (-1.0, False)
        self._spare = TokenBucket(STATES_PER_SECOND, STATES_QUEUE, time.monotonic())
        self._sent = (-1, 0, 0)  # revision, sequence and step of the newest states that went out
        self._clock_message = _PackedClock()
        self._clock = clock
        self._clock.impl.add_subscriber_listener(SubscriberEvents(self._wake.set))
        self._channels: List[Channel] = []
        if states:
            self._channels = [
                Channel("model_states", _PackedModelStates,
                        lambda layout: (layout.model_names, layout.model_places), states_hz,
                        self._wake),
                Channel("link_states", _PackedLinkStates,
                        lambda layout: (layout.link_names, layout.link_places), states_hz,
                        self._wake),
            ]

    def _run(self) -> None:
        step, clock = self._simulator.clock.now()
        selector = StepSelector(step, clock.sim_ns(step), time.monotonic(), self._clock_period_ns)
        while not self._stop.is_set():
            clock_wanted = self._clock.get_num_connections() > 0
            states_wanted = any(channel.wanted for channel in self._channels)
            self._set_demand(clock_wanted, states_wanted)
            if not (clock_wanted or states_wanted):
                self._sleep()
                step, clock = self._simulator.clock.now()
                selector = StepSelector(step, clock.sim_ns(step), time.monotonic(),
                                        self._clock_period_ns)
                continue
            began, before = time.monotonic(), selector.step
            try:
                self._publish(selector, states_wanted)
            except rospy.ROSException as fault:
                if not self._stop.is_set():
                    rospy.logerr("publishing failed: %s", fault)
                    self._stop.wait(1.0)
            self._pace(began, selector.step - before, selector.step)

    def _set_demand(self, clock_wanted: bool, states_wanted: bool) -> None:
        hz = 0.0
        if states_wanted:
            hz = self._states_hz or 1.0 / self._simulator.physics.settings.max_step_size
        demand = (hz, clock_wanted or states_wanted)
        if demand != self._demand:
            self._demand = demand
            self._simulator.feed.request("topics", states_hz=hz, notify=demand[1])

    def _pace(self, began: float, made: int, step: int) -> None:
        """Wait for the next step; in a world of many steps a millisecond, look once in one."""
        if made > FEW_STEPS:
            left = began + LOOK_SECONDS - time.monotonic()
            if left > 0.0:
                time.sleep(left)
        else:
            self._simulator.clock.wait_step(step, PAUSED_LOOK_SECONDS)

    def _publish(self, selector: StepSelector, states_wanted: bool) -> None:
        step, clock = self._simulator.clock.now()
        for nanoseconds in selector.times(step, clock.sim_ns, time.monotonic()):
            self._clock_message.packed = packed_time(nanoseconds)
            self._clock.publish(self._clock_message)
        if states_wanted:
            sim_ns = clock.sim_ns(step)
            due = [channel for channel in self._channels
                   if channel.wanted and channel.is_due(step, sim_ns, self._standing)]
            if due:
                layout, sequence, links = self._simulator.feed.states()
                passed_by = self._passed_by(layout.revision, sequence, step, len(links))
                for earlier in passed_by:
                    for channel in due:
                        channel.send(layout, *earlier)
                self._spare.take(1 + len(passed_by))
                for channel in due:
                    channel.send(layout, sequence, links)
                self._sent = (layout.revision, sequence, step)

    def _passed_by(self, revision: int, sequence: int, step: int,
                   size: int) -> List[Tuple[int, bytes]]:
        """States of the steps since the last message, but for the newest: number and rows.

        Only where every step is to be told, in a world that has not changed otherwise, and where
        this thread came a little late: the ring forgets the rest.
        """
        known, last, before = self._sent
        missed = min(step - before - 1, PASSED_BY, self._spare.available(time.monotonic()))
        if self._states_hz or revision != known or missed <= 0:
            return []
        shown: List[Tuple[int, Tuple[int, bytes]]] = []
        for number in range(max(last, sequence - PASSED_BY), sequence):
            earlier = self._simulator.feed.earlier_states(number)
            if earlier is not None and len(earlier[1]) == size:
                shown.append((earlier[0], (number, earlier[1])))
        # A step without a snapshot of its own left everything where it was.
        there = [[state for since, state in shown if since <= at]
                 for at in range(step - missed, step)]
        return [states[-1] for states in there if states]

    def _standing(self) -> Optional[Tuple[int, int]]:
        """What a world that stands still looks like; None while it runs."""
        if self._simulator.clock.running:
            return None
        layout, sequence, _ = self._simulator.feed.states()
        return layout.revision, sequence
