"""The context of a plugin in a running simulator."""
from __future__ import annotations

import threading
from collections import deque
from dataclasses import replace
from typing import Any, Callable, Deque, Dict, List, Optional, Sequence, Tuple

from ..description.model import Inertial, Mimic, Model
from ..description.model import Joint as JointSpec
from ..description.plugin import PluginSpec
from ..description.sensor import Sensor
from ..description.surroundings import SphericalCoordinates
from ..description.transmission import Transmission
from ..engine.commands import JointMotor, JointServo, JointWrench, PlanarVelocity, WheelSlip
from ..errors import CommandError, InputError, Issue, Severity
from ..geometry import IDENTITY, STILL, Pose, Twist, Vec3, compose
from ..sensing.api import Mount, Pictures, RayFan, RayReturns
from ..simulator.appointments import Moment, Rate
from ..simulator.registry import Entity
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator
from ..simulator.wrenches import first_step
from .context import PluginError, View
from .graph import Closing, Graph, MissingTypeError, Topic, TopicUse, TransformOf
from .message_maker import Later
from .parameters import Parameters
from .sensing_requests import SensingRequests

Report = Callable[[Issue], None]

_LOOK_S = 0.2   # between two looks whether a plugin that is asked still lives


class Appointment:
    """Something that is called at a rate, or once.

    Attributes:
        call: what is called.
        next: the step at which that is due.
        single: whether it is over then.
    """

    def __init__(self, owner: "List[Appointment]", rate: Optional[Rate],
                 call: Callable[[], None], ns: int = 0) -> None:
        self._owner, self._rate, self._ns = owner, rate, ns
        self.call = call
        self.next = 0
        self.single = rate is None

    def set_next(self, moment: Moment) -> None:
        """The first time after a moment."""
        if self._rate is not None:
            self.next = self._rate.after(moment.step, moment.clock)
        else:
            self.next = max(moment.step + 1, first_step(moment.clock, self._ns))

    def end(self) -> None:
        """Never again."""
        if self in self._owner:
            self._owner.remove(self)


class SimulatedLink:
    """A link, by the row it has now."""

    def __init__(self, context: "SimulatedContext", name: str) -> None:
        self.name = name
        self._context = context
        self.row = -1
        self.inertial = Inertial()

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
        self.servo: Optional[JointServo] = None
        self.spec = spec

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

    def steer(self, servo: JointServo) -> None:
        """Hand over to a servo."""
        self.servo = replace(servo, row=self.row)
        self._context.servos[self.row] = self.servo


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

    def publish_later(self, make: Callable[[], Any]) -> None:
        """Publish what another thread makes."""
        self._context.outbox.append((self._topic, Later(make, self._context.sensing.unsent)))

    def close(self) -> None:
        """Take it off the graph."""
        waiting = [one for one in self._context.outbox if one[0] is self._topic]
        self._context.outbox = [one for one in self._context.outbox if one[0] is not self._topic]
        for _, message in waiting:
            self._topic.send(message.make() if isinstance(message, Later) else message)
        self._context.close_one(self._topic)


class OpenEnd:
    """A subscription or service of a plugin."""

    def __init__(self, context: "SimulatedContext", end: Closing) -> None:
        self._context, self._end = context, end
        context.opened.append(end)

    def close(self) -> None:
        """Take it off the graph."""
        self._context.close_one(self._end)


