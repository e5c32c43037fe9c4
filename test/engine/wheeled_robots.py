"""Robots on wheels, and what their odometry says."""
from __future__ import annotations

import math

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.shapes import Collision, Cylinder, Surface
from my_simulations.geometry import Pose, quat_from_rpy


def plugin(library, inside):
    return PluginSpec("p", library, f"<plugin>{inside}</plugin>", "robot.urdf", 1)


def wheel(name, x, y, radius=0.1, mass=0.5, mu=1.0):
    spin, across = mass * radius ** 2 / 2, mass * (3 * radius ** 2 + 0.01 ** 2) / 12
    return Link(name, Pose((x, y, radius)),
                Inertial(mass, ixx=across, iyy=spin, izz=across),
                [Collision("c", Cylinder(radius, 0.01),
                           Pose(orientation=quat_from_rpy(math.pi / 2, 0, 0)),
                           surface=Surface(mu=mu, mu2=mu))])


def axle(name, child, parent="base"):
    return Joint(name, "revolute", parent, child, axis=JointAxis((0.0, 1.0, 0.0)))


def base(mass=10.0, z=0.1, com=0.0):
    return Link("base", Pose((0.0, 0.0, z)),
                Inertial(mass, Pose((com, 0.0, 0.0)), ixx=0.1, iyy=0.2, izz=0.25))


def skid(mu=1.0):
    corners = {"left_front": (0.2, 0.25), "right_front": (0.2, -0.25), "left_rear": (-0.2, 0.25),
               "right_rear": (-0.2, -0.25)}
    return Model("skid", links=[base()] + [wheel(f"{name}_wheel", *at, mu=mu)
                                           for name, at in corners.items()],
                 joints=[axle(f"{name}_joint", f"{name}_wheel") for name in corners],
                 plugins=[plugin("libgazebo_ros_skid_steer_drive.so",
                                 "<wheelSeparation>0.5</wheelSeparation><torque>20</torque>"
                                 "<wheelDiameter>0.2</wheelDiameter>")])


def tricycle(extra=""):
    fork = Link("fork", Pose((0.8, 0.0, 0.1)), Inertial(0.5, ixx=0.01, iyy=0.01, izz=0.01))
    steering = Joint("front_steering_joint", "revolute", "base", "fork",
                     axis=JointAxis((0.0, 0.0, 1.0)))
    return Model("tricycle", links=[base(com=0.5), fork, wheel("front", 0.8, 0.0),
                                    wheel("left", 0.0, 0.25), wheel("right", 0.0, -0.25)],
                 joints=[steering, axle("front_wheel_joint", "front", "fork"),
                         axle("left_wheel_joint", "left"), axle("right_wheel_joint", "right")],
                 plugins=[plugin("libgazebo_ros_tricycle_drive.so",
                                 "<actuatedWheelDiameter>0.2</actuatedWheelDiameter><wheelTorque>20"
                                 "</wheelTorque><encoderWheelDiameter>0.2</encoderWheelDiameter>"
                                 "<odometrySource>encoder</odometrySource>" + extra)])


def odometry(message):
    pose = message.pose.pose
    return (pose.position.x, pose.position.y,
            2.0 * math.atan2(pose.orientation.z, pose.orientation.w))
