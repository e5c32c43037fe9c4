"""Plugins that drive a robot."""
