"""Runs the plugins of all models of a simulator, in one thread.

The host has appointments with the engine: while it works, the world stands at a step. What plugins
order (motors, velocities) is sent to the engine in one command; then the engine goes on, and only
then messages are published, so that publishing costs no sim time.
"""
from __future__ import annotations

import threading
import traceback
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple

from ..description.model import Model
from ..description.plugin import PluginSpec
from ..description.sensor import Sensor
from ..engine.commands import JointMotor, PlanarVelocity
from ..errors import CommandError, Issue, Severity, warning
from ..simulator.appointments import Consumer, Moment
from ..simulator.registry import Entity
from ..simulator.simulator import Simulator
from .base import Plugin
from .context import PluginError
from .eyes import Eyes
from .graph import Graph, TopicUse
from .registry import PluginRegistry, UnknownPluginError, library_name
from .simulated_context import SimulatedContext

_LOOK_S = 0.5      # between two looks while nothing rings
_SETTLE_S = 30.0   # how long a caller waits for plugins to be loaded
_END_S = 2.0


@dataclass(frozen=True)
class Found:
    """A plugin in a description: where it belongs. `scope` is that of a nested model, `inner::`."""

    spec: PluginSpec
    scope: str = ""
    link: str = ""
    sensor: Optional[Sensor] = field(default=None, compare=False)


@dataclass
class Running:
    """A plugin at work; `plugin` None for one that is unknown or was switched off."""

    found: Found
    context: SimulatedContext
    plugin: Optional[Plugin]


def plugins_of(model: Model, scope: str = "") -> Iterator[Found]:
    """The plugins of a flattened model: its own, those of its sensors, those of nested models."""
    for spec in model.plugins:
        yield Found(spec, scope)
    if not scope:
        for link in model.links:
            inner = link.name.rpartition("::")[0]
            for sensor in link.sensors:
                for spec in sensor.plugins:
                    yield Found(spec, f"{inner}::" if inner else "", link.name, sensor)
    for nested in (model.guide.models if model.guide is not None else model.models):
        yield from plugins_of(nested, f"{scope}{nested.name}::")


