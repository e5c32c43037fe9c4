"""The node `gazebo`: one simulator behind services, topics and parameters."""
from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional

import rospy

from .. import __version__
from ..errors import CommandError, InputError
from ..geometry import Pose, is_finite
from ..resources.resolver import Resolver
from ..simulator.simulator import Simulator
from .interface import Row, rows
from .issue_logging import log_issue
from .lifecycle import abandoned
from .lifecycle.launch_info import Launch
from .lifecycle.master_membership import Membership
from .plugins.plugin_starter import PluginStarter
from .services.editor_service import Open
from .services.world_services import WorldServices

if TYPE_CHECKING:
    from .services.model_services import ModelServices

ROSOUT_SECONDS = 1.0
"""How long a node that is about to end waits for /rosout to hear why."""


class Node:
    """Owns the ROS side of a running simulator."""

    def __init__(self, simulator: Simulator, resolver: Resolver, clock: rospy.Publisher,
                 open_editor: Optional[Open] = None, master_uri: str = "",
                 announce_editor: Callable[[], None] = lambda: None,
                 launch: Optional[Launch] = None) -> None:
        """Take over a simulator that does not run yet.

        Args:
            simulator: started, paused.
            resolver: finds what spawned models name.
            clock: the advertised `/clock`.
            open_editor: starts the world editor and returns its address.
            master_uri: of the ROS master, whose restarts are looked after; "" for not at all.
            announce_editor: sets the parameter with the editor's address, if there is one.
            launch: how this process was started.
        """
        self._simulator = simulator
        self._clock = clock
        self._resolver = resolver
        self._open_editor = open_editor
        self._launch = launch or Launch.of(())
        self._registered: List[Any] = []
        self._publishers: Optional[Any] = None
        self._metrics: Optional[Any] = None
        self._reconfigure: Optional[Any] = None
        self._parameters = _private_parameters()
        self._network = _flag(self._parameters, "enable_ros_network", True)
        self._extensions = _flag(self._parameters, "extensions", True)
        self._plugins = PluginStarter(simulator, log_issue, _plugin_classes(self._parameters))
        self._engine_pid = 0
        self._announce_editor = announce_editor
        self._membership = Membership(master_uri, rospy.get_name(),
                                      self._set_parameters) if master_uri else None

    def advertise(self) -> None:
        """Offer topics, services and parameters."""
        from .lifecycle.tcpros_handshake import take_side_by_side
        from .registration import register
        from .topics.state_publishers import Publishers

        if _flag(self._parameters, "lockstep", False):
            self._simulator.clock.set_manual_stepping(True)
        self._publishers = Publishers(
            self._simulator, self._clock, states=self._network,
            clock_hz=_number(self._parameters, "pub_clock_frequency", 0.0),
            states_hz=_number(self._parameters, "model_states_rate", 0.0))
        take_side_by_side()
        # Tools ask for it to know whose services they call: before there are any.
        rospy.set_param("~my_simulations/version", __version__)
        if self._network:
            self._registered = register(self._rows(late=False), self._faces())
        self._set_world_parameters()

    def _set_world_parameters(self) -> None:
        rospy.set_param("~world_base_name", base_name(self._simulator.world.file))
        self._keep_engine_pid()
        if not rospy.has_param("/use_sim_time"):
            rospy.set_param("/use_sim_time", True)

    def _set_parameters(self) -> None:
        """All that this node has set, for a master that knows nothing of it."""
        self._engine_pid = 0
        self._set_world_parameters()
        rospy.set_param("~my_simulations/version", __version__)
        self._announce_editor()
        if self._reconfigure is not None:
            self._reconfigure.forget_stored()

    def advertise_late(self) -> None:
        """Offer what the start does not wait for; call it once the world runs."""
        if not self._network:
            return
        from .registration import register

        if self._extensions:
            from .topics.performance_metrics import Metrics

            self._metrics = Metrics(self._simulator)
            self._metrics.start()
        faces = self._late_faces()
        self._reconfigure = faces["reconfigure"]
        self._registered += register(self._rows(late=True), faces)

    def _rows(self, late: bool) -> List[Row]:
        return [row for row in rows(extensions=self._extensions) if row.late == late]

    def _faces(self) -> Dict[str, Any]:
        """Who handles what, by the first half of the table's handlers."""
        from .services.joint_services import JointServices
        from .services.light_services import LightServices
        from .services.link_services import LinkServices
        from .services.state_services import StateServices
        from .services.wrench_services import LoadServices

        simulator = self._simulator
        return {
            "joints": JointServices(simulator), "lights": LightServices(simulator),
            "links": LinkServices(simulator), "loads": LoadServices(simulator),
            "models": self._models(),
            "states": StateServices(simulator), "world": WorldServices(simulator),
        }

    def _models(self) -> ModelServices:
        from .services.model_services import ModelServices

        return ModelServices(self._simulator, self._resolver, log_issue, self._launch.pid,
                             self._plugins.settle)

    def _late_faces(self) -> Dict[str, Any]:
        from .services.editor_service import EditorService
        from .services.save_service import SaveService
        from .services.step_service import SteppingService

        simulator = self._simulator
        return {
            "editor": EditorService(self._open_editor), "reconfigure": _reconfigure(simulator),
            "saving": SaveService(simulator, self._resolver, self._launch.folder),
            "stepping": SteppingService(simulator), "world": WorldServices(simulator),
        }

    def seconds_alone(self) -> float:
        """How long the master or the launch may be gone before the node ends; 0 for ever."""
        found = _number(self._parameters, "master_timeout", abandoned.SECONDS)
        if found < 0.0:
            rospy.logerr("parameter ~master_timeout must not be negative, it is %g; %g is used",
                         found, abandoned.SECONDS)
            return abandoned.SECONDS
        return found

    def keep_up(self) -> None:
        """Keep the registration, and the parameters that follow the world; call it now and then.

        A master that is away is asked again the next time.
        """
        if self._network:
            self._plugins.look()
        try:
            if self._membership is not None and not self._membership.keep_up():
                return
            self._keep_engine_pid()
            if self._reconfigure is not None:
                self._reconfigure.keep_up()
        except OSError as fault:
            rospy.logdebug("the master does not answer: %s", fault)

    def _keep_engine_pid(self) -> None:
        pid = self._simulator.engine_pid
        if pid != self._engine_pid:
            rospy.set_param("~my_simulations/engine_pid", pid)
            self._engine_pid = pid

    def start_publishing(self) -> None:
        """Begin to publish `/clock` and the states; plugins of the world's models begin, too."""
        if self._publishers is not None:
            self._publishers.start()
        if self._network:
            self._plugins.settle()

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
        try:
            said = self._models().spawn_text(text, None, Pose((where[0], where[1], where[2])),
                                             file="robot_description", launched=True)
            rospy.loginfo("robot_description: %s", said)
        except (CommandError, InputError) as fault:
            rospy.logerr("robot_description was not spawned: %s; correct it and spawn it with "
                         "rosrun gazebo_ros spawn_model -urdf -param robot_description "
                         "-model NAME", fault)

    def stop(self) -> None:
        """Stop publishing; rospy's own shutdown takes the services off the graph."""
        self._plugins.stop()
        for publishers in (self._publishers, self._metrics):
            if publishers is not None:
                publishers.stop()


def _reconfigure(simulator: Simulator) -> Optional[Any]:
    """The dynamic_reconfigure server; None where its messages are not installed."""
    try:
        from .services.physics_reconfigure import Reconfigure
    except ImportError as fault:
        rospy.logwarn("the physics settings are not offered to dynamic_reconfigure: %s", fault)
        return None
    return Reconfigure(simulator)


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


def _plugin_classes(parameters: Dict[str, Any]) -> Dict[str, str]:
    found = parameters.get("plugins", {})
    if isinstance(found, dict) and all(isinstance(where, str) for where in found.values()):
        return {str(library): where for library, where in found.items()}
    rospy.logerr("parameter ~plugins must map libraries to package.module:Class, it is %r", found)
    return {}


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
