"""Convex parts of concave meshes, for bodies that move."""
