"""Runs the plugins of all models of a simulator, in one thread.

Plugins that only read follow the engine by its records (`observations.py`). For plugins that act
the engine waits at exact steps: their commands (motors, velocities) are sent to the engine
together; then the engine resumes. Messages are published after that, so the engine does not wait
for publishing.
"""
from __future__ import annotations

import contextlib
import threading
from collections import deque
from typing import Callable, Deque, Dict, List, Optional, Tuple

from ..errors import CommandError, Issue, error, warning
from ..simulator.entity import Entity
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator
from ..simulator.sync_points import SimTimeStep
from .barrier import Barrier
from .base import Plugin
from .call_watch import CALL_LIMITS, CallLimits, ThreadAbandoned
from .clock_changes import ClockChanges
from .command_sender import send_commands
from .found_plugins import FoundPlugin
from .graph import Graph, TopicUse
from .nested_turns import NestedTurns
from .observations import Observation, Observations, StepView
from .outgoing import Outgoing
from .plugin_faults import PluginGuard, describe_fault
from .plugin_loader import PluginLoader
from .plugin_state import PluginState
from .record_handover import RecordHandover
from .registry import PluginRegistry
from .running import ModelPlugins, RunningPlugin
from .schedule import Schedule, ScheduledCall
from .simulated_context import SharedServices, SimulatedContext
from .step_readings import StepReadings

_LOOK_S = 0.5      # between two checks while nothing wakes the thread
_LOADING_S = 120.0   # how long a caller waits for plugins to be loaded
_END_S = 2.0