class PluginHost:
    """Starts plugins with their models, calls them, and ends them.

    Args:
        simulator: the world; started.
        graph: how plugins reach ROS.
        registry: finds their classes.
        log: hears of plugins that are unknown or fail.
    """

    def __init__(self, simulator: Simulator, graph: Graph, registry: PluginRegistry,
                 log: Callable[[Issue], None]) -> None:
        self._simulator, self._graph, self._registry, self._log = simulator, graph, registry, log
        self._eyes = Eyes(simulator, log)
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
        self._thread = threading.Thread(target=self._run, name="plugins", daemon=True)

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
        finally:
            self._stop.set()
            for name in list(self._models):
                self._end_model(name)
            self._eyes.close()
            if self._consumer is not None:
                self._consumer.leave()
                self._consumer = None
            with self._settled:
                self._settled.notify_all()

    def _rest(self) -> None:
        if self._consumer is not None:
            self._consumer.wait(_LOOK_S)
        else:
            self._wake.wait(_LOOK_S)
            self._wake.clear()

    def _turn(self) -> None:
        """Look at the world once, and do what is due."""
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
            for appointment in running.context.appointments:
                if moment.step >= appointment.next:
                    self._guarded(running, appointment.call)
                    appointment.next = appointment.rate.after(moment.step, moment.clock)

    def _give_orders(self) -> None:
        """What plugins have ordered, in one command, for the models that there are now."""
        while not self._stop.is_set() and not self._ordered():
            self._follow_models()

    def _ordered(self) -> bool:
        motors: List[JointMotor] = []
        planar: List[PlanarVelocity] = []
        for _, all_running in self._models.values():
            for running in all_running:
                context = running.context
                motors += context.motors.values()
                if context.planar is not None:
                    planar.append(context.planar)
        if (motors or planar) and not self._simulator.drives.set(motors, planar, self._followed):
            return False
        for _, all_running in self._models.values():
            for running in all_running:
                running.context.motors, running.context.planar = {}, None
        return True

    def _go_on(self, moment: Moment) -> None:
        """Let the engine run to the next appointment of anybody."""
        steps = [appointment.next for running in self._all()
                 for appointment in running.context.appointments]
        if steps and self._consumer is None:
            self._consumer = self._simulator.appointments.join()
            moment = self._consumer.now()
            self._make_anew(moment)
            steps = [appointment.next for running in self._all()
                     for appointment in running.context.appointments]
        if self._consumer is not None and steps:
            self._consumer.allow(moment, min(steps))
        elif self._consumer is not None:
            self._consumer.leave()
            self._consumer = None
        self._moment = moment

    def _make_anew(self, moment: Moment) -> None:
        for running in self._all():
            for appointment in running.context.appointments:
                appointment.next = appointment.rate.after(moment.step, moment.clock)

    def _publish(self, moment: Moment) -> None:
        transforms = []
        for _, all_running in self._models.values():
            for running in all_running:
                context = running.context
                outbox, context.outbox = context.outbox, []
                for topic, message in outbox:
                    self._guarded(running, topic.send, message)
                transforms += context.transforms
                context.transforms = []
        if transforms:
            self._graph.send_transforms(transforms, moment.sim_ns)

    def _deliver(self, running: Running) -> None:
        inbox = running.context.inbox
        while inbox:
            self._guarded(running, inbox.popleft())

    def _notice_resets(self, moment: Moment) -> None:
        """Tell plugins of resets and of another clock."""
        before = self._moment
        resets = self._simulator.resets
        calls: List[str] = []
        if before is not None and moment.clock_sets != before.clock_sets:
            self._make_anew(moment)
            if resets.simulation_resets != self._simulation_resets:
                calls.append("reset")
            elif moment.sim_ns < before.sim_ns:
                calls.append("clock_set")
            self._simulation_resets = resets.simulation_resets
        if resets.world_resets != self._world_resets:
            self._world_resets = resets.world_resets
            calls.append("reset")
        for call in calls:
            for running in self._all():
                self._guarded(running, getattr(running.plugin, call))

    # -- models ------------------------------------------------------------------------------------

    def _follow_models(self) -> None:
        """Start and end plugins with their models."""
        revision, entities = self._simulator.models.inventory()
        if revision == self._followed:
            return
        self._followed = revision
        present = {entity.model.name: entity for entity in entities}
        for name in [name for name in self._models if name not in present]:
            self._end_model(name)
        for name, entity in present.items():
            before = self._models.get(name)
            if before is not None and before[0] is entity:
                continue
            found = list(plugins_of(entity.model))
            if before is not None and [one.found for one in before[1]] == found:
                self._rebind(entity, before[1])
                self._models[name] = (entity, before[1])
                continue
            if before is not None:
                self._end_model(name)
            self._models[name] = (entity, [])
            for one in found:
                self._load(entity, one, self._models[name][1])

    def _rebind(self, entity: Entity, all_running: List[Running]) -> None:
        for running in all_running:
            if running.plugin is not None:
                self._guarded(running, running.context.bind, entity)

    def _load(self, entity: Entity, found: Found, into: List[Running]) -> None:
        context = SimulatedContext(self._simulator, self._graph, entity, found.spec, found.scope,
                                   self._log, self.wake, self._eyes, found.sensor, found.link)
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
        if self._guarded(running, running.plugin.load):
            for appointment in context.appointments:
                appointment.next = appointment.rate.after(moment.step, moment.clock)

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
        for running in all_running:
            if running.plugin is not None:
                self._guarded(running, running.plugin.close)
            running.context.close()

    def _guarded(self, running: Running, call: Callable[..., None], *arguments: Any) -> bool:
        """Call a plugin; one that raises is reported and switched off."""
        try:
            call(*arguments)
            return True
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
