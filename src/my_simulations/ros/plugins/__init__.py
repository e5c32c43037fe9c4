"""Plugins on the ROS graph: topics, services, tf; started with the models that have some."""
