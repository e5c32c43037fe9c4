"""Plugins of sensors."""
