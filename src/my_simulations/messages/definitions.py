"""Definitions of the standard message and service types, in the syntax of .msg files.

A type stands in one entry, `Name: constant; ...; field; ...`, below the name of its package. A
service has the entries `NameRequest` and `NameResponse`.
"""
from __future__ import annotations

import re
from functools import lru_cache
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ..errors import SimulationError

_DEFINITIONS = """
[ackermann_msgs]
AckermannDrive: float32 steering_angle; float32 steering_angle_velocity; float32 speed; float32
    acceleration; float32 jerk
AckermannDriveStamped: Header header; AckermannDrive drive
[actionlib_msgs]
GoalID: time stamp; string id
GoalStatus: uint8 PENDING=0; uint8 ACTIVE=1; uint8 PREEMPTED=2; uint8 SUCCEEDED=3; uint8
    ABORTED=4; uint8 REJECTED=5; uint8 PREEMPTING=6; uint8 RECALLING=7; uint8 RECALLED=8; uint8
    LOST=9; GoalID goal_id; uint8 status; string text
GoalStatusArray: Header header; GoalStatus[] status_list
[control_msgs]
FollowJointTrajectoryAction: FollowJointTrajectoryActionGoal action_goal;
    FollowJointTrajectoryActionResult action_result; FollowJointTrajectoryActionFeedback
    action_feedback
FollowJointTrajectoryActionFeedback: Header header; actionlib_msgs/GoalStatus status;
    FollowJointTrajectoryFeedback feedback
FollowJointTrajectoryActionGoal: Header header; actionlib_msgs/GoalID goal_id;
    FollowJointTrajectoryGoal goal
FollowJointTrajectoryActionResult: Header header; actionlib_msgs/GoalStatus status;
    FollowJointTrajectoryResult result
FollowJointTrajectoryFeedback: Header header; string[] joint_names;
    trajectory_msgs/JointTrajectoryPoint desired; trajectory_msgs/JointTrajectoryPoint actual;
    trajectory_msgs/JointTrajectoryPoint error
FollowJointTrajectoryGoal: trajectory_msgs/JointTrajectory trajectory; JointTolerance[]
    path_tolerance; JointTolerance[] goal_tolerance; duration goal_time_tolerance
FollowJointTrajectoryResult: int32 SUCCESSFUL=0; int32 INVALID_GOAL=-1; int32 INVALID_JOINTS=-2;
    int32 OLD_HEADER_TIMESTAMP=-3; int32 PATH_TOLERANCE_VIOLATED=-4; int32
    GOAL_TOLERANCE_VIOLATED=-5; int32 error_code; string error_string
GripperCommand: float64 position; float64 max_effort
GripperCommandAction: GripperCommandActionGoal action_goal; GripperCommandActionResult
    action_result; GripperCommandActionFeedback action_feedback
GripperCommandActionFeedback: Header header; actionlib_msgs/GoalStatus status;
    GripperCommandFeedback feedback
GripperCommandActionGoal: Header header; actionlib_msgs/GoalID goal_id; GripperCommandGoal goal
GripperCommandActionResult: Header header; actionlib_msgs/GoalStatus status; GripperCommandResult
    result
GripperCommandFeedback: float64 position; float64 effort; bool stalled; bool reached_goal
GripperCommandGoal: GripperCommand command
GripperCommandResult: float64 position; float64 effort; bool stalled; bool reached_goal
JointControllerState: Header header; float64 set_point; float64 process_value; float64
    process_value_dot; float64 error; float64 time_step; float64 command; float64 p; float64 i;
    float64 d; float64 i_clamp; bool antiwindup
JointTolerance: string name; float64 position; float64 velocity; float64 acceleration
JointTrajectoryControllerState: Header header; string[] joint_names;
    trajectory_msgs/JointTrajectoryPoint desired; trajectory_msgs/JointTrajectoryPoint actual;
    trajectory_msgs/JointTrajectoryPoint error
PointHeadAction: PointHeadActionGoal action_goal; PointHeadActionResult action_result;
    PointHeadActionFeedback action_feedback
PointHeadActionFeedback: Header header; actionlib_msgs/GoalStatus status; PointHeadFeedback feedback
PointHeadActionGoal: Header header; actionlib_msgs/GoalID goal_id; PointHeadGoal goal
PointHeadActionResult: Header header; actionlib_msgs/GoalStatus status; PointHeadResult result
PointHeadFeedback: float64 pointing_angle_error
PointHeadGoal: geometry_msgs/PointStamped target; geometry_msgs/Vector3 pointing_axis; string
    pointing_frame; duration min_duration; float64 max_velocity
PointHeadResult:
QueryTrajectoryStateRequest: time time
QueryTrajectoryStateResponse: string[] name; float64[] position; float64[] velocity; float64[]
    acceleration
[controller_manager_msgs]
ControllerState: string name; string state; string type; HardwareInterfaceResources[]
    claimed_resources
HardwareInterfaceResources: string hardware_interface; string[] resources
ListControllerTypesRequest:
ListControllerTypesResponse: string[] types; string[] base_classes
ListControllersRequest:
ListControllersResponse: ControllerState[] controller
LoadControllerRequest: string name
LoadControllerResponse: bool ok
ReloadControllerLibrariesRequest: bool force_kill
ReloadControllerLibrariesResponse: bool ok
SwitchControllerRequest: int32 BEST_EFFORT=1; int32 STRICT=2; string[] start_controllers; string[]
    stop_controllers; int32 strictness; bool start_asap; float64 timeout
SwitchControllerResponse: bool ok
UnloadControllerRequest: string name
UnloadControllerResponse: bool ok
[dynamic_reconfigure]
BoolParameter: string name; bool value
Config: BoolParameter[] bools; IntParameter[] ints; StrParameter[] strs; DoubleParameter[]
    doubles; GroupState[] groups
ConfigDescription: Group[] groups; Config max; Config min; Config dflt
DoubleParameter: string name; float64 value
Group: string name; string type; ParamDescription[] parameters; int32 parent; int32 id
GroupState: string name; bool state; int32 id; int32 parent
IntParameter: string name; int32 value
ParamDescription: string name; string type; uint32 level; string description; string edit_method
ReconfigureRequest: Config config
ReconfigureResponse: Config config
StrParameter: string name; string value
[four_wheel_steering_msgs]
FourWheelSteering: float32 front_steering_angle; float32 rear_steering_angle; float32
    front_steering_angle_velocity; float32 rear_steering_angle_velocity; float32 speed; float32
    acceleration; float32 jerk
FourWheelSteeringStamped: Header header; FourWheelSteering data
[gazebo_conveyor]
ConveyorBeltControlRequest: float64 power
ConveyorBeltControlResponse: bool success
ConveyorBeltState: bool enabled; float64 power
[gazebo_msgs]
ContactState: string info; string collision1_name; string collision2_name; geometry_msgs/Wrench[]
    wrenches; geometry_msgs/Wrench total_wrench; geometry_msgs/Vector3[] contact_positions;
    geometry_msgs/Vector3[] contact_normals; float64[] depths
ContactsState: Header header; ContactState[] states
LinkStates: string[] name; geometry_msgs/Pose[] pose; geometry_msgs/Twist[] twist
ModelStates: string[] name; geometry_msgs/Pose[] pose; geometry_msgs/Twist[] twist
SetJointTrajectoryRequest: string model_name; trajectory_msgs/JointTrajectory joint_trajectory;
    geometry_msgs/Pose model_pose; bool set_model_pose; bool disable_physics_updates
SetJointTrajectoryResponse: bool success; string status_message
[gazebo_ros_link_attacher]
AttachRequest: string model_name_1; string link_name_1; string model_name_2; string link_name_2
AttachResponse: bool ok
SetStaticRequest: string model_name; string link_name; bool set_static
SetStaticResponse: bool ok
[geometry_msgs]
Accel: Vector3 linear; Vector3 angular
AccelStamped: Header header; Accel accel
Point32: float32 x; float32 y; float32 z
Point: float64 x; float64 y; float64 z
PointStamped: Header header; Point point
Polygon: Point32[] points
PolygonStamped: Header header; Polygon polygon
Pose2D: float64 x; float64 y; float64 theta
Pose: Point position; Quaternion orientation
PoseArray: Header header; Pose[] poses
PoseStamped: Header header; Pose pose
PoseWithCovariance: Pose pose; float64[36] covariance
PoseWithCovarianceStamped: Header header; PoseWithCovariance pose
Quaternion: float64 x; float64 y; float64 z; float64 w
QuaternionStamped: Header header; Quaternion quaternion
Transform: Vector3 translation; Quaternion rotation
TransformStamped: Header header; string child_frame_id; Transform transform
Twist: Vector3 linear; Vector3 angular
TwistStamped: Header header; Twist twist
TwistWithCovariance: Twist twist; float64[36] covariance
TwistWithCovarianceStamped: Header header; TwistWithCovariance twist
Vector3: float64 x; float64 y; float64 z
Vector3Stamped: Header header; Vector3 vector
Wrench: Vector3 force; Vector3 torque
WrenchStamped: Header header; Wrench wrench
[hector_uav_msgs]
Altimeter: Header header; float32 altitude; float32 pressure; float32 qnh
AttitudeCommand: Header header; float32 roll; float32 pitch
EnableMotorsRequest: bool enable
EnableMotorsResponse: bool success
MotorCommand: Header header; float32[] force; float32[] torque; float32[] frequency;
    float32[] voltage
MotorPWM: Header header; uint8[] pwm
MotorStatus: Header header; bool on; bool running; float32[] voltage; float32[] frequency;
    float32[] current
Supply: Header header; float32[] voltage; float32[] current
ThrustCommand: Header header; float64 thrust
YawrateCommand: Header header; float64 turnrate
[mav_msgs]
Actuators: Header header; float64[] angles; float64[] angular_velocities; float64[] normalized
[nav_msgs]
Odometry: Header header; string child_frame_id; geometry_msgs/PoseWithCovariance pose;
    geometry_msgs/TwistWithCovariance twist
Path: Header header; geometry_msgs/PoseStamped[] poses
[pedsim_msgs]
AgentForce: geometry_msgs/Vector3 desired_force; geometry_msgs/Vector3 obstacle_force;
    geometry_msgs/Vector3 social_force; geometry_msgs/Vector3 group_coherence_force;
    geometry_msgs/Vector3 group_gaze_force; geometry_msgs/Vector3 group_repulsion_force;
    geometry_msgs/Vector3 random_force
AgentState: string TYPE_STANDING=standing; string TYPE_INDIVIDUAL_MOVING=individual_moving; string
    TYPE_WAITING_IN_QUEUE=waiting_in_queue; string TYPE_GROUP_MOVING=group_moving; Header header;
    uint64 id; uint16 type; string social_state; geometry_msgs/Pose pose; geometry_msgs/Twist twist;
    AgentForce forces
AgentStates: Header header; AgentState[] agent_states
[prius_msgs]
Control: Header header; float64 throttle; float64 brake; float64 steer; uint8 NO_COMMAND=0; uint8
    NEUTRAL=1; uint8 FORWARD=2; uint8 REVERSE=3; uint8 shift_gears
[rosgraph_msgs]
Clock: time clock
[rotors_comm]
WindSpeed: Header header; geometry_msgs/Vector3 velocity
[sensor_msgs]
BatteryState: uint8 POWER_SUPPLY_STATUS_UNKNOWN=0; uint8 POWER_SUPPLY_STATUS_CHARGING=1; uint8
    POWER_SUPPLY_STATUS_DISCHARGING=2; uint8 POWER_SUPPLY_STATUS_NOT_CHARGING=3; uint8
    POWER_SUPPLY_STATUS_FULL=4; uint8 POWER_SUPPLY_HEALTH_UNKNOWN=0; uint8
    POWER_SUPPLY_HEALTH_GOOD=1; uint8 POWER_SUPPLY_HEALTH_OVERHEAT=2; uint8
    POWER_SUPPLY_HEALTH_DEAD=3; uint8 POWER_SUPPLY_HEALTH_OVERVOLTAGE=4; uint8
    POWER_SUPPLY_HEALTH_UNSPEC_FAILURE=5; uint8 POWER_SUPPLY_HEALTH_COLD=6; uint8
    POWER_SUPPLY_HEALTH_WATCHDOG_TIMER_EXPIRE=7; uint8 POWER_SUPPLY_HEALTH_SAFETY_TIMER_EXPIRE=8;
    uint8 POWER_SUPPLY_TECHNOLOGY_UNKNOWN=0; uint8 POWER_SUPPLY_TECHNOLOGY_NIMH=1; uint8
    POWER_SUPPLY_TECHNOLOGY_LION=2; uint8 POWER_SUPPLY_TECHNOLOGY_LIPO=3; uint8
    POWER_SUPPLY_TECHNOLOGY_LIFE=4; uint8 POWER_SUPPLY_TECHNOLOGY_NICD=5; uint8
    POWER_SUPPLY_TECHNOLOGY_LIMN=6; Header header; float32 voltage; float32 temperature; float32
    current; float32 charge; float32 capacity; float32 design_capacity; float32 percentage; uint8
    power_supply_status; uint8 power_supply_health; uint8 power_supply_technology; bool present;
    float32[] cell_voltage; float32[] cell_temperature; string location; string serial_number
CameraInfo: Header header; uint32 height; uint32 width; string distortion_model; float64[] D;
    float64[9] K; float64[9] R; float64[12] P; uint32 binning_x; uint32 binning_y;
    RegionOfInterest roi
ChannelFloat32: string name; float32[] values
CompressedImage: Header header; string format; uint8[] data
FluidPressure: Header header; float64 fluid_pressure; float64 variance
Illuminance: Header header; float64 illuminance; float64 variance
Image: Header header; uint32 height; uint32 width; string encoding; uint8 is_bigendian; uint32
    step; uint8[] data
Imu: Header header; geometry_msgs/Quaternion orientation; float64[9] orientation_covariance;
    geometry_msgs/Vector3 angular_velocity; float64[9] angular_velocity_covariance;
    geometry_msgs/Vector3 linear_acceleration; float64[9] linear_acceleration_covariance
JointState: Header header; string[] name; float64[] position; float64[] velocity; float64[] effort
Joy: Header header; float32[] axes; int32[] buttons
LaserScan: Header header; float32 angle_min; float32 angle_max; float32 angle_increment; float32
    time_increment; float32 scan_time; float32 range_min; float32 range_max; float32[] ranges;
    float32[] intensities
MagneticField: Header header; geometry_msgs/Vector3 magnetic_field; float64[9]
    magnetic_field_covariance
NavSatFix: uint8 COVARIANCE_TYPE_UNKNOWN=0; uint8 COVARIANCE_TYPE_APPROXIMATED=1; uint8
    COVARIANCE_TYPE_DIAGONAL_KNOWN=2; uint8 COVARIANCE_TYPE_KNOWN=3; Header header; NavSatStatus
    status; float64 latitude; float64 longitude; float64 altitude; float64[9] position_covariance;
    uint8 position_covariance_type
NavSatStatus: int8 STATUS_NO_FIX=-1; int8 STATUS_FIX=0; int8 STATUS_SBAS_FIX=1; int8
    STATUS_GBAS_FIX=2; uint16 SERVICE_GPS=1; uint16 SERVICE_GLONASS=2; uint16 SERVICE_COMPASS=4;
    uint16 SERVICE_GALILEO=8; int8 status; uint16 service
PointCloud2: Header header; uint32 height; uint32 width; PointField[] fields; bool is_bigendian;
    uint32 point_step; uint32 row_step; uint8[] data; bool is_dense
PointCloud: Header header; geometry_msgs/Point32[] points; ChannelFloat32[] channels
PointField: uint8 INT8=1; uint8 UINT8=2; uint8 INT16=3; uint8 UINT16=4; uint8 INT32=5; uint8
    UINT32=6; uint8 FLOAT32=7; uint8 FLOAT64=8; string name; uint32 offset; uint8 datatype; uint32
    count
Range: uint8 ULTRASOUND=0; uint8 INFRARED=1; Header header; uint8 radiation_type; float32
    field_of_view; float32 min_range; float32 max_range; float32 range
RegionOfInterest: uint32 x_offset; uint32 y_offset; uint32 height; uint32 width; bool do_rectify
SetCameraInfoRequest: CameraInfo camera_info
SetCameraInfoResponse: bool success; string status_message
Temperature: Header header; float64 temperature; float64 variance
[std_msgs]
Bool: bool data
ColorRGBA: float32 r; float32 g; float32 b; float32 a
Duration: duration data
Empty:
Float32: float32 data
Float32MultiArray: MultiArrayLayout layout; float32[] data
Float64: float64 data
Float64MultiArray: MultiArrayLayout layout; float64[] data
Header: uint32 seq; time stamp; string frame_id
Int16: int16 data
Int32: int32 data
Int32MultiArray: MultiArrayLayout layout; int32[] data
Int64: int64 data
Int8: int8 data
MultiArrayDimension: string label; uint32 size; uint32 stride
MultiArrayLayout: MultiArrayDimension[] dim; uint32 data_offset
String: string data
Time: time data
UInt16: uint16 data
UInt32: uint32 data
UInt64: uint64 data
UInt8: uint8 data
[std_srvs]
EmptyRequest:
EmptyResponse:
SetBoolRequest: bool data
SetBoolResponse: bool success; string message
TriggerRequest:
TriggerResponse: bool success; string message
[tf2_msgs]
TFMessage: geometry_msgs/TransformStamped[] transforms
[trajectory_msgs]
JointTrajectory: Header header; string[] joint_names; JointTrajectoryPoint[] points
JointTrajectoryPoint: float64[] positions; float64[] velocities; float64[] accelerations;
    float64[] effort; duration time_from_start
[unitree_legged_msgs]
MotorCmd: uint8 mode; float32 q; float32 dq; float32 tau; float32 Kp; float32 Kd; uint32[3]
    reserve
MotorState: uint8 mode; float32 q; float32 dq; float32 ddq; float32 tauEst; float32 q_raw; float32
    dq_raw; float32 ddq_raw; int8 temperature; uint32[2] reserve
"""


