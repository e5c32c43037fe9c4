"""Rays, cameras and sensor models. Plans and data import nothing."""
