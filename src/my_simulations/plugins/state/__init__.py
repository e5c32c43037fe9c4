"""Plugins that tell or set the state of a robot."""