@lru_cache(maxsize=None)
def standard_definitions() -> Mapping[str, List[str]]:
    """The statements of each standard type, by `package/Name`."""
    found: Dict[str, List[str]] = {}
    package = kind = ""
    for line in _DEFINITIONS.strip().split("\n"):
        if line.startswith("["):
            package = line.strip("[]")
            continue
        text = line
        if not line.startswith(" "):
            name, _, text = line.partition(":")
            kind = f"{package}/{name}"
            found[kind] = [""]
        found[kind][0] += f" {text.strip()}"
    return {kind: [one.strip() for one in text.split(";") if one.strip()]
            for kind, (text,) in found.items()}


Constant = Union[int, float, str, bool]

INTEGERS = {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
            "int64": "q", "uint64": "Q", "byte": "b", "char": "B"}
"""The code of `struct` for each type of whole numbers."""

FLOATS = {"float32": "f", "float64": "d"}
SIMPLE = {*INTEGERS, *FLOATS, "bool", "string", "time", "duration"}

_FIELD = re.compile(r"([A-Za-z]\w*(?:/\w+)?)(\[(\d*)\])?\s+([A-Za-z]\w*)$")
_CONSTANT = re.compile(r"([a-z]\w*)\s+([A-Za-z]\w*)\s*=(.*)$")


