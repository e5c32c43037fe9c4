"""The context of a plugin in a running simulator."""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Callable, Deque, Dict, List, NamedTuple, Optional, Sequence, Tuple

from ..description.light import Light
from ..description.model import Joint as JointSpec
from ..description.model import Mimic, Model
from ..description.sensor import Sensor
from ..description.shapes import Material
from ..description.surroundings import SphericalCoordinates
from ..description.transmission import Transmission
from ..engine.commands import Command, JointWrench
from ..engine.drive_commands import PlanarVelocity, WheelSlip
from ..engine.rates import Rate
from ..engine.wrench_laws import WrenchLaw
from ..errors import CommandError, Issue, Severity
from ..geometry import IDENTITY, STILL, ZERO3, Pose, Twist, Vec3, compose
from ..sensing.api import Mount, Pictures, RayFan, RayReturns
from ..simulator.entity import Entity
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator
from .checked_arguments import check_finite, check_vector
from .context import PluginError, Publication, View
from .found_plugins import FoundPlugin, owner_text
from .graph import Graph, TopicUse
from .model_rows import ModelRows, transmissions_of
from .observations import Observation, Observations, Reads, StepView, queries_of
from .parameters import Parameters
from .plugin_state import PluginParameter
from .schedule import Schedule, ScheduledCall
from .sensing_requests import SensingRequests
from .simulated_graph import GraphUser
from .simulated_handles import PendingCommands, SimulatedJoint, SimulatedLink
from .step_readings import StepReadings


class SharedServices(NamedTuple):
    """What the contexts of all plugins share.

    Attributes:
        report: reports an issue to the user.
        view: where links and joints are.
        subscribers_changed: called, in any thread, when subscribers of a topic come or go.
    """

    simulator: Simulator
    graph: Graph
    report: Callable[[Issue], None]
    scene: SceneSensing
    schedule: Schedule
    readings: StepReadings
    observations: Observations
    view: StepView
    subscribers_changed: Callable[[], None]


