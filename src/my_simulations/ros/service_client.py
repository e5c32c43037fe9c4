"""Service clients with wall-clock timeouts."""
from __future__ import annotations

import time
from typing import Any, Callable

import rospy

from ..errors import SimulationError

SERVICE_SECONDS = 60.0
"""How long a client waits for a service to appear."""

POLL_SECONDS = 0.1


class ServiceUnavailableError(SimulationError):
    """A service or condition did not become available; the text names it and the timeout."""


def wait_until(condition: Callable[[], bool], what: str, seconds: float) -> None:
    """Wait on the wall clock, since ROS time does not advance in a paused world.

    Raises ServiceUnavailableError: `seconds` passed, or the node was shut down.
    """
    until = time.monotonic() + seconds
    while not condition():
        if rospy.is_shutdown():
            raise ServiceUnavailableError(f"interrupted while waiting for {what}")
        if time.monotonic() > until:
            raise ServiceUnavailableError(f"{what} not available within {seconds:g} s")
        time.sleep(POLL_SECONDS)


def service_proxy(name: str, service_class: Any, seconds: float = SERVICE_SECONDS) -> Any:
    """Wait until a service is available and return a proxy for it.

    Raises ServiceUnavailableError: it did not appear in time.
    """
    try:
        rospy.wait_for_service(name, timeout=seconds)
    except rospy.ROSInterruptException as fault:
        raise ServiceUnavailableError(f"interrupted while waiting for service {name}") from fault
    except rospy.ROSException as fault:
        raise ServiceUnavailableError(f"service {name} not available within {seconds:g} s; "
                       "is the simulator running?") from fault
    return rospy.ServiceProxy(name, service_class)


def api_name(namespace: str, name: str) -> str:
    """`namespace/name` with one slash between."""
    return f"{namespace.rstrip('/')}/{name}"
