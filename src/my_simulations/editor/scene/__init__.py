"""The world as the page draws it: JSON, materials, meshes."""
