"""The ROS interface as one table, read by registration, documentation and tests.

Imports nothing of ROS, so it can be read without a ROS installation.
"""
from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Iterator, List, Tuple


class Direction(enum.Enum):
    """How the node uses a service or topic name."""

    SERVES = "service"
    PUBLISHES = "published"
    SUBSCRIBES = "subscribed"


SERVES, PUBLISHES, SUBSCRIBES = (
    Direction.SERVES, Direction.PUBLISHES, Direction.SUBSCRIBES)

BY_ROSPY = "rospy"
"""Handler of services and topics that rospy itself provides in every node."""

OURS = "my_simulations_msgs"


@dataclass(frozen=True)
class Row:
    """One service or topic.

    Attributes:
        name: below the node's own name, or absolute.
        type: `package/Type`.
        direction: served, published or subscribed.
        handler: `group.method`, see `registration`; `BY_ROSPY` where rospy provides it.
        title: prefix of every status message of a service (Gazebo behaviour).
        extension: not in gazebo_ros with Gazebo 9; not offered with `~extensions` false.
        since: version of Gazebo from which on gazebo_ros has an extension, too; "" for never.
        always: offered even with `~enable_ros_network` false.
        meaning: description for the documentation; "" where the name says it all.
    """

    name: str
    type: str
    direction: Direction
    handler: str
    title: str = ""
    extension: bool = False
    since: str = ""
    always: bool = False
    meaning: str = ""

    @property
    def late(self) -> bool:
        """Whether it is offered only once the world runs, to shorten the start."""
        return self.extension or self.handler.split(".")[0] == "reconfigure"

    @property
    def changes_world(self) -> bool:
        """Whether requests or messages can change the world, its time or files."""
        return (self.direction is not Direction.PUBLISHES and self.handler != BY_ROSPY
                and not self.name.startswith("get_"))

    @property
    def graph_name(self) -> str:
        """The name for rospy: private unless absolute."""
        return self.name if self.name.startswith("/") else f"~{self.name}"

    def under(self, node: str) -> str:
        """The full name below a node's name, without remappings."""
        return self.name if self.name.startswith("/") else f"{node}/{self.name}"


def _gazebo(name: str, kind: str, handler: str, title: str, meaning: str = "") -> Row:
    return Row(name, f"gazebo_msgs/{kind}", SERVES, handler, title, meaning=meaning)


def _empty(name: str, handler: str, title: str, meaning: str, extension: bool = False) -> Row:
    return Row(name, "std_srvs/Empty", SERVES, handler, title, extension, meaning=meaning)


def _ours(name: str, kind: str, handler: str, title: str, meaning: str) -> Row:
    return Row(name, f"{OURS}/{kind}", SERVES, handler, title, True, meaning=meaning)


