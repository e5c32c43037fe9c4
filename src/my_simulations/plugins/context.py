"""The interface between a plugin and the world. It does not depend on rospy or PyBullet.

Poses and twists are in the world frame; twists are at the link's (or model's) origin, in world
axes. Lengths in m, angles in rad, times in s of sim time. All calls of a plugin come from one
thread, and see the world as it is at the step they belong to.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Protocol, Sequence, Tuple

from ..description.light import Light
from ..description.model import Inertial, Model
from ..description.model import Joint as JointSpec
from ..description.sensor import Sensor
from ..description.shapes import Material
from ..description.surroundings import SphericalCoordinates
from ..description.transmission import Transmission
from ..engine.commands import JointWrench
from ..engine.drive_commands import JointServo, RateRamp
from ..engine.wrench_laws import WrenchLaw
from ..errors import SimulationError
from ..geometry import STILL, Pose, Twist, Vec3
from ..sensing.api import CameraSpec, Pictures, RayFan, RayReturns
from .parameters import Parameters


class PluginError(SimulationError):
    """A plugin cannot work as its element says; the message is one sentence for the user."""


class RequestError(PluginError):
    """An invalid service request; its caller gets the message, and the plugin continues."""


@dataclass(frozen=True)
class View:
    """A camera at `pose` in the frame of a link, and its `outputs` of `sensing.api`."""

    link: str
    pose: Pose
    camera: CameraSpec
    outputs: Tuple[str, ...]


class Link(Protocol):
    """A link; `inertial` is that of its description."""

    name: str
    inertial: Inertial

    @property
    def pose(self) -> Pose:
        """World pose of the link frame."""

    @property
    def twist(self) -> Twist:
        """Twist at the link's origin, world axes."""


class Joint(Protocol):
    """An axis of a joint of the plugin's model; `parent` and `child` name its links."""

    name: str
    parent: str
    child: str

    @property
    def position(self) -> float:
        """rad or m."""

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""

    @property
    def set_count(self) -> float:
        """The number of times the position was set directly; -1 outside of an observation."""

    def drive(self, rate: float, effort: float, ramp: Optional[RateRamp] = None) -> None:
        """Drive the motor at `rate` with at most `effort`; an effort of 0 turns it off.

        With a `ramp` the engine lets the motor approach the rate.
        """

    @property
    def spec(self) -> JointSpec:
        """The description of the joint."""

    def set_servo(self, servo: JointServo) -> None:
        """Drive the axis by a servo of the engine from the next step on; `row` is filled in."""


class CallHandle(Protocol):
    """A repeated call that continues until it is ended."""

    def end(self) -> None:
        """End the calls; a second call of this method has no effect."""


class Publication(Protocol):
    """A topic that the plugin publishes."""

    @property
    def wanted(self) -> bool:
        """Whether the topic has a subscriber."""

    def publish(self, message: Any) -> None:
        """Publish a message after the engine has resumed; do not change it after this call."""

    def publish_later(self, make: Callable[[], Any]) -> None:
        """Publish what `make` returns; another thread calls it, in order.

        For messages that take more than a millisecond to make: neither the world nor other plugins
        wait for them. `make` must use only data that it has captured.
        """

    def close(self) -> None:
        """Remove the topic from the ROS graph."""


class Handle(Protocol):
    """A subscription or service, which exists until it is closed or the plugin ends."""

    def close(self) -> None:
        """End the subscription or service."""


