"""Handlers of the `/gazebo/*` services."""