class DefinitionError(SimulationError):
    """A definition of a message type that cannot be read."""


class Field(NamedTuple):
    """A field of a message.

    Attributes:
        name: of the field.
        kind: a type of `SIMPLE`, or `package/Name`.
        is_array: whether it is an array of that type.
        length: of an array of fixed length; None for any.
    """

    name: str
    kind: str
    is_array: bool
    length: Optional[int]


class Definition(NamedTuple):
    """A message type.

    Attributes:
        kind: `package/Name`.
        fields: in order.
        constants: by name.
    """

    kind: str
    fields: Tuple[Field, ...]
    constants: Dict[str, Constant]


def parse_definition(kind: str, statements: Sequence[str]) -> Definition:
    """Return the definition that statements make. Raises DefinitionError."""
    package = kind.partition("/")[0]
    fields: List[Field] = []
    constants: Dict[str, Constant] = {}
    for statement in statements:
        constant = _CONSTANT.match(statement)
        if constant is not None:
            constants[constant.group(2)] = _constant(constant.group(1), constant.group(3))
            continue
        found = _FIELD.match(statement)
        if found is None:
            raise DefinitionError(f"{kind}: {statement!r} is neither a field nor a constant")
        base, array, length, name = found.groups()
        fields.append(Field(name, _full_name(base, package), array is not None,
                            int(length) if length else None))
    return Definition(kind, tuple(fields), constants)


def statements_of(text: str) -> List[str]:
    """The statements of the text of a .msg file, without comments."""
    found = []
    for line in text.split("\n"):
        stripped = line.strip()
        if not re.match(r"string\s+\w+\s*=", stripped):  # whose value may contain a #
            stripped = stripped.partition("#")[0].strip()
        if stripped:
            found.append(stripped)
    return found


def _full_name(base: str, package: str) -> str:
    if base in SIMPLE or "/" in base:
        return base
    return "std_msgs/Header" if base == "Header" else f"{package}/{base}"


def _constant(kind: str, text: str) -> Constant:
    try:
        if kind == "string":
            return text.strip()
        if kind in FLOATS:
            return float(text)
        return bool(int(text)) if kind == "bool" else int(text, 0)
    except ValueError as fault:
        raise DefinitionError(f"{text!r} is not a value of type {kind}") from fault
