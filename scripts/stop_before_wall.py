#!/usr/bin/env python3
"""Exercise 2: drive ahead, and stop before what the laser sees.

rosrun my_simulations stop_before_wall.py _distance:=0.5
"""
from my_simulations.cli.course_robot import Robot

robot = Robot("stop_before_wall")
distance = robot.parameter("distance", 0.5)  # m, from the laser
speed = robot.parameter("speed", 0.3)        # m/s

while robot.running():
    ahead = robot.nearest() - distance
    if ahead < 0.005:
        break
    robot.drive(min(speed, 0.02 + ahead))    # the nearer, the slower
robot.come_to_rest()
robot.say(f"stopped {robot.nearest():.2f} m before the wall")
