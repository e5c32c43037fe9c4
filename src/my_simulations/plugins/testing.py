"""A world without ROS and physics, in which a plugin can be tested.

context = FakeContext('<plugin><updateRate>10</updateRate></plugin>', joints=("left", "right"))
plugin = context.load(MyPlugin)
context.deliver("cmd_vel", linear={"x": 0.5})
context.advance(1.0)
assert context.joints["left"].motor == (5.0, 1.0)
assert context.published["odom"][-1].pose.pose.position.x == 0.5
"""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, TypeVar

from ..description.light import Light
from ..description.model import Inertial, JointAxis, Model
from ..description.model import Joint as JointSpec
from ..description.sensor import Sensor
from ..description.shapes import Material
from ..description.surroundings import SphericalCoordinates
from ..description.transmission import Transmission
from ..engine.commands import JointWrench
from ..engine.drive_commands import JointMotor, JointServo, RateRamp, SetMotors
from ..engine.motor_ramps import MotorRamps
from ..engine.rates import Rate
from ..engine.ring import Clock
from ..engine.servo_law import FOLLOW, ServoLaw
from ..engine.wrench_laws import AT_REST, WrenchLaw
from ..geometry import IDENTITY, STILL, Pose, Twist, Vec3
from .base import Plugin
from .context import PluginError
from .parameters import Parameters
from .testing_graph import FakeGraph, FakeHandle, Message

__all__ = ["FakeContext", "FakeHandle", "Message"]

LoadedPlugin = TypeVar("LoadedPlugin", bound=Plugin)


class _Call:
    def __init__(self, owner: "List[_Call]", call: Callable[[], None], rate: Optional[Rate],
                 ns: int = 0, stops: bool = False) -> None:
        self._owner, self._rate, self._ns, self.stops = owner, rate, ns, stops
        self.call = call

    def is_due(self, step: int, now_ns: int, clock: Clock) -> bool:
        if self._rate is not None:
            return self._rate.is_at(step, clock)
        if now_ns < self._ns:
            return False
        self.end()
        return True

    def end(self) -> None:
        if self in self._owner:
            self._owner.remove(self)


