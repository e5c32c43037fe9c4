"""Pictures, drawn by OpenGL."""
