"""Reads URDF robots as Gazebo's converter does."""
