"""Reads and writes SDF and URDF by tables. Readers collect issues; they never print."""
