"""Worlds from Python, without ROS: `my_simulations.open_world` (see doc/python_api.md)."""
from .open_world import OpenWorld, open_world
from .randomisation import Randomisation
from .ray_casts import RayReading
from .readings import ContactReading, JointReadings, Readings, SavedState
from .robot_joints import Robot
from .robots import RobotOptions
from .world_choice import WorldChoice
from .world_pictures import Picture, PictureRequest

__all__ = ["ContactReading", "JointReadings", "OpenWorld", "Picture", "PictureRequest",
           "Randomisation", "RayReading", "Readings", "Robot", "RobotOptions", "SavedState",
           "WorldChoice", "open_world"]
