"""Parameters and services for the object tools, each with a wall-clock timeout.

No rospy node is created, and rospy is not imported: a tool that only calls services needs no
registration, and starts much faster without.
"""
from __future__ import annotations

import argparse
import contextlib
import functools
import signal
import sys
import time
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

from ..errors import InputError, Issue, Severity, SimulationError
from ..geometry import Pose, Vec3, quat_from_rpy
from ..ros.arguments import parse_seconds
from ..ros.call_deadline import CallTimeoutError, call_with_deadline
from ..ros.lifecycle import master_api
from ..ros.own_server import spawns_objects
from ..ros.service_connection import ServiceCallError, ServiceConnection, service_class

OK, FAILED, USAGE = 0, 1, 2
TIMEOUT = 30.0
POLL_SECONDS = 0.05
LIST_SECONDS = 10.0
"""Longest wait for the object list, once the simulator is running."""

OBJECTS = "/objects"
GROUPS = "/object_groups"

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

CALLER = "/my_simulations_object_tool"


class ToolError(SimulationError):
    """A tool failed; the text says what failed and what to do."""


def add_common_options(parser: argparse.ArgumentParser) -> None:
    """Add the options common to all object tools."""
    parser.add_argument("--timeout", type=parse_seconds, default=TIMEOUT, metavar="SECONDS",
                        help="wall-clock timeout of each call (default %(default)g)")
    parser.add_argument("--gazebo-namespace", default="gazebo", metavar="NS",
                        help="name of the simulator node (default %(default)s)")


def split_command_line(argv: Optional[Sequence[str]]) -> Tuple[List[str], List[str]]:
    """Return the arguments and the ROS remappings of a command line, without the program."""
    words = list(sys.argv if argv is None else argv)[1:]
    return ([word for word in words if ":=" not in word],
            [word for word in words if ":=" in word])


def run_tool(name: str, parser: argparse.ArgumentParser, argv: Optional[Sequence[str]],
             work: Callable[[argparse.Namespace, Sequence[str]], int]) -> int:
    """Read a command line, program name first, and `run` the tool with options and remappings."""
    words, remappings = split_command_line(argv)
    options = parser.parse_args(words)
    return run(name, lambda: work(options, remappings))


def run(name: str, work: Callable[[], int]) -> int:
    """Run a tool; a ToolError or InputError is printed and gives exit code 1."""
    try:
        return work()
    except ToolError as fault:
        print(f"{name}: {fault}", file=sys.stderr)
    except InputError as fault:
        show(fault.issues)
    except KeyboardInterrupt:
        print(f"\n{name}: interrupted", file=sys.stderr)
    return FAILED


def show(issues: Sequence[Issue]) -> None:
    """Print issues to standard error, one per line."""
    for issue in issues:
        print(issue, file=sys.stderr, flush=True)


def has_errors(issues: Sequence[Issue]) -> bool:
    return any(issue.severity is Severity.ERROR for issue in issues)


class Parameters:
    """Access to the parameter server and the master."""

    def __init__(self, remappings: Sequence[str] = ()) -> None:
        """Connect to the master. Raises ToolError: no master responds."""
        self.uri = master_api.master_uri(remappings)
        fault = master_api.fault_of(self.uri, CALLER)
        if fault:
            raise ToolError(f"no ROS master at {self.uri} ({fault}); start one with roscore or "
                            "roslaunch, or set ROS_MASTER_URI")

    def get(self, name: str) -> Any:
        """The value of a parameter, None if it is not set."""
        return self._call("getParam", name)

    def set(self, name: str, value: Any) -> None:
        """Set a parameter, replacing the whole tree below it."""
        self._call("setParam", name, value)

    def delete(self, name: str) -> None:
        """Delete a parameter or tree, if it is set."""
        self._call("deleteParam", name)

    def has_service(self, name: str) -> bool:
        """Whether a node offers the service."""
        return bool(self._call("lookupService", name))

    def wait(self, condition: Callable[[], Any], limit: float, what: str, hint: str) -> Any:
        """Wait on the wall clock until the condition returns something true; returns that.

        Raises ToolError: `limit` wall seconds passed; the text contains `what` and `hint`.
        """
        until = time.monotonic() + limit
        while True:
            found = condition()
            if found:
                return found
            if time.monotonic() >= until:
                raise ToolError(f"timed out after {limit:g} s waiting for {what}; {hint}")
            time.sleep(POLL_SECONDS)

    def _call(self, method: str, *arguments: Any) -> Any:
        try:
            return master_api.call(self.uri, method, CALLER, *arguments)
        except OSError as fault:
            raise ToolError(f"the ROS master at {self.uri} stopped responding ({fault}); "
                            "is roscore still running?") from fault


def full_name(name: str, remappings: Sequence[str]) -> str:
    """A name resolved in the namespace of the tool."""
    if name.startswith("/"):
        return name.rstrip("/")
    return master_api.node_name([word for word in remappings if word.startswith("__ns:=")], name)


