"""Loads meshes, and makes meshes of shapes; triangles in metres."""
