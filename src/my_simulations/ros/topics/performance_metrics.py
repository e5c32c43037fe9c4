"""Topic `performance_metrics`: the real-time factor, at 5 Hz while there are subscribers."""
from __future__ import annotations

import time
from typing import Any

import rospy

from ...simulator.simulator import Simulator
from ..interface import PUBLISHES, row_of
from ..message_conversion import seconds_and_nanoseconds
from ..registration import advertise_topic, class_of
from .subscriber_events import SubscriberEvents
from .worker_thread import WorkerThread

TOPIC = "performance_metrics"
PERIOD_SECONDS = 0.2
"""Wall seconds between messages (Gazebo behaviour)."""


class Metrics(WorkerThread):
    """Publishes the topic; its thread sleeps while there is no subscriber."""

    def __init__(self, simulator: Simulator) -> None:
        super().__init__("metrics")
        self._simulator = simulator
        self._message: Any = class_of(row_of(TOPIC, PUBLISHES))()
        self._publisher = advertise_topic(TOPIC, queue_size=10,
                                          subscriber_listener=SubscriberEvents(self._wake.set))

    def _run(self) -> None:
        while not self._stop.is_set():
            self._sleep()
            self._measure()

    def _measure(self) -> None:
        """Publish until there is no subscriber."""
        sim, real = self._simulator.clock.sim_ns, time.monotonic()
        while not self._stop.wait(PERIOD_SECONDS) and self._publisher.get_num_connections():
            sim_now, real_now = self._simulator.clock.sim_ns, time.monotonic()
            if sim_now > sim:
                self._publish_factor(sim_now, (sim_now - sim) * 1e-9 / (real_now - real))
            sim, real = sim_now, real_now

    def _publish_factor(self, sim_ns: int, factor: float) -> None:
        stamp = self._message.header.stamp
        stamp.secs, stamp.nsecs = seconds_and_nanoseconds(sim_ns)
        self._message.real_time_factor = factor
        try:
            self._publisher.publish(self._message)
        except rospy.ROSException as fault:
            rospy.logdebug("performance_metrics: %s", fault)
