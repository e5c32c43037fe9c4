"""Edits that the page asks for, as operations on the simulator."""
