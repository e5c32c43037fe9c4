"""Two mobile robots for measurements, written after the public TurtleBot3 burger and Husky.

They have the same bodies, joints, plugins, rates and topics as those; pictures, meshes and names of
makers are left out. `plugins` False leaves out all plugins and sensors, and keeps the bodies.
"""
from __future__ import annotations

from typing import Dict, List, Tuple

Kinds = List[Tuple[str, str, str]]
"""Topic below the namespace, package, type."""


def _inertia(mass: float, x: float, y: float, z: float) -> str:
    return (f'<inertial><mass value="{mass}"/><inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0"'
            ' ixz="0" iyz="0"/></inertial>')


def _wheel(name: str, parent: str, at: str, turn: str, shape: str, inertia: str,
           axis: str = "0 0 1") -> str:
    return f"""<joint name="{name}_joint" type="continuous"><parent link="{parent}"/>
      <child link="{name}"/><origin xyz="{at}" rpy="{turn}"/><axis xyz="{axis}"/></joint>
      <link name="{name}">{inertia}<collision>{shape}</collision></link>"""


def _fixed(name: str, parent: str, at: str, inside: str = "", turn: str = "0 0 0") -> str:
    return f"""<joint name="{name}_joint" type="fixed"><parent link="{parent}"/>
      <child link="{name}"/><origin xyz="{at}" rpy="{turn}"/></joint>
      <link name="{name}">{inside}</link>"""


def small_robot(plugins: bool = True) -> str:
    """Two driven wheels, a caster, a laser of 360 rays at 5 Hz, and an IMU at every step."""
    rolling = '<geometry><cylinder length="0.018" radius="0.033"/></geometry>'
    wheels = "".join(_wheel(f"wheel_{side}", "base_link", f"0 {y} 0.023", "-1.57 0 0", rolling,
                            _inertia(0.0285, 1.12e-5, 1.12e-5, 2.07e-5))
                     for side, y in (("left", 0.08), ("right", -0.08)))
    surfaces = "".join(
        f"""<gazebo reference="wheel_{side}"><mu1>0.1</mu1><mu2>0.1</mu2><kp>500000</kp>
        <kd>10</kd><minDepth>0.001</minDepth><maxVel>0.1</maxVel><fdir1>1 0 0</fdir1></gazebo>"""
        for side in ("left", "right")) + """<gazebo reference="caster"><mu1>0.1</mu1><mu2>0.1</mu2>
        <kp>1000000</kp><kd>100</kd><minDepth>0.001</minDepth><maxVel>1</maxVel></gazebo>"""
    base = _fixed("base_link", "base_footprint", "0 0 0.01",
                  _inertia(0.8257, 2.21e-3, 2.12e-3, 2.01e-3)
                  + """<collision><origin xyz="-0.032 0 0.07"/><geometry>
                  <box size="0.14 0.14 0.143"/></geometry></collision>""")
    caster = _fixed("caster", "base_link", "-0.081 0 -0.004", _inertia(0.005, 1e-3, 1e-3, 1e-3)
                    + """<collision><origin xyz="0 0.001 0"/><geometry>
                    <box size="0.03 0.009 0.02"/></geometry></collision>""", "-1.57 0 0")
    scanner = _fixed("scanner", "base_link", "-0.032 0 0.172", _inertia(0.114, 1e-3, 1e-3, 1e-3)
                     + """<collision><origin xyz="0.015 0 -0.0065"/><geometry>
                     <cylinder length="0.0315" radius="0.055"/></geometry></collision>""")
    imu = _fixed("imu_link", "base_link", "-0.032 0 0.068")
    return (f'<robot name="small"><link name="base_footprint"/>{base}{wheels}{caster}{imu}'
            f'{scanner}{surfaces}{_SMALL_PLUGINS if plugins else ""}</robot>')


_SMALL_PLUGINS = """
<gazebo reference="imu_link"><sensor type="imu" name="imu"><always_on>true</always_on></sensor>
</gazebo>
<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <commandTopic>cmd_vel</commandTopic><odometryTopic>odom</odometryTopic>
  <odometryFrame>odom</odometryFrame><odometrySource>world</odometrySource>
  <publishOdomTF>true</publishOdomTF><robotBaseFrame>base_footprint</robotBaseFrame>
  <publishWheelTF>false</publishWheelTF><publishTf>true</publishTf>
  <publishWheelJointState>true</publishWheelJointState><legacyMode>false</legacyMode>
  <updateRate>30</updateRate><leftJoint>wheel_left_joint</leftJoint>
  <rightJoint>wheel_right_joint</rightJoint><wheelSeparation>0.16</wheelSeparation>
  <wheelDiameter>0.066</wheelDiameter><wheelAcceleration>1</wheelAcceleration>
  <wheelTorque>10</wheelTorque></plugin></gazebo>
<gazebo><plugin name="imu_plugin" filename="libgazebo_ros_imu.so"><alwaysOn>true</alwaysOn>
  <bodyName>imu_link</bodyName><frameName>imu_link</frameName><topicName>imu</topicName>
  <serviceName>imu_service</serviceName><gaussianNoise>0</gaussianNoise><updateRate>0</updateRate>
  </plugin></gazebo>
<gazebo reference="scanner"><sensor type="ray" name="lds"><update_rate>5</update_rate><ray>
  <scan><horizontal><samples>360</samples><resolution>1</resolution><min_angle>0</min_angle>
  <max_angle>6.28319</max_angle></horizontal></scan>
  <range><min>0.12</min><max>3.5</max><resolution>0.015</resolution></range>
  <noise><type>gaussian</type><mean>0</mean><stddev>0.01</stddev></noise></ray>
  <plugin name="laser" filename="libgazebo_ros_laser.so"><topicName>scan</topicName>
  <frameName>scanner</frameName></plugin></sensor></gazebo>"""