class Context(Protocol):
    """The world, as one plugin of one model sees it.

    Attributes:
        model: the model's name; `world` for a plugin of the world.
        parameters: what the `<plugin>` element says.
        sensor: the sensor that the plugin belongs to; None for a plugin of the model.
        sensor_link: the name of that sensor's link; "" without one.
        sensor_joint: the name of that sensor's joint; "" without one.
    """

    model: str
    parameters: Parameters
    sensor: Optional[Sensor]
    sensor_link: str
    sensor_joint: str

    # -- time ------------------------------------------------------------------------------------

    @property
    def now_ns(self) -> int:
        """Sim time of this step, ns."""

    @property
    def step_size(self) -> float:
        """Step size of the simulation, s."""

    @property
    def is_stepped_manually(self) -> bool:
        """Whether the world is stepped manually, and waits for pictures."""

    @property
    def step(self) -> int:
        """The number of steps before this one."""

    def every(self, hertz: float, call: Callable[[], None]) -> "CallHandle":
        """Be called at a rate in Hz of sim time, the first time one period from now.

        A rate of 0 or less means every step. The calls are exact to the step, without drift. `end`
        of the returned object ends them.
        """

    def observe(self, hertz: float, call: Callable[[], None],
                topics: "Sequence[Publication]" = (), *, lead: float = 0.0,
                resume: Optional[Callable[[], None]] = None, transforms: bool = False,
                remembers: bool = False, contacts: bool = False, efforts: Sequence[str] = (),
                wrenches: Sequence[str] = (), world: bool = False) -> "CallHandle":
        """Follow the world at a rate in Hz of sim time, without stopping it.

        As `every`, but `call` comes some milliseconds after the step, while the world continues.
        The context then shows that step: its time, the model's pose, and the links and joints that
        the plugin has looked up before. `call` can publish, but not act.

        Args:
            hertz: 0 or less is every step.
            call: the function.
            topics: the topics that it publishes. While none of them has a subscriber, it is not
                called; the steps stay those of the rate. Without topics it is always called.
            lead: s by which each step of the rate is earlier.
            resume: called instead of `call` at the first step after a time without subscribers.
            transforms: it broadcasts to tf, and is also called while tf has a subscriber.
            remembers: what it publishes depends on earlier calls: it is called without
                subscribers, too, though later and in larger groups.
            contacts: it reads `contacts`.
            efforts: joints that it reads `efforts` of.
            wrenches: joints that it reads `joint_wrench` of.
            world: it scans or photographs the world.
        """

    def once(self, ns: int, call: Callable[[], None]) -> "CallHandle":
        """Be called in the first step that does not begin before a sim time (ns); not in this one.

        When time is set, nothing is left of it.
        """

    def on_world_change(self, call: Callable[[], None]) -> CallHandle:
        """Be called before the next step after a change of models, physics or surroundings.

        Gravity and wind are among these; poses and velocities of models are not.
        """

    # -- the model -------------------------------------------------------------------------------

    @property
    def pose(self) -> Pose:
        """World pose of the model frame."""

    @property
    def twist(self) -> Twist:
        """Twist of the model's canonical link at its origin, world axes."""

    @property
    def gravity(self) -> Vec3:
        """m/s^2, world axes."""

    @property
    def seed(self) -> int:
        """Seed of random numbers."""

    @property
    def magnetic_field(self) -> Vec3:
        """Magnetic field of the world, T, world axes."""

    @property
    def wind(self) -> Vec3:
        """Present wind of the world, m/s, world axes."""

    @property
    def spherical_coordinates(self) -> Optional[SphericalCoordinates]:
        """Spherical coordinates of the world's origin; None if the world has none."""

    def link(self, name: str) -> Link:
        """A link of the model; "" for the canonical one.

        Raises PluginError with the names that there are.
        """

    def joint(self, name: str) -> Joint:
        """A joint of the model that moves. Raises PluginError with the names that there are."""

    def set_planar_velocity(self, x: float, y: float, yaw_rate: float) -> None:
        """Move the model in its horizontal plane from now on: m/s along its own x and y axis, and
        rad/s.
        """

    @property
    def description(self) -> Model:
        """The flattened description of the model."""

    def transmissions(self, parameter: str) -> List[Transmission]:
        """The transmissions of the model's description, else of the URDF in a parameter.

        The parameter is looked for in the namespace and those above. Raises PluginError.
        """

    def set_wrench(self, link: str, force: Vec3, torque: Vec3) -> None:
        """A wrench on a link from now on, instead of the one given before.

        N and N m, world axes, at the centre of mass. The link is one of the model, or of another
        model by its scoped name.
        """

    def set_wrench_law(self, link: str, law: WrenchLaw, joint: str = "") -> None:
        """As `set_wrench`, with the wrench that a law gives for the state of the link in each step.

        The engine computes it, so it costs no synchronization. `law` is one of
        `engine.wrench_laws`; it can follow the state of a joint of the model.
        """

    def move(self, pose: Pose, twist: Twist = STILL) -> None:
        """Set the model's pose and twist at once; all its links move as one body."""

    def hold(self, held: bool) -> None:
        """Keep the model at rest at its pose, whatever forces act on it, or release it again."""

    def scoped(self, link: str) -> str:
        """Return the name of a link in the world, as used by contacts and `attach`.

        The part after the model's name is the link's name in `description`. Raises PluginError.
        """

    def joint_spec(self, name: str) -> JointSpec:
        """Return the description of a joint, which can be fixed. Raises PluginError."""

    def set_wheel_slip(self, link: str, joint: str, radius: float, normal_force: float,
                       lateral: float,
             longitudinal: float) -> None:
        """Let a wheel slip in proportion to its speed, until a reset (`engine.WheelSlip`).

        `joint` is the axis it turns about; m, N, and compliances without a unit.
        """

    def mimic(self, follower: str, leader: str, multiplier: float, offset: float) -> None:
        """Make a joint follow another one from now on: q = multiplier q_leader + offset."""

    # -- other models ----------------------------------------------------------------------------

    def model_link(self, scoped: str) -> Link:
        """Return a link of any model by its scoped name, for this call only. Raises PluginError."""

    def models(self) -> "Dict[str, Model]":
        """The flattened descriptions of all models by name, the plugin's own among them."""

    def move_model(self, name: str, pose: Pose, twist: Twist = STILL) -> None:
        """Set the pose and twist of any model, as `move`. Raises PluginError."""

    def lights(self) -> "Dict[str, Light]":
        """The lights of the world by name."""

    def set_light(self, light: Light) -> None:
        """Replace the light of that name, for cameras and the editor.

        Raises PluginError for a light that the world does not have.
        """

    def set_material(self, link: str, visual: str, material: Material) -> None:
        """Show a visual of a link of the model in another material, for cameras and the editor.

        It replaces the whole material; the model keeps it, also in a saved world. Raises
        PluginError for a visual that the link does not have.
        """

    def attach(self, name: str, parent: str, child: str) -> None:
        """Fix a link (scoped name) to one of another model, or to `world`, as they are now.

        The joint ends with either model, with a reset, and with `detach`. Raises PluginError.
        """

    def detach(self, name: str) -> bool:
        """Remove the joint of `attach`; return whether it existed."""

    def attached_link(self, name: str) -> str:
        """Return the child link of the joint of `attach`; "" if there is no such joint."""

    def efforts(self, joints: Sequence[str]) -> List[float]:
        """Return the efforts of motors and servos in the last step, N m or N, from the engine."""

    def set_joint_positions(self, positions: "dict[str, float]") -> None:
        """Set joint positions (rad or m) at once, with velocity 0."""

    def joint_wrench(self, name: str) -> Optional[JointWrench]:
        """What a joint of the model, a fixed one too, transmitted in the last step.

        The first answer is None, and so is the one after a reset; so ask once in `load`. Raises
        PluginError with the names of the joints that there are.
        """

    def contacts(self) -> "List[Any]":
        """The contacts of the last step: (link, other link, `engine.commands.Contact`).

        Links by their scoped names; of all models.
        """

    def scan(self, fan: RayFan, visuals: bool, call: Callable[[RayReturns, int], None],
             place: Optional[Tuple[str, Pose]] = None) -> None:
        """Cast rays from the plugin's sensor, or from a place on a link, as of now.

        `call` gets what they have met, and the sim time (ns) they were cast at, up to one scan
        later; the world does not run further ahead. `visuals`: rays see what is drawn, else what
        collides.
        """

    def photograph(self, views: Sequence[View], call: Callable[[List[Pictures], int], None],
                   stream: str = "", queue: bool = False) -> bool:
        """Take pictures of the world as of now.

        `call` gets them in the order of the views, and the sim time (ns) they show. A stream has
        one pending call at a time: until its pictures are published, further pictures are late.
        Then the world continues, these are left out (False), and the user gets a warning; a world
        that is stepped manually waits instead. `stream` names cameras of a plugin with calls
        independent of other streams. `queue` allows a call while messages of the last are made.
        """

    def sensors(self) -> List[Tuple[str, Sensor]]:
        """Return the sensors of the model's links: (name of the link, sensor)."""

    def link_names(self) -> "dict[int, str]":
        """Scoped names of all links of the world, by the numbers that `Pictures.labels` has."""

    # -- topics, services, parameters ------------------------------------------------------------

    def use_namespace(self, namespace: str) -> None:
        """The namespace that names of topics, services and parameters are relative to.

        "/" is the root; "", as without a call, is the node's own.
        """

    def message(self, kind: str) -> Any:
        """Return a new message of a type such as `nav_msgs/Odometry`."""

    def stamp(self, ns: Optional[int] = None) -> Any:
        """Return a time as a message field; the default is now."""

    def publish(self, name: str, kind: str, queue: int = 1, latch: bool = False) -> Publication:
        """Advertise a topic; a topic with an empty name is not on the ROS graph.

        Raises PluginError if the type's package is not installed.
        """

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None],
                  queue: int = 1) -> Handle:
        """Subscribe to a topic. Between two steps `queue` messages are kept; the oldest are lost.

        Raises PluginError if the type's package is not installed.
        """

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> Handle:
        """Advertise a service; `call` gets the request and a response to fill."""

    def parameter(self, name: str, default: Any) -> Any:
        """Return a parameter of the namespace; a nested one is a dictionary."""

    def search_parameter(self, name: str, default: Any) -> Any:
        """Return a parameter of the namespace or of the nearest parent that has it."""

    def transform(self, parent: str, child: str, pose: Pose) -> None:
        """Broadcast the present pose of `child` in `parent` to tf."""

    # -- log -------------------------------------------------------------------------------------

    def info(self, text: str) -> None:
        """Report information to the user, with file and line of the plugin."""

    def warn(self, text: str) -> None:
        """Report a warning to the user, with file and line of the plugin."""
