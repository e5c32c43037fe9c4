"""Camera, laser scanner and IMU: links with a sensor, and each alone on a post."""
from __future__ import annotations

import math

from . import sdf_parts as sdf
from .template_parameters import Parameter, Values, number

CAMERA_SIZE = (0.03, 0.06, 0.04)
LASER_RADIUS, LASER_LENGTH = 0.04, 0.06
IMU_SIZE = (0.03, 0.03, 0.01)
_POST_RADIUS = 0.02

NAMESPACE = Parameter("namespace", "ROS namespace", "", optional=True)
HEIGHT = number("height", "Height above the ground", 1.0, "m", 0.1, 10.0)

CAMERA = (
    Parameter("camera_name", "Camera name (topic <name>/image_raw)", "camera"),
    number("image_width", "Image width", 320, "pixels", 16, 1920),
    number("image_height", "Image height", 240, "pixels", 16, 1080),
    number("field_of_view", "Horizontal field of view", 80.0, "degrees", 10.0, 170.0),
    number("camera_rate", "Camera rate", 10.0, "Hz", 1.0, 60.0),
)
LASER = (
    Parameter("scan_topic", "Laser topic", "scan"),
    number("scan_angle", "Laser angle", 180.0, "degrees", 10.0, 360.0),
    number("scan_samples", "Laser rays", 181, "", 2, 2000),
    number("scan_range", "Laser range", 8.0, "m", 0.5, 100.0),
    number("scan_rate", "Laser rate", 10.0, "Hz", 1.0, 50.0),
)
IMU = (
    Parameter("imu_topic", "IMU topic", "imu"),
    number("imu_rate", "IMU rate", 100.0, "Hz", 1.0, 1000.0),
)


def namespace(values: Values) -> str:
    """The `<robotNamespace>`: absolute, the root for an empty name."""
    return "/" + values["namespace"]


def camera_sensor(values: Values, name: str, link: str, at: str = "") -> str:
    """A camera; `at` is its `<pose>` in the link."""
    width, height = int(values["image_width"]), int(values["image_height"])
    return (f'<sensor name="{name}" type="camera">{at}<update_rate>'
            f'{values["camera_rate"]:g}</update_rate><camera>'
            f'<horizontal_fov>{math.radians(values["field_of_view"]):.6g}</horizontal_fov>'
            f"<image><width>{width}</width><height>{height}</height><format>R8G8B8</format>"
            "</image><clip><near>0.02</near><far>100</far></clip></camera>"
            + sdf.plugin(name, "libgazebo_ros_camera.so", robotNamespace=namespace(values),
                         cameraName=values["camera_name"], imageTopicName="image_raw",
                         cameraInfoTopicName="camera_info", frameName=link)
            + "</sensor>")


def laser_sensor(values: Values, name: str, link: str) -> str:
    """A laser scanner about the z axis of the link."""
    half, samples = math.radians(values["scan_angle"]) / 2.0, int(values["scan_samples"])
    return (f'<sensor name="{name}" type="ray"><update_rate>{values["scan_rate"]:g}</update_rate>'
            f"<ray><scan><horizontal><samples>{samples}</samples><resolution>1</resolution>"
            f"<min_angle>{-half:.6g}</min_angle><max_angle>{half:.6g}</max_angle></horizontal>"
            f'</scan><range><min>0.06</min><max>{values["scan_range"]:g}</max>'
            "<resolution>0.01</resolution></range></ray>"
            + sdf.plugin(name, "libgazebo_ros_laser.so", robotNamespace=namespace(values),
                         topicName=values["scan_topic"], frameName=link) + "</sensor>")


def imu_sensor(values: Values, name: str, link: str) -> str:
    """An IMU at the origin of the link."""
    return (f'<sensor name="{name}" type="imu"><always_on>1</always_on>'
            f'<update_rate>{values["imu_rate"]:g}</update_rate>'
            + sdf.plugin(name, "libgazebo_ros_imu_sensor.so", robotNamespace=namespace(values),
                         topicName=values["imu_topic"], frameName=link,
                         updateRateHZ=f'{values["imu_rate"]:g}') + "</sensor>")


