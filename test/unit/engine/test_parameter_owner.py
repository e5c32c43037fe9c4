"""One module alone sets the parameters that Bullet has once for a whole world."""
from __future__ import annotations

import ast
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[3] / "src" / "my_simulations"


def test_one_module_sets_the_parameters_of_the_physics_engine():
    setters = {str(path.relative_to(PACKAGE)) for path in PACKAGE.rglob("*.py")
               for node in ast.walk(ast.parse(path.read_text()))
               if isinstance(node, (ast.Attribute, ast.Name))
               and (node.attr if isinstance(node, ast.Attribute) else node.id)
               == "setPhysicsEngineParameter"}
    assert setters == {"engine/bullet/world_parameters.py"}
