"""Plugins of models, sensors and worlds, found by the names of Gazebo's libraries."""
