"""A rospy node that publishes one message on /bare_clock, to measure the start of ours against."""
from __future__ import annotations

import rospy
from rosgraph_msgs.msg import Clock

if __name__ == "__main__":
    rospy.init_node("bare_node", disable_rostime=True)
    publisher = rospy.Publisher("/bare_clock", Clock, queue_size=1, latch=True)
    publisher.publish(Clock())
    rospy.spin()
