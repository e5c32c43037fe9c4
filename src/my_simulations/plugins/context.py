"""What a plugin sees of the world. Neither rospy nor PyBullet are behind these names by themselves.

Poses and twists are in the world frame; twists are at the link's (or model's) origin, in world
axes. Lengths in m, angles in rad, times in s of sim time. All calls of a plugin come from one
thread, with the world standing still at the step they belong to.
"""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional, Protocol

from ..description.model import Inertial, Model
from ..description.sensor import Sensor
from ..engine.commands import JointWrench
from ..errors import SimulationError
from ..geometry import STILL, Pose, Twist, Vec3
from ..sensing.api import RayFan, RayReturns
from .parameters import Parameters


class PluginError(SimulationError):
    """A plugin cannot work as its element says; the message is one sentence for the user."""


class Link(Protocol):
    """A link; `inertial` is what its description says."""

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

    def drive(self, rate: float, effort: float) -> None:
        """Turn the motor: to `rate` with `effort` at most; 0 effort turns it off."""


class Ending(Protocol):
    """Something that goes on until it is ended."""

    def end(self) -> None:
        """End it; nothing happens when it has ended already."""


class Publication(Protocol):
    """A topic that the plugin publishes."""

    @property
    def wanted(self) -> bool:
        """Whether anybody listens."""

    def publish(self, message: Any) -> None:
        """Publish a message once the world goes on; it must not be changed any more."""


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
        """Of the simulation, s."""

    def every(self, hertz: float, call: Callable[[], None]) -> "Ending":
        """Be called at a rate in Hz of sim time, the first time one period from now.

        0 or less is every step. The appointments are exact to the step and never drift. `end` of
        what is returned ends them.
        """

    def once(self, ns: int, call: Callable[[], None]) -> "Ending":
        """Be called in the first step that does not begin before a sim time (ns); not in this one.

        When time is set, nothing is left of it.
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
        """Of what is drawn at random."""

    def link(self, name: str) -> Link:
        """A link of the model. Raises PluginError with the names that there are."""

    def joint(self, name: str) -> Joint:
        """A joint of the model that moves. Raises PluginError with the names that there are."""

    def drive_level(self, x: float, y: float, yaw_rate: float) -> None:
        """Have the model move level from now on: m/s along its own x and y axis, and rad/s."""

    @property
    def description(self) -> Model:
        """The flattened description of the model."""

    def push(self, link: str, force: Vec3, torque: Vec3) -> None:
        """A wrench on a link from now on, instead of the one given before.

        N and N m, world axes, at the centre of mass. The link is one of the model, or of another
        model by its scoped name.
        """

    def move(self, pose: Pose, twist: Twist = STILL) -> None:
        """Put the model somewhere at once; all its links move as one body."""

    def hold(self, held: bool) -> None:
        """Keep the model at rest where it is put, whatever acts on it; or no more."""

    def slip(self, link: str, joint: str, radius: float, normal_force: float, lateral: float,
             longitudinal: float) -> None:
        """Let a wheel slip in proportion to its speed, until a reset (`engine.WheelSlip`).

        `joint` is the axis it turns about; m, N, and compliances without a unit.
        """

    def mimic(self, follower: str, leader: str, multiplier: float, offset: float) -> None:
        """Have a joint follow another one from now on: q = multiplier q_leader + offset."""

    # -- other models ----------------------------------------------------------------------------

    def model_link(self, scoped: str) -> Link:
        """A link of any model by its scoped name; for this moment. Raises PluginError."""

    def models(self) -> "Dict[str, Model]":
        """The flattened descriptions of all models by name, the plugin's own among them."""

    def attach(self, name: str, parent: str, child: str) -> None:
        """Fix a link (scoped name) to one of another model, or to `world`, as they are now.

        The joint ends with either model, with a reset, and with `detach`. Raises PluginError.
        """

    def detach(self, name: str) -> bool:
        """Let go of what `attach` has joined; returns whether it held."""

    def set_joint_positions(self, positions: "dict[str, float]") -> None:
        """Move joints (rad or m) at once, at rest."""

    def joint_wrench(self, name: str) -> Optional[JointWrench]:
        """What a joint of the model, a fixed one too, transmitted in the last step.

        The first answer is None, and so is the one after a reset; so ask once in `load`. Raises
        PluginError with the names of the joints that there are.
        """

    def contacts(self) -> "List[Any]":
        """The contacts of the last step: (link, other link, `engine.commands.Contact`).

        Links by their scoped names; of all models.
        """

    def scan(self, fan: RayFan, visuals: bool, call: Callable[[RayReturns, int], None]) -> None:
        """Cast rays from the plugin's sensor, as of now.

        `call` gets what they have met, and the sim time (ns) they were cast at, up to one scan
        later; the world does not run further ahead. `visuals`: rays see what is drawn, else what
        collides.
        """

    # -- topics, services, parameters ------------------------------------------------------------

    def use_namespace(self, namespace: str) -> None:
        """The namespace that names of topics, services and parameters are relative to."""

    def message(self, kind: str) -> Any:
        """A new message of a type such as `nav_msgs/Odometry`."""

    def stamp(self, ns: Optional[int] = None) -> Any:
        """A time as messages have it; default now."""

    def publish(self, name: str, kind: str, queue: int = 1, latch: bool = False) -> Publication:
        """Offer a topic. Raises PluginError where the type's package is not installed."""

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None],
                  queue: int = 1) -> None:
        """Hear a topic. Of more messages than `queue` between two steps the oldest are lost.

        Raises PluginError where the type's package is not installed.
        """

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> None:
        """Offer a service; `call` gets the request and a response to fill."""

    def search_parameter(self, name: str, default: Any) -> Any:
        """A parameter of the namespace, or of the next one above that has it (`tf_prefix`)."""

    def transform(self, parent: str, child: str, pose: Pose) -> None:
        """Broadcast to tf where `child` is in `parent`, as of now."""

    # -- log -------------------------------------------------------------------------------------

    def info(self, text: str) -> None:
        """Tell the user something; file and line of the plugin are added."""

    def warn(self, text: str) -> None:
        """Warn the user."""
