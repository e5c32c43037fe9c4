#!/usr/bin/env python3
"""Drives the lab robot to a wall, as its laser sees it, and prints the scans. Needs no ROS.

    python3 examples/drive_robot.py [DISTANCE]
"""
import sys
from pathlib import Path

import numpy as np

import my_simulations

ROBOT = Path(__file__).resolve().parents[1] / "urdf" / "robo.urdf"
WALL = """<sdf version="1.7"><model name="wall"><static>true</static><link name="link">
<collision name="c"><geometry><box><size>0.2 4 1</size></box></geometry></collision>
</link></model></sdf>"""
SPEED, SLOWNESS = 0.4, 0.8   # m/s, and m/s for each m that is left
SECONDS = 20.0


def ahead(scan):
    """The distance in m within 5 degrees of straight ahead; inf if nothing is in range."""
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    return float(np.min(scan.ranges[np.abs(angles) < np.radians(5.0)]))


def approach(distance):
    """Drive until a wall is `distance` m ahead; gives (s, m to the wall, m by odometry)."""
    with my_simulations.open_world("worlds/empty.world") as world:
        world.spawn(ROBOT)
        world.spawn(WALL, pose=[3.0, 0.0, 0.5])
        scan, odometry = world.topics["/scan"], world.topics["/odom"]
        left = np.inf
        while world.time < SECONDS and left > 0.005:
            seen = ahead(scan.wait())
            left = seen - distance
            yield world.time, seen, odometry.latest.pose.pose.position.x
            world.publish("/cmd_vel", {"linear": {"x": min(SPEED, SLOWNESS * max(0.0, left))}})


def main():
    """Stop half a metre before the wall, or at the distance of the command line."""
    print(f"{'time':>6} {'wall':>6} {'odometry':>9}")
    for time, seen, driven in approach(float((sys.argv[1:] or ["0.5"])[0])):
        print(f"{time:5.1f}s {seen:5.2f}m {driven:8.2f}m")


if __name__ == "__main__":
    main()
