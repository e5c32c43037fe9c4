"""A program of a student that moves a box by the services, and says so on a topic."""
from __future__ import annotations


def box_program(next_x: str, setup: str = "") -> str:
    """Its source.

    Args:
        next_x: expression for the place of the box along x in each period, m.
        setup: lines between the topic and the service.
    """
    return f"""#!/usr/bin/env python3
import rospy
from gazebo_msgs.msg import ModelState
from gazebo_msgs.srv import SetModelState
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse

rospy.init_node("go")
chat = rospy.Publisher("/chat", String, queue_size=10)
{setup}
rospy.wait_for_service("/gazebo/set_model_state")
move = rospy.ServiceProxy("/gazebo/set_model_state", SetModelState)
state = ModelState(model_name="box")
state.pose.position.z, state.pose.orientation.w = 0.1, 1.0
rate = rospy.Rate(25)
while not rospy.is_shutdown():
    chat.publish("here")
    state.pose.position.x = {next_x}
    move(state)
    rate.sleep()
"""
