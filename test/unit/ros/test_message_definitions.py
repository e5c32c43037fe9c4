"""The definitions of messages in this package are those of ROS; messages convert both ways."""
from __future__ import annotations

import importlib
import io

import pytest
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan

from my_simulations.messages import from_ros, geometry_msgs, sensor_msgs, to_ros
from my_simulations.messages.definitions import standard_definitions
from my_simulations.messages.message_types import standard_type

ELSEWHERE = {"ackermann_msgs", "gazebo_conveyor", "gazebo_ros_link_attacher", "hector_uav_msgs",
             "mav_msgs", "pedsim_msgs", "prius_msgs", "rotors_comm"}
"""Packages that Debian does not have."""


def of_ros(kind):
    package, _, name = kind.partition("/")
    for sort in ("msg", "srv"):
        try:
            found = getattr(importlib.import_module(f"{package}.{sort}"), name, None)
        except ImportError:
            continue
        if found is not None:
            return found
    return None


@pytest.mark.parametrize("kind", sorted(standard_definitions()))
def test_a_definition_is_that_of_ros(kind):
    theirs = of_ros(kind)
    if theirs is None:
        assert kind.partition("/")[0] in ELSEWHERE
        return
    ours = standard_type(kind).DEFINITION
    types = [one.kind + (f"[{one.length or ''}]" if one.is_array else "") for one in ours.fields]
    assert [one.name for one in ours.fields] == list(theirs.__slots__)
    assert types == list(theirs._slot_types)
    for name, value in ours.constants.items():
        assert getattr(theirs, name) == value


def test_messages_convert_both_ways():
    scan = sensor_msgs.LaserScan(ranges=[1.0, 2.5], range_max=3.0)
    scan.header.frame_id, scan.header.stamp.secs = "laser", 3
    theirs = to_ros(scan)
    assert isinstance(theirs, LaserScan)
    buffer = io.BytesIO()
    theirs.serialize(buffer)
    received = from_ros(LaserScan().deserialize(buffer.getvalue()))
    assert received == from_ros(theirs) and received.ranges.tolist() == [1.0, 2.5]
    assert (received.header.frame_id, received.header.stamp.secs) == ("laser", 3)
    twist = Twist()
    twist.linear.x = 0.5
    assert from_ros(twist) == geometry_msgs.Twist(linear=geometry_msgs.Vector3(x=0.5))
