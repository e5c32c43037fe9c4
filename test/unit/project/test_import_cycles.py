"""No module of the package imports itself by way of others, imports inside functions included.

`.importlinter` says the same of the packages that lie side by side.
"""
from __future__ import annotations

import ast
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3] / "src"
PACKAGE = "my_simulations"


def module_name(path, source):
    parts = path.relative_to(source).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(path, name, modules):
    """The modules that a file imports, at the top, in functions and under TYPE_CHECKING."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(), str(path))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
                parts = parts[:len(parts) - node.level + 1]
                base = ".".join([*parts, *([node.module] if node.module else [])])
            for alias in node.names:
                inner = f"{base}.{alias.name}"
                found.add(inner if inner in modules else base)
    return {module for module in found if module in modules and module != name}


def import_graph(source, package):
    paths = {module_name(path, source): path for path in (source / package).rglob("*.py")}
    return {name: imports_of(path, name, paths) for name, path in paths.items()}


def cycle_in(graph):
    """The modules of one cycle, in order; [] if there is none."""
    done = set()
    for start in graph:
        stack = [(start, iter(sorted(graph[start])))] if start not in done else []
        while stack:
            for module in stack[-1][1]:
                on_path = [name for name, _ in stack]
                if module in on_path:
                    return [*on_path[on_path.index(module):], module]
                if module not in done:
                    stack.append((module, iter(sorted(graph[module]))))
                    break
            else:
                done.add(stack.pop()[0])
    return []


def test_no_module_imports_itself_by_way_of_others():
    graph = import_graph(SOURCE, PACKAGE)
    assert len(graph) > 200
    assert cycle_in(graph) == []


def test_a_cycle_by_way_of_an_import_inside_a_function_is_found(tmp_path):
    package = tmp_path / "house"
    (package / "room").mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "room" / "__init__.py").touch()
    (package / "door.py").write_text("from .room import wall\n")
    (package / "room" / "wall.py").write_text("def f():\n    from ..door import x\n")
    assert cycle_in(import_graph(tmp_path, "house")) == [
        "house.door", "house.room.wall", "house.door"]
