"""What the object tools need of ROS: parameters and services, each with a wall-clock deadline.

No rospy node is made here: a tool that only asks and ends needs no registration, and starts in a
fraction of the time.
"""
from __future__ import annotations

import argparse
import contextlib
import signal
import sys
import time
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

from ..errors import InputError, Issue, Severity, SimulationError
from ..geometry import Pose, Vec3, quat_from_rpy
from ..objects.object_list import ObjectList, parse_objects
from ..objects.selection import parse_groups
from ..objects.yaml_source import Source
from ..resources.package_files import PACKAGE
from ..ros.arguments import number
from ..ros.call_deadline import CallTimeoutError, within
from ..ros.lifecycle import master_api

OK, FAILED, USAGE = 0, 1, 2
TIMEOUT = 30.0
POLL_SECONDS = 0.05
LIST_SECONDS = 10.0
"""How long a list may take to appear once the simulator is there."""

OBJECTS = "/objects"
GROUPS = "/object_groups"
LIST_MARK = "/my_simulations/object_list"
"""Written last by the upload: world, file and package of the list that is loaded."""

CALLER = "/my_simulations_object_tool"


class ToolError(SimulationError):
    """The tool cannot go on; the text says what was waited for or asked, and what to do."""


def common_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options that all object tools have."""
    parser.add_argument("--timeout", type=seconds, default=TIMEOUT, metavar="SECONDS",
                        help="wall-clock limit of every wait (default %(default)g)")
    parser.add_argument("--gazebo-namespace", default="gazebo", metavar="NS",
                        help="name of the simulator node (default %(default)s)")


def seconds(text: str) -> float:
    """A positive finite number of seconds, for argparse."""
    value = number(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a positive number of seconds")
    return value


def plain_words(argv: Optional[Sequence[str]]) -> Tuple[List[str], List[str]]:
    """The command line without the program's name: (own words, ROS remappings)."""
    words = list(sys.argv if argv is None else argv)[1:]
    return ([word for word in words if ":=" not in word],
            [word for word in words if ":=" in word])


def run(name: str, work: Callable[[], int]) -> int:
    """Runs a tool; expected faults become one message and exit code 1."""
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
    """Prints faults, one a line, on standard error."""
    for issue in issues:
        print(issue, file=sys.stderr, flush=True)


def has_errors(issues: Sequence[Issue]) -> bool:
    """Whether any of them is an error."""
    return any(issue.severity is Severity.ERROR for issue in issues)


class Parameters:
    """The parameter server and the names registered at the master."""

    def __init__(self, remappings: Sequence[str] = ()) -> None:
        """Reaches the master.

        Raises:
            ToolError: there is none.
        """
        self.uri = master_api.uri(remappings)
        fault = master_api.fault_of(self.uri, CALLER)
        if fault:
            raise ToolError(f"no ROS master at {self.uri} ({fault}); start one with roscore or "
                            "roslaunch, or set ROS_MASTER_URI")

    def get(self, name: str) -> Any:
        """A parameter's value, None where it is not set."""
        return self._call("getParam", name)

    def set(self, name: str, value: Any) -> None:
        """Replaces a parameter, or the whole tree below it."""
        self._call("setParam", name, value)

    def delete(self, name: str) -> None:
        """Removes a parameter or tree; nothing happens where it is not set."""
        self._call("deleteParam", name)

    def service_is_there(self, name: str) -> bool:
        """Whether a node offers the service."""
        return bool(self._call("lookupService", name))

    def wait(self, condition: Callable[[], Any], limit: float, what: str, hint: str) -> Any:
        """Waits on the wall clock until the condition gives something true.

        Raises:
            ToolError: the time is over; the text names it, with `what` and `hint`.
        """
        until = time.monotonic() + limit
        while True:
            found = condition()
            if found:
                return found
            if time.monotonic() >= until:
                raise ToolError(f"{what} did not come within {limit:g} s; {hint}")
            time.sleep(POLL_SECONDS)

    def _call(self, method: str, *arguments: Any) -> Any:
        try:
            return master_api.call(self.uri, method, CALLER, *arguments)
        except OSError as fault:
            raise ToolError(f"the ROS master at {self.uri} does not answer any more ({fault}); "
                            "is roscore still up?") from fault


def full_name(name: str, remappings: Sequence[str]) -> str:
    """A name resolved in the namespace the tool was started in."""
    if name.startswith("/"):
        return name.rstrip("/")
    return master_api.node_name([word for word in remappings if word.startswith("__ns:=")], name)


