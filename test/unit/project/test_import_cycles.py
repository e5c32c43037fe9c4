"""No module or sub-package imports itself by way of others, imports inside functions included."""
from __future__ import annotations

import ast
from functools import lru_cache
from itertools import takewhile
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


@lru_cache(maxsize=None)
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


def sibling_graphs(graph):
    """By package: the imports between the modules and packages that lie directly in it."""
    found = {}
    for importer, imports in graph.items():
        for imported in imports:
            here, there = importer.split("."), imported.split(".")
            shared = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(here, there)))
            if shared < min(len(here), len(there)):
                siblings = found.setdefault(".".join(here[:shared]), {})
                siblings.setdefault(here[shared], set()).add(there[shared])
                siblings.setdefault(there[shared], set())
    return found


def test_no_package_imports_itself_by_way_of_those_beside_it():
    found = sibling_graphs(import_graph(SOURCE, PACKAGE))
    assert {PACKAGE, *(f"{PACKAGE}.{name}" for name in (
        "editor", "engine", "formats", "formats.sdf", "ros"))} <= set(found)
    assert {package: cycle for package, cycle in (
        (package, cycle_in(graph)) for package, graph in found.items()) if cycle} == {}


def test_a_cycle_of_packages_without_one_of_modules_is_found(tmp_path):
    package = tmp_path / "house"
    for room in ("kitchen", "bath"):
        (package / room).mkdir(parents=True)
        (package / room / "__init__.py").touch()
        (package / room / "floor.py").touch()
    (package / "__init__.py").touch()
    (package / "kitchen" / "sink.py").write_text("from ..bath import floor\n")
    (package / "bath" / "tub.py").write_text("from ..kitchen.floor import tile\n")
    graph = import_graph(tmp_path, "house")
    assert cycle_in(graph) == []
    assert cycle_in(sibling_graphs(graph)["house"]) in (
        ["bath", "kitchen", "bath"], ["kitchen", "bath", "kitchen"])


def test_a_cycle_by_way_of_an_import_inside_a_function_is_found(tmp_path):
    package = tmp_path / "house"
    (package / "room").mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "room" / "__init__.py").touch()
    (package / "door.py").write_text("from .room import wall\n")
    (package / "room" / "wall.py").write_text("def f():\n    from ..door import x\n")
    assert cycle_in(import_graph(tmp_path, "house")) == [
        "house.door", "house.room.wall", "house.door"]
