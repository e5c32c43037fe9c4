#!/usr/bin/env python3
"""Exercise 1: drive a square by odometry.

rosrun my_simulations drive_square.py _side:=1.0 _speed:=0.2
"""
import math

from my_simulations.cli.course_robot import Robot

robot = Robot("drive_square")
side = robot.parameter("side", 1.0)      # m
speed = robot.parameter("speed", 0.2)    # m/s
start = robot.pose

for corner in range(4):
    # Straight on, and back to the heading of this side where the robot has drifted from it.
    begin, heading = robot.pose, start[2] + corner * math.pi / 2
    while robot.running() and robot.distance_from(begin) < side:
        left = side - robot.distance_from(begin)
        robot.drive(min(speed, 0.03 + left), -2.0 * robot.angle_from(heading))
    robot.come_to_rest()

    # A quarter turn to the left, slower at its end.
    heading += math.pi / 2
    while robot.running() and robot.angle_from(heading) < -0.01:
        robot.drive(0.0, min(0.8, 0.05 - robot.angle_from(heading)))
    robot.come_to_rest()

robot.say(f"back at the start, {100 * robot.distance_from(start):.1f} cm beside it by odometry")
