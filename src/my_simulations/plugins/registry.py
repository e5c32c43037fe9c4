"""The classes that replace libraries of Gazebo.

Other packages add theirs by an export in their package.xml,

    <export><my_simulations plugin="package.module:Class" library="libfoo.so"/></export>

or a user by the parameter `~plugins` of the node, a map from library to class. Packages are looked
at when a library is met that is known in no other way.
"""
from __future__ import annotations

import importlib
import os
import re
from typing import Callable, Dict, Iterable, List, Mapping, Optional, Type

from ..description.plugin import GRIPPER_LIBRARY
from ..errors import SimulationError
from .base import Plugin
from .context import PluginError
from .missing_plugins import missing_plugin

BUILT_IN: Mapping[str, str] = {
    "libgazebo_ros_diff_drive.so": "drive.diff_drive:DiffDrive",
    "libgazebo_ros_skid_steer_drive.so": "drive.skid_steer_drive:SkidSteerDrive",
    "libgazebo_ros_ackerman.so": "drive.limo_ackermann:LimoAckermann",
    "libgazebo_ros_planar_move.so": "drive.planar_move:PlanarMove",
    "libgazebo_ros_tricycle_drive.so": "drive.tricycle_drive:TricycleDrive",
    "libgazebo_ros_wheel_slip.so": "drive.wheel_slip:RosWheelSlip",
    "libWheelSlipPlugin.so": "drive.wheel_slip:WheelSlip",
    "libgazebo_ros_force_based_move.so": "drive.force_based_move:ForceBasedMove",
    "librobotnik_force_based_move.so": "drive.force_based_move:RobotnikForceBasedMove",
    "libridgeback_ros_force_based_move.so":
        "drive.force_based_move:RidgebackForceBasedMove",
    "libnexus_ros_force_based_move.so": "drive.force_based_move:NexusForceBasedMove",
    "libwpr_plugin.so": "drive.force_based_move:WprForceBasedMove",
    "libgazebo_ros_joint_state_publisher.so": "state.joint_state_publisher:JointStatePublisher",
    "libgazebo_ros_control.so": "control.gazebo_ros_control:GazeboRosControl",
    "libfetch_gazebo_plugin.so": "control.fetch:FetchGazebo",
    "libhwi_switch_gazebo_ros_control.so": "control.hwi_switch:HwiSwitchGazeboRosControl",
    "libgazebo_ros_p3d.so": "state.p3d:P3d",
    "libgazebo_world_odometry.so": "state.world_odometry:PalWorldOdometry",
    "librobotnik_gazebo_ground_truth_odom.so": "state.world_odometry:RobotnikGroundTruthOdometry",
    "libgazebo_ros_force.so": "state.force:Force",
    "libgazebo_ros_joint_pose_trajectory.so": "state.joint_pose_trajectory:JointPoseTrajectory",
    "libgazebo_ros_joint_trajectory.so": "state.joint_pose_trajectory:JointPoseTrajectory",
    "libgazebo_ros_ft_sensor.so": "state.ft_sensor:FtSensor",
    "libgazebo_ros_hand_of_god.so": "state.hand_of_god:HandOfGod",
    "libroboticsgroup_gazebo_mimic_joint_plugin.so": "state.joint_springs:MimicJoint",
    "libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so": "state.joint_springs:MimicJoint",
    "libgazebo_mimic_joint_plugin.so": "state.joint_springs:MimicJoint",
    "libleo_gazebo_differential_plugin.so": "state.joint_springs:Differential",
    "libwarthog_suspension_plugin.so": "state.joint_springs:WarthogSuspension",
    "libgazebo_ros_power_monitor.so": "state.power_monitor:PowerMonitor",
    "libhector_servo_plugin.so": "state.hector_servo:HectorServo",
    "libInitialVelocityPlugin.so": "state.random_velocity:InitialVelocity",
    "libRandomVelocityPlugin.so": "state.random_velocity:RandomVelocity",
    "libgazebo_random_velocity_plugin.so": "state.random_velocity:RandomVelocity",
    "libGimbalSmall2dPlugin.so": "state.gimbal:Gimbal",
    "libgazebo_ros_vacuum_gripper.so": "gripping.vacuum_gripper:VacuumGripper",
    "libgazebo_grasp_fix.so": "gripping.grasp_fix:GraspFix",
    "libActorPosesPlugin.so": "world.actor_poses:ActorPoses",
    "libgazebo_ros_link_attacher.so": "gripping.link_attacher:LinkAttacher",
    "libHarnessPlugin.so": "gripping.harness:Harness",
    "libgazebo_ros_harness.so": "gripping.harness:Harness",
    "libElevatorPlugin.so": "world.elevator:Elevator",
    "libROSConveyorBeltPlugin.so": "world.conveyor_belt:ConveyorBelt",
    "libConveyorBeltPlugin.so": "world.conveyor_belt:ConveyorBelt",
    "libgazebo_ros_elevator.so": "world.elevator:Elevator",
    "libWindPlugin.so": "world.wind:Wind",
    "libgazebo_ros_f3d.so": "state.f3d:F3d",
    "libJointControlPlugin.so": "state.joint_control:JointControl",
    "libgazebo_ros_create.so": "drive.create:Create",
    "libgazebo_ros_kobuki.so": "drive.kobuki:Kobuki",
    "libPriusHybridPlugin.so": "drive.prius:PriusHybrid",
    "libaudibot_interface_plugin.so": "drive.audibot:Audibot",
    "libcatvehiclegazebo.so": "state.world_odometry:CatVehicle",
    "libunitreeFootContactPlugin.so": "sensors.bumper:FootContact",
    "libLiftDragPlugin.so": "world.lift_drag:LiftDrag",
    "libgazebo_dipole_magnet.so": "world.dipole_magnet:DipoleMagnet",
    "libBuoyancyPlugin.so": "world.buoyancy:Buoyancy",
    "libGravityCompensationPlugin.so": "world.gravity_compensation:GravityCompensationPlugin",
    "libgazebo_ros_laser.so": "sensors.laser_points:Laser",
    "libgazebo_ros_gpu_laser.so": "sensors.laser_points:Laser",
    "libgazebo_ros_ray_sensor.so": "sensors.ray_sensor:RaySensor",
    "libgazebo_ros_block_laser.so": "sensors.laser_points:BlockLaser",
    "libgazebo_ros_velodyne_laser.so": "sensors.laser_points:Velodyne",
    "libgazebo_ros_velodyne_gpu_laser.so": "sensors.laser_points:Velodyne",
    "libgazebo_ros_range.so": "sensors.range:Range",
    "libgazebo_ros_imu.so": "sensors.imu:ModelImu",
    "libgazebo_ros_imu_sensor.so": "sensors.imu:SensorImu",
    "libhector_gazebo_ros_imu.so": "sensors.hector_imu:HectorImu",
    "libhector_gazebo_ros_gps.so": "sensors.hector:Gps",
    "libhector_gazebo_ros_magnetic.so": "sensors.hector:Magnetic",
    "libhector_gazebo_ros_baro.so": "sensors.hector:Baro",
    "libhector_gazebo_ros_sonar.so": "sensors.hector:Sonar",
    "libgazebo_ros_bumper.so": "sensors.bumper:Bumper",
    "libgazebo_ros_camera.so": "sensors.camera:Camera",
    "libgazebo_ros_thermal_camera.so": "sensors.thermal_camera:ThermalCamera",
    "libgazebo_ros_thermal_depth_camera.so": "sensors.thermal_camera:ThermalCamera",
    "libgazebo_ros_triggered_camera.so": "sensors.camera:TriggeredCamera",
    "libgazebo_ros_multicamera.so": "sensors.camera:MultiCamera",
    "libgazebo_ros_triggered_multicamera.so": "sensors.camera:TriggeredMultiCamera",
    "libgazebo_ros_prosilica.so": "sensors.camera:Camera",
    "libgazebo_ros_depth_camera.so": "sensors.depth_camera:DepthCamera",
    "librealsense_gazebo_plugin.so": "sensors.realsense:RealSense",
    "libgazebo_ros_realsense.so": "sensors.realsense:RealSense",
    "libgazebo_ros_openni_kinect.so": "sensors.depth_camera:OpenniKinect",
    "libhector_gazebo_quadrotor_simple_controller.so":
        "flight.quadrotor_simple_controller:QuadrotorSimpleController",
    "libhector_gazebo_quadrotor_state_controller.so": "flight.ardrone:ArdroneStateController",
    "libhector_gazebo_quadrotor_propulsion.so": "flight.quadrotor_propulsion:QuadrotorPropulsion",
    "libhector_gazebo_quadrotor_aerodynamics.so":
        "flight.quadrotor_propulsion:QuadrotorAerodynamics",
    "libplugin_drone.so": "flight.sjtu_drone:SjtuDrone",
    "libArduPilotPlugin.so": "flight.ardupilot:ArduPilot",
    "librotors_gazebo_motor_model.so": "flight.motor_model:MotorModel",
    "librotors_gazebo_multirotor_base_plugin.so": "flight.multirotor_base:MultirotorBase",
    "librotors_gazebo_controller_interface.so": "flight.multirotor_base:ControllerInterface",
    "librotors_gazebo_odometry_plugin.so": "flight.rotors_odometry:RotorsOdometry",
    "librotors_gazebo_imu_plugin.so": "flight.rotors_sensors:RotorsImu",
    "librotors_gazebo_magnetometer_plugin.so": "flight.rotors_sensors:RotorsMagnetometer",
    "librotors_gazebo_pressure_plugin.so": "flight.rotors_sensors:RotorsPressure",
    "librotors_gazebo_gps_plugin.so": "flight.rotors_sensors:RotorsGps",
    "librotors_gazebo_wind_plugin.so": "flight.rotors_wind:RotorsWind",
    GRIPPER_LIBRARY: "gripping.sdf_gripper:SdfGripper",
    "libmy_simulations_segmentation_camera.so": "sensors.segmentation:SegmentationCamera",
    "libmy_simulations_gps.so": "sensors.environment:GpsSensor",
    "libmy_simulations_magnetometer.so": "sensors.environment:MagnetometerSensor",
    "libmy_simulations_altimeter.so": "sensors.environment:AltimeterSensor",
}
"""Classes in this package, by library. Those called libmy_simulations are not in Gazebo."""