def sensor_alone(kind: str, name: str, link: str) -> str:
    """The XML of a sensor with default values and topics below its name.

    Args:
        kind: `camera`, `laser` or `imu`.
        name: of the sensor and its topics.
        link: name of the link, which is the frame of the messages.
    """
    values: Values = {"namespace": "", **{one.name: one.default for one in (*CAMERA, *LASER, *IMU)},
                      "camera_name": name, "scan_topic": name, "imu_topic": name}
    if kind == "camera":
        return camera_sensor(values, name, link)
    return (laser_sensor if kind == "laser" else imu_sensor)(values, name, link)


def camera_link(values: Values, at: sdf.Triple) -> str:
    """`camera_link`, which looks along its x axis; `at` is its place in the model, m."""
    # The camera looks from the front of its box, which it would see from inside otherwise.
    sensor = camera_sensor(values, "camera", "camera_link", sdf.pose((0.025, 0.0, 0.0)))
    lens = sdf.visual("lens", sdf.cylinder(0.012, 0.01), "glass",
                      sdf.pose((CAMERA_SIZE[0] / 2.0, 0.0, 0.0), (0.0, math.pi / 2.0, 0.0)))
    return sdf.link("camera_link", sdf.pose(at), sdf.box_inertial(0.05, CAMERA_SIZE),
                    sdf.visual("case", sdf.box(CAMERA_SIZE), "dark"), lens, sensor)


def laser_link(values: Values, at: sdf.Triple) -> str:
    """`laser_link`, whose scan is about its z axis; `at` is its place in the model, m."""
    sensor = laser_sensor(values, "laser", "laser_link")
    return sdf.link("laser_link", sdf.pose(at),
                    sdf.cylinder_inertial(0.1, LASER_RADIUS, LASER_LENGTH),
                    sdf.visual("case", sdf.cylinder(LASER_RADIUS, LASER_LENGTH), "dark"), sensor)


def imu_link(values: Values, at: sdf.Triple) -> str:
    """`imu_link`; `at` is its place in the model, m."""
    sensor = imu_sensor(values, "imu", "imu_link")
    return sdf.link("imu_link", sdf.pose(at), sdf.box_inertial(0.02, IMU_SIZE),
                    sdf.visual("case", sdf.box(IMU_SIZE), "blue"), sensor)


def _on_post(values: Values, sensor: str, child: str) -> str:
    height = values["height"]
    base = sdf.cylinder(0.1, 0.02)
    post = sdf.cylinder(_POST_RADIUS, height)
    return sdf.document(
        values["name"],
        sdf.link("post", sdf.pose((0.0, 0.0, 0.0)),
                 sdf.collision_and_visual("foot", base, "dark", sdf.pose((0.0, 0.0, 0.01))),
                 sdf.collision_and_visual("post", post, "light",
                                          sdf.pose((0.0, 0.0, height / 2.0)))),
        sensor, sdf.fixed_joint("mount", "post", child), static=True)


def camera_on_post(values: Values) -> str:
    """A static camera at a height."""
    above = values["height"] + CAMERA_SIZE[2] / 2.0
    return _on_post(values, camera_link(values, (0.0, 0.0, above)), "camera_link")


def laser_on_post(values: Values) -> str:
    """A static laser scanner at a height."""
    above = values["height"] + LASER_LENGTH / 2.0
    return _on_post(values, laser_link(values, (0.0, 0.0, above)), "laser_link")


def imu_box(values: Values) -> str:
    """A free box with an IMU in it, to push and drop."""
    size, mass = values["size"], values["mass"]
    sides = (size, size, size)
    return sdf.document(
        values["name"],
        sdf.link("base_link", sdf.pose((0.0, 0.0, size / 2.0)), sdf.box_inertial(mass, sides),
                 sdf.collision_and_visual("case", sdf.box(sides), "light")),
        imu_link(values, (0.0, 0.0, size + IMU_SIZE[2] / 2.0)),
        sdf.fixed_joint("mount", "base_link", "imu_link"))