class FakeContext(FakeGraph):
    """A `Context` for tests; see `FakeGraph` for topics and services.

    Attributes:
        links, joints: by name; a requested link is created.
        pose, twist: of the model.
        said: the messages to the user.
        wrenches: the last wrench of each link; laws are computed after each step.
        level: the last planar velocity.
        returns: the returns of rays; `fans`: (fan, visuals) of the scans.
        pictures: the result of each view; `views`: the views of each call. `late`: none is ready.
        is_stepped_manually: the world is stepped manually.
        model_sensors, labels: the results of `sensors` and `link_names`.
        touching: the contacts.
        joint_wrenches: the wrenches that joints transmit.
        held: whether the model is held.
        slips: (joint, radius, normal force, lateral, longitudinal) of wheels.
        followers: (leader, multiplier, offset) of joints that mimic others.
        others: descriptions of the models in the world. `moved`: poses of `move_model`, by name.
        attached: (parent, child) by the name of the joint.
        world_lights: the lights of the world by name, which a test puts there.
        materials: the materials of `set_material`, by link and visual.
        description: description of the model.
        log_messages: the texts of `info` and `warn`, and faults of parameters.
    """

    def __init__(self, xml: str = "<plugin/>", *, model: str = "robot",
                 joints: Sequence[str] = (), links: Optional[Sequence[str]] = None,
                 sensor: Optional[Sensor] = None, sensor_link: str = "", sensor_joint: str = "",
                 step_size: float = 0.001) -> None:
        super().__init__()
        self.model, self.sensor = model, sensor
        self.sensor_link, self.sensor_joint = sensor_link, sensor_joint
        self.joint_wrenches: Dict[str, JointWrench] = {}
        self.log_messages: List[str] = []
        self.parameters = Parameters(xml, self.log_messages.append)
        self.joints = {name: FakeJoint(name) for name in joints}
        self.links: Dict[str, FakeLink] = {name: FakeLink(name) for name in links or ()}
        self._closed_links = links is not None
        self.pose: Pose = IDENTITY
        self.twist: Twist = STILL
        self.gravity: Vec3 = (0.0, 0.0, -9.8)
        self.magnetic_field: Vec3 = (0.0, 0.0, 0.0)
        self.wind: Vec3 = (0.0, 0.0, 0.0)
        self.spherical_coordinates: Optional[SphericalCoordinates] = None
        self.seed = 0
        self.step_size, self.step = step_size, 0
        self.wrenches: Dict[str, Tuple[Vec3, Vec3]] = {}
        self.world_lights: Dict[str, Light] = {}
        self.materials: Dict[Tuple[str, str], Material] = {}
        self._laws: Dict[str, Tuple[WrenchLaw, str]] = {}
        self.level: Optional[Tuple[float, float, float]] = None
        self.touching: List[Any] = []
        self.held = False
        self.slips: Dict[str, Tuple[Any, ...]] = {}
        self.followers: Dict[str, Tuple[str, float, float]] = {}
        self.others: Dict[str, Model] = {}
        self.moved: Dict[str, Pose] = {}
        self.attached: Dict[str, Tuple[str, str]] = {}
        self.description = Model(model)
        self.returns: Any = None
        self.fans: List[Any] = []
        self.pictures: List[Any] = []
        self.views: List[Any] = []
        self.late = self.is_stepped_manually = False
        self.model_sensors: List[Tuple[str, Sensor]] = []
        self.labels: Dict[int, str] = {}
        self._ramps = MotorRamps(self._read_axes, self._set_motors)
        self._calls: List[_Call] = []
        self._world_changes: List[_Call] = []

    # -- what a test does --------------------------------------------------------------------------

    def load(self, kind: Callable[[Any], LoadedPlugin]) -> LoadedPlugin:
        """Make a plugin of a class, load it, and return it."""
        plugin = kind(self)
        plugin.load()
        return plugin

    def advance(self, seconds: float) -> None:
        """Advance sim time: joints move, and the scheduled functions are called."""
        clock = Clock(0, 0, round(self.step_size * 1e12))
        for _ in range(round(seconds / self.step_size)):
            self._set_pending_motors(clock)
            for joint in self.joints.values():
                joint.step(self.step, self.step_size)
            self.step += 1
            self._ramps.act(self.step, clock)
            for one in list(self._calls):
                if one in self._calls and one.is_due(self.step, self.now_ns, clock):
                    one.call()
            self._compute_laws()

    def _set_pending_motors(self, clock: Clock) -> None:
        motors = []
        for row, joint in enumerate(self.joints.values()):
            if joint.pending_motor is not None:
                motors.append(JointMotor(row, *joint.pending_motor))
                joint.pending_motor = None
        if motors:
            self._ramps.set(SetMotors(tuple(motors)), self.step, clock)

    def _set_motors(self, command: SetMotors) -> None:
        joints = list(self.joints.values())
        for motor in command.motors:
            joints[motor.row].motor = motor.rate, motor.effort

    def _read_axes(self, rows: Sequence[int]) -> List[float]:
        joints = list(self.joints.values())
        return [value for row in rows for value in (joints[row].position, joints[row].velocity)]

    def change_world(self) -> None:
        """Call the functions of `on_world_change`, after the test has changed something."""
        for one in list(self._world_changes):
            one.call()
        self._compute_laws()

    # -- Context -----------------------------------------------------------------------------------

    @property
    def now_ns(self) -> int:
        return round(self.step * self.step_size * 1e9)

    def every(self, hertz: float, call: Callable[[], None]) -> Any:
        self._calls.append(_Call(self._calls, call, Rate(hertz), stops=True))
        return self._calls[-1]

    @property
    def stops(self) -> int:
        """How many calls at a rate stop the engine, see `every`."""
        return sum(one.stops for one in self._calls)

    def observe(self, hertz: float, call: Callable[[], None], topics: Sequence[Any] = (), *,
                lead: float = 0.0, resume: Optional[Callable[[], None]] = None,
                transforms: bool = False, remembers: bool = False, contacts: bool = False,
                efforts: Sequence[str] = (), wrenches: Sequence[str] = (),
                world: bool = False) -> Any:
        idle = False

        def follow() -> None:
            nonlocal idle
            was_idle, idle = idle, not remembers and not transforms and not any(
                topic.wanted for topic in topics) and bool(topics)
            if not idle:
                (resume if was_idle and resume is not None else call)()

        self._calls.append(_Call(self._calls, follow, Rate(hertz, lead)))
        return self._calls[-1]

    def once(self, ns: int, call: Callable[[], None]) -> Any:
        self._calls.append(_Call(self._calls, call, None, ns))
        return self._calls[-1]

    def on_world_change(self, call: Callable[[], None]) -> Any:
        self._world_changes.append(_Call(self._world_changes, call, None))
        return self._world_changes[-1]

    def link(self, name: str) -> FakeLink:
        name = name or "base"
        if self._closed_links and name not in self.links:
            raise PluginError(f"model '{self.model}' has no link '{name}'")
        return self.links.setdefault(name, FakeLink(name))

    def joint(self, name: str) -> FakeJoint:
        if name not in self.joints:
            raise PluginError(f"model '{self.model}' has no joint '{name}'")
        return self.joints[name]

    def transmissions(self, parameter: str) -> List[Transmission]:
        return self.description.transmissions

    def set_planar_velocity(self, x: float, y: float, yaw_rate: float) -> None:
        self.level = (x, y, yaw_rate)

    def set_wrench(self, link: str, force: Vec3, torque: Vec3) -> None:
        self.wrenches[link] = (force, torque)
        self._laws.pop(link, None)

    def set_wrench_law(self, link: str, law: WrenchLaw, joint: str = "") -> None:
        self._laws[link] = law, joint
        self._compute_laws()

    def _compute_laws(self) -> None:
        for name, (law, joint) in self._laws.items():
            link = self.link(name)
            self.wrenches[name] = law.wrench(
                link.pose, link.twist, link.inertial.pose.position,
                (self.joint(joint).position, self.joint(joint).velocity) if joint else AT_REST)

    def move(self, pose: Pose, twist: Twist = STILL) -> None:
        self.pose, self.twist = pose, twist

    def hold(self, held: bool) -> None:
        self.held = held

    def scoped(self, link: str) -> str:
        self.link(link)
        return f"{self.model}::{link}"

    def joint_spec(self, name: str) -> JointSpec:
        for joint in self.description.joints:
            if joint.name == name:
                return joint
        raise PluginError(f"model '{self.model}' has no joint '{name}'")

    def set_wheel_slip(self, link: str, joint: str, *values: float) -> None:
        self.slips[link] = (joint, *values)

    def mimic(self, follower: str, leader: str, multiplier: float, offset: float) -> None:
        self.joint(follower), self.joint(leader)
        self.followers[follower] = (leader, multiplier, offset)

    def model_link(self, scoped: str) -> FakeLink:
        return self.links.setdefault(scoped, FakeLink(scoped))

    def models(self) -> Dict[str, Model]:
        return self.others

    def move_model(self, name: str, pose: Pose, twist: Twist = STILL) -> None:
        if name not in self.others:
            raise PluginError(f"there is no model '{name}'")
        self.moved[name] = pose

    def lights(self) -> Dict[str, Light]:
        """The lights that a test has put into `world_lights`."""
        return dict(self.world_lights)

    def set_light(self, light: Light) -> None:
        if light.name not in self.world_lights:
            raise PluginError(f"unknown light '{light.name}'")
        self.world_lights[light.name] = light

    def set_material(self, link: str, visual: str, material: Material) -> None:
        self.link(link)
        self.materials[link, visual] = material

    def attach(self, name: str, parent: str, child: str) -> None:
        self.attached[name] = (parent, child)

    def detach(self, name: str) -> bool:
        return self.attached.pop(name, None) is not None

    def attached_link(self, name: str) -> str:
        return self.attached.get(name, ("", ""))[1]

    def efforts(self, joints: Sequence[str]) -> List[float]:
        return [self.joint(name).effort for name in joints]

    def set_joint_positions(self, positions: Dict[str, float]) -> None:
        for name, value in positions.items():
            self.joint(name).put(value)

    def scan(self, fan: Any, visuals: bool, call: Callable[[Any, int], None],
             place: Optional[Tuple[str, Pose]] = None) -> None:
        """Store the fan in `fans`, and pass `returns`, which the test sets, to `call` at once."""
        self.fans.append((fan, visuals))
        call(self.returns, self.now_ns)

    def photograph(self, views: Any, call: Callable[[Any, int], None], stream: str = "",
                   queue: bool = False) -> bool:
        """Pass the test's `pictures` to `call`, unless they are `late`."""
        if self.late:
            return False
        self.views.append(list(views))
        call(self.pictures[:len(views)], self.now_ns)
        return True

    def sensors(self) -> List[Tuple[str, Sensor]]:
        return self.model_sensors

    def link_names(self) -> Dict[int, str]:
        return self.labels

    def joint_wrench(self, name: str) -> Optional[JointWrench]:
        return self.joint_wrenches.get(name)

    def contacts(self) -> List[Any]:
        return self.touching

    def info(self, text: str) -> None:
        self.log_messages.append(text)

    def warn(self, text: str) -> None:
        self.log_messages.append(text)


