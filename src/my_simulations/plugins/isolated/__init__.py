"""Plugins of users, each in a process of its own; their context is served over a socket."""
