"""Plugins that publish or set the state of a robot."""
