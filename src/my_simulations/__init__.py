"""A Gazebo Classic substitute for ROS 1, on PyBullet.

Files are read into a description; a simulator keeps the description and the clock; an engine
in its own process moves it; ROS, the editor and the command line are faces of the simulator.
"""

__version__ = "0.1.0"
