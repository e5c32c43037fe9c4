"""Notes on topics that only a program uses."""
from __future__ import annotations

import re

import pytest

from my_simulations.grading.misnamed_topics import misnamed_topics

SUBSCRIBERS = [["/robo/cmd_vel", ["/gazebo"]], ["/joint/command", ["/gazebo"]], ["/rosout", []]]
PUBLISHERS = [["/robo/odom", ["/gazebo"]], ["/scan", ["/gazebo"]], ["/clock", ["/gazebo"]]]


@pytest.mark.parametrize("publishes, subscribes, told", [
    ("/cmd_vel", "", ["publishes /cmd_vel, which nothing subscribes .*mean /robo/cmd_vel"]),
    ("/robo/cmd_vell", "", ["publishes /robo/cmd_vell, .*did you mean /robo/cmd_vel"]),
    ("/robo/cmd_vel", "/scan", []),
    ("/distance", "/distance", []),           # between the nodes of the program
    ("/my_plot", "/goal", []),                # unlike any topic of the world
    ("", "/odom", ["subscribes to /odom, which nothing publishes; did you mean /robo/odom"]),
    ("/rosout", "/tf", []),
])
def test_topics_that_resemble_one_of_the_world_are_named(publishes, subscribes, told):
    found = misnamed_topics([*PUBLISHERS, *([[publishes, ["/go"]]] if publishes else [])],
                            [*SUBSCRIBERS, *([[subscribes, ["/go"]]] if subscribes else [])])
    assert len(found) == len(told)
    for text, pattern in zip(found, told):
        assert re.search(pattern, text), text
