"""The node `gazebo`: one simulator behind services, topics and parameters."""
from __future__ import annotations

import os
import time
from typing import Any, Dict, List, Optional

import rospy

from .. import __version__
from ..errors import CommandError, InputError
from ..geometry import Pose, is_finite
from ..resources.resolver import Resolver
from ..simulator.simulator import Simulator
from .log import log_issue

ROSOUT_SECONDS = 1.0
"""How long a node that is about to end waits for /rosout to hear why."""


class Node:
    """Owns the ROS side of a running simulator."""

    def __init__(self, simulator: Simulator, resolver: Resolver, clock: rospy.Publisher) -> None:
        self._simulator = simulator
        self._clock = clock
        self._resolver = resolver
        self._services: List[Any] = []
        self._subscribers: List[Any] = []
        self._publishers: Optional[Any] = None
        self._parameters = _private_parameters()
        self._engine_pid = 0

    def advertise(self) -> None:
        """Offer topics, services and parameters."""
        from .connections import take_side_by_side
        from .publishers import Publishers

        network = _flag(self._parameters, "enable_ros_network", True)
        self._publishers = Publishers(
            self._simulator, self._clock, states=network,
            clock_hz=_number(self._parameters, "pub_clock_frequency", 0.0),
            states_hz=_number(self._parameters, "model_states_rate", 0.0))
        take_side_by_side()
        if network:
            self._advertise_api()
        rospy.set_param("~world_base_name", base_name(self._simulator.world.file))
        rospy.set_param("~my_simulations/version", __version__)
        self.keep_up()
        if not rospy.has_param("/use_sim_time"):
            rospy.set_param("/use_sim_time", True)

    def _advertise_api(self) -> None:
        from .endpoints import advertise
        from .models import ModelServices
        from .saving import SaveService
        from .states import StateServices
        from .world import WorldServices

        states = StateServices(self._simulator)
        faces = (WorldServices(self._simulator), states,
                 ModelServices(self._simulator, self._resolver, log_issue),
                 SaveService(self._simulator, self._resolver))
        self._services = advertise(row for face in faces for row in face.endpoints())
        self._subscribers = states.subscribe()

    def keep_up(self) -> None:
        """Keep `~my_simulations/engine_pid` true; call it now and then.

        A master that is away is asked again the next time.
        """
        pid = self._simulator.engine_pid
        if pid == self._engine_pid:
            return
        try:
            rospy.set_param("~my_simulations/engine_pid", pid)
            self._engine_pid = pid
        except OSError as fault:
            rospy.logdebug("the master does not answer: %s", fault)

    def start_publishing(self) -> None:
        """Begin to publish `/clock` and the states."""
        if self._publishers is not None:
            self._publishers.start()

    def spawn_robot(self) -> None:
        """Spawn the parameter `robot_description` when `~spawn_robot` says so.

        Faults are logged with what to do; the node runs on.
        """
        if not _flag(self._parameters, "spawn_robot", False):
            return
        # It was meant for this start: a master that lives on would hand it to the next one.
        rospy.delete_param("~spawn_robot")
        where = [_number(self._parameters, f"robot_{axis}", 0.0) for axis in "xyz"]
        text = rospy.get_param("robot_description", None)
        if not isinstance(text, str) or not text.strip():
            rospy.logerr("~spawn_robot is true, but the parameter %s holds no URDF; load it with "
                         '<param name="robot_description" textfile="..."/> before the node starts',
                         rospy.resolve_name("robot_description"))
            return
        from .models import ModelServices

        models = ModelServices(self._simulator, self._resolver, log_issue)
        try:
            said = models.spawn_text(text, None, Pose((where[0], where[1], where[2])),
                                     file="robot_description")
            rospy.loginfo("robot_description: %s", said)
        except (CommandError, InputError) as fault:
            rospy.logerr("robot_description was not spawned: %s; correct it and spawn it with "
                         "rosrun gazebo_ros spawn_model -urdf -param robot_description "
                         "-model NAME", fault)

    def stop(self) -> None:
        """Stop publishing; rospy's own shutdown takes the services off the graph."""
        if self._publishers is not None:
            self._publishers.stop()


def base_name(world_file: str) -> str:
    """A world file's name without folder and extension."""
    return os.path.splitext(os.path.basename(world_file))[0]


def fail(lines: List[str]) -> None:
    """Say why the node ends, on standard error and on /rosout, and wait until it is out."""
    from rosgraph_msgs.msg import Log

    out = rospy.Publisher("/rosout", Log, queue_size=100)
    until = time.monotonic() + ROSOUT_SECONDS
    while out.get_num_connections() == 0 and time.monotonic() < until:
        time.sleep(0.02)
    for line in lines:
        rospy.logfatal("%s", line)
    time.sleep(0.1)


def _private_parameters() -> Dict[str, Any]:
    found = rospy.get_param("~", {})
    return found if isinstance(found, dict) else {}


def _flag(parameters: Dict[str, Any], name: str, default: bool) -> bool:
    value = parameters.get(name, default)
    if isinstance(value, bool):
        return value
    if isinstance(value, str) and value.strip().lower() in ("true", "false", "1", "0"):
        return value.strip().lower() in ("true", "1")
    rospy.logerr("parameter ~%s must be true or false, it is %r; %r is used", name, value, default)
    return default


def _number(parameters: Dict[str, Any], name: str, default: float) -> float:
    value = parameters.get(name, default)
    try:
        if isinstance(value, bool):
            raise ValueError
        number = float(value)
        if not is_finite(number):
            raise ValueError
        return number
    except (TypeError, ValueError):
        rospy.logerr("parameter ~%s must be a finite number, it is %r; %r is used",
                     name, value, default)
        return default
