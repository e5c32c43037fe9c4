"""Runs the plugins of all models of a simulator, in one thread.

The host has appointments with the engine: while it works, the world stands at a step. What plugins
order (motors, velocities) is sent to the engine in one command; then the engine goes on, and only
then messages are published, so that publishing costs no sim time.
"""
from __future__ import annotations

import contextlib
import threading
import traceback
from collections import deque
from typing import Any, Callable, Deque, Dict, Iterable, List, Optional, Tuple

from ..description.model import WORLD, Model
from ..engine.commands import JointMotor, JointServo, PlanarVelocity
from ..errors import CommandError, Issue, Severity, warning
from ..geometry import IDENTITY
from ..simulator.appointments import Consumer, Moment
from ..simulator.registry import Entity
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator
from .call_watch import PATIENCE, CallOverdue, CallWatch, Patience
from .context import PluginError
from .graph import Graph, Topic, TopicUse
from .message_maker import Later, MessageMaker
from .registry import PluginRegistry, UnknownPluginError, library_name
from .running import Found, Running, plugins_of
from .simulated_context import SimulatedContext

_LOOK_S = 0.5      # between two looks while nothing rings
_SETTLE_S = 30.0   # how long a caller waits for plugins to be loaded
_END_S = 2.0

WORLD_SCOPE = ""
"""Stands for the world among the names of models."""


