"""Which mesh files the editor's page reads; what sensors see of actors goes by it, too."""
from __future__ import annotations

PAGE_FORMATS = {".dae": "dae", ".stl": "stl", ".stla": "stl", ".stlb": "stl", ".obj": "obj",
                ".glb": "glb", ".gltf": "gltf"}
"""The page's reader by a file's extension; of these formats only COLLADA (dae) has animations."""

MOVEMENTS = {".bvh": "bvh"}
"""As `PAGE_FORMATS`, of files that move an actor and have no surface."""
