"""Starts the plugins' host with the first model that has a plugin."""
from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Callable, List, Optional

from ..errors import Issue, warning
from ..simulator.simulator import Simulator
from .plugin_state import PluginState

if TYPE_CHECKING:
    from .host import PluginHost


class HostStarter:
    """Stores the host, if there is one.

    Args:
        simulator: the world.
        make: makes the host; it imports what plugins need.
    """

    def __init__(self, simulator: Simulator, make: Callable[[], PluginHost]) -> None:
        self._simulator, self._make = simulator, make
        self._lock = threading.Lock()
        self._host: Optional[PluginHost] = None
        self._seen_revision = -1
        self._ended = False

    @property
    def host(self) -> Optional[PluginHost]:
        """The host; None before the first model with a plugin."""
        return self._host

    def wait_until_published(self, seconds: float) -> bool:
        """Wait until plugins have published all that is due, s of wall time; False if not yet."""
        host = self._host
        return host is None or host.barrier.wait(seconds)

    def wait_until_loaded(self, model: str = "") -> List[Issue]:
        """Start the plugins of all models; return when they run.

        Cheap where no model has a plugin, and where nothing has changed.

        Returns:
            Why plugins of `model` do not work.
        """
        loaded = self._start_all()
        host = self._host
        faults: List[Issue] = host.faults(model) if host is not None and model else []
        if not loaded:
            faults.append(warning("plugin-loading", "plugins are still being loaded"))
        return faults

    def _start_all(self) -> bool:
        """Start the plugins; returns whether they all run, or were switched off."""
        models, world = self._simulator.models, self._simulator.world
        with self._lock:
            revision = models.revision
            if self._ended or revision == self._seen_revision:
                return True
            self._seen_revision = revision
            if self._host is None and not (
                    models.entities_with_plugins()[1] or world.plugins
                    or any(actor.plugins for actor in world.actors)):
                return True
            host = self._begin_host()
        return host.wait_until_loaded()

    def _begin_host(self) -> PluginHost:
        """The host; started if it does not run. The world waits while it loads plugins."""
        if self._host is None:
            self._host = self._make()
            self._host.begin()
        return self._host

    def start_early(self) -> None:
        """Start the host before the first model with plugins is added (`SyncPoints.on_plugins`)."""
        with self._lock:
            if not self._ended:
                self._begin_host()

    def start_if_needed(self) -> None:
        """Start the host if a model has come that needs it; for models from the editor."""
        if self._host is None:
            self.wait_until_loaded()

    def topic_uses(self) -> List[Any]:
        """The topics of all plugins (`plugins.graph.TopicUse`)."""
        return self._host.topic_uses() if self._host is not None else []

    def states(self) -> List[PluginState]:
        return self._host.states() if self._host is not None else []

    def stop(self) -> None:
        with self._lock:
            self._ended = True
        if self._host is not None:
            self._host.stop()