class SimulatedContext:
    """One plugin's view of one model; see `context.Context`. For the thread of the host.

    Attributes:
        appointments: when the plugin wants to be called.
        motors, servos, planar, pushes: what it has ordered since they were last taken.
        push_ids: the wrenches that act now, by link.
        outbox, transforms: what it has published since they were last taken.
        inbox: what has come for it: functions to be called.
        sensing: what it has asked of the sensing process.
        opened: what it has on the graph.
    """

    def __init__(self, simulator: Simulator, graph: Graph, entity: Entity, spec: PluginSpec,
                 scope: str, report: Report, wake: Callable[[], None],
                 scene: SceneSensing, sensor: Optional[Sensor] = None, sensor_link: str = "",
                 sensor_joint: str = "") -> None:
        self.simulator = simulator
        self.model = entity.model.name
        self.sensor, self.sensor_link, self.sensor_joint = sensor, sensor_link, sensor_joint
        self.spec = spec
        self._graph, self._scope, self._report, self._wake = graph, scope, report, wake
        self.parameters = Parameters(spec.xml, self.warn)
        self.entity = entity
        self.moment: Optional[Moment] = None
        self.appointments: List[Appointment] = []
        self.motors: Dict[int, JointMotor] = {}
        self.servos: Dict[int, JointServo] = {}
        self.planar: Optional[PlanarVelocity] = None
        self.level: Optional[PlanarVelocity] = None
        self.outbox: List[Tuple[Topic, Any]] = []
        self.transforms: List[TransformOf] = []
        self.inbox: Deque[Callable[[], None]] = deque()
        self._links: Dict[str, SimulatedLink] = {}
        self._joints: Dict[str, SimulatedJoint] = {}
        self.pushes: Dict[str, Tuple[Vec3, Vec3]] = {}
        self.push_ids: Dict[str, int] = {}
        self._closed = threading.Event()
        self._attached: List[str] = []
        self._held = False
        self.sensing = SensingRequests(scene, self.inbox, wake, self.warn)
        self._namespace = ""
        self.opened: List[Closing] = []
        self._topics: List[Tuple[str, str, bool]] = []

    # -- for the host ----------------------------------------------------------------------------

    def bind(self, entity: Entity) -> None:
        """The model has other rows, or another name, now. Raises PluginError for what is gone."""
        self.entity, self.model = entity, entity.model.name
        for link in self._links.values():
            self._find(link)
        self.motors, self.servos = {}, {}
        for joint in self._joints.values():
            joint.row = self._axis_row(joint.spec_name)
            if joint.motor is not None:
                joint.drive(joint.motor.rate, joint.motor.effort)
            if joint.servo is not None:
                joint.steer(joint.servo)
        if self.level is not None:
            self.drive_level(self.level.x, self.level.y, self.level.yaw_rate)

    def close(self) -> None:
        """Take everything off the graph, and switch off what was driven."""
        for one in self.opened:
            one.close()
        self.opened.clear()
        self._topics.clear()
        self.appointments.clear()
        self._closed.set()

    def close_one(self, end: Closing) -> None:
        """Take one thing off the graph."""
        if end in self.opened:
            self.opened.remove(end)
            end.close()

    def stop(self) -> None:
        """Switch off what the plugin drives, in a world that still has the model."""
        for joint in self._joints.values():
            if joint.motor is not None:
                joint.drive(0.0, 0.0)
            if joint.servo is not None:
                joint.steer(JointServo(joint.row, ""))
        if self.level is not None:
            self.simulator.drives.stop(self.entity)
        if self._held:
            self.hold(False)
        self.let_go()

    def let_go(self) -> None:
        """Detach what the plugin has attached, and push nothing any more."""
        self.pushes = {}
        if self.push_ids:
            self.simulator.wrenches.remove(list(self.push_ids.values()))
        self.push_ids = {}
        for name in list(self._attached):
            self.detach(name)

    # -- time ------------------------------------------------------------------------------------

    @property
    def now_ns(self) -> int:
        """Sim time of this step."""
        return self.moment.sim_ns if self.moment is not None else self.simulator.clock.sim_ns

    @property
    def step_size(self) -> float:
        """Of the simulation, s."""
        return self.simulator.physics.settings.max_step_size

    @property
    def step(self) -> int:
        """The step count."""
        return self.moment.step if self.moment is not None else self.simulator.clock.step

    def every(self, hertz: float, call: Callable[[], None]) -> Appointment:
        """Be called at a rate."""
        return self._appointed(Appointment(self.appointments, Rate(hertz), call))

    def once(self, ns: int, call: Callable[[], None]) -> Appointment:
        """Be called once."""
        return self._appointed(Appointment(self.appointments, None, call, ns))

    def _appointed(self, made: Appointment) -> Appointment:
        if self.moment is not None:
            made.set_next(self.moment)
        self.appointments.append(made)
        return made

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

    @property
    def magnetic_field(self) -> Vec3:
        """T, world axes."""
        return self.simulator.world.magnetic_field

    @property
    def place_on_earth(self) -> Optional[SphericalCoordinates]:
        """Where the world's origin is."""
        return self.simulator.world.spherical_coordinates

    def link(self, name: str) -> SimulatedLink:
        """A link of the model."""
        if not name and self.entity.link_names:
            name = self.entity.link_names[self.entity.canonical]
        if name not in self._links:
            link = SimulatedLink(self, name)
            self._find(link)
            self._links[name] = link
        return self._links[name]

    def _find(self, link: SimulatedLink) -> None:
        link.row = self._link_row(link.name)
        link.inertial = self.entity.model.links[link.row - self.entity.first_link_row].inertial

    def joint(self, name: str) -> SimulatedJoint:
        """A joint of the model that moves."""
        if name not in self._joints:
            spec = self._joint_spec(name)
            joint = SimulatedJoint(self, spec, name)
            joint.row = self._axis_row(spec.name)
            self._joints[name] = joint
        return self._joints[name]

    def _joint_spec(self, name: str) -> JointSpec:
        known = {joint.name: joint for joint in self.entity.model.joints}
        spec = known.get(self._scope + name) or known.get(name)
        if spec is None:
            raise PluginError(f"model '{self.model}' has no joint '{name}'" + _list(known))
        return spec

    def joint_wrench(self, name: str) -> Optional[JointWrench]:
        """What a joint transmitted in the last step."""
        spec = self._joint_spec(name)
        return self.simulator.joints.wrenches([f"{self.model}::{spec.name}"])[0]

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

    @property
    def description(self) -> Model:
        """The flattened description."""
        return self.entity.model

    def transmissions(self, parameter: str) -> List[Transmission]:
        """Those of the description, else of a parameter."""
        own = self.entity.model.transmissions
        text = "" if own else self.search_parameter(parameter, "")
        if not isinstance(text, str) or not text.strip():
            return own
        from ..formats.urdf.transmission import transmissions_of

        try:
            return transmissions_of(text, f"parameter {parameter}")
        except InputError as fault:
            raise PluginError(str(fault)) from fault

    def push(self, link: str, force: Vec3, torque: Vec3) -> None:
        """A wrench from now on."""
        if "::" not in link or self._owns(link):
            row = self._link_row(link)
            link = f"{self.model}::{self.entity.link_names[row - self.entity.first_link_row]}"
        self.pushes[link] = (force, torque)

    def _owns(self, link: str) -> bool:
        return link in self.entity.link_names or self._scope + link in self.entity.link_names

    def move(self, pose: Pose, twist: Twist = STILL) -> None:
        """Put the model somewhere."""
        self.simulator.states.set_model_state(self.model, pose, twist)

    def hold(self, held: bool) -> None:
        """Keep the model where it is put."""
        self._held = held
        self.simulator.models.hold(self.model, held)

    def slip(self, link: str, joint: str, radius: float, normal_force: float, lateral: float,
             longitudinal: float) -> None:
        """Let a wheel slip."""
        self.simulator.drives.set_wheel_slips([WheelSlip(
            self._link_row(link), self._axis_row(self._joint_spec(joint).name), radius,
            normal_force, lateral, longitudinal)])

    def mimic(self, follower: str, leader: str, multiplier: float, offset: float) -> None:
        """Have a joint follow another one."""
        (joint, ahead) = self.joint(follower), self.joint(leader)
        spec = next(one for one in self.entity.model.joints if one.name == joint.spec_name)
        wanted = Mimic(ahead.spec_name, multiplier, offset)
        if spec.axis is None or spec.axis.mimic == wanted:
            return
        self.simulator.joints.edit(f"{self.model}::{spec.name}", replace(
            spec, axis=replace(spec.axis, mimic=wanted)))

    # -- other models ----------------------------------------------------------------------------

    def model_link(self, scoped: str) -> SimulatedLink:
        """A link of any model."""
        found = self.simulator.models.link_place(scoped)
        if found is None:
            raise PluginError(f"there is no link '{scoped}'")
        link = SimulatedLink(self, scoped)
        link.row, link.inertial = found
        return link

    def models(self) -> Dict[str, Model]:
        """All models."""
        return {entity.model.name: entity.model
                for entity in self.simulator.models.inventory()[1]}

    def attach(self, name: str, parent: str, child: str) -> None:
        """Fix a link to another."""
        try:
            self.simulator.models.attach(name, parent, child)
        except CommandError as fault:
            raise PluginError(str(fault)) from fault
        if name not in self._attached:
            self._attached.append(name)

    def detach(self, name: str) -> bool:
        """Let go."""
        self._attached = [one for one in self._attached if one != name]
        return self.simulator.models.detach(name)

    def efforts(self, joints: Sequence[str]) -> List[float]:
        """What was spent on joints in the last step."""
        return self.simulator.drives.efforts([self.joint(name).row for name in joints])

    def set_joint_positions(self, positions: Dict[str, float]) -> None:
        """Move joints at once."""
        self.simulator.joints.set_positions(
            {f"{self.model}::{self.joint(name).spec_name}": value
             for name, value in positions.items()})

    def scan(self, fan: RayFan, visuals: bool, call: Callable[[RayReturns, int], None]) -> None:
        """Cast rays from the plugin's sensor."""
        assert self.sensor is not None
        self.sensing.scan(Mount(self._link_row(self.sensor_link), self.sensor.pose), fan, visuals,
                          call, self.now_ns)

    def photograph(self, views: Sequence[View], call: Callable[[List[Pictures], int], None],
                   stream: str = "") -> bool:
        """Take pictures."""
        mounted = [(Mount(self._link_row(view.link), view.pose), view) for view in views]
        return self.sensing.photograph(mounted, call, self.now_ns, self.simulator.clock.by_hand,
                                       stream)

    def sensors(self) -> List[Tuple[str, Sensor]]:
        """The sensors of the model's links."""
        return [(link.name, sensor) for link in self.entity.model.links for sensor in link.sensors]

    def link_names(self) -> Dict[int, str]:
        """Scoped names by row."""
        return self.simulator.states.link_names()

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
        self.opened.append(topic)
        self._topics.append((self._name(name), kind, False))
        return Offer(self, topic)

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None],
                  queue: int = 1) -> "OpenEnd":
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
            heard = OpenEnd(self, self._graph.subscribe(self._name(name), kind, arrived, queue))
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing
        self._topics.append((self._name(name), kind, True))
        return heard

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

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> "OpenEnd":
        """Offer a service."""
        def asked(request: Any, response: Any) -> None:
            done = threading.Event()

            fault: List[str] = []

            def answer() -> None:
                try:
                    call(request, response)
                except Exception as raised:  # the caller hears of it as well
                    fault.append(str(raised))
                    raise
                finally:
                    done.set()

            self.inbox.append(answer)
            self._wake()
            while not done.wait(_LOOK_S):
                if self._closed.is_set():
                    fault.append("the plugin has ended")
                    break
            if fault:
                raise PluginError(fault[0])

        try:
            return OpenEnd(self, self._graph.serve(self._name(name), kind, asked))
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing

    def parameter(self, name: str, default: Any) -> Any:
        """A parameter of the namespace."""
        return self._graph.parameter(self._namespace, name, default)

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
