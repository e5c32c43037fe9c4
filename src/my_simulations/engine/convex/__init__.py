"""Simpler solids for meshes: convex parts where they move, flat faces where they do not."""
