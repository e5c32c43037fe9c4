"""Sensors and transmissions, read from SDF and URDF."""
import pytest

from my_simulations.description.compare import differences
from my_simulations.description.sensor import Lens, Noise
from my_simulations.formats.reading import read_entity
from my_simulations.formats.sdf.writer.entities import write_entity
from my_simulations.resources.resolver import Resolver

LASER = """
<sensor name="scan" type="gpu_ray">
  <pose>0 0 0.1 0 0 0</pose><update_rate>5</update_rate><visualize>true</visualize>
  <ray>
    <scan><horizontal><samples>360</samples><resolution>1</resolution><min_angle>0</min_angle>
      <max_angle>6.28</max_angle></horizontal></scan>
    <range><min>0.12</min><max>3.5</max><resolution>0.015</resolution></range>
    <noise><type>gaussian</type><mean>0.0</mean><stddev>0.01</stddev></noise>
  </ray>
  <plugin name="laser" filename="libgazebo_ros_laser.so"><topicName>scan</topicName></plugin>
</sensor>"""


def model_of(text):
    model, issues = read_entity(text, Resolver())
    return model, issues


def sdf(inside, joint=""):
    return (f"<sdf version='1.7'><model name='m'><link name='l'>{inside}</link>"
            f"<link name='k'/>{joint}</model></sdf>")


def robot(extra):
    body = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    return (f'<robot name="r"><link name="base">{body}</inertial></link>'
            f'<link name="mast">{body}</inertial></link>'
            '<joint name="up" type="fixed"><parent link="base"/><child link="mast"/>'
            f'<origin xyz="0 0 1"/></joint>\n{extra}</robot>')


def test_a_laser_of_sdf():
    model, _ = model_of(sdf(LASER))
    (sensor,) = model.links[0].sensors
    assert (sensor.name, sensor.type, sensor.update_rate) == ("scan", "gpu_ray", 5.0)
    assert sensor.visualize and sensor.pose.position == (0.0, 0.0, 0.1)
    assert sensor.ray.horizontal.samples == 360 and sensor.ray.vertical.samples == 1
    assert (sensor.ray.min_range, sensor.ray.max_range) == (0.12, 3.5)
    assert sensor.ray.noise == Noise("gaussian", stddev=0.01)
    (plugin,) = sensor.plugins
    assert plugin.filename == "libgazebo_ros_laser.so" and "<topicName>scan" in plugin.xml
    assert (sensor.line, plugin.line) == (2, 10)


def test_a_sensor_is_written_back_as_it_was():
    model, _ = model_of(sdf(LASER))
    again, issues = model_of(write_entity(model))
    assert differences(model, again) == []


def test_a_sensor_of_a_lumped_link_stands_where_the_link_was():
    model, _ = model_of(robot(f'<gazebo reference="mast">{LASER}</gazebo>'))
    (sensor,) = model.links[0].sensors
    assert sensor.pose.position == pytest.approx((0.0, 0.0, 1.1))
    assert sensor.ray.horizontal.samples == 360
    assert sensor.line == 3 and sensor.plugins[0].line == 11


def test_a_sensor_that_goes_through_a_file_of_sdf_stays_at_the_same_place():
    model, _ = model_of(robot(f'<gazebo reference="mast">{LASER}</gazebo>'))
    again, _ = model_of(write_entity(model))
    assert again.links[0].sensors[0].pose.position == pytest.approx((0.0, 0.0, 1.1))


def test_imu_noise_by_axis():
    model, _ = model_of(sdf(
        "<sensor name='i' type='imu'><imu><angular_velocity><x><noise type='gaussian'>"
        "<stddev>0.02</stddev></noise></x></angular_velocity></imu></sensor>"))
    imu = model.links[0].sensors[0].imu
    assert imu.angular_velocity.x == Noise("gaussian", stddev=0.02)
    assert imu.angular_velocity.y == Noise() and imu.enable_orientation


def test_several_cameras_and_their_names():
    model, _ = model_of(sdf(
        "<sensor name='s' type='multicamera'><camera name='left'><image><width>10</width></image>"
        "</camera><camera name='right'><clip><far>7</far></clip></camera></sensor>"))
    left, right = model.links[0].sensors[0].cameras
    assert (left.name, left.width, left.height) == ("left", 10, 240)
    assert (right.name, right.width, right.far) == ("right", 320, 7.0)


def test_the_lens_of_a_wide_angle_camera_is_read_and_written_back():
    model, issues = model_of(sdf(
        '<sensor name="s" type="wideanglecamera"><camera name="c"><lens><type>custom</type>'
        "<custom_function><c1>1.05</c1><c2>4</c2><f>2</f><fun>tan</fun></custom_function>"
        "<scale_to_hfov>false</scale_to_hfov><cutoff_angle>3.1</cutoff_angle>"
        "<env_texture_size>512</env_texture_size></lens></camera>"
        '<plugin name="p" filename="libgazebo_ros_camera.so"/></sensor>'))
    assert not issues, issues
    lens = model.links[0].sensors[0].cameras[0].lens
    assert lens == Lens("custom", 1.05, 4.0, 0.0, 2.0, "tan", False, 3.1, 512)
    again, _ = read_entity(write_entity(model), Resolver())
    assert not differences(model, again)


def test_a_contact_sensor_names_collisions():
    model, _ = model_of(sdf(
        "<sensor name='s' type='contact'><contact><collision>a</collision><collision>b</collision>"
        "</contact></sensor>"))
    assert model.links[0].sensors[0].contact.collisions == ["a", "b"]


def test_a_joint_has_a_force_torque_sensor():
    model, _ = model_of(sdf("", "<joint name='j' type='fixed'><parent>l</parent><child>k</child>"
                            "<sensor name='ft' type='force_torque'><force_torque><frame>parent"
                            "</frame></force_torque></sensor></joint>"))
    (sensor,) = model.joints[0].sensors
    assert sensor.force_torque.frame == "parent" and model.joints[0].extra


def test_a_value_that_cannot_be_read_is_a_warning_and_the_model_lives():
    model, issues = model_of(sdf(
        "<sensor name='s' type='ray'>\n<update_rate>often</update_rate></sensor>"))
    assert model.links[0].sensors[0].update_rate == 0.0
    assert [issue.line for issue in issues if issue.code in ("bad-value", "value-odd")] == [2]


def test_a_transmission_of_a_robot():
    model, _ = model_of(robot(
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
        '<joint name="up"><hardwareInterface>hardware_interface/EffortJointInterface'
        '</hardwareInterface></joint><actuator name="motor"><mechanicalReduction>50'
        '</mechanicalReduction></actuator></transmission>'))
    (one,) = model.transmissions
    assert one.type == "transmission_interface/SimpleTransmission"
    assert one.joints[0].interfaces == ["hardware_interface/EffortJointInterface"]
    assert one.actuators[0].reduction == 50.0
