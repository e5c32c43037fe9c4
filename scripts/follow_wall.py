#!/usr/bin/env python3
"""Exercise 3: follow the walls of a room at a distance, with the wall on the right.

rosrun my_simulations follow_wall.py _distance:=0.5 _way:=8
"""
import math

from my_simulations.cli.course_robot import Robot

RIGHT = -math.pi / 2

robot = Robot("follow_wall")
distance = robot.parameter("distance", 0.5)  # m, from the laser to the wall
way = robot.parameter("way", 8.0)            # m along the walls
speed = robot.parameter("speed", 0.2)        # m/s

# To the wall, then left until it is on the right.
while robot.running() and robot.nearest() > distance + 0.1:
    robot.drive(speed)
robot.come_to_rest()
heading = robot.pose[2]
while robot.running() and robot.angle_from(heading) < 0.95 * math.pi / 2:
    robot.drive(0.0, 0.6)

driven, last = 0.0, robot.pose
while robot.running() and driven < way:
    driven, last = driven + robot.distance_from(last), robot.pose
    if robot.nearest() < distance + 0.1:     # a corner: turn on the spot
        robot.drive(0.0, 0.6)
        continue
    # The wall is as far as its nearest point, and in parallel where that is exactly on the right.
    beside = robot.nearest(RIGHT, 1.6)
    askew = math.remainder(robot.direction_of_nearest(RIGHT, 1.6) - RIGHT, 2 * math.pi)
    robot.drive(speed, max(-0.8, min(0.8, 1.5 * askew + 1.5 * (distance - beside))))
robot.come_to_rest()
robot.say(f"followed the wall for {driven:.1f} m")
