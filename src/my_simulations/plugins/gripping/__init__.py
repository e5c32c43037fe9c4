"""Plugins that hold objects."""