class SimulatedContext(GraphUser):
    """One plugin's view of one model; see `context.Context`. For the thread of the host.

    Attributes:
        commands: those for its model since they were last sent.
        wrench_ids: the wrenches that act now, by link.
        sensing: what it has asked of the sensing process.
    """

    def __init__(self, shared: SharedServices, entity: Entity, found: FoundPlugin,
                 wake: Callable[[], None]) -> None:
        super().__init__(shared.graph, wake, shared.subscribers_changed)
        self.simulator, self._report, self._schedule, self._readings = (
            shared.simulator, shared.report, shared.schedule, shared.readings)
        self.observations, self._view = shared.observations, shared.view
        self.model = entity.model.name
        self.sensor, self.sensor_link, self.sensor_joint = found.sensor, found.link, found.joint
        self.spec, self._scope = found.spec, found.scope
        self.parameters = Parameters(found.spec.xml, self.warn)
        self.entity = entity
        self._rows = ModelRows(entity, found.scope)
        self.commands = PendingCommands()
        self._level: Optional[PlanarVelocity] = None
        self._links: Dict[str, SimulatedLink] = {}
        self._joints: Dict[str, SimulatedJoint] = {}
        self.wrench_ids: Dict[str, int] = {}
        self._attached: List[str] = []
        self._held = False
        self._world_changes: List[ScheduledCall] = []
        self.sensing = SensingRequests(shared.scene, self.inbox, wake, self.warn,
                                       lambda: self.observations.request_step(self),
                                       "" if found.sensor is None else found.sensor.name)

    # -- for the host ----------------------------------------------------------------------------

    def bind(self, entity: Entity) -> None:
        """Use the model's new rows and name. Raises PluginError for a missing link or joint."""
        has_same_rows = self.entity.model_id == entity.model_id
        self.entity = self._rows.entity = entity
        if has_same_rows:   # it only looks different
            return
        self.model = entity.model.name
        for link in self._links.values():
            self._find(link)
        self.commands.motors.clear()
        self.commands.servos.clear()
        for joint in self._joints.values():
            joint.moved_to(self._rows.axis(joint.spec_name))
        if self._level is not None:
            self.set_planar_velocity(self._level.x, self._level.y, self._level.yaw_rate)
        self.observations.changed = True

    def close(self) -> None:
        """Remove the plugin from the ROS graph, and end its calls."""
        self.close_graph()
        self._schedule.end_all(self)
        self.observations.end_all(self)

    def stop(self) -> None:
        """Switch off what the plugin drives, in a world that still has the model."""
        for joint in self._joints.values():
            joint.release()
        if self._level is not None:
            self.simulator.drives.stop(self.entity)
        if self._held:
            self.hold(False)
        self.release()

    def release(self) -> None:
        """Remove the joints and the wrenches of the plugin."""
        self.commands.wrenches.clear()
        if self.wrench_ids:
            self.simulator.wrenches.remove(list(self.wrench_ids.values()))
        self.wrench_ids = {}
        for name in list(self._attached):
            self.detach(name)

    def unsent(self) -> Deque[None]:
        return self.sensing.unsent

    # -- time ------------------------------------------------------------------------------------

    @property
    def now_ns(self) -> int:
        return self._schedule.sim_ns

    @property
    def step_size(self) -> float:
        return self.simulator.physics.settings.max_step_size

    @property
    def is_stepped_manually(self) -> bool:
        return self.simulator.clock.is_stepped_manually

    @property
    def step(self) -> int:
        time_step = self._schedule.time_step
        return time_step.step if time_step is not None else self.simulator.clock.step

    def every(self, hertz: float, call: Callable[[], None]) -> ScheduledCall:
        return self._schedule.every(self, hertz, call)

    def observe(self, hertz: float, call: Callable[[], None],
                topics: Sequence[Publication] = (), *, lead: float = 0.0,
                resume: Optional[Callable[[], None]] = None, transforms: bool = False,
                remembers: bool = False, contacts: bool = False, efforts: Sequence[str] = (),
                wrenches: Sequence[str] = (), world: bool = False) -> Observation:
        if transforms:
            self.offer_transforms()
        made = self.observations.add(
            self, Rate(hertz, lead), call, resume, topics, transforms, remembers,
            Reads(contacts, tuple(efforts), tuple(wrenches), world))
        made.begin(self._schedule.time_step)
        return made

    def list_observed(self, reads: Reads) -> Tuple[Tuple[int, ...], Tuple[int, ...],
                                                   Tuple[Command, ...]]:
        """Rows of links and joint axes that observations record, and their queries."""
        links = {link.row for link in self._links.values()}
        if self.entity.link_names:
            links.add(self.entity.canonical_row)
        return (tuple(sorted(links)), tuple(sorted(joint.row for joint in self._joints.values())),
                queries_of(reads, self._rows))

    def once(self, ns: int, call: Callable[[], None]) -> ScheduledCall:
        return self._schedule.once(self, ns, call)

    def on_world_change(self, call: Callable[[], None]) -> ScheduledCall:
        made = ScheduledCall(self, None, call)
        self._world_changes = [*(one for one in self._world_changes if not one.ended), made]
        return made

    @property
    def world_change_calls(self) -> List[Callable[[], None]]:
        """The functions to call after a change of the world."""
        return [one.call for one in self._world_changes if not one.ended]

    # -- the model -------------------------------------------------------------------------------

    @property
    def pose(self) -> Pose:
        if not self.entity.link_names:
            return self.entity.pose
        pose = self._view.link_at(self.entity.canonical_row)[0]
        offset = self.entity.link_from_model
        return pose if offset == IDENTITY else compose(pose, offset)

    @property
    def twist(self) -> Twist:
        return self._view.link_at(self.entity.canonical_row)[1]

    @property
    def gravity(self) -> Vec3:
        return self.simulator.physics.gravity

    @property
    def seed(self) -> int:
        return self.simulator.world.seed

    @property
    def magnetic_field(self) -> Vec3:
        return self.simulator.world.magnetic_field

    @property
    def wind(self) -> Vec3:
        return self.simulator.world.wind.linear_velocity

    @property
    def spherical_coordinates(self) -> Optional[SphericalCoordinates]:
        return self.simulator.world.spherical_coordinates

    def link(self, name: str) -> SimulatedLink:
        if not name and self.entity.link_names:
            name = self.entity.link_names[self.entity.canonical]
        if name not in self._links:
            link = SimulatedLink(self._view, name)
            self._find(link)
            self._links[name] = link
        return self._links[name]

    def _find(self, link: SimulatedLink) -> None:
        link.row = self._rows.link(link.name)
        link.inertial = self.entity.model.links[link.row - self.entity.first_link_row].inertial

    def joint(self, name: str) -> SimulatedJoint:
        if name not in self._joints:
            spec = self._rows.joint(name)
            joint = SimulatedJoint(self._view, self.commands, spec, name)
            joint.row = self._rows.axis(spec.name)
            self._joints[name] = joint
        return self._joints[name]

    def joint_wrench(self, name: str) -> Optional[JointWrench]:
        return self._readings.wrench(self.entity, self._rows.joint(name).name)

    def set_planar_velocity(self, x: float, y: float, yaw_rate: float) -> None:
        self.commands.planar = self._level = PlanarVelocity(
            self.entity.model_id, check_finite(x, "x"), check_finite(y, "y"),
            check_finite(yaw_rate, "yaw_rate"))

    @property
    def description(self) -> Model:
        return self.entity.model

    def transmissions(self, parameter: str) -> List[Transmission]:
        return transmissions_of(self.entity.model, parameter,
                                lambda: self.search_parameter(parameter, ""))

    def set_wrench(self, link: str, force: Vec3, torque: Vec3) -> None:
        self.commands.wrenches[self._pushed(link)] = (check_vector(force, "force"),
                                                  check_vector(torque, "torque"), None, "")

    def set_wrench_law(self, link: str, law: WrenchLaw, joint: str = "") -> None:
        followed = joint and f"{self.model}::{self._rows.joint(joint).name}"
        self.commands.wrenches[self._pushed(link)] = (ZERO3, ZERO3, law, followed)

    def _pushed(self, link: str) -> str:
        return link if "::" in link and not self._rows.has_link(link) else self.scoped(link)

    def scoped(self, link: str) -> str:
        return f"{self.model}::{self._link_name(link)}"

    def _link_name(self, link: str) -> str:
        """The name of a link in the description of the model."""
        return self.entity.link_names[self._rows.link(link) - self.entity.first_link_row]

    def joint_spec(self, name: str) -> JointSpec:
        return self._rows.joint(name)

    def move(self, pose: Pose, twist: Twist = STILL) -> None:
        self.simulator.states.set_model_state(self.model, pose, twist)

    def hold(self, held: bool) -> None:
        self._held = held
        self.simulator.models.hold(self.model, held)

    def set_wheel_slip(self, link: str, joint: str, radius: float, normal_force: float,
                       lateral: float,
             longitudinal: float) -> None:
        self.simulator.drives.set_wheel_slips([WheelSlip(
            self._rows.link(link), self._rows.axis(self._rows.joint(joint).name), radius,
            normal_force, lateral, longitudinal)])

    def mimic(self, follower: str, leader: str, multiplier: float, offset: float) -> None:
        (joint, ahead) = self.joint(follower), self.joint(leader)
        spec = next(one for one in self.entity.model.joints if one.name == joint.spec_name)
        wanted = Mimic(ahead.spec_name, multiplier, offset)
        if spec.axis is None or spec.axis.mimic == wanted:
            return
        self.simulator.joints.edit(f"{self.model}::{spec.name}", replace(
            spec, axis=replace(spec.axis, mimic=wanted)))

    # -- other models ----------------------------------------------------------------------------

    def model_link(self, scoped: str) -> SimulatedLink:
        found = self.simulator.models.link_place(scoped)
        if found is None:
            raise PluginError(f"there is no link '{scoped}'")
        link = SimulatedLink(self._view, scoped)
        link.row, link.inertial = found
        return link

    def models(self) -> Dict[str, Model]:
        return {entity.model.name: entity.model
                for entity in self.simulator.models.inventory()[1]}

    def move_model(self, name: str, pose: Pose, twist: Twist = STILL) -> None:
        try:
            self.simulator.states.set_model_state(name, pose, twist)
        except CommandError as fault:
            raise PluginError(str(fault)) from fault

    def lights(self) -> Dict[str, Light]:
        return {light.name: light for light in self.simulator.lights.all()}

    def set_light(self, light: Light) -> None:
        try:
            self.simulator.lights.set(light.name, light)
        except CommandError as fault:
            raise PluginError(str(fault)) from fault

    def set_material(self, link: str, visual: str, material: Material) -> None:
        try:
            self.simulator.models.set_material(self.model, self._link_name(link), visual, material)
        except CommandError as fault:
            raise PluginError(str(fault)) from fault

    def attach(self, name: str, parent: str, child: str) -> None:
        try:
            self.simulator.models.attach(name, parent, child)
        except CommandError as fault:
            raise PluginError(str(fault)) from fault
        if name not in self._attached:
            self._attached.append(name)

    def detach(self, name: str) -> bool:
        self._attached = [one for one in self._attached if one != name]
        return self.simulator.models.detach(name)

    def attached_link(self, name: str) -> str:
        return next((joint.child for joint in self.simulator.models.attachments(name)), "")

    def efforts(self, joints: Sequence[str]) -> List[float]:
        return self._readings.efforts([self.joint(name).row for name in joints])

    def set_joint_positions(self, positions: Dict[str, float]) -> None:
        self.simulator.joints.set_positions(
            {f"{self.model}::{self.joint(name).spec_name}": value
             for name, value in positions.items()})

    def scan(self, fan: RayFan, visuals: bool, call: Callable[[RayReturns, int], None],
             place: Optional[Tuple[str, Pose]] = None) -> None:
        if place is None:
            assert self.sensor is not None
            place = (self.sensor_link, self.sensor.pose)
        self.sensing.scan(Mount(self._rows.link(place[0]), place[1]), fan, visuals, call,
                          self.now_ns, self._view.world_rows())

    def photograph(self, views: Sequence[View], call: Callable[[List[Pictures], int], None],
                   stream: str = "", queue: bool = False) -> bool:
        mounted = [(Mount(self._rows.link(view.link), view.pose), view) for view in views]

        def again() -> None:
            self.photograph(views, call, stream, queue)

        # Request again at a step: the message's stamp is the sim time of the picture.
        return self.sensing.photograph(mounted, call, self.now_ns, self._view.world_rows(),
                                       self.is_stepped_manually, lambda: self.once(0, again),
                                       stream, queue)

    def sensors(self) -> List[Tuple[str, Sensor]]:
        return [(link.name, sensor) for link in self.entity.model.links for sensor in link.sensors]

    def link_names(self) -> Dict[int, str]:
        return self.simulator.states.link_names()

    def contacts(self) -> List[Any]:
        return self._readings.contacts()

    def topic_uses(self) -> List[TopicUse]:
        """Return the topics of the plugin; from any thread."""
        link, pose = "", IDENTITY
        if self.sensor is not None:
            link, pose = self._scope + self.sensor_link, self.sensor.pose
            if link not in self.entity.link_names:
                link = self.sensor_link
        kind = self.sensor.type if self.sensor is not None else ""
        return [TopicUse(name, message, is_subscription, self.model, link, kind, pose)
                for name, message, is_subscription in self.uses()]

    def declare_parameters(self, parameters: Sequence[PluginParameter]) -> None:
        """Add parameters that the plugin has read in its own process."""
        self.parameters.declare(parameters)

    # -- log -------------------------------------------------------------------------------------

    def info(self, text: str) -> None:
        self._report_issue(Severity.NOTE, text)

    def warn(self, text: str) -> None:
        self._report_issue(Severity.WARNING, text)

    def _report_issue(self, severity: Severity, text: str) -> None:
        self._report(Issue(severity, "plugin", f"plugin '{self.spec.name}' of"
                           f" {owner_text(self.model)}: {text}", self.spec.file, self.spec.line))