TABLE: Tuple[Row, ...] = (
    Row("/clock", "rosgraph_msgs/Clock", PUBLISHES, "publishers", always=True,
        meaning="each step, or at `~pub_clock_frequency` Hz of sim time; at most 1000 messages "
                "per second of wall time, always including the newest"),
    Row("model_states", "gazebo_msgs/ModelStates", PUBLISHES, "publishers",
        meaning="each step, or at `~model_states_rate` Hz of sim time; a new subscriber receives "
                "the current state at once, also while paused"),
    Row("link_states", "gazebo_msgs/LinkStates", PUBLISHES, "publishers",
        meaning="as `model_states`"),
    Row("performance_metrics", "gazebo_msgs/PerformanceMetrics", PUBLISHES, "metrics",
        extension=True, since="11.2",
        meaning="at 5 Hz while there are subscribers and the simulation runs"),
    Row("parameter_descriptions", "dynamic_reconfigure/ConfigDescription", PUBLISHES,
        "reconfigure", meaning="dynamic_reconfigure, latched"),
    Row("parameter_updates", "dynamic_reconfigure/Config", PUBLISHES, "reconfigure",
        meaning="latched; also published when physics properties are changed by other means"),
    Row("/rosout", "rosgraph_msgs/Log", PUBLISHES, BY_ROSPY, always=True),
    Row("set_model_state", "gazebo_msgs/ModelState", SUBSCRIBES, "states.on_model_state",
        meaning="as the service; errors are logged"),
    Row("set_link_state", "gazebo_msgs/LinkState", SUBSCRIBES, "states.on_link_state",
        meaning="as the service; errors are logged"),

    _gazebo("spawn_urdf_model", "SpawnModel", "models.spawn_urdf", "SpawnModel",
            "replies once the model is in the world"),
    _gazebo("spawn_sdf_model", "SpawnModel", "models.spawn_sdf", "SpawnModel",
            "accepts models and lights, and URDF"),
    _gazebo("delete_model", "DeleteModel", "models.delete", "DeleteModel",
            "replies once the model is deleted"),
    _gazebo("delete_light", "DeleteLight", "lights.delete", "DeleteLight"),
    _gazebo("get_world_properties", "GetWorldProperties", "world.get_world",
            "GetWorldProperties"),
    _gazebo("get_model_properties", "GetModelProperties", "world.get_model",
            "GetModelProperties", "unscoped names; `canonical_body_name` is filled in"),
    _gazebo("get_model_state", "GetModelState", "states.get_model", "GetModelState",
            "nested models too: `outer::inner`"),
    _gazebo("get_link_state", "GetLinkState", "states.get_link", "GetLinkState"),
    _gazebo("get_link_properties", "GetLinkProperties", "links.get", "GetLinkProperties"),
    _gazebo("get_joint_properties", "GetJointProperties", "joints.get", "GetJointProperties",
            "actual joint type; damping, position and rate of each axis"),
    _gazebo("get_light_properties", "GetLightProperties", "lights.get", "getLightProperties"),
    _gazebo("get_physics_properties", "GetPhysicsProperties", "world.get_physics",
            "GetPhysicsProperties"),
    _gazebo("set_model_state", "SetModelState", "states.set_model", "SetModelState",
            "all links get the twist of one rigid body; a joint to the world follows the pose; a "
            "nested model moves if it has one link"),
    _gazebo("set_link_state", "SetLinkState", "states.set_link", "SetLinkState",
            "a link of an articulated model moves the whole model"),
    _gazebo("set_model_configuration", "SetModelConfiguration", "joints.configure",
            "SetModelConfiguration",
            "clamped to joint limits; the status message lists unknown joints"),
    _gazebo("set_joint_properties", "SetJointProperties", "joints.set", "SetJointProperties",
            "damping, joint limits, and the motor of `fmax` and `vel`"),
    _gazebo("set_link_properties", "SetLinkProperties", "links.set", "SetLinkProperties",
            "mass, centre of mass, inertia and gravity take effect"),
    _gazebo("set_light_properties", "SetLightProperties", "lights.set", "setLightProperties",
            "fields that are all zero are left unchanged"),
    _gazebo("set_physics_properties", "SetPhysicsProperties", "world.set_physics",
            "SetPhysicsProperties",
            "out-of-range values are rejected; `ode_config` is stored and returned"),
    _gazebo("apply_body_wrench", "ApplyBodyWrench", "wrenches.apply_wrench", "ApplyBodyWrench",
            "wrenches add up; start and end are exact to the step"),
    _gazebo("apply_joint_effort", "ApplyJointEffort", "wrenches.apply_effort", "ApplyJointEffort",
            "efforts add up; start and end are exact to the step"),
    _gazebo("clear_body_wrenches", "BodyRequest", "wrenches.clear_wrenches", "ClearBodyWrenches",
            "scoped or unscoped link name"),
    _gazebo("clear_joint_forces", "JointRequest", "wrenches.clear_efforts", "ClearJointForces",
            "`model::joint`, or an unscoped name for that joint of every model"),
    _empty("pause_physics", "world.pause", "PausePhysics", ""),
    _empty("unpause_physics", "world.unpause", "UnpausePhysics", ""),
    _empty("reset_world", "world.reset_world", "ResetWorld",
           "resets model poses; keeps sim time and joint positions, except of joints to the world"),
    _empty("reset_simulation", "world.reset_simulation", "ResetSimulation",
           "resets model poses, joint positions and sim time"),
    Row("set_parameters", "dynamic_reconfigure/Reconfigure", SERVES, "reconfigure.set",
        "SetParameters", meaning="dynamic_reconfigure, 15 parameters"),
    Row("get_loggers", "roscpp/GetLoggers", SERVES, BY_ROSPY, always=True),
    Row("set_logger_level", "roscpp/SetLoggerLevel", SERVES, BY_ROSPY, always=True),

    _empty("reset_time", "world.reset_time", "ResetTime", "resets sim time only", True),
    _ours("spawn_object", "SpawnObject", "models.spawn_object", "SpawnModel",
          "models and lights of SDF or URDF; can replace a model of that name in one step"),
    _ours("step_world", "StepWorld", "stepping.step", "StepWorld",
          "executes `steps` steps as fast as possible, also while paused; replies when done"),
    _ours("save_world", "SaveWorld", "saving.save", "SaveWorld",
          "saves the running world as SDF 1.7, next to the loaded world file or in "
          "`~/my_simulations/worlds`; only below the allowed folders (`~save_roots`)"),
    _ours("open_editor", "OpenEditor", "editor.open", "OpenEditor",
          "starts the world editor if needed and returns its URL"),
)


def offered_rows(*, network: bool = True, extensions: bool = True) -> Iterator[Row]:
    """The rows that a node with these settings offers.

    Args:
        network: parameter `~enable_ros_network`.
        extensions: parameter `~extensions`.
    """
    for row in TABLE:
        if (network or row.always) and (extensions or not row.extension):
            yield row


def row_of(name: str, direction: Direction) -> Row:
    """The row of a name. Raises KeyError."""
    for row in TABLE:
        if row.name == name and row.direction is direction:
            return row
    raise KeyError(name)


def interface_tables() -> str:
    lines: List[str] = []
    for direction, head in ((PUBLISHES, "Published topics"),
                            (SUBSCRIBES, "Subscribed topics"), (SERVES, "Services")):
        lines += ["", f"| {head} | type | |", "|---|---|---|"]
        lines += [_line(row) for row in TABLE if row.direction is direction]
    return "\n".join(lines).strip() + "\n"


def _line(row: Row) -> str:
    origin = f"since Gazebo {row.since}" if row.since else "*extension*" if row.extension else ""
    parts = (origin, row.meaning)
    meaning = "; ".join(part for part in parts if part)
    return f"| `{row.name}` | `{row.type}` | {meaning} |"