class PluginHost:
    """Starts plugins with their models, calls them, and ends them.

    Args:
        simulator: the world; started.
        graph: how plugins reach ROS.
        registry: finds their classes.
        log: hears of plugins that are unknown or fail.
        patience: how long a call of a plugin may take; loading may take five times as long.
    """

    def __init__(self, simulator: Simulator, graph: Graph, registry: PluginRegistry,
                 log: Callable[[Issue], None], patience: Patience = PATIENCE) -> None:
        self._simulator, self._graph, self._registry, self._log = simulator, graph, registry, log
        self._scene_sensing = SceneSensing(simulator, log)
        self._messages = MessageMaker()
        self._models: Dict[str, Tuple[Entity, List[Running]]] = {}
        self._told: Dict[str, bool] = {}
        self._revision = self._followed = -1
        self._world_resets = simulator.resets.world_resets
        self._simulation_resets = simulator.resets.simulation_resets
        self._settled = threading.Condition()
        self._stop = threading.Event()
        self._consumer: Optional[Consumer] = None
        self._wake = threading.Event()
        self._moment: Optional[Moment] = None
        self._patience = patience
        self._watch = CallWatch(self._go_on_without)
        self._to_load: Deque[Tuple[str, Found]] = deque()
        self._leaving: Deque[Running] = deque()
        self._overdue: Deque[Tuple[Running, str]] = deque()
        self._thread = self._new_thread()

    def _new_thread(self) -> threading.Thread:
        return threading.Thread(target=self._run, name="plugins", daemon=True)

    def start(self) -> None:
        """Begin; returns when the plugins of all present models are loaded."""
        self._thread.start()
        self.settle()

    def settle(self) -> None:
        """Wait until the plugins of all models that are in the world now are loaded."""
        wanted = self._simulator.models.revision
        self.wake()
        with self._settled:
            self._settled.wait_for(lambda: self._revision >= wanted or self._stop.is_set(),
                                   _SETTLE_S)

    def wake(self) -> None:
        """Have the thread look at what has changed."""
        consumer = self._consumer
        if consumer is not None:
            consumer.rung.set()
        self._wake.set()

    def stop(self) -> None:
        """End all plugins."""
        self._stop.set()
        self.wake()
        if self._thread.is_alive():
            self._thread.join(_END_S)

    def topic_uses(self) -> List[TopicUse]:
        """The topics of all plugins; from any thread."""
        return [use for _, all_running in list(self._models.values())
                for running in list(all_running) for use in running.context.topic_uses()]

    # -- the thread --------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while not self._stop.is_set():
                try:
                    self._turn()
                except CommandError as fault:  # the engine is being replaced, or the world ends
                    self._log(warning("plugin-turn", f"plugins missed their turn: {fault}"))
                self._rest()
            for name in list(self._models):
                self._end_model(name)
            self._end_leaving()
        except CallOverdue:
            return  # this thread was left behind; another one goes on
        finally:
            if threading.current_thread() is self._thread:
                self._clean_up()

    def _clean_up(self) -> None:
        self._stop.set()
        self._watch.stop()
        self._scene_sensing.close()
        self._messages.stop()
        if self._consumer is not None:
            self._consumer.leave()
            self._consumer = None
        with self._settled:
            self._settled.notify_all()

    def _go_on_without(self, running: Running, why: str) -> None:
        """Leave a thread behind that does not come back from a plugin; comes from the watch."""
        running.plugin = None
        self._overdue.append((running, why))
        self._thread = self._new_thread()
        self._thread.start()

    def _rest(self) -> None:
        if self._consumer is not None:
            self._consumer.wait(_LOOK_S)
        else:
            self._wake.wait(_LOOK_S)
            self._wake.clear()

    def _turn(self) -> None:
        """Look at the world once, and do what is due."""
        while self._overdue:
            running, why = self._overdue.popleft()
            self._switch_off(running, f"{why}; its thread was left behind")
        self._follow_models()
        moment = self._now()
        self._notice_resets(moment)
        for running in self._all():
            self._deliver(running)
        self._serve(moment)
        self._give_orders()
        self._go_on(moment)
        self._publish(moment)
        with self._settled:
            self._revision = self._followed
            self._settled.notify_all()

    def _now(self) -> Moment:
        moment = self._simulator.appointments.now()
        for running in self._all():
            running.context.moment = moment
        return moment

    def _all(self) -> List[Running]:
        return [one for _, running in self._models.values() for one in running
                if one.plugin is not None]

    def _serve(self, moment: Moment) -> None:
        """Call whose appointment it is."""
        for running in self._all():
            for appointment in list(running.context.appointments):
                if moment.step >= appointment.next and running.plugin is not None:
                    if appointment.single:
                        appointment.end()
                    appointment.set_next(moment)
                    self._guarded(running, appointment.call)

    def _give_orders(self) -> None:
        """What plugins have ordered, in one command, for the models that there are now."""
        while not self._stop.is_set() and not self._ordered():
            self._follow_models()

    def _ordered(self) -> bool:
        motors: List[JointMotor] = []
        servos: List[JointServo] = []
        planar: List[PlanarVelocity] = []
        contexts = [running.context for _, all_running in self._models.values()
                    for running in all_running]
        for context in contexts:
            motors += context.motors.values()
            servos += context.servos.values()
            if context.planar is not None:
                planar.append(context.planar)
        if (motors or servos or planar) and not self._simulator.drives.set(
                motors, planar, self._followed, servos):
            return False
        for context in contexts:
            context.motors, context.servos, context.planar = {}, {}, None
        return self._pushed([context for context in contexts if context.pushes])

    def _pushed(self, contexts: List[SimulatedContext]) -> bool:
        if not contexts:
            return True
        orders = [(context, link, *push) for context in contexts
                  for link, push in context.pushes.items()]
        ids = self._simulator.wrenches.swap(
            [context.push_ids[link] for context, link, *_ in orders if link in context.push_ids],
            [order[1:] for order in orders], self._followed)
        if ids is None:
            return False
        for (context, link, *_), number in zip(orders, ids):
            context.push_ids.pop(link, None)
            if number:
                context.push_ids[link] = number
        for context in contexts:
            context.pushes = {}
        return True

    def _go_on(self, moment: Moment) -> None:
        """Let the engine run to the next appointment of anybody."""
        steps = self._next_steps()
        if steps and self._consumer is None:
            self._consumer = self._simulator.appointments.join()
            moment = self._consumer.now()
            self._make_anew(moment)
            steps = self._next_steps()
        if self._consumer is not None and steps:
            self._consumer.allow(moment, min(steps))
        elif self._consumer is not None:
            self._consumer.leave()
            self._consumer = None
        self._moment = moment

    def _next_steps(self) -> List[int]:
        return [appointment.next for running in self._all()
                for appointment in running.context.appointments]

    def _make_anew(self, moment: Moment) -> None:
        for running in self._all():
            for appointment in list(running.context.appointments):
                if appointment.single and self._clock_was_set(moment):
                    appointment.end()
                appointment.set_next(moment)

    def _clock_was_set(self, moment: Moment) -> bool:
        return self._moment is not None and moment.clock_sets != self._moment.clock_sets

    def _publish(self, moment: Moment) -> None:
        transforms = []
        for _, all_running in self._models.values():
            for running in all_running:
                context = running.context
                if context.outbox:
                    outbox, context.outbox = context.outbox, []
                    self._guarded(running, self._send, running, outbox)
                transforms += context.transforms
                context.transforms = []
        if transforms:
            self._graph.send_transforms(transforms, moment.sim_ns)

    def _failing(self, running: Running) -> Callable[[Exception], None]:
        """What tells the plugins' thread of a fault in another one."""
        def fail(fault: Exception) -> None:
            def again() -> None:
                raise fault

            running.context.inbox.append(again)
            self.wake()
        return fail

    def _send(self, running: Running, messages: Iterable[Tuple[Topic, Any]]) -> None:
        for topic, message in messages:
            if isinstance(message, Later):
                self._messages.put(topic, message, self._failing(running))
            else:
                topic.send(message)

    def _deliver(self, running: Running) -> None:
        inbox = running.context.inbox
        while inbox and running.plugin is not None:
            self._guarded(running, inbox.popleft())

    def _notice_resets(self, moment: Moment) -> None:
        """Tell plugins of resets and of another clock."""
        before = self._moment
        resets = self._simulator.resets
        calls: List[str] = []
        if before is not None and moment.clock_sets != before.clock_sets:
            self._make_anew(moment)
            for running in self._all():
                running.context.sensing.forget()
            if resets.simulation_resets != self._simulation_resets:
                calls.append("reset")
            elif moment.sim_ns < before.sim_ns:
                calls.append("clock_set")
            self._simulation_resets = resets.simulation_resets
        if resets.world_resets != self._world_resets:
            self._world_resets = resets.world_resets
            calls.append("reset")
        for call in reversed(calls):
            for running in self._all():
                running.context.inbox.appendleft(getattr(running.plugin, call))

    # -- models ------------------------------------------------------------------------------------

    def _follow_models(self) -> None:
        """Start and end plugins with their models."""
        while True:
            revision, entities = self._simulator.models.inventory()
            if revision != self._followed:
                self._followed = revision
                self._compare({WORLD_SCOPE: self._world_entity(),
                               **{entity.model.name: entity for entity in entities}})
            self._end_leaving()
            if not self._to_load:
                return
            name, found = self._to_load.popleft()
            self._load(*self._models[name], found)  # which may change models

    def _compare(self, present: Dict[str, Entity]) -> None:
        """Note what is to be loaded and ended; tell of other rows those that stay."""
        for name in [name for name in self._models if name not in present]:
            self._end_model(name)
        for name, entity in present.items():
            before = self._models.get(name)
            if before is not None and before[0] is entity:
                continue
            found = list(plugins_of(entity.model))
            known = [] if before is None else [
                *(one.found for one in before[1]),
                *(one for owner, one in self._to_load if owner == name)]
            if before is not None and known == found:
                self._models[name] = (entity, before[1])
                self._rebind(entity, before[1])
                continue
            if before is not None:
                self._end_model(name)
            self._models[name] = (entity, [])
            self._to_load += [(name, one) for one in found]

    def _world_entity(self) -> Entity:
        """What stands for the world as owner of its plugins."""
        world = self._simulator.world  # plugins of actors are unknown here, and told so
        plugins = [*world.plugins, *(spec for actor in world.actors for spec in actor.plugins)]
        before = self._models.get(WORLD_SCOPE)
        if before is not None and before[0].model.plugins == plugins:
            return before[0]
        return Entity(0, Model(WORLD, plugins=plugins), IDENTITY, 0, 0)

    def _rebind(self, entity: Entity, all_running: List[Running]) -> None:
        for running in all_running:
            if running.plugin is not None:
                self._guarded(running, running.context.bind, entity)

    def _load(self, entity: Entity, into: List[Running], found: Found) -> None:
        context = SimulatedContext(self._simulator, self._graph, entity, found.spec, found.scope,
                                   self._log, self.wake, self._scene_sensing, found.sensor,
                                   found.link, found.joint)
        running = Running(found, context, None)
        into.append(running)
        if self._registry.is_provided(found.spec.filename):
            return
        try:
            running.plugin = self._registry.find(found.spec.filename)(context)
        except UnknownPluginError as unknown:
            self._tell_unknown(found, entity, str(unknown))
            return
        moment = context.moment = self._simulator.appointments.now()
        if self._guarded(running, running.plugin.load, patience=self._patience.longer()):
            for appointment in context.appointments:
                appointment.set_next(moment)

    def _tell_unknown(self, found: Found, entity: Entity, text: str) -> None:
        name = library_name(found.spec.filename)
        if name not in self._told:
            self._told[name] = True
            self._log(warning("plugin-unknown", f"{text}; '{found.spec.name}' of model"
                              f" '{entity.model.name}' does nothing", file=found.spec.file,
                              line=found.spec.line,
                              hint="a package can bring one: see doc/plugins.md"))

    def _end_model(self, name: str) -> None:
        _, all_running = self._models.pop(name)
        self._to_load = deque(one for one in self._to_load if one[0] != name)
        self._leaving += all_running

    def _end_leaving(self) -> None:
        while self._leaving:
            running = self._leaving.popleft()
            if running.plugin is not None:
                self._guarded(running, running.plugin.close)
            running.context.close()
            with contextlib.suppress(CommandError):  # the engine ends as well
                running.context.let_go()

    def _guarded(self, running: Running, call: Callable[..., None], *arguments: Any,
                 patience: Optional[Patience] = None) -> bool:
        """Call a plugin; one that raises, or does not come back, is reported and switched off."""
        try:
            self._watch.run(running, patience or self._patience, call, *arguments)
            return True
        except CallOverdue as overdue:
            if threading.current_thread() is not self._thread:
                raise
            self._switch_off(running, str(overdue))
        except PluginError as fault:
            self._switch_off(running, str(fault))
        except Exception as fault:  # whatever a plugin does wrong, the world goes on
            frame = traceback.extract_tb(fault.__traceback__)[-1]
            self._switch_off(running, f"{type(fault).__name__}: {fault} (in {frame.name}, "
                             f"{frame.filename}:{frame.lineno})")
        return False

    def _switch_off(self, running: Running, why: str) -> None:
        spec, context = running.found.spec, running.context
        self._log(Issue(Severity.ERROR, "plugin-failed", f"plugin '{spec.name}'"
                        f" ({library_name(spec.filename)}) of model '{context.model}' is switched"
                        f" off: {why}", spec.file, spec.line))
        running.plugin = None
        context.close()
        try:
            context.stop()
        except CommandError as fault:
            self._log(warning("plugin-order", f"its motors could not be switched off: {fault}"))