class PluginHost:
    """Starts plugins with their models, calls them, and ends them.

    Attributes:
        barrier: waits for all that is due, in a world that makes no steps.

    Args:
        simulator: the world; started.
        graph: how plugins reach ROS.
        registry: finds their classes.
        log: receives the faults of plugins that are unknown or fail.
        limits: how long a call of a plugin may take; loading may compute twice as long.
        isolate: run each plugin that is not of this package in a process of its own.
        scene: casts rays and takes pictures; it is not closed. None for one of this host.
        is_used: whether a plugin is loaded.
    """

    def __init__(self, simulator: Simulator, graph: Graph, registry: PluginRegistry,
                 log: Callable[[Issue], None], limits: CallLimits = CALL_LIMITS,
                 isolate: bool = False, scene: Optional[SceneSensing] = None,
                 is_used: Callable[[FoundPlugin], bool] = lambda found: True) -> None:
        self._simulator, self._graph, self._log = simulator, graph, log
        self._has_scene = scene is None
        self._scene, self._schedule = scene or SceneSensing(simulator, log), Schedule()
        self._sync, self._observations = simulator.sync_points, Observations()
        view = StepView(simulator.states, simulator.feed.rows)
        self._records = RecordHandover(self._sync, self._observations, view, self._schedule)
        readings = StepReadings(simulator, self._schedule, view)
        self._shared = SharedServices(simulator, graph, log, self._scene, self._schedule, readings,
                              self._observations, view, self._request_subscriber_check)
        self.barrier = Barrier(self.wake)
        self._outgoing = Outgoing(graph, self.wake)
        self._models = ModelPlugins(simulator, self._rebind)
        self._running: Dict[SimulatedContext, RunningPlugin] = {}
        # Plugins with received messages or requests, and plugins with commands or messages to send.
        self._with_input: Deque[RunningPlugin] = deque()
        self._with_output: Dict[SimulatedContext, RunningPlugin] = {}
        self._due: Deque[ScheduledCall] = deque()
        self._revision = self._seen_revision = -1   # of the loaded models, and of the last turn
        self._clock_changes = ClockChanges(simulator.resets)
        self._loaded = threading.Condition()
        self._stop = threading.Event()
        self._was_stepped_manually = simulator.clock.is_stepped_manually
        self._delivering = False     # input was handed over, and its commands are not sent yet
        self._settings: Optional[int] = None
        self._limits = limits
        self._loader = PluginLoader(
            registry, log, limits, isolate, is_used,
            lambda running, waited: self._nested_turns.take_turn(running, waited))
        self._guard = PluginGuard(log, limits, self._mark_output, self._abandon_thread)
        self._overdue: Deque[Tuple[RunningPlugin, str]] = deque()
        self._turns = 0
        self._nested_turns = self._new_nested_turns()
        self._thread = self._new_thread()

    def _new_thread(self) -> threading.Thread:
        return threading.Thread(target=self._run, name="plugins", daemon=True)

    def _new_nested_turns(self) -> NestedTurns:
        return NestedTurns(
            lambda: self._guard.run_inside(self._guarded_turn), self._sync.wait,
            lambda: self._simulator.clock.is_stepped_manually,
            lambda running: running.context in self._running, self._resume)

    def start(self) -> None:
        """Begin; returns when the plugins of all present models are loaded."""
        self.begin()
        self.wait_until_loaded()

    def begin(self) -> None:
        """Begin; from now on the world makes no step while plugins of new models are loaded.

        Raises CommandError for a second host.
        """
        self._sync.attach(self._deliver_all)
        self._thread.start()

    def wait_until_loaded(self) -> bool:
        """Wait until the plugins of all models that are in the world now are loaded.

        Returns whether that happened within `_LOADING_S`.
        """
        wanted = self._simulator.models.revision
        self.wake()
        with self._loaded:
            return self._loaded.wait_for(
                lambda: self._revision >= wanted or self._stop.is_set(), _LOADING_S)

    def faults(self, model: str) -> List[Issue]:
        """Return the faults of the plugins of a model; from any thread."""
        return [one.fault for one in self._models.plugins_of(model) if one.fault is not None]

    def states(self) -> List[PluginState]:
        """Return the states of all plugins; from any thread."""
        return self._models.states()

    def wake(self) -> None:
        """Wake the plugins' thread, which then checks for changes."""
        self._sync.notify()

    def _request_subscriber_check(self) -> None:
        """Make the plugins' thread check the topics for subscribers; from any thread."""
        self._observations.changed = True
        self.wake()

    def stop(self) -> None:
        self._stop.set()
        self.wake()
        if self._thread.is_alive():
            self._thread.join(_END_S)

    def topic_uses(self) -> List[TopicUse]:
        """Return the topics of all plugins; from any thread."""
        return [use for running in self._models.all() for use in running.context.topic_uses()]

    @property
    def has_pending_input(self) -> bool:
        """Whether a received message or request is not applied yet."""
        return self._delivering or self._observations.changed or (
            self._seen_revision != self._simulator.models.revision) or any(
            running.context.inbox for running in self._models.all() if not running.is_busy)

    def _deliver_all(self) -> None:
        """Wait until all received messages and requests are handed over and applied."""
        if self._was_stepped_manually != self._simulator.clock.is_stepped_manually:
            self._request_subscriber_check()
        elif self._seen_revision != self._simulator.models.revision:
            self.wake()
        with self._loaded:
            self._loaded.wait_for(lambda: not self.has_pending_input or self._stop.is_set(),
                                  _LOADING_S)

    def _is_quiet(self) -> bool:
        """Return whether all scans, pictures and messages that are due are published."""
        return self._settings is not None and not (
            self.has_pending_input or self._with_input or self._with_output or self._due
            or self._sync.records.first() is not None
            or any(running.context.sensing.is_pending for running in self._models.all()))

    # -- the thread --------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while not self._stop.is_set():
                self._guarded_turn()
                self.barrier.answer_if_quiet(self._is_quiet)
                self._wait_for_wake()
            self._models.end_all()
            self._end_removed()
        except ThreadAbandoned:
            return  # another thread has taken over
        except BaseException:
            self._clean_up()
            raise
        self._clean_up()

    def _guarded_turn(self) -> None:
        try:
            self._turn()
        except CommandError as fault:  # the engine is being replaced, or the world ends
            self._log(warning("plugin-turn", f"plugins missed their turn: {fault}"))
            self._end_deliveries(loaded=False)
        except Exception as fault:  # a defect here must not end the plugins of all models
            self._log(error("plugin-turn", f"plugins missed their turn: {describe_fault(fault)}"))
            self._end_deliveries(loaded=False)

    def _clean_up(self) -> None:
        self._stop.set()
        self._guard.stop()
        self._loader.stop()
        if self._has_scene:
            self._scene.close()
        self._outgoing.stop()
        self._sync.detach()
        self.barrier.end()
        with self._loaded:
            self._loaded.notify_all()

    def _abandon_thread(self, running: RunningPlugin, why: str) -> None:
        """Abandon a thread that does not return from a plugin; called by the watch."""
        running.plugin = None
        self._overdue += [(one, why) for one in (running, *self._nested_turns.busy)]
        self._nested_turns = self._new_nested_turns()
        self._thread = self._new_thread()
        self._thread.start()

    def _wait_for_wake(self) -> None:
        if not self._sync.wait(_LOOK_S):
            self._observations.changed = True   # graphs need not report subscribers

    def _turn(self) -> None:
        """Read the state of the world once, and make the calls that are due."""
        while self._overdue:
            running, why = self._overdue.popleft()
            self._guard.switch_off(running, f"{why}; its thread was left behind")
        if self._was_stepped_manually != self._simulator.clock.is_stepped_manually:
            self._was_stepped_manually = not self._was_stepped_manually
            self._observations.changed = True
        settings, time_step = self._sync.settings, self._sync.now()
        if self._settings is None and not self._sync.waits_at(time_step):
            return   # until the engine has stopped, for the first time
        turn = self._turns = self._turns + 1
        for act in (self._take_records, self._finish_changes, self._notice_resets,
                    self._deliver_input, self._serve):
            act(settings, time_step)
            if self._turns != turn:   # a nested turn: these values are old
                self.wake()
                return
        self._scene.send()
        if self._with_output:
            self._send_commands()
        self._go_on(settings)
        self._end_deliveries(loaded=True)
        if self._with_output:
            self._publish()

    def _end_deliveries(self, loaded: bool) -> None:
        with self._loaded:
            self._delivering = False
            if loaded and not self._nested_turns.busy:
                self._revision = self._models.revision
            self._loaded.notify_all()

    def _take_records(self, _settings: int, _time_step: SimTimeStep) -> None:
        self._records.hand_over(self._hand_over)

    def _hand_over(self, observation: Observation) -> None:
        running = self._running.get(observation.owner)
        if running is not None and running.is_callable:
            time_step = self._schedule.time_step
            assert time_step is not None   # that of the record
            self._guard.call(running, observation.call, time_step)

    def _finish_changes(self, settings: int, _time_step: SimTimeStep) -> None:
        if settings != self._settings:
            self._sync.await_model_changes()
        self._follow_models()
        if self._seen_revision != self._models.revision:
            self._seen_revision = self._models.revision
            for running in self._at_work():
                for call in running.context.world_change_calls:
                    self._call_now_or_later(running, call)

    def _at_work(self) -> List[RunningPlugin]:
        return [one for one in self._models.all() if one.plugin is not None]

    def _serve(self, _settings: int, time_step: SimTimeStep) -> None:
        """Make the calls that are due."""
        if not self._sync.waits_at(time_step):
            return
        self._due += self._schedule.take_due()
        while self._due:
            scheduled = self._due.popleft()
            running = self._running.get(scheduled.owner)
            if running is None or running.plugin is None or scheduled.ended:
                continue
            if scheduled.single:
                scheduled.end()
                self._call_now_or_later(running, scheduled.call)
            elif not running.is_busy:
                self._guard.call(running, scheduled.call)

    def _call_now_or_later(self, running: RunningPlugin, call: Callable[[], None]) -> None:
        """Call a function of a plugin; if the plugin is busy, after its present call."""
        if running.is_busy:
            running.context.inbox.append(call)
        else:
            self._guard.call(running, call)

    def _resume(self, running: RunningPlugin) -> None:
        """Process the inbox and the commands of a plugin after its present call."""
        self._mark_output(running)
        if running.context.inbox:
            self._with_input.append(running)   # without a notice, which would end the next wait

    def _send_commands(self) -> None:
        """Send the commands of plugins for the present models to the engine, in one command."""
        while not self._stop.is_set() and not send_commands(
                self._simulator, list(self._with_output), self._models.revision):
            self._follow_models()

    def _go_on(self, settings: int) -> None:
        """Let the engine run to the next step at which a plugin acts."""
        if self._settings is None:
            self._schedule.reschedule(was_set_back=False)
        if settings != self._settings or self._observations.changed:
            rules = self._observations.new_rules(self._graph.transforms_wanted,
                                                 settings != self._settings)
            if rules is not None:
                self._sync.set_rules(rules)
        self._sync.allow(settings, self._schedule.next_step)
        self._settings = settings

    def _publish(self) -> None:
        waiting, self._with_output = self._with_output, {}
        self._outgoing.send(waiting, self._guard.send, self._fault_handler)

    def _mark_input(self, running: RunningPlugin) -> None:
        """Wake the plugins' thread to process the inbox of a plugin."""
        self._with_input.append(running)
        self.wake()

    def _fault_handler(self, running: RunningPlugin) -> Callable[[Exception], None]:
        """Return a function that passes an exception of another thread to the plugins' thread."""
        def fail(fault: Exception) -> None:
            def again() -> None:
                raise fault

            running.context.inbox.append(again)
            self._mark_input(running)
        return fail

    def _deliver_input(self, _settings: int, _time_step: SimTimeStep) -> None:
        while self._with_input:
            self._delivering = True
            self._deliver(self._with_input.popleft())

    def _deliver(self, running: RunningPlugin) -> None:
        inbox = running.context.inbox
        while inbox and not running.is_busy:
            call = inbox.popleft()
            if running.plugin is not None:   # else it was switched off: nothing waits for this
                self._guard.call(running, call)

    def _notice_resets(self, _settings: int, time_step: SimTimeStep) -> None:
        """Notify plugins of resets and of sim time that was set back."""
        self._schedule.set_time_step(time_step)
        change = self._clock_changes.since_last(time_step)
        if change.is_clock_set:
            self._schedule.reschedule(change.is_set_back)
            self._observations.begin_all(time_step)
            for running in self._at_work():
                running.context.sensing.discard_pending()
        for notice in change.notices:
            for running in self._at_work():
                if running.plugin is not None:
                    self._call_now_or_later(running, getattr(running.plugin, notice))

    # -- models ------------------------------------------------------------------------------------

    def _follow_models(self) -> None:
        """Start and end plugins with their models."""
        while True:
            self._models.update()
            self._end_removed()
            found = self._models.next_to_load()
            if found is None:
                return
            self._load(*found)  # which may change models

    def _rebind(self, running: RunningPlugin, entity: Entity) -> None:
        if running.plugin is not None:
            self._guard.call(running, running.context.bind, entity)

    def _load(self, entity: Entity, into: List[RunningPlugin], found: FoundPlugin) -> None:
        context = SimulatedContext(self._shared, entity, found, lambda: self._mark_input(running))
        running = self._running[context] = RunningPlugin(found, context, None)
        into.append(running)
        where = self._loader.locate(running, entity)
        if where is None:
            return
        made: List[Plugin] = []
        limits = self._limits.doubled()
        if not self._guard.call(running, lambda: made.append(self._loader.create(running, where)),
                                limits=limits):
            return
        running.plugin = made[0]
        self._schedule.set_time_step(self._sync.now())
        self._guard.call(running, running.plugin.load, limits=limits)

    def _end_removed(self) -> None:
        leaving = self._models.removed
        while leaving:
            running = leaving.popleft()
            if running.plugin is not None and not running.is_busy:
                self._guard.call(running, running.plugin.close)
            context = running.context
            context.close()
            with contextlib.suppress(CommandError):  # the engine ends as well
                context.release()
            running.plugin = None
            running.end()
            del self._running[context]
            self._with_output.pop(context, None)

    def _mark_output(self, running: RunningPlugin) -> None:
        """Mark a plugin so that its commands and messages are collected."""
        if running.context in self._running:
            self._with_output[running.context] = running
