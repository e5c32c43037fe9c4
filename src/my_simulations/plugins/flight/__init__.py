"""Plugins of multirotors: rotors, drag, flight controllers and their sensors."""
