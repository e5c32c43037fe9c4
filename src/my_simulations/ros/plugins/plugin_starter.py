"""Starts the plugins' host when the first model with a plugin is there, and not before."""
from __future__ import annotations

import threading
from typing import Any, Callable, List, Mapping, Optional

from ...errors import Issue, warning
from ...simulator.simulator import Simulator

LOOK_SECONDS = 0.5
"""How soon the plugins of a model run that came in another way than by a service."""


class PluginStarter:
    """Knows the host, if there is one.

    Args:
        simulator: the world.
        log: hears of plugins that are unknown or fail.
        extra: the parameter `~plugins`: classes by library.
    """

    def __init__(self, simulator: Simulator, log: Callable[[Issue], None],
                 extra: Optional[Mapping[str, str]] = None) -> None:
        self._simulator, self._log, self._extra = simulator, log, dict(extra or {})
        self._lock = threading.Lock()
        self._host: Optional[Any] = None
        self._seen = -1
        self._ended = False

    def settle(self, model: str = "") -> List[Issue]:
        """Start the plugins of all models; return when they run.

        Cheap where no model has a plugin, and where nothing has changed.

        Returns:
            Why plugins of `model` do not work.
        """
        settled = self._settle()
        host = self._host
        faults: List[Issue] = host.faults(model) if host is not None and model else []
        if not settled:
            faults.append(warning("plugin-loading", "plugins are still being loaded"))
        return faults

    def _settle(self) -> bool:
        """Start the plugins; returns whether they all run, or were switched off."""
        models, world = self._simulator.models, self._simulator.world
        with self._lock:
            revision = models.revision
            if self._ended or revision == self._seen:
                return True
            self._seen = revision
            if self._host is None and not (
                    models.with_plugins()[1] or world.plugins
                    or any(actor.plugins for actor in world.actors)):
                return True
            host = self._begun()
        return bool(host.settle())

    def _begun(self) -> Any:
        """The host; started if it does not run. The world waits while it loads plugins."""
        if self._host is None:
            self._host = self._made()
            self._host.begin()
        return self._host

    def expect(self) -> None:
        """Start the host, before the first model with plugins comes (`SyncPoints.on_plugins`)."""
        with self._lock:
            if not self._ended:
                self._begun()

    def look(self) -> None:
        """Start the host if a model has come that needs it; for models from the editor."""
        if self._host is None:
            self.settle()

    def topic_uses(self) -> List[Any]:
        """The topics of all plugins (`plugins.graph.TopicUse`)."""
        return self._host.topic_uses() if self._host is not None else []

    def stop(self) -> None:
        """End all plugins."""
        with self._lock:
            self._ended = True
        if self._host is not None:
            self._host.stop()

    def _made(self) -> Any:
        from ...plugins.host import PluginHost
        from ...plugins.registry import PluginRegistry
        from ...resources.ros_packages import PackageIndex
        from .ros_graph import RosGraph

        return PluginHost(self._simulator, RosGraph(),
                          PluginRegistry(self._extra, PackageIndex().folders), self._log,
                          isolate=True)
