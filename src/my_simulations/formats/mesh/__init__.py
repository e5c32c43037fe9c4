"""Mesh files, and shapes that become meshes, as triangles in metres."""
