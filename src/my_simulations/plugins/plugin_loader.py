"""Finds the class of a plugin, and creates the plugin."""
from __future__ import annotations

from typing import Callable, Dict, Optional

from ..errors import Issue, warning
from ..simulator.entity import Entity
from .base import Plugin
from .call_watch import CallLimits
from .found_plugins import FoundPlugin, owner_text
from .isolated.isolated_plugin import IsolatedPlugin
from .isolated.plugin_process import PluginProcesses
from .missing_plugins import missing_plugin
from .registry import (
    PluginRegistry,
    UnknownPluginError,
    is_built_in,
    library_name,
    plugin_class,
)
from .running import RunningPlugin
from .without_effect import no_effect_note


class PluginLoader:
    """Finds the classes of plugins, and creates the plugins.

    Args:
        registry: finds the classes.
        log: receives a fault for each library that is unknown, once.
        limits: how long a call of a plugin in a process of its own may take.
        isolate: create each plugin that is not of this package in a process of its own.
        is_used: whether a plugin is loaded.
        take_turn: `take_turn(running, waited)` makes a turn while a plugin in a process of its
            own is busy, and waits at most `waited` seconds; see `NestedTurns.take_turn`.
    """

    def __init__(self, registry: PluginRegistry, log: Callable[[Issue], None], limits: CallLimits,
                 isolate: bool, is_used: Callable[[FoundPlugin], bool],
                 take_turn: Callable[[RunningPlugin, float], bool]) -> None:
        self._registry, self._log, self._limits = registry, log, limits
        self._is_used, self._take_turn = is_used, take_turn
        self._processes = PluginProcesses() if isolate else None
        self._reported: Dict[str, bool] = {}

    def locate(self, running: RunningPlugin, entity: Entity) -> Optional[str]:
        """Return where the class of a plugin is, for `create`.

        Returns None for a plugin that is not created, and sets its `note` or `fault` to the reason.
        """
        found = running.found
        if self._registry.is_provided(found.spec.filename):
            running.note = "the simulator itself has its functions"
            return None
        if not self._is_used(found):
            running.note = "the program does not use it"
            return None
        try:
            return self._registry.locate(found.spec.filename)
        except UnknownPluginError as unknown:
            note = no_effect_note(found.spec)
            running.note = note.message if note is not None else ""
            if note is None:
                running.fault = _unknown(found, entity, str(unknown))
            self._report_once(library_name(found.spec.filename), note or running.fault)
            return None

    def create(self, running: RunningPlugin, where: str) -> Plugin:
        """Create a plugin; one of a user runs in its own process if this loader isolates them.

        Raises what the import of its module and its constructor raise.
        """
        if self._processes is None or is_built_in(where):
            return plugin_class(where)(running.context)
        process = self._processes.start()
        running.end = process.end
        return IsolatedPlugin(running.context, where, process, self._limits,
                              lambda waited: self._take_turn(running, waited))

    def stop(self) -> None:
        if self._processes is not None:
            self._processes.stop()

    def _report_once(self, library: str, issue: Optional[Issue]) -> None:
        if issue is not None and library not in self._reported:
            self._reported[library] = True
            self._log(issue)


def _unknown(found: FoundPlugin, entity: Entity, text: str) -> Issue:
    return warning("plugin-unknown", f"{text}; '{found.spec.name}' of"
                   f" {owner_text(entity.model.name)} does nothing", file=found.spec.file,
                   line=found.spec.line,
                   hint=missing_plugin(library_name(found.spec.filename))[1])
