"""Clients of the controller manager."""
