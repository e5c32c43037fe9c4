"""The whole ROS interface in one table: registration, the README and the tests read it.

Nothing of ROS is imported here, so that anybody can look.
"""
from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Iterator, List, Tuple


class Direction(enum.Enum):
    """What the node does with a name."""

    SERVES = "service"
    PUBLISHES = "published"
    HEARS = "heard"


SERVES, PUBLISHES, HEARS = Direction.SERVES, Direction.PUBLISHES, Direction.HEARS

BY_ROSPY = "rospy"
"""The handler of what rospy offers in every node."""

OURS = "my_simulations_msgs"


@dataclass(frozen=True)
class Row:
    """One service or topic.

    Attributes:
        name: under the node's own name, or absolute.
        type: `package/Type`.
        direction: what the node does with it.
        handler: `face.method`, see `registration`; `BY_ROSPY` where rospy does it.
        title: starts every status message of a service (Gazebo's words).
        extension: not in Gazebo's own interface of 2018, left out with `~extensions` false.
        always: there even with `~enable_ros_network` false.
        meaning: what a user must know that the name does not say.
    """

    name: str
    type: str
    direction: Direction
    handler: str
    title: str = ""
    extension: bool = False
    always: bool = False
    meaning: str = ""

    @property
    def late(self) -> bool:
        """Offered once the world runs, for a short start (dynamic_reconfigure is so in Gazebo)."""
        return self.extension or self.handler.split(".")[0] == "reconfigure"

    @property
    def graph_name(self) -> str:
        """The name as rospy wants it: private unless absolute."""
        return self.name if self.name.startswith("/") else f"~{self.name}"

    def under(self, node: str) -> str:
        """The full name for a node of that name, without remappings."""
        return self.name if self.name.startswith("/") else f"{node}/{self.name}"


def _gazebo(name: str, kind: str, handler: str, title: str, meaning: str = "") -> Row:
    return Row(name, f"gazebo_msgs/{kind}", SERVES, handler, title, meaning=meaning)


def _empty(name: str, handler: str, title: str, meaning: str, extension: bool = False) -> Row:
    return Row(name, "std_srvs/Empty", SERVES, handler, title, extension, meaning=meaning)


def _ours(name: str, kind: str, handler: str, title: str, meaning: str) -> Row:
    return Row(name, f"{OURS}/{kind}", SERVES, handler, title, True, meaning=meaning)


