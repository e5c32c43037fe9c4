"""Worlds from Python, without ROS: `my_simulations.open_world` (see doc/python_api.md)."""
from .open_world import OpenWorld, WorldChoice, open_world
from .readings import ContactReading, JointReadings, Readings, SavedState

__all__ = ["ContactReading", "JointReadings", "OpenWorld", "Readings", "SavedState", "WorldChoice",
           "open_world"]
