"""The plugins and sensors of the robots in an open world."""
from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Union

from ..errors import CommandError, Issue
from ..resources.ros_packages import PackageIndex
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator
from .plain_values import name_of

if TYPE_CHECKING:
    from ..messages.message_types import Message
    from ..plugins.host import PluginHost
    from ..plugins.host_starter import HostStarter
    from ..plugins.local_graph import LocalGraph
    from .topics import Topics

Plugins = Union[bool, Mapping[str, str]]
"""Whether plugins run; or further classes of plugins, by library."""

_FINISH_S = 120.0  # of wall time, for all that is due after a step


class RobotOptions(NamedTuple):
    """What runs in an open world besides the physics.

    Attributes:
        plugins: whether plugins run.
        sensors: whether the plugins of `<sensor>` elements run, too.
        classes: further classes of plugins as `package.module:Class`, by library.
        parameters: of plugins and controllers, as on ROS's parameter server.
        isolate: run each plugin that is not of this package in a process of its own.
    """

    plugins: bool = True
    sensors: bool = True
    classes: Mapping[str, str] = {}
    parameters: Mapping[str, Any] = {}
    isolate: bool = False


def classes_of(plugins: Plugins) -> Mapping[str, str]:
    """Return the further classes of plugins, by library. Raises CommandError."""
    if isinstance(plugins, bool):
        return {}
    if not isinstance(plugins, Mapping):
        raise CommandError("plugins are True, False or a dictionary of classes by library, not"
                           f" {plugins!r}")
    return dict(plugins)


class Robots:
    """Runs the plugins of one simulator after another; costs nothing without plugins.

    Args:
        options: what runs.
        log: receives issues of plugins.
        advance: makes steps in the world.
        step_size: of the world, s.
    """

    def __init__(self, options: RobotOptions, log: Callable[[Issue], None],
                 advance: Callable[[int], None], step_size: Callable[[], float]) -> None:
        self._options, self._report = options, log
        self._issues: List[Issue] = []
        self._advance, self._step_size = advance, step_size
        self._simulator: Optional[Simulator] = None
        self._scene: Optional[SceneSensing] = None
        self._starter: Optional[HostStarter] = None
        self._graph: Optional[LocalGraph] = None
        self._topics: Optional[Topics] = None

    @property
    def graph(self) -> LocalGraph:
        """Topics, services and parameters."""
        if self._graph is None:
            from ..plugins.local_graph import LocalGraph
            from ..plugins.local_parameters import LocalParameters

            self._graph = LocalGraph(LocalParameters(self._options.parameters),
                                     PackageIndex().find)
        return self._graph

    @property
    def topics(self) -> Topics:
        if self._topics is None:
            from .topics import Topics

            self._topics = Topics(self.graph, self._advance, self._step_size,
                                  self.wait_until_loaded, self.explain_silence)
        return self._topics

    # -- life --------------------------------------------------------------------------------------

    def begin(self, simulator: Simulator) -> None:
        """Run the plugins of a simulator that is stepped manually."""
        self._issues.clear()
        if not self._options.plugins:
            return
        from ..plugins.host_starter import HostStarter

        if simulator is not self._simulator:
            self._close_scene()
            self._simulator, self._scene = simulator, SceneSensing(simulator, self._log)
        starter = self._starter = HostStarter(simulator, self._new_host)
        simulator.sync_points.on_plugins(starter.start_early)
        with contextlib.nullcontext() if self._graph is None else self._graph.suspended():
            self.wait_until_loaded()

    def end(self) -> None:
        """End all plugins; the messages that have arrived are removed."""
        if self._starter is not None:
            self._starter.stop()
            self._starter = None
        if self._graph is not None:
            self._graph.end_transforms()
        if self._topics is not None:
            self._topics.forget()

    def close(self) -> None:
        """End the plugins, and the process of the sensors."""
        self.end()
        self._close_scene()

    def wait_until_loaded(self) -> None:
        """Have the plugins of all models run; returns when they are loaded."""
        if self._starter is not None:
            for issue in self._starter.wait_until_loaded():
                self._log(issue)

    def finish(self) -> None:
        """Wait until all that is due after the last step has arrived.

        Raises CommandError: a plugin or sensor needs too long.
        """
        if self._starter is not None and not self._starter.wait_until_published(_FINISH_S):
            raise CommandError(f"plugins or sensors have not finished within {_FINISH_S:g} s")

    # -- exchange ----------------------------------------------------------------------------------

    def publish(self, topic: str, message: Any) -> None:
        """Send a message to the plugins. Raises CommandError."""
        self._require_plugins()
        self.wait_until_loaded()
        self.graph.publish_once(name_of(topic, "the name of a topic"), message)

    def call(self, service: str, request: Any) -> Message:
        """Ask a service of a plugin. Raises CommandError."""
        self._require_plugins()
        self.wait_until_loaded()
        return self.graph.call(name_of(service, "the name of a service"), request)

    def services(self) -> Dict[str, str]:
        """The types of the services by name."""
        self.wait_until_loaded()
        return self.graph.services()

    def explain_silence(self) -> str:
        """Why plugins may not publish, to be appended to a message; "" if nothing is known."""
        if not self._options.plugins:
            return " (the world was opened with plugins=False)"
        if self._issues:
            more = len(self._issues) - 1
            rest = f", and {more} more in world.issues" if more else ""
            return f" (plugins reported: {self._issues[0]}{rest})"
        return "" if self._options.sensors else " (the world was opened with sensors=False)"

    # -- inside ------------------------------------------------------------------------------------

    def _log(self, issue: Issue) -> None:
        self._issues.append(issue)
        self._report(issue)

    def _require_plugins(self) -> None:
        if not self._options.plugins:
            raise CommandError("plugins do not run: the world was opened with plugins=False")

    def _close_scene(self) -> None:
        if self._scene is not None:
            self._scene.close()
            self._scene = self._simulator = None

    def _new_host(self) -> PluginHost:
        from ..plugins.host import PluginHost
        from ..plugins.registry import PluginRegistry

        assert self._simulator is not None
        sensors = self._options.sensors
        return PluginHost(self._simulator, self.graph,
                          PluginRegistry(self._options.classes, PackageIndex().folders),
                          self._log, scene=self._scene, isolate=self._options.isolate,
                          is_used=lambda found: sensors or found.sensor is None)
