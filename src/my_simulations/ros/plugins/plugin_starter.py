"""Starts the plugins' host of the node when the first model with a plugin is there."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Mapping, Optional

from ...errors import Issue
from ...plugins.host_starter import HostStarter
from ...simulator.simulator import Simulator

if TYPE_CHECKING:
    from ...plugins.host import PluginHost

LOOK_SECONDS = 0.5
"""How soon the plugins of a model run that came in another way than by a service."""


class PluginStarter(HostStarter):
    """Stores the host, if there is one.

    Args:
        simulator: the world.
        log: hears of plugins that are unknown or fail.
        extra: the parameter `~plugins`: classes by library.
    """

    def __init__(self, simulator: Simulator, log: Callable[[Issue], None],
                 extra: Optional[Mapping[str, str]] = None) -> None:
        classes = dict(extra or {})

        def make() -> PluginHost:
            from ...plugins.host import PluginHost
            from ...plugins.registry import PluginRegistry
            from ...resources.ros_packages import PackageIndex
            from .ros_graph import RosGraph

            return PluginHost(simulator, RosGraph(),
                              PluginRegistry(classes, PackageIndex().folders), log, isolate=True)

        super().__init__(simulator, make)
