"""The context of a plugin in a running simulator."""
from __future__ import annotations

import threading
from collections import deque
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Any, Callable, Deque, Dict, List, Optional, Tuple

from ..description.model import Joint as JointSpec
from ..description.plugin import PluginSpec
from ..description.sensor import Sensor
from ..engine.commands import FOREVER, JointMotor, PlanarVelocity, TimedWrench
from ..errors import Issue, Severity
from ..geometry import IDENTITY, Pose, Twist, Vec3, compose
from ..sensing.api import RayFan, RayReturns, SensingError
from ..simulator.appointments import Moment, Rate
from ..simulator.registry import Entity
from ..simulator.simulator import Simulator
from .context import PluginError
from .eyes import Eyes
from .graph import Closing, Graph, MissingTypeError, Topic, TopicUse, TransformOf
from .parameters import Parameters

Report = Callable[[Issue], None]

_SCAN_S = 10.0  # of wall time, for rays


class Appointment:
    """Something that is called at a rate."""

    def __init__(self, hertz: float, call: Callable[[], None]) -> None:
        self.rate = Rate(hertz)
        self.call = call
        self.next = 0


class SimulatedLink:
    """A link, by the row it has now."""

    def __init__(self, context: "SimulatedContext", name: str) -> None:
        self.name = name
        self._context = context
        self.row = -1

    @property
    def pose(self) -> Pose:
        """World pose of the link frame."""
        return self._context.simulator.states.link_at(self.row)[0]

    @property
    def twist(self) -> Twist:
        """Twist at the link's origin, world axes."""
        return self._context.simulator.states.link_at(self.row)[1]


class SimulatedJoint:
    """A joint axis, by the row it has now."""

    def __init__(self, context: "SimulatedContext", spec: JointSpec, name: str) -> None:
        self.name, self.spec_name = name, spec.name
        self.parent, self.child = spec.parent, spec.child
        self._context = context
        self.row = -1
        self.motor: Optional[JointMotor] = None

    @property
    def position(self) -> float:
        """rad or m."""
        return self._context.simulator.states.axis_at(self.row)[0]

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""
        return self._context.simulator.states.axis_at(self.row)[1]

    def drive(self, rate: float, effort: float) -> None:
        """Turn the motor."""
        self.motor = JointMotor(self.row, rate, effort)
        self._context.motors[self.row] = self.motor


class Offer:
    """A topic of a plugin; what is published leaves once the world goes on."""

    def __init__(self, context: "SimulatedContext", topic: Topic) -> None:
        self._context, self._topic = context, topic

    @property
    def wanted(self) -> bool:
        """Whether anybody listens."""
        return self._topic.wanted

    def publish(self, message: Any) -> None:
        """Publish."""
        self._context.outbox.append((self._topic, message))