PROVIDED = ("libgazebo_ros_api_plugin.so", "libgazebo_ros_paths_plugin.so",
            "libgazebo_ros_init.so", "libgazebo_ros_factory.so",
            "libroboticsgroup_gazebo_disable_link_plugin.so",
            "libroboticsgroup_upatras_gazebo_disable_link_plugin.so",
            "libgazebo_ros_template.so", "librotors_gazebo_ros_interface_plugin.so",
            "libpegasus_gazebo_closed_loop_plugin.so", "libActorPlugin.so")
"""What these libraries do, the simulator itself does, or it is nothing here."""

_EXPORT = re.compile(r"<my_simulations\b([^>]*)>")
_ATTRIBUTE = re.compile(r"""(plugin|library)\s*=\s*["']([^"']*)["']""")


class UnknownPluginError(SimulationError):
    """No class exists for a library; the message is one sentence for the user."""


def library_name(filename: str) -> str:
    """`libfoo.so` of whatever a file calls a library: a path, a bare name."""
    name = os.path.basename(filename.strip())
    if name and not name.endswith((".so", ".dylib", ".dll")):
        name = f"{name}.so" if name.startswith("lib") else f"lib{name}.so"
    return name


class PluginRegistry:
    """Finds classes.

    Args:
        extra: further classes as `package.module:Class`, by library; they come first.
        folders: lists the folders of all packages, whose package.xml may export plugins.
    """

    def __init__(self, extra: Optional[Mapping[str, str]] = None,
                 folders: Callable[[], Iterable[str]] = list) -> None:
        self._extra = {library_name(name): where for name, where in (extra or {}).items()}
        self._folders = folders
        self._exported: Optional[Dict[str, str]] = None

    def is_provided(self, filename: str) -> bool:
        """Whether the simulator itself has the functions of the library."""
        return library_name(filename) in PROVIDED

    def is_supported(self, filename: str) -> bool:
        """Whether the simulator or a plugin replaces the library; nothing is imported."""
        name = library_name(filename)
        return (name in PROVIDED or name in self._extra or name in BUILT_IN
                or name in self._of_packages())

    def locate(self, filename: str) -> str:
        """The class for a library as `package.module:Class`; nothing is imported.

        Raises UnknownPluginError.
        """
        name = library_name(filename)
        where = self._extra.get(name)
        if where is None and name in BUILT_IN:
            where = f"{__package__}.{BUILT_IN[name]}"
        if where is None:
            where = self._of_packages().get(name)
        if where is None:
            raise UnknownPluginError(missing_plugin(name)[0])
        return where

    def _of_packages(self) -> Dict[str, str]:
        if self._exported is None:
            self._exported = {}
            for folder in self._folders():
                for attributes in read_exports(os.path.join(folder, "package.xml")):
                    self._exported.setdefault(library_name(attributes.get("library", "")),
                                              attributes.get("plugin", ""))
        return self._exported


def read_exports(manifest: str) -> List[Dict[str, str]]:
    """Read the attributes of the `<my_simulations>` exports of a package.xml."""
    try:
        with open(manifest, encoding="utf-8", errors="replace") as stream:
            text = stream.read()
    except OSError:
        return []
    found = [dict(_ATTRIBUTE.findall(tag)) for tag in _EXPORT.findall(text)]
    return [attributes for attributes in found if attributes.get("plugin")]


def is_built_in(where: str) -> bool:
    """Whether `package.module:Class` is in this package."""
    return where.startswith(f"{__package__}.")


def plugin_class(where: str) -> Type[Plugin]:
    """Import `package.module:Class`.

    Raises PluginError for an object that is not a plugin, and what the module raises.
    """
    module, _, name = where.partition(":")
    importlib.invalidate_caches()   # the file may be newer than the last look at its folder
    imported = importlib.import_module(module)
    found = getattr(imported, name, None)
    if found is None:
        raise PluginError(f"{imported.__file__} has no class '{name}'")
    if not (isinstance(found, type) and issubclass(found, Plugin)):
        raise PluginError(f"'{name}' in {imported.__file__} is not a class derived from"
                          f" {Plugin.__module__}.Plugin")
    return found
