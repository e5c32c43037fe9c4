"""The ROS side of a simulator: services, topics and parameters of the node `gazebo`."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional

import rospy

from .. import __version__
from ..errors import CommandError, InputError
from ..geometry import Pose, is_finite
from ..resources.resolver import Resolver
from ..simulator.simulator import Simulator
from .interface import Row, offered_rows
from .issue_logging import log_issue
from .lifecycle import abandoned
from .lifecycle.launch_info import Launch
from .lifecycle.master_membership import Membership
from .own_server import EDITOR_REQUESTED
from .plugins.plugin_starter import PluginStarter
from .services.world_services import (
    EditorService,
    Open,
    SaveService,
    StepService,
    WorldServices,
)

if TYPE_CHECKING:
    from .registration import Replace
    from .services.model_services import ModelServices


class Node:
    """Owns services, topics and parameters of a running simulator."""

    def __init__(self, simulator: Simulator, resolver: Resolver, clock: rospy.Publisher,
                 open_editor: Optional[Open] = None, master_uri: str = "",
                 announce_editor: Callable[[], None] = lambda: None,
                 launch: Optional[Launch] = None, replace: Replace = lambda _: None) -> None:
        """Take over a started, paused simulator.

        Args:
            simulator: the simulator.
            resolver: resolves URIs of spawned models.
            clock: the advertised `/clock`.
            open_editor: starts the world editor and returns its URL; None for no editor.
            master_uri: URI of the ROS master, to register again after it restarts; "" for never.
            announce_editor: sets the parameter with the editor's URL, if the editor runs.
            launch: how this process was started.
            replace: replaces handlers of some services and topics.
        """
        self._simulator = simulator
        self._clock = clock
        self._master_uri = master_uri
        self._resolver = resolver
        self._open_editor = open_editor
        self._launch = launch or Launch.of(())
        self._registered: List[Any] = []
        self._replace = replace
        self._publishers: Optional[Any] = None
        self._metrics: Optional[Any] = None
        self._reconfigure: Optional[Any] = None
        self._parameters = _private_parameters()
        self._network = _flag(self._parameters, "enable_ros_network", True)
        self._extensions = _flag(self._parameters, "extensions", True)
        self._plugins = PluginStarter(simulator, simulator.report,
                                      _plugin_classes(self._parameters))
        if self._network:
            simulator.sync_points.on_plugins(self._plugins.start_early)
        self._engine_pid = 0
        self._announce_editor = announce_editor
        self._membership = Membership(master_uri, rospy.get_name(),
                                      self._set_parameters) if master_uri else None

    def topic_graph(self) -> Optional[Any]:
        """The ROS topics, for the world editor; None without `~enable_ros_network`."""
        if not self._network:
            return None
        from .lifecycle import master_api
        from .plugins.topic_graph import TopicGraph

        return TopicGraph(self._plugins.topic_uses, lambda method: master_api.call(
            self._master_uri, method, rospy.get_name()))

    def plugin_states(self) -> List[Any]:
        """The states of the plugins (`plugins.plugin_state`), for the world editor."""
        return self._plugins.states()

    def wait_for_plugins(self, seconds: float) -> bool:
        """Wait until plugins have published all that is due, s of wall time; False if not yet."""
        return self._plugins.wait_until_published(seconds)

    def advertise(self) -> None:
        """Advertise topics and services, and set parameters."""
        from .lifecycle.tcpros_handshake import parallelise_handshakes
        from .registration import register_endpoints
        from .topics.state_publishers import Publishers

        if self._manual_stepping():
            self._simulator.clock.set_manual_stepping(True)
        self._publishers = Publishers(
            self._simulator, self._clock, states=self._network,
            clock_hz=_number(self._parameters, "pub_clock_frequency", 0.0),
            states_hz=_number(self._parameters, "model_states_rate", 0.0))
        parallelise_handshakes()
        # Set before any service: tools read it to tell this node from Gazebo.
        rospy.set_param("~my_simulations/version", __version__)
        if self._network:
            self._registered = register_endpoints(self._rows(late=False), self._handlers(),
                                                  self._replace)
        self._set_world_parameters()

    def _manual_stepping(self) -> bool:
        """Parameter `~manual_stepping`, or its deprecated alias `~lockstep`."""
        name = "manual_stepping"
        if "lockstep" in self._parameters:
            rospy.logwarn("parameter ~lockstep is deprecated; use ~manual_stepping")
            if name in self._parameters:
                rospy.delete_param("~lockstep")  # else the next node would warn again
            else:
                name = "lockstep"
        return _flag(self._parameters, name, False)

    def _set_world_parameters(self) -> None:
        world = self._simulator.world.file
        rospy.set_param("~my_simulations/world_file", os.path.abspath(world) if world else "")
        rospy.set_param("~world_base_name", base_name(world))
        self._publish_engine_pid()
        if not rospy.has_param("/use_sim_time"):
            rospy.set_param("/use_sim_time", True)

    def _set_parameters(self) -> None:
        """Set all parameters of this node again, on a restarted master."""
        self._engine_pid = 0
        self._set_world_parameters()
        rospy.set_param("~my_simulations/version", __version__)
        self._announce_editor()
        if self._reconfigure is not None:
            self._reconfigure.forget_stored()

    def advertise_late(self) -> None:
        """Advertise services and topics that the start does not wait for; call it last."""
        if not self._network:
            return
        from .registration import register_endpoints

        if self._extensions:
            from .topics.performance_metrics import Metrics

            self._metrics = Metrics(self._simulator)
            self._metrics.start()
        handlers = self._late_handlers()
        self._reconfigure = handlers["reconfigure"]
        self._registered += register_endpoints(self._rows(late=True), handlers, self._replace)

    def _rows(self, late: bool) -> List[Row]:
        return [row for row in offered_rows(extensions=self._extensions) if row.late == late]

    def _handlers(self) -> Dict[str, Any]:
        """Handler objects by the first half of `Row.handler`."""
        from .services.joint_services import JointServices
        from .services.light_services import LightServices
        from .services.link_services import LinkServices
        from .services.state_services import StateServices
        from .services.wrench_services import WrenchServices

        simulator = self._simulator
        return {
            "joints": JointServices(simulator), "lights": LightServices(simulator),
            "links": LinkServices(simulator), "models": self._models(),
            "states": StateServices(simulator), "world": WorldServices(simulator),
            "wrenches": WrenchServices(simulator),
        }

    def _models(self) -> ModelServices:
        from .services.model_services import ModelServices

        return ModelServices(self._simulator, self._resolver, log_issue, self._launch.pid,
                             self._plugins.wait_until_loaded)

    def _late_handlers(self) -> Dict[str, Any]:
        simulator = self._simulator
        return {
            "models": self._models(), "editor": EditorService(self._open_editor),
            "reconfigure": _reconfigure(simulator),
            "saving": SaveService(simulator, self._resolver, self._launch.folder),
            "stepping": StepService(simulator), "world": WorldServices(simulator),
        }

    def master_timeout(self) -> float:
        """Parameter `~master_timeout`: wall seconds without master or roslaunch; 0 for never."""
        found = _number(self._parameters, "master_timeout", abandoned.SECONDS)
        if found < 0.0:
            rospy.logerr("parameter ~master_timeout must not be negative, is %g; using %g",
                         found, abandoned.SECONDS)
            return abandoned.SECONDS
        return found

    def refresh(self) -> None:
        """Keep the registration and the parameters up to date; call it about once a second.

        While the master is unreachable, the next call tries again.
        """
        if self._network:
            self._plugins.start_if_needed()
        try:
            if self._membership is not None and not self._membership.refresh():
                return
            self._publish_engine_pid()
            if not (self._network and self._extensions):
                self._open_requested_editor()
            if self._reconfigure is not None:
                self._reconfigure.refresh()
        except OSError as fault:
            rospy.logdebug("the ROS master does not respond: %s", fault)

    def _open_requested_editor(self) -> None:
        name = f"~{EDITOR_REQUESTED}"
        if self._open_editor is None or not rospy.get_param(name, False):
            return
        rospy.delete_param(name)
        try:
            self._open_editor()
        except CommandError as fault:
            rospy.logerr("the world editor cannot be opened: %s", fault)

    def _publish_engine_pid(self) -> None:
        pid = self._simulator.engine_pid
        if pid != self._engine_pid:
            rospy.set_param("~my_simulations/engine_pid", pid)
            self._engine_pid = pid

    def start_publishing(self) -> None:
        """Start to publish `/clock` and the state topics, and the plugins of the world's models."""
        if self._publishers is not None:
            self._publishers.start()
        if self._network:
            self._plugins.wait_until_loaded()

    def spawn_robot(self) -> None:
        """Spawn the parameter `robot_description` if `~spawn_robot` is true; delete `~spawn_robot`.

        Errors are logged with what to do; the node keeps running.
        """
        if not _flag(self._parameters, "spawn_robot", False):
            return
        # Valid for this start only: the master keeps parameters for the next node.
        rospy.delete_param("~spawn_robot")
        where = [_number(self._parameters, f"robot_{axis}", 0.0) for axis in "xyz"]
        text = rospy.get_param("robot_description", None)
        if not isinstance(text, str) or not text.strip():
            rospy.logerr("~spawn_robot is true, but parameter %s is not set; load a URDF with "
                         '<param name="robot_description" textfile="..."/> before the node starts',
                         rospy.resolve_name("robot_description"))
            return
        try:
            said = self._models().spawn_text(text, None, Pose((where[0], where[1], where[2])),
                                             file="robot_description", launched=True)
            rospy.loginfo("robot_description: %s", said)
        except (CommandError, InputError) as fault:
            rospy.logerr("cannot spawn robot_description: %s; correct it and run "
                         "rosrun gazebo_ros spawn_model -urdf -param robot_description "
                         "-model NAME", fault)

    def stop(self) -> None:
        """Stop publishing; rospy's own shutdown unregisters the services."""
        self._plugins.stop()
        for publishers in (self._publishers, self._metrics):
            if publishers is not None:
                publishers.stop()


def _reconfigure(simulator: Simulator) -> Optional[Any]:
    """The dynamic_reconfigure server; None if its messages are not installed."""
    try:
        from .services.physics_reconfigure import ReconfigureServer
    except ImportError as fault:
        rospy.logwarn("dynamic_reconfigure is not available: %s", fault)
        return None
    return ReconfigureServer(simulator)


def base_name(world_file: str) -> str:
    """A world file's name without folder and extension."""
    return os.path.splitext(os.path.basename(world_file))[0]


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
    rospy.logerr("parameter ~%s must be true or false, is %r; using %r", name, value, default)
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
        rospy.logerr("parameter ~%s must be a finite number, is %r; using %r",
                     name, value, default)
        return default
