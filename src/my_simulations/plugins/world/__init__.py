"""Plugins of worlds, and of what surrounds a model: air, water, wind."""
