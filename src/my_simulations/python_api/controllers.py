"""Controllers of ros_control in an open world, by the services of their controller manager."""
from __future__ import annotations

import os
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Sequence, Tuple, Union

from ..errors import CommandError, Issue
from .robots import Robots

_MANAGER = "/controller_manager/"
_STRICT = 2

Parameters = Union[Mapping[str, Any], str, "os.PathLike[str]"]
"""Parameters by name, or the path of a YAML file of them."""


class ControllerReading(NamedTuple):
    """A loaded controller.

    Attributes:
        type: such as `effort_controllers/JointPositionController`.
        state: `running`, `stopped` or `initialized`.
        joints: that it drives while it runs.
    """

    type: str
    state: str
    joints: Tuple[str, ...]


def read_parameters(source: Parameters) -> Mapping[str, Any]:
    """Return parameters that are given as a mapping, or as a YAML file.

    Raises CommandError: the file cannot be read, or is no mapping.
    """
    if isinstance(source, Mapping):
        return source
    import yaml

    if not isinstance(source, (str, os.PathLike)):
        raise CommandError(f"parameters are a dictionary or a YAML file, not {source!r}")
    path = os.fspath(source)
    try:
        with open(path, encoding="utf-8") as stream:
            found = yaml.safe_load(stream)
    except (OSError, yaml.YAMLError, UnicodeDecodeError) as fault:
        raise CommandError(f"the parameters cannot be read: {path}: {fault}") from fault
    if not isinstance(found, dict):
        raise CommandError(f"{path} must contain parameters by name")
    return found


class Controllers:
    """The controllers of the robots with libgazebo_ros_control.so.

    `robot` is the namespace of a robot's controller manager, usually the name of its model; it can
    be left out if only one robot has a manager. Methods raise CommandError with the reason if the
    manager refuses. A reset of the world unloads all controllers.

    Args:
        robots: of the world.
        issues: those of the world, which give the reasons of refusals.
    """

    def __init__(self, robots: Robots, issues: Callable[[], List[Issue]]) -> None:
        self._robots, self._issues = robots, issues

    def load(self, name: str, parameters: Parameters = {},  # noqa: B006
             robot: str = "") -> None:
        """Load a controller.

        Args:
            name: of the controller.
            parameters: set below its name before; none if they are set already.
            robot: see the class.
        """
        namespace = self._namespace(robot)
        found = read_parameters(parameters)
        if found:
            self._robots.graph.parameters.set(f"{namespace}/{name}", found)
        self._call_manager(namespace, "load_controller", {"name": name})

    def start(self, *names: str, robot: str = "") -> None:
        self.switch(names, (), robot)

    def stop(self, *names: str, robot: str = "") -> None:
        self.switch((), names, robot)

    def switch(self, start: Sequence[str], stop: Sequence[str], robot: str = "") -> None:
        """Stop some controllers and start others at the same step."""
        self._call_manager(self._namespace(robot), "switch_controller", {
            "start_controllers": list(start), "stop_controllers": list(stop),
            "strictness": _STRICT})

    def unload(self, name: str, robot: str = "") -> None:
        """Unload a controller that does not run."""
        self._call_manager(self._namespace(robot), "unload_controller", {"name": name})

    def states(self, robot: str = "") -> Dict[str, ControllerReading]:
        """The loaded controllers, by name."""
        response: Any = self._robots.call(
            f"{self._namespace(robot)}{_MANAGER}list_controllers", {})
        return {one.name: ControllerReading(one.type, one.state, tuple(
            joint for used in one.claimed_resources for joint in used.resources))
            for one in response.controller}

    def _namespace(self, robot: str) -> str:
        end = f"{_MANAGER}load_controller"
        found = [name[:-len(end)] for name in self._robots.services() if name.endswith(end)]
        name = robot.strip("/")
        wanted = f"/{name}" if name else ""   # "/" is the namespace of the node
        if robot:
            found = [one for one in found if one == wanted]
        if len(found) == 1:
            return found[0]
        if robot or not found:
            raise CommandError(f"no robot{f' {robot!r}' if robot else ''} has a controller manager"
                               " (the plugin libgazebo_ros_control.so)")
        raise CommandError("several robots have a controller manager, name one of them:"
                           f" {', '.join(one or '/' for one in found)}")

    def _call_manager(self, namespace: str, service: str, request: Mapping[str, Any]) -> None:
        known = len(self._issues())
        response: Any = self._robots.call(f"{namespace}{_MANAGER}{service}", request)
        if not response.ok:
            reasons = [issue.message for issue in self._issues()[known:]]
            raise CommandError("; ".join(reasons) or f"{service} was refused")
