"""imu_sensor_controller and force_torque_sensor_controller: sensors of the robot, by their names.

Topics, rates and frames are those of ros_controllers. In Gazebo a robot's own hardware interface
brings the sensors; here they are the `<sensor>`s of the model of type imu, and of type force_torque
of its joints. Parameters of pal_hardware_gazebo, `imu` and `force_torque`, name sensors and their
frames instead.
"""
from __future__ import annotations

from typing import Callable, Dict, List, Optional, Tuple

from ...description.model import Joint
from ...description.sensor import ForceTorque, Sensor
from ...sensing.sensor_models import measure_wrench
from ..context import PluginError, Publication
from ..imu_meter import ImuMeter
from ..standard_messages import imu_message, wrench_message
from .controller import Controller
from .settings import Settings

_HANDLES = 4  # messages in a topic's queue, as the original


class _SensorController(Controller):
    """A topic for each sensor, in the robot's namespace."""

    def _named_sensors(self, kind: str, needed: str) -> Dict[str, Settings]:
        """Sensors that parameters name, as pal_hardware_gazebo reads them."""
        found = self.context.parameter(kind, {})
        return {name: Settings(self.context, f"{kind}/{name}", entry)
                for name, entry in (found.items() if isinstance(found, dict) else ())
                if isinstance(entry, dict) and needed in entry}

    def _offer(self, name: str, kind: str) -> Publication:
        topic = self.context.publish(name, kind, _HANDLES)
        self.keep_handle(topic)
        return topic


class ImuSensorController(_SensorController):
    """sensor_msgs/Imu of each `<sensor type="imu">`; the frame is that of its link."""

    def load(self) -> None:
        self._hertz = self.settings.number("publish_rate")
        self._sensors: List[Tuple[ImuMeter, str, Publication]] = []
        imus = {sensor.name: (link, sensor) for link, sensor in self.context.sensors()
                if sensor.type == "imu"}
        named = self._named_sensors("imu", "gazebo_sensor_name")
        topics = [(name, settings.text("gazebo_sensor_name"), settings.text("frame", ""))
                  for name, settings in named.items()] or [(name, name, "") for name in imus]
        for topic, name, frame in topics:
            if name not in imus:
                raise PluginError(f"parameter imu/{topic}/gazebo_sensor_name: the robot has no"
                                  f" <sensor type=\"imu\" name=\"{name}\">")
            link, sensor = imus[name]
            meter = ImuMeter(self.context, self.context.link(link), sensor.pose)
            self._sensors.append((meter, frame or link, self._offer(topic, "sensor_msgs/Imu")))
        if not self._sensors:
            raise PluginError(f"controller '{self.name}': the robot has no <sensor type=\"imu\">")

    def start(self) -> None:
        self._restart()
        if self._hertz > 0.0:
            self.observe(self._hertz, self._publish_all, [topic for _, _, topic in self._sensors],
                         resume=self._restart)

    def _restart(self) -> None:
        for meter, _, _ in self._sensors:
            meter.restart()

    def _publish_all(self) -> None:
        for meter, frame, topic in self._sensors:
            sample = meter.measure()
            if topic.wanted:
                topic.publish(imu_message(self.context, frame, *sample))


class ForceTorqueSensorController(_SensorController):
    """geometry_msgs/WrenchStamped of each force_torque sensor; the frame is that of the child."""

    def load(self) -> None:
        self._hertz = self.settings.number("publish_rate")
        self._measurements: List[Callable[[], None]] = []
        self._topics: List[Publication] = []
        self._joints: List[str] = []
        joints = self.context.description.joints
        named = self._named_sensors("force_torque", "sensor_joint")
        for name, settings in named.items():
            joint = self.context.joint(settings.text("sensor_joint")).spec
            # The frame of the parameters can be a link that was merged with the joint's child.
            self._measurements.append(self._advertise_wrench(joint, Sensor(
                name, "force_torque", force_torque=ForceTorque(
                    measure_direction="parent_to_child"))))
        for joint in () if named else joints:
            for sensor in joint.sensors:
                if sensor.type == "force_torque":
                    self._measurements.append(self._advertise_wrench(joint, sensor))
        if not self._measurements:
            raise PluginError(f"controller '{self.name}': no joint of the robot has a"
                              " <sensor type=\"force_torque\">")

    def _advertise_wrench(self, joint: Joint, sensor: Sensor) -> Callable[[], None]:
        topic = self._offer(sensor.name, "geometry_msgs/WrenchStamped")
        self._topics.append(topic)
        self._joints.append(joint.name)
        block: Optional[ForceTorque] = sensor.force_torque
        frame, direction = (block.frame, block.measure_direction) if block is not None else (
            "child", "child_to_parent")
        named = {"parent": joint.parent, "sensor": sensor.name}.get(frame, joint.child)
        self.context.joint_wrench(joint.name)   # have the engine measure from now on

        def publish() -> None:
            wrench = self.context.joint_wrench(joint.name) if topic.wanted else None
            if wrench is None:
                return
            sample = measure_wrench(wrench, frame, direction, joint.pose, sensor.pose)
            topic.publish(wrench_message(self.context, named, (sample.force, sample.torque)))

        return publish

    def start(self) -> None:
        if self._hertz > 0.0:
            self.observe(self._hertz, self._publish_all, self._topics, wrenches=self._joints)

    def _publish_all(self) -> None:
        for publish in self._measurements:
            publish()