TABLE: Tuple[Row, ...] = (
    Row("/clock", "rosgraph_msgs/Clock", PUBLISHES, "publishers", always=True,
        meaning="every step, or `~pub_clock_frequency` Hz of sim time; faster than real time "
                "1000 a second, the newest always among them"),
    Row("model_states", "gazebo_msgs/ModelStates", PUBLISHES, "publishers",
        meaning="every step, or `~model_states_rate` Hz of sim time; a new subscriber hears the "
                "present state at once, also while paused"),
    Row("link_states", "gazebo_msgs/LinkStates", PUBLISHES, "publishers", meaning="likewise"),
    Row("performance_metrics", "gazebo_msgs/PerformanceMetrics", PUBLISHES, "metrics",
        extension=True, meaning="5 Hz with a subscriber, while time goes on"),
    Row("parameter_descriptions", "dynamic_reconfigure/ConfigDescription", PUBLISHES,
        "reconfigure", meaning="dynamic_reconfigure, latched"),
    Row("parameter_updates", "dynamic_reconfigure/Config", PUBLISHES, "reconfigure",
        meaning="latched; also when the physics properties are set in another way"),
    Row("/rosout", "rosgraph_msgs/Log", PUBLISHES, BY_ROSPY, always=True),
    Row("set_model_state", "gazebo_msgs/ModelState", HEARS, "states.on_model_state",
        meaning="as the service; faults go to the log"),
    Row("set_link_state", "gazebo_msgs/LinkState", HEARS, "states.on_link_state",
        meaning="as the service; faults go to the log"),

    _gazebo("spawn_urdf_model", "SpawnModel", "models.spawn_urdf", "SpawnModel",
            "answered when the model is in the world"),
    _gazebo("spawn_sdf_model", "SpawnModel", "models.spawn_sdf", "SpawnModel",
            "models and lights, URDF too"),
    _gazebo("delete_model", "DeleteModel", "models.delete", "DeleteModel",
            "answered when it is gone"),
    _gazebo("delete_light", "DeleteLight", "lights.delete", "DeleteLight"),
    _gazebo("get_world_properties", "GetWorldProperties", "world.get_world",
            "GetWorldProperties"),
    _gazebo("get_model_properties", "GetModelProperties", "world.get_model",
            "GetModelProperties", "names without scope; `canonical_body_name` is filled"),
    _gazebo("get_model_state", "GetModelState", "states.get_model", "GetModelState"),
    _gazebo("get_link_state", "GetLinkState", "states.get_link", "GetLinkState"),
    _gazebo("get_link_properties", "GetLinkProperties", "links.get", "GetLinkProperties"),
    _gazebo("get_joint_properties", "GetJointProperties", "joints.get", "GetJointProperties",
            "the real type; damping, position and rate of each axis"),
    _gazebo("get_light_properties", "GetLightProperties", "lights.get", "getLightProperties"),
    _gazebo("get_physics_properties", "GetPhysicsProperties", "world.get_physics",
            "GetPhysicsProperties"),
    _gazebo("set_model_state", "SetModelState", "states.set_model", "SetModelState",
            "a rigid body's velocity for all links"),
    _gazebo("set_link_state", "SetLinkState", "states.set_link", "SetLinkState",
            "a link of an articulated model takes the model along"),
    _gazebo("set_model_configuration", "SetModelConfiguration", "joints.configure",
            "SetModelConfiguration", "within the limits; unknown joints are named in the message"),
    _gazebo("set_joint_properties", "SetJointProperties", "joints.set", "SetJointProperties",
            "damping, stops, and the motor of `fmax` and `vel`"),
    _gazebo("set_link_properties", "SetLinkProperties", "links.set", "SetLinkProperties",
            "mass, centre of mass, inertia and gravity reach the engine"),
    _gazebo("set_light_properties", "SetLightProperties", "lights.set", "setLightProperties",
            "fields that are all zero stay as they are"),
    _gazebo("set_physics_properties", "SetPhysicsProperties", "world.set_physics",
            "SetPhysicsProperties", "checked for range; `ode_config` is kept and read back"),
    _gazebo("apply_body_wrench", "ApplyBodyWrench", "loads.apply_wrench", "ApplyBodyWrench",
            "wrenches add up, exact to the step"),
    _gazebo("apply_joint_effort", "ApplyJointEffort", "loads.apply_effort", "ApplyJointEffort",
            "efforts add up, exact to the step"),
    _gazebo("clear_body_wrenches", "BodyRequest", "loads.clear_wrenches", "ClearBodyWrenches",
            "either form of the name"),
    _gazebo("clear_joint_forces", "JointRequest", "loads.clear_efforts", "ClearJointForces",
            "`model::joint`, or a plain name in all models"),
    _empty("pause_physics", "world.pause", "PausePhysics", ""),
    _empty("unpause_physics", "world.unpause", "UnpausePhysics", ""),
    _empty("reset_world", "world.reset_world", "ResetWorld", "joints and time stay"),
    _empty("reset_simulation", "world.reset_simulation", "ResetSimulation",
           "joints too, and time is 0"),
    Row("set_parameters", "dynamic_reconfigure/Reconfigure", SERVES, "reconfigure.set",
        "SetParameters", meaning="dynamic_reconfigure, 15 parameters"),
    Row("get_loggers", "roscpp/GetLoggers", SERVES, BY_ROSPY, always=True),
    Row("set_logger_level", "roscpp/SetLoggerLevel", SERVES, BY_ROSPY, always=True),

    _empty("reset_time", "world.reset_time", "ResetTime", "time is 0, all else stays", True),
    _ours("spawn_object", "SpawnObject", "models.spawn_object", "SpawnObject",
          "models and lights of SDF or URDF; can replace a model of that name in one step"),
    _ours("step_world", "StepWorld", "stepping.step", "StepWorld",
          "makes `steps` steps as fast as the machine can, also while paused; answered when they "
          "are done"),
    _ours("save_world", "SaveWorld", "saving.save", "SaveWorld",
          "the running world as SDF 1.7, beside the world that was loaded or in "
          "`~/my_simulations/worlds`; below the allowed folders only (`~save_roots`)"),
    _ours("open_editor", "OpenEditor", "editor.open", "OpenEditor",
          "starts the world editor if it is not there, and tells its address"),
)


def rows(*, network: bool = True, extensions: bool = True) -> Iterator[Row]:
    """The rows that a node with these settings offers."""
    for row in TABLE:
        if (network or row.always) and (extensions or not row.extension):
            yield row


def row_of(name: str, direction: Direction) -> Row:
    """The row of a name. Raises KeyError."""
    for row in TABLE:
        if row.name == name and row.direction is direction:
            return row
    raise KeyError(name)


def markdown() -> str:
    """The table for the README."""
    lines: List[str] = []
    for direction, head in ((PUBLISHES, "topic, published"), (HEARS, "topic, heard"),
                            (SERVES, "service")):
        lines += ["", f"| {head} | type | |", "|---|---|---|"]
        lines += [_line(row) for row in TABLE if row.direction is direction]
    return "\n".join(lines).strip() + "\n"


def _line(row: Row) -> str:
    parts = ("*extension*" if row.extension else "", row.meaning)
    meaning = "; ".join(part for part in parts if part)
    return f"| `{row.name}` | `{row.type}` | {meaning} |"