class FakeLink:
    """A link at a pose that a test sets."""

    def __init__(self, name: str) -> None:
        self.name, self.pose, self.twist = name, IDENTITY, STILL
        self.inertial = Inertial()


class FakeJoint:
    """A joint that turns as its motor says, without delay; a servo's effort turns 1 kg m^2.

    Attributes:
        motor: rate and effort that it is driven with; None before.
        pending_motor: rate, effort and ramp that the next step begins with; None for the same.
        servo: what it was steered with; None before.
        spec: its description.
        effort: what the servo spent in the last step.
        stuck: something holds it.
        set_count: how often a test or a plugin has put it somewhere.
    """

    def __init__(self, name: str) -> None:
        self.name, self.parent, self.child = name, "base", name
        self.position = self.velocity = 0.0
        self.motor: Optional[Tuple[float, float]] = None
        self.pending_motor: Optional[Tuple[float, float, Optional[RateRamp]]] = None
        self.servo: Optional[JointServo] = None
        self.spec = JointSpec(name, "revolute", "base", name, axis=JointAxis())
        self.effort = 0.0
        self.stuck = False
        self.set_count = 0
        self._law: Optional[ServoLaw] = None

    def put(self, position: float) -> None:
        """Set the position at once, with velocity 0."""
        self.position, self.velocity = position, 0.0
        self.set_count += 1
        if self.servo is not None and self.servo.holds:
            self.set_servo(self.servo)

    def drive(self, rate: float, effort: float, ramp: Optional[RateRamp] = None) -> None:
        if ramp is None:
            self.motor = (rate, effort)
        self.pending_motor = rate, effort, ramp

    def set_servo(self, servo: JointServo) -> None:
        servo = servo.held_at(self.position)
        before, self.servo = self.servo, servo
        if not servo.drive:
            self._law = None
        elif self._law is not None and before is not None and before.same_loops(servo):
            self._law.change(servo)
        else:
            self._law = None

    def step(self, step: int, dt: float) -> None:
        """Integrate one step."""
        if self.stuck:
            self.velocity = 0.0
            return
        if self.motor is not None and self.motor[1] > 0.0:
            self.velocity = self.motor[0]
        elif self.servo is not None and self.servo.drive:
            self._law = self._law or ServoLaw(self.servo, dt)
            self._follow(self._law, step, dt)
        else:
            return
        self.position += self.velocity * dt

    def _follow(self, law: ServoLaw, step: int, dt: float) -> None:
        servo = law.servo
        if not law.steady:
            asked = law.advance(self.position, self.velocity, step)
            self.effort = asked if law.gives_effort else 0.0
            self.velocity = self.velocity + asked * dt if law.gives_effort else asked
        elif servo.drive == "velocity":
            self.velocity = max(-servo.most_rate, min(servo.most_rate, servo.target))
        elif servo.drive == "position":
            way = max(servo.lower, min(servo.upper, servo.target)) - self.position
            self.velocity = max(-servo.most_rate, min(servo.most_rate, FOLLOW * way / dt))