class SimulatorClient:
    """The services of a running simulator, ours or a real Gazebo."""

    def __init__(self, parameters: Parameters, name: str, timeout: float) -> None:
        """Waits until the simulator `name` (a full node name) offers its services.

        Raises:
            ToolError: it does not within `timeout` seconds.
        """
        self.name = name
        self._timeout = timeout
        self._proxies: Dict[str, Any] = {}
        probe = f"{name}/get_world_properties"
        parameters.wait(lambda: parameters.service_is_there(probe), timeout,
                        f"the simulator (service {probe})",
                        "is the node running? roslaunch my_simulations my_world.launch starts it")
        self.replaces = parameters.get(f"{name}/my_simulations/version") is not None
        """Whether a spawn request may replace a model in one step."""

    def model_names(self) -> List[str]:
        """The models of the world."""
        answer = self._call("get_world_properties", "GetWorldProperties")
        return list(answer.model_names)

    def ask(self, service: str, kind: str, **fields: Any) -> Any:
        """The answer of a service of the node, of a class in gazebo_msgs or one of ours.

        Raises:
            ToolError: it is not offered or did not answer.
        """
        return self._call(service, kind, **fields)

    def spawn(self, name: str, xml: str, sdf: bool, position: Vec3, rpy: Vec3) -> str:
        """Puts a model into the world; the simulator's words.

        Raises:
            ToolError: it was refused or did not answer.
        """
        return self._checked("spawn_sdf_model" if sdf else "spawn_urdf_model", "SpawnModel",
                             model_name=name, model_xml=xml,
                             initial_pose=pose_message(Pose(position, quat_from_rpy(*rpy))))

    def delete(self, name: str) -> str:
        """Takes a model out of the world; the simulator's words.

        Raises:
            ToolError: it was refused or did not answer.
        """
        return self._checked("delete_model", "DeleteModel", model_name=name)

    def model_state(self, name: str) -> Any:
        """A `GetModelState` response in the world frame, None where there is no such model."""
        answer = self._call("get_model_state", "GetModelState", model_name=name)
        return answer if answer.success else None

    def place(self, name: str, pose: Pose) -> None:
        """Moves a model, at rest, to a pose in the world frame.

        Raises:
            ToolError: it was refused or did not answer.
        """
        from gazebo_msgs.msg import ModelState

        state = ModelState(model_name=name, pose=pose_message(pose), reference_frame="world")
        self._checked("set_model_state", "SetModelState", model_state=state)

    @contextlib.contextmanager
    def standing_still(self) -> Iterator[None]:
        """Lets time stand still meanwhile, where it runs and the simulator is ours.

        For the main thread: SIGTERM becomes a KeyboardInterrupt meanwhile.

        Raises:
            ToolError: the simulator did not answer.
        """
        if not self.replaces or self._call("get_physics_properties", "GetPhysicsProperties").pause:
            yield
            return
        # A request to end must not leave the world as it is meanwhile.
        before = signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            self._call("pause_physics", "Empty")
            yield
        finally:
            self._call("unpause_physics", "Empty")
            signal.signal(signal.SIGTERM, before)

    def _checked(self, service: str, kind: str, **fields: Any) -> str:
        answer = self._call(service, kind, **fields)
        if not answer.success:
            raise ToolError(answer.status_message)
        return str(answer.status_message)

    def _call(self, service: str, kind: str, **fields: Any) -> Any:
        import rospy

        full = f"{self.name}/{service}"
        if full not in self._proxies:
            self._proxies[full] = rospy.ServiceProxy(full, _service_class(kind), persistent=True)
        try:
            return within(self._timeout, f"service {full}", lambda: self._proxies[full](**fields))
        except CallTimeoutError as fault:
            raise ToolError(str(fault)) from fault
        except (rospy.ServiceException, rospy.ROSException, OSError) as fault:
            self._proxies.pop(full).close()
            raise ToolError(f"service {full} failed: {fault}; is the simulator still running?"
                            ) from fault


def _service_class(kind: str) -> Any:
    try:
        from gazebo_msgs import srv
        from std_srvs.srv import Empty
    except ImportError as fault:
        raise ToolError("the ROS package gazebo_msgs is not there; source the workspace's "
                        "devel/setup.bash first") from fault
    if kind == "Empty":
        return Empty
    if kind == "StepWorld":
        from my_simulations_msgs.srv import StepWorld

        return StepWorld
    return getattr(srv, kind)


def pose_message(pose: Pose) -> Any:
    """The `geometry_msgs/Pose` of a pose."""
    from geometry_msgs.msg import Point, Quaternion
    from geometry_msgs.msg import Pose as PoseMessage

    return PoseMessage(position=Point(*pose.position), orientation=Quaternion(*pose.orientation))


def read_list(parameters: Parameters, package: str, wait: float
              ) -> Tuple[Optional[ObjectList], Mapping[str, List[str]], List[Issue]]:
    """Reads the object list and the groups from the parameter server.

    Args:
        parameters: the parameter server.
        package: where a 2012 entry's file is looked for; "" for where the list came from.
        wait: wall seconds to wait for a list that is not there yet.

    Returns:
        The list (None where none is loaded), the members by group name, faults of the groups.
    """
    until = time.monotonic() + wait
    tree = parameters.get(OBJECTS)
    while tree is None and parameters.get(LIST_MARK) is None and time.monotonic() < until:
        time.sleep(POLL_SECONDS)
        tree = parameters.get(OBJECTS)
    if tree is None:
        # The mark is written after the list: look once more.
        tree = parameters.get(OBJECTS)
    listing = None if tree is None else parse_objects(
        tree, Source(OBJECTS), package or _package_of_list(parameters))
    groups, issues = parse_groups(parameters.get(GROUPS), Source(GROUPS))
    return listing, groups, issues


def _package_of_list(parameters: Parameters) -> str:
    mark = parameters.get(LIST_MARK)
    found = mark.get("package") if isinstance(mark, Mapping) else None
    return found if isinstance(found, str) and found else PACKAGE


def no_list(parameters: Parameters) -> str:
    """Why there is no object list, and what to do."""
    mark = parameters.get(LIST_MARK)
    if isinstance(mark, Mapping) and mark.get("world"):
        return (f"the world '{mark['world']}' has no object list in the package "
                f"'{mark.get('package') or PACKAGE}'; write "
                f"config/{mark['world']}/object_locations.yaml there and load it with "
                "roslaunch my_simulations upload_param.launch, or with package:=PACKAGE where it "
                "lies in another one")
    return (f"no objects are loaded to {OBJECTS}; load them with "
            "roslaunch my_simulations upload_param.launch")