SMALL_TOPICS: Kinds = [
    ("odom", "nav_msgs", "Odometry"), ("imu", "sensor_msgs", "Imu"),
    ("scan", "sensor_msgs", "LaserScan"), ("joint_states", "sensor_msgs", "JointState"),
    ("/tf", "tf2_msgs", "TFMessage")]


_PLACES: Dict[str, str] = {
    "front_left": "0.256 0.2854 0.03282", "front_right": "0.256 -0.2854 0.03282",
    "rear_left": "-0.256 0.2854 0.03282", "rear_right": "-0.256 -0.2854 0.03282"}


def large_robot(plugins: bool = True) -> str:
    """Four wheels that skid, driven by ros_control at 50 Hz; an IMU at 50 Hz, GPS at 40 Hz."""
    rolling = ('<origin xyz="0 0 0" rpy="1.570795 0 0"/>'
               '<geometry><cylinder length="0.1143" radius="0.1651"/></geometry>')
    wheels = "".join(_wheel(f"{place}_wheel_link", "base_link", at, "0 0 0", rolling,
                            _inertia(2.637, 0.02467, 0.04411, 0.02467), "0 1 0").replace(
                                "_wheel_link_joint", "_wheel")
                     for place, at in _PLACES.items())
    moved = "".join(f"""<transmission name="{place}_wheel_trans" type="SimpleTransmission">
      <type>transmission_interface/SimpleTransmission</type><actuator name="{place}_wheel_motor">
      <mechanicalReduction>1</mechanicalReduction></actuator><joint name="{place}_wheel">
      <hardwareInterface>hardware_interface/VelocityJointInterface</hardwareInterface></joint>
      </transmission>""" for place in _PLACES)
    surfaces = "".join(
        f"""<gazebo reference="{place}_wheel_link"><mu1>1</mu1><mu2>1</mu2><kp>10000000</kp>
        <kd>1</kd><fdir1>1 0 0</fdir1></gazebo>""" for place in _PLACES)
    body = """<collision><origin xyz="0 0 0.12"/><geometry><box size="0.9874 0.5709 0.1238"/>
      </geometry></collision><collision><origin xyz="0 0 0.177"/><geometry>
      <box size="0.7899 0.5709 0.1238"/></geometry></collision>"""
    inertial = _fixed("inertial_link", "base_link", "0 0 0",
                      _inertia(46.034, 0.6022, 1.7386, 2.0296))
    return (f'<robot name="large"><link name="base_link">{body}</link>{inertial}{wheels}'
            f'{_fixed("imu_link", "base_link", "0.19 0 0.149")}{moved}{surfaces}'
            f'{_LARGE_PLUGINS if plugins else ""}</robot>')


_LARGE_PLUGINS = """
<gazebo><plugin name="control" filename="libgazebo_ros_control.so">
  <robotNamespace>NAMESPACE</robotNamespace></plugin></gazebo>
<gazebo><plugin name="imu" filename="libhector_gazebo_ros_imu.so">
  <robotNamespace>NAMESPACE</robotNamespace><updateRate>50</updateRate>
  <bodyName>base_link</bodyName><topicName>imu/data</topicName>
  <accelDrift>0.005 0.005 0.005</accelDrift>
  <accelGaussianNoise>0.005 0.005 0.005</accelGaussianNoise>
  <rateDrift>0.005 0.005 0.005</rateDrift><rateGaussianNoise>0.005 0.005 0.005</rateGaussianNoise>
  <headingDrift>0.005</headingDrift><headingGaussianNoise>0.005</headingGaussianNoise>
  </plugin></gazebo>
<gazebo><plugin name="gps" filename="libhector_gazebo_ros_gps.so">
  <robotNamespace>NAMESPACE</robotNamespace><updateRate>40</updateRate>
  <bodyName>base_link</bodyName><frameId>base_link</frameId><topicName>navsat/fix</topicName>
  <velocityTopicName>navsat/vel</velocityTopicName><referenceLatitude>49.9</referenceLatitude>
  <referenceLongitude>8.9</referenceLongitude><referenceHeading>0</referenceHeading>
  <referenceAltitude>0</referenceAltitude><drift>0.0001 0.0001 0.0001</drift></plugin></gazebo>"""

LARGE_TOPICS: Kinds = [
    ("drive/odom", "nav_msgs", "Odometry"), ("imu/data", "sensor_msgs", "Imu"),
    ("navsat/fix", "sensor_msgs", "NavSatFix"),
    ("navsat/vel", "geometry_msgs", "Vector3Stamped"),
    ("joint_states", "sensor_msgs", "JointState")]

LARGE_CONTROLLERS = {
    "joints": {"type": "joint_state_controller/JointStateController", "publish_rate": 50},
    "drive": {
        "type": "diff_drive_controller/DiffDriveController",
        "left_wheel": ["front_left_wheel", "rear_left_wheel"],
        "right_wheel": ["front_right_wheel", "rear_right_wheel"], "publish_rate": 50,
        "pose_covariance_diagonal": [0.001] * 5 + [0.03],
        "twist_covariance_diagonal": [0.001] * 5 + [0.03], "cmd_vel_timeout": 0.25,
        "velocity_rolling_window_size": 2, "publish_cmd": True, "base_frame_id": "base_link",
        "enable_odom_tf": False, "wheel_separation_multiplier": 1.875,
        "linear": {"x": {"has_velocity_limits": True, "max_velocity": 1.0,
                         "has_acceleration_limits": True, "max_acceleration": 3.0}},
        "angular": {"z": {"has_velocity_limits": True, "max_velocity": 2.0,
                          "has_acceleration_limits": True, "max_acceleration": 6.0}}}}