class SimulatedContext:
    """One plugin's view of one model; see `context.Context`. For the thread of the host.

    Attributes:
        appointments: when the plugin wants to be called.
        motors, planar: what it has ordered since they were last taken.
        outbox, transforms: what it has published since they were last taken.
        inbox: what has come for it: functions to be called.
    """

    def __init__(self, simulator: Simulator, graph: Graph, entity: Entity, spec: PluginSpec,
                 scope: str, report: Report, wake: Callable[[], None],
                 eyes: Eyes, sensor: Optional[Sensor] = None, sensor_link: str = "") -> None:
        self.simulator = simulator
        self.model = entity.model.name
        self.sensor, self.sensor_link = sensor, sensor_link
        self.spec = spec
        self._graph, self._scope, self._report, self._wake = graph, scope, report, wake
        self.parameters = Parameters(spec.xml, self.warn)
        self.entity = entity
        self.moment: Optional[Moment] = None
        self.appointments: List[Appointment] = []
        self.motors: Dict[int, JointMotor] = {}
        self.planar: Optional[PlanarVelocity] = None
        self.level: Optional[PlanarVelocity] = None
        self.outbox: List[Tuple[Topic, Any]] = []
        self.transforms: List[TransformOf] = []
        self.inbox: Deque[Callable[[], None]] = deque()
        self._links: Dict[str, SimulatedLink] = {}
        self._joints: Dict[str, SimulatedJoint] = {}
        self._scan_fault = ""
        self._pushes: Dict[str, List[int]] = {}
        self._eyes = eyes
        self._scan: "Optional[Tuple[Future[RayReturns], Callable[[RayReturns, int], None], int]]" \
            = None
        self._namespace = ""
        self._open: List[Closing] = []
        self._topics: List[Tuple[str, str, bool]] = []

    # -- for the host ----------------------------------------------------------------------------

    def bind(self, entity: Entity) -> None:
        """The model has other rows, or another name, now. Raises PluginError for what is gone."""
        self.entity, self.model = entity, entity.model.name
        for link in self._links.values():
            link.row = self._link_row(link.name)
        self.motors = {}
        for joint in self._joints.values():
            joint.row = self._axis_row(joint.spec_name)
            if joint.motor is not None:
                joint.drive(joint.motor.rate, joint.motor.effort)
        if self.level is not None:
            self.drive_level(self.level.x, self.level.y, self.level.yaw_rate)

    def close(self) -> None:
        """Take everything off the graph, and switch off what was driven."""
        for one in self._open:
            one.close()
        self._open.clear()
        self._topics.clear()
        self.appointments.clear()

    def stop(self) -> None:
        """Switch off what the plugin drives, in a world that still has the model."""
        for joint in self._joints.values():
            if joint.motor is not None:
                joint.drive(0.0, 0.0)
        if self.level is not None:
            self.simulator.drives.stop(self.entity)
        for link in list(self._pushes):
            self.simulator.wrenches.remove(self._pushes.pop(link))

    # -- time ------------------------------------------------------------------------------------

    @property
    def now_ns(self) -> int:
        """Sim time of this step."""
        return self.moment.sim_ns if self.moment is not None else self.simulator.clock.sim_ns

    @property
    def step_size(self) -> float:
        """Of the simulation, s."""
        return self.simulator.physics.settings.max_step_size

    def every(self, hertz: float, call: Callable[[], None]) -> None:
        """Be called at a rate."""
        self.appointments.append(Appointment(hertz, call))

    # -- the model -------------------------------------------------------------------------------

    @property
    def pose(self) -> Pose:
        """World pose of the model frame."""
        if not self.entity.link_names:
            return self.entity.pose
        pose = self.simulator.states.link_at(self.entity.canonical_row)[0]
        offset = self.entity.link_from_model
        return pose if offset == IDENTITY else compose(pose, offset)

    @property
    def twist(self) -> Twist:
        """Twist of the canonical link."""
        return self.simulator.states.link_at(self.entity.canonical_row)[1]

    @property
    def gravity(self) -> Vec3:
        """World axes."""
        return self.simulator.physics.gravity

    @property
    def seed(self) -> int:
        """Of what is drawn at random."""
        return self.simulator.world.seed

    def link(self, name: str) -> SimulatedLink:
        """A link of the model."""
        if name not in self._links:
            link = SimulatedLink(self, name)
            link.row = self._link_row(name)
            self._links[name] = link
        return self._links[name]

    def joint(self, name: str) -> SimulatedJoint:
        """A joint of the model that moves."""
        if name not in self._joints:
            known = {joint.name: joint for joint in self.entity.model.joints}
            spec = known.get(self._scope + name) or known.get(name)
            if spec is None:
                raise PluginError(f"model '{self.model}' has no joint '{name}'" + _list(known))
            joint = SimulatedJoint(self, spec, name)
            joint.row = self._axis_row(spec.name)
            self._joints[name] = joint
        return self._joints[name]

    def _link_row(self, name: str) -> int:
        names = self.entity.link_names
        for full in (self._scope + name, name, name.partition("::")[2]):
            if full in names:
                return self.entity.first_link_row + names.index(full)
        raise PluginError(f"model '{self.model}' has no link '{name}'" + _list(names))

    def _axis_row(self, name: str) -> int:
        row = self.entity.axis_row(name, 0)
        if row is None:
            raise PluginError(f"joint '{name}' of model '{self.model}' does not move")
        return row

    def drive_level(self, x: float, y: float, yaw_rate: float) -> None:
        """Move level from now on."""
        self.planar = self.level = PlanarVelocity(self.entity.model_id, x, y, yaw_rate)

    def push(self, link: str, force: Vec3, torque: Vec3) -> None:
        """A wrench from now on."""
        wrenches, row = self.simulator.wrenches, self._link_row(link)
        old = self._pushes.pop(link, [])
        if any((*force, *torque)):
            self._pushes[link] = wrenches.add(
                [TimedWrench(0, row, 0, FOREVER, force, torque)], whole=True)
        if old:
            wrenches.remove(old)

    def set_joint_positions(self, positions: Dict[str, float]) -> None:
        """Move joints at once."""
        self.simulator.joints.set_positions(
            {f"{self.model}::{self.joint(name).spec_name}": value
             for name, value in positions.items()})

    def scan(self, fan: RayFan, visuals: bool, call: Callable[[RayReturns, int], None]) -> None:
        """Cast rays from the plugin's sensor."""
        self._end_scan()
        assert self.sensor is not None
        future = self._eyes.cast(self._link_row(self.sensor_link), self.sensor.pose, fan, visuals)
        self._scan = (future, call, self.now_ns)
        future.add_done_callback(self._scanned)

    def _scanned(self, future: "Future[RayReturns]") -> None:
        self.inbox.append(lambda: self._end_scan(future))
        self._wake()

    def _end_scan(self, only: "Optional[Future[RayReturns]]" = None) -> None:
        """Wait for the scan on its way, if there is one, and hand it over."""
        if self._scan is None or only not in (None, self._scan[0]):
            return
        (future, call, ns), self._scan = self._scan, None
        try:
            found = future.result(_SCAN_S)
        except (SensingError, FutureTimeoutError) as fault:
            if str(fault) != self._scan_fault:
                self._scan_fault = str(fault)
                self.warn(f"a scan is left out: {fault or 'it took too long'}")
            return
        call(found, ns)

    def contacts(self) -> List[Any]:
        """The contacts of the last step."""
        return self.simulator.states.contacts()

    # -- topics, services, parameters --------------------------------------------------------------

    def use_namespace(self, namespace: str) -> None:
        """What names are relative to."""
        self._namespace = namespace.strip().rstrip("/")

    def _name(self, name: str) -> str:
        if name.startswith(("/", "~")) or not self._namespace:
            return name
        return f"{self._namespace}/{name}"

    def message(self, kind: str) -> Any:
        """A new message."""
        try:
            return self._graph.message(kind)
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing

    def stamp(self, ns: Optional[int] = None) -> Any:
        """A time as messages have it."""
        return self._graph.stamp(self.now_ns if ns is None else ns)

    def publish(self, name: str, kind: str, queue: int = 1, latch: bool = False) -> Offer:
        """Offer a topic."""
        try:
            topic = self._graph.publish(self._name(name), kind, queue, latch)
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing
        self._open.append(topic)
        self._topics.append((self._name(name), kind, False))
        return Offer(self, topic)

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None], queue: int = 1) -> None:
        """Hear a topic."""
        waiting: Deque[Any] = deque(maxlen=max(1, queue))

        def deliver() -> None:
            while waiting:
                call(waiting.popleft())

        def arrived(message: Any) -> None:
            waiting.append(message)
            self.inbox.append(deliver)
            self._wake()

        try:
            self._open.append(self._graph.subscribe(self._name(name), kind, arrived, queue))
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing
        self._topics.append((self._name(name), kind, True))

    def topic_uses(self) -> List[TopicUse]:
        """The topics it offers and hears; from any thread."""
        link, pose = "", IDENTITY
        if self.sensor is not None:
            link, pose = self._scope + self.sensor_link, self.sensor.pose
            if link not in self.entity.link_names:
                link = self.sensor_link
        kind = self.sensor.type if self.sensor is not None else ""
        return [TopicUse(name, message, heard, self.model, link, kind, pose)
                for name, message, heard in list(self._topics)]

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> None:
        """Offer a service."""
        def asked(request: Any, response: Any) -> None:
            done = threading.Event()

            def answer() -> None:
                try:
                    call(request, response)
                finally:
                    done.set()

            self.inbox.append(answer)
            self._wake()
            done.wait()

        try:
            self._open.append(self._graph.serve(self._name(name), kind, asked))
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing

    def search_parameter(self, name: str, default: Any) -> Any:
        """A parameter of the namespace or above."""
        return self._graph.search_parameter(self._namespace, name, default)

    def transform(self, parent: str, child: str, pose: Pose) -> None:
        """Broadcast to tf."""
        self.transforms.append((parent, child, pose))

    # -- log -------------------------------------------------------------------------------------

    def info(self, text: str) -> None:
        """Tell the user something."""
        self._say(Severity.NOTE, text)

    def warn(self, text: str) -> None:
        """Warn the user."""
        self._say(Severity.WARNING, text)

    def _say(self, severity: Severity, text: str) -> None:
        self._report(Issue(severity, "plugin", f"plugin '{self.spec.name}' of model"
                           f" '{self.model}': {text}", self.spec.file, self.spec.line))


def _list(names: Any) -> str:
    found = list(names)
    if not found:
        return "; it has none"
    return "; there are " + ", ".join(found[:8]) + (", ..." if len(found) > 8 else "")
