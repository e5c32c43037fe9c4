#!/usr/bin/env python3
"""Exercise 4: find the nearest thing, turn to it, and push it.

rosrun my_simulations push_box.py _way:=0.5
"""
from my_simulations.cli.course_robot import Robot

robot = Robot("push_box")
way = robot.parameter("way", 0.5)        # m that it is pushed
speed = robot.parameter("speed", 0.15)   # m/s
front = robot.parameter("front", 0.15)   # m, from the laser to where the robot touches things

# Turn to it.
while robot.running():
    angle = robot.direction_of_nearest()
    if abs(angle) < 0.02:
        break
    robot.drive(0.0, max(-0.8, min(0.8, 1.5 * angle)))
robot.come_to_rest()

# To the box and on, towards its middle.
gap, start = robot.nearest() - front, robot.pose
robot.say(f"the box is {gap:.2f} m away")
while robot.running() and robot.distance_from(start) < gap + way:
    steer = robot.direction_of_nearest(0.0, 0.6) if robot.distance_from(start) < 0.8 * gap else 0.0
    robot.drive(speed, steer)
robot.come_to_rest()
robot.say(f"pushed it for {robot.distance_from(start) - gap:.2f} m")
