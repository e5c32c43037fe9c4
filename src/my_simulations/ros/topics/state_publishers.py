"""Topics `/clock`, `model_states` and `link_states`, published by one thread.

The thread waits on the wall clock and on the engine's steps, never on ROS time, which it publishes
itself.
"""
from __future__ import annotations

import threading
import time
from typing import Any, Callable, List, Optional, Tuple

import rospy
from gazebo_msgs.msg import LinkStates, ModelStates
from rosgraph_msgs.msg import Clock

from ...simulator.row_layout import FrameLocation, RowLayout
from ...simulator.simulator import Simulator
from ..direct_connection import direct_publish
from ..registration import advertise_topic
from .publish_pacing import StateSchedule, StepSelector, TokenBucket
from .state_buffers import StatesBuffer, pack_time
from .subscriber_events import SubscriberEvents
from .worker_thread import WorkerThread

LOOK_SECONDS = 0.001
"""Wall seconds between polls of a world that makes many steps in that time."""

FEW_STEPS = 2
"""Steps per poll of a world in real time, one poll a little late."""

PAUSED_LOOK_SECONDS = 0.05
"""Wall seconds between polls of a paused world."""

STATES_QUEUE = 50

PASSED_BY = 12
"""Most past snapshots that a late poll publishes; the ring holds four more."""

STATES_PER_SECOND = 1000.0
"""State messages per wall second above which a late poll publishes the newest state only."""


class _PackedClock(Clock):
    """A Clock that is already serialised."""

    __slots__ = ["packed"]

    def serialize(self, buff: Any) -> None:
        buff.write(self.packed)


class _PackedModelStates(ModelStates):
    """A ModelStates that is already serialised."""

    __slots__ = ["packed"]

    def serialize(self, buff: Any) -> None:
        buff.write(self.packed)


class _PackedLinkStates(LinkStates):
    """A LinkStates that is already serialised."""

    __slots__ = ["packed"]

    def serialize(self, buff: Any) -> None:
        buff.write(self.packed)


class StateTopic:
    """One state topic: its publisher and its schedule."""

    def __init__(self, topic: str, packed_class: Any,
                 entities: Callable[[RowLayout], Tuple[List[str], List[FrameLocation]]],
                 rate: float, wake: threading.Event) -> None:
        self._entities = entities
        self._schedule = StateSchedule(rate)
        self._buffer = StatesBuffer()
        self._message = packed_class()
        self._owed = threading.Event()
        self._wake = wake
        self.publisher = advertise_topic(topic, queue_size=STATES_QUEUE, tcp_nodelay=True,
                                         subscriber_listener=SubscriberEvents(self._on_subscriber))
        self._publish = direct_publish(self.publisher)

    def _on_subscriber(self) -> None:
        self._owed.set()
        self._wake.set()

    @property
    def wanted(self) -> bool:
        return self.publisher.get_num_connections() > 0

    def is_due(self, step: int, sim_ns: int,
               standing: Callable[[], Optional[Tuple[int, int]]]) -> bool:
        """Whether to publish now; see `StateSchedule.due`."""
        owed = self._owed.is_set()
        self._owed.clear()
        return self._schedule.due(step, sim_ns, owed, standing)

    def send(self, layout: RowLayout, sequence: int, links: bytes) -> None:
        """Publish the rows that `StateFeed.states` returned."""
        names, places = self._entities(layout)
        self._message.packed = self._buffer.pack(layout.revision, sequence, names, places, links)
        self._publish(self._message)
        self._schedule.note_published((layout.revision, sequence))


class Publishers(WorkerThread):
    """The publishing thread of the three topics."""

    def __init__(self, simulator: Simulator, clock: rospy.Publisher, *, clock_hz: float = 0.0,
                 states_hz: float = 0.0, states: bool = True) -> None:
        """Advertise the state topics.

        Args:
            simulator: the world to publish.
            clock: the advertised `/clock`.
            clock_hz: rate of `/clock` in Hz of sim time; 0 for every step.
            states_hz: rate of the state topics in Hz of sim time; 0 for every step.
            states: whether to advertise the state topics.
        """
        super().__init__("publishers")
        self._simulator = simulator
        self._clock_period_ns = round(1e9 / clock_hz) if clock_hz > 0.0 else 0
        self._states_hz = states_hz
        self._demand = (-1.0, False)
        self._spare = TokenBucket(STATES_PER_SECOND, STATES_QUEUE, time.monotonic())
        self._sent = (-1, 0, 0)  # revision, sequence and step of the newest published states
        self._clock_message = _PackedClock()
        self._clock, self._publish_clock = clock, direct_publish(clock)
        self._clock.impl.add_subscriber_listener(SubscriberEvents(self._wake.set))
        self._state_topics: List[StateTopic] = []
        if states:
            self._state_topics = [
                StateTopic("model_states", _PackedModelStates,
                        lambda layout: (layout.model_names, layout.model_places), states_hz,
                        self._wake),
                StateTopic("link_states", _PackedLinkStates,
                        lambda layout: (layout.link_names, layout.link_places), states_hz,
                        self._wake),
            ]

    def _run(self) -> None:
        step, clock = self._simulator.clock.now()
        selector = StepSelector(step, clock.sim_ns(step), time.monotonic(), self._clock_period_ns)
        while not self._stop.is_set():
            clock_wanted = self._clock.get_num_connections() > 0
            states_wanted = any(channel.wanted for channel in self._state_topics)
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
                    rospy.logerr("cannot publish: %s", fault)
                    self._stop.wait(1.0)
            self._pace(began, selector.step - before, selector.step)

    def _set_demand(self, clock_wanted: bool, states_wanted: bool) -> None:
        """Request the rate of states, and a notification of each step, from the engine."""
        hz = 0.0
        if states_wanted:
            hz = self._states_hz or 1.0 / self._simulator.physics.settings.max_step_size
        demand = (hz, clock_wanted or states_wanted)
        if demand != self._demand:
            self._demand = demand
            self._simulator.feed.request("topics", states_hz=hz, notify=demand[1])

    def _pace(self, began: float, made: int, step: int) -> None:
        """Wait for the next step; if there are many in a millisecond, poll once in one."""
        if made > FEW_STEPS:
            left = began + LOOK_SECONDS - time.monotonic()
            if left > 0.0:
                time.sleep(left)
        else:
            self._simulator.clock.wait_step(step, PAUSED_LOOK_SECONDS)

    def _publish(self, selector: StepSelector, states_wanted: bool) -> None:
        step, clock = self._simulator.clock.now()
        for nanoseconds in selector.times(step, clock.sim_ns, time.monotonic()):
            self._clock_message.packed = pack_time(nanoseconds)
            self._publish_clock(self._clock_message)
        if states_wanted:
            sim_ns = clock.sim_ns(step)
            due = [channel for channel in self._state_topics
                   if channel.wanted and channel.is_due(step, sim_ns, self._paused_state)]
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
        """States between the last message and the newest: sequence number and rows of each.

        Only if every step is to be published, models have not changed, and the thread was only a
        little late: the ring keeps few snapshots.
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

    def _paused_state(self) -> Optional[Tuple[int, int]]:
        """Key of the state of a paused world; None while it runs."""
        if self._simulator.clock.running:
            return None
        layout, sequence, _ = self._simulator.feed.states()
        return layout.revision, sequence