class SimulatorClient:
    """The services of a running simulator, ours or a real Gazebo."""

    def __init__(self, parameters: Parameters, name: str, timeout: float) -> None:
        """Wait until the simulator `name` (a full node name) has advertised its services.

        Raises ToolError: not within `timeout` wall seconds.
        """
        self.name = name
        self._master = parameters.uri
        self._timeout = timeout
        self._connections: Dict[str, ServiceConnection] = {}
        probe = f"{name}/get_world_properties"
        parameters.wait(lambda: parameters.has_service(probe), timeout,
                        f"simulator (service {probe})",
                        "start it with roslaunch my_simulations my_world.launch")
        self.replaces = spawns_objects(parameters.get, name)
        """Whether a spawn request may replace a model in one step."""
        if self.replaces:
            offered = f"{name}/spawn_object"
            parameters.wait(lambda: parameters.has_service(offered), timeout,
                            f"service {offered}", "is the simulator still starting?")

    def model_names(self) -> List[str]:
        answer = self._call("get_world_properties", "GetWorldProperties")
        return list(answer.model_names)

    def call_service(self, service: str, kind: str, timeout: Optional[float] = None, **fields: Any
                     ) -> Any:
        """The response of a service of the node, with a type of gazebo_msgs or my_simulations_msgs.

        Args:
            service: its name, below the node's name.
            kind: its type.
            timeout: wall seconds for the response; by default those of this client.
            fields: of the request.

        Raises ToolError: it is not available or did not respond.
        """
        return self._call(service, kind, timeout, **fields)

    def spawn(self, name: str, xml: str, sdf: bool, position: Vec3, rpy: Vec3) -> str:
        """Spawn a model; returns the status message.

        Raises ToolError: it failed or did not respond.
        """
        return self._call_service("spawn_sdf_model" if sdf else "spawn_urdf_model", "SpawnModel",
                                  model_name=name, model_xml=xml,
                                  initial_pose=pose_message(Pose(position, quat_from_rpy(*rpy))))

    def spawn_object(self, name: str, xml: str, position: Vec3, rpy: Vec3, *, replace: bool,
                     file: str, launch_pid: int) -> str:
        """Spawn a model in our own simulator; see `SpawnObject.srv`.

        Raises ToolError: it failed or did not respond.
        """
        return self._call_service("spawn_object", "SpawnObject", model_name=name, model_xml=xml,
                                  initial_pose=pose_message(Pose(position, quat_from_rpy(*rpy))),
                                  replace=replace, file=file, launch_pid=launch_pid)

    def delete(self, name: str) -> str:
        """Delete a model; returns the status message.

        Raises ToolError: it failed or did not respond.
        """
        return self._call_service("delete_model", "DeleteModel", model_name=name)

    def model_state(self, name: str) -> Any:
        """A `GetModelState` response in the world frame, None if the model does not exist."""
        answer = self._call("get_model_state", "GetModelState", model_name=name)
        return answer if answer.success else None

    def set_model_pose(self, name: str, pose: Pose) -> None:
        """Set the pose of a model in the world frame, with zero twist.

        Raises ToolError: it failed or did not respond.
        """
        from gazebo_msgs.msg import ModelState

        state = ModelState(model_name=name, pose=pose_message(pose), reference_frame="world")
        self._call_service("set_model_state", "SetModelState", model_state=state)

    @contextlib.contextmanager
    def paused(self) -> Iterator[None]:
        """Pause the world in the `with` block, unless it is paused or the simulator is Gazebo.

        Use in the main thread: the first SIGINT, SIGTERM or SIGHUP raises KeyboardInterrupt in the
        block. No further one, and none after the block, keeps the world paused. Raises ToolError:
        the simulator did not respond.
        """
        if not self.replaces or self._call("get_physics_properties", "GetPhysicsProperties").pause:
            yield
            return
        told: List[int] = []

        def interrupt(number: int, _frame: Any) -> None:
            told.append(number)
            if len(told) == 1:
                raise KeyboardInterrupt

        before = {number: signal.signal(number, interrupt) for number in _ENDING
                  if signal.getsignal(number) != signal.SIG_IGN}
        try:
            try:
                self._call("pause_physics", "Empty")
                yield
            finally:
                told.append(0)
        finally:
            self._call("unpause_physics", "Empty")
            for number, handler in before.items():
                signal.signal(number, handler)

    def _call_service(self, service: str, kind: str, **fields: Any) -> str:
        answer = self._call(service, kind, **fields)
        if not answer.success:
            raise ToolError(answer.status_message)
        return str(answer.status_message)

    def _call(self, service: str, kind: str, timeout: Optional[float] = None, **fields: Any) -> Any:
        """Call a service by the open connection, or a new one. Raises ToolError."""
        full = f"{self.name}/{service}"
        of_kind = _service_class(kind)

        def call() -> Any:
            if full not in self._connections:
                self._connections[full] = ServiceConnection(self._master, CALLER, full, of_kind)
            return self._connections[full](**fields)

        try:
            return call_with_deadline(timeout or self._timeout, f"service {full}", call)
        except CallTimeoutError as fault:
            raise ToolError(str(fault)) from fault
        except (ServiceCallError, OSError) as fault:
            if full in self._connections:
                self._connections.pop(full).close()
            raise ToolError(f"service {full} failed: {fault}; is the simulator still running?"
                            ) from fault


@functools.lru_cache(maxsize=None)
def _service_class(kind: str) -> Any:
    """The class of a service of the packages that a simulator offers."""
    package = {"Empty": "std_srvs", "SpawnObject": "my_simulations_msgs",
               "StepWorld": "my_simulations_msgs"}.get(kind, "gazebo_msgs")
    try:
        return service_class(package, kind)
    except ImportError as fault:
        raise ToolError(f"the ROS package {package} was not found; source the workspace's "
                        "devel/setup.bash") from fault


def pose_message(pose: Pose) -> Any:
    """The `geometry_msgs/Pose` of a pose."""
    from geometry_msgs.msg import Point, Quaternion
    from geometry_msgs.msg import Pose as PoseMessage

    return PoseMessage(position=Point(*pose.position), orientation=Quaternion(*pose.orientation))
