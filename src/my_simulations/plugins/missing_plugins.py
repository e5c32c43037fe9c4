"""Libraries that have no substitute, each with the reason and the nearest alternative."""
from __future__ import annotations

from typing import Mapping, Tuple

_USUAL_HINT = "a package can bring one: see doc/plugins.md"

# Reason, alternative, names of the libraries without `lib` and `.so`.
_KNOWN: Tuple[Tuple[str, str, str], ...] = (
    ("the controllers of PR2 are libraries in C++",
     "libgazebo_ros_control.so moves the same joints, with a <transmission> and a controller of"
     " ros_control for each", "gazebo_ros_controller_manager"),
    ("patterns are not projected",
     "the depth cameras, such as libgazebo_ros_openni_kinect.so, need no pattern",
     "gazebo_ros_projector"),
    ("visuals do not show videos", "a <material> can show a texture", "gazebo_ros_video"),
    ("it publishes the world as a planning scene of MoveIt",
     "moveit_commander adds objects to a planning scene", "gazebo_ros_moveit_planning_scene"),
    ("it records messages", "rosbag records the same topics", "rotors_gazebo_bag_plugin"),
    ("it makes an octomap of the world",
     "octomap_server makes one from the points of a depth camera",
     "rotors_gazebo_octomap_plugin"),
    ("its noise is not simulated", "libgazebo_ros_openni_kinect.so has the same topics",
     "rotors_gazebo_noisydepth_plugin gazebo_noisydepth_camera_plugin"),
    ("it writes pictures to files", "libgazebo_ros_camera.so publishes pictures, and"
     " librotors_gazebo_gps_plugin.so positions",
     "rotors_gazebo_geotagged_images_plugin gazebo_geotagged_images_plugin"),
    ("the aerodynamics of fixed wings are not read from its files",
     "libLiftDragPlugin.so simulates wings and rudders", "rotors_gazebo_fw_dynamics_plugin"),
    ("PX4 is not connected", "libArduPilotPlugin.so connects ArduPilot, and"
     " librotors_gazebo_motor_model.so and its sensors fly without an autopilot",
     "gazebo_mavlink_interface gazebo_motor_model gazebo_imu_plugin gazebo_gps_plugin"
     " gazebo_barometer_plugin gazebo_magnetometer_plugin gazebo_multirotor_base_plugin"
     " gazebo_groundtruth_plugin gazebo_lidar_plugin gazebo_opticalflow_plugin"
     " gazebo_opticalflow_mockup_plugin gazebo_airspeed_plugin gazebo_vision_plugin"
     " gazebo_sonar_plugin gazebo_irlock_plugin gazebo_aruco_plugin gazebo_gst_camera_plugin"
     " gazebo_camera_manager_plugin gazebo_gimbal_controller_plugin gazebo_uuv_plugin"
     " gazebo_usv_dynamics_plugin gazebo_airship_dynamics_plugin gazebo_catapult_plugin"
     " gazebo_drop_plugin gazebo_parachute_plugin"),
    ("its wind acts on the vehicles of PX4 only",
     "libWindPlugin.so moves models, and librotors_gazebo_wind_plugin.so a link",
     "gazebo_wind_plugin"),
    ("its coefficients of control surfaces are not simulated",
     "libLiftDragPlugin.so simulates wings and rudders", "AdvancedLiftDragPlugin"),
    ("the forces of water on vehicles are not simulated",
     "libBuoyancyPlugin.so lifts a model, and libgazebo_ros_force.so pushes it",
     "uuv_underwater_object_plugin uuv_underwater_object_ros_plugin uuv_thruster_plugin"
     " uuv_thruster_ros_plugin uuv_fin_plugin uuv_fin_ros_plugin"
     " uuv_underwater_current_plugin uuv_underwater_current_ros_plugin uuv_sc_ros_interface_plugin"
     " usv_gazebo_dynamics_plugin"
     " usv_gazebo_thrust_plugin usv_gazebo_wind_plugin freefloating_gazebo_fluid"
     " freefloating_gazebo_control"),
    ("its joints and controllers are those of libraries in C++",
     "libgazebo_ros_control.so moves the same joints with the controllers of ros_control",
     "panda_gazebo_ros_control baxter_gazebo_ros_control sawyer_gazebo_ros_control"),
    ("actors have no contacts", "a model with libRandomVelocityPlugin.so is an obstacle that moves",
     "ActorCollisionsPlugin"),
    ("the social forces between pedestrians are not simulated",
     "an actor can walk along a <trajectory>, and libActorPosesPlugin.so follows the agents of"
     " pedsim_ros", "PedestrianSFMPlugin"),
    ("radio ranges are not simulated",
     "libgazebo_ros_p3d.so publishes the positions that they can be computed from",
     "gtec_uwb_plugin gtec_tag_pos_publisher_plugin"),
    ("the motion sensors of the camera are not simulated",
     "libgazebo_ros_imu_sensor.so measures accelerations and turn rates",
     "realsense_gazebo_accel_sensor realsense_gazebo_gyro_sensor"),
    ("sensors of the ARIAC competition are not simulated",
     "libgazebo_ros_range.so, libgazebo_ros_laser.so and libgazebo_ros_depth_camera.so measure"
     " distances", "ROSLogicalCameraPlugin ROSProximityRayPlugin"),
    ("the vacuum gripper of the ARIAC competition is not simulated",
     "libgazebo_ros_vacuum_gripper.so holds objects, too",
     "ROSVacuumGripperPlugin VacuumGripperPlugin"),
    ("it publishes the pose and velocity of a vehicle",
     "libgazebo_ros_p3d.so does, too", "uuv_gazebo_ros_pose_gt_plugin"),
    ("underwater sensors are not simulated",
     "libgazebo_ros_imu_sensor.so, libgazebo_ros_camera.so and libgazebo_ros_p3d.so can replace"
     " some", "uuv_gazebo_ros_imu_plugin uuv_gazebo_ros_dvl_plugin uuv_gazebo_ros_rpt_plugin"
     " uuv_gazebo_ros_subsea_pressure_plugin uuv_gazebo_ros_magnetometer_plugin"
     " uuv_gazebo_ros_gps_plugin uuv_gazebo_ros_camera_plugin uuv_gazebo_ros_cpc_plugin"),
    ("the scan patterns of Livox are not simulated",
     "libgazebo_ros_velodyne_laser.so scans in rows", "livox_laser_simulation"),
)

_REASONS: Mapping[str, Tuple[str, str]] = {
    f"lib{name}.so": (reason, alternative)
    for reason, alternative, names in _KNOWN for name in names.split()}


def missing_plugin(library: str) -> Tuple[str, str]:
    """Return the sentence that there is no plugin for a library, and what the user can do."""
    text = f"there is no plugin for {library or 'a library without a name'}"
    if library not in _REASONS:
        return text, _USUAL_HINT
    reason, alternative = _REASONS[library]
    return f"{text}: {reason}", alternative
