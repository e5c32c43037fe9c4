"""Finds the issue codes in the sources, without importing them."""
from __future__ import annotations

import ast
import functools
import pathlib
import re
from dataclasses import dataclass
from typing import Dict, Iterable, Iterator, List, Set, Tuple

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "src" / "my_simulations"

CARRIERS = ("code", "notice")
"""Names of parameters and fields that hold an issue code."""

LOGGERS = ("_log", "rospy", "logging")
"""Objects whose `error` and `warning` are log functions and take no code."""

_CODE = re.compile(r"[a-z]+(?:-[a-z0-9]+)*\Z")


@dataclass(frozen=True)
class Use:
    """One place where a code is given.

    Attributes:
        pattern: regular expression of the codes meant; a literal code unless part is computed.
        severity: "error", "warning", "note", or "" where it is not written there.
        path: of the module, below the package.
        line: 1-based.
    """

    pattern: str
    severity: str
    path: str
    line: int


@dataclass(frozen=True)
class Module:
    """One module of the package.

    Attributes:
        path: below the package.
        constants: values of the names that it assigns, `A, B = ...` too.
        nodes: its calls, raises, assignments, functions and classes, at whatever depth.
    """

    path: str
    constants: Dict[str, ast.expr]
    nodes: Tuple[ast.AST, ...]


@functools.lru_cache(maxsize=None)
def modules() -> Tuple[Module, ...]:
    """Each module of the package, read once: to walk all of their trees takes seconds."""
    found: List[Module] = []
    for file in sorted(PACKAGE.rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        found.append(Module(
            file.relative_to(PACKAGE).as_posix(), dict(_constants_of(tree)),
            tuple(node for node in ast.walk(tree) if isinstance(
                node, (ast.Call, ast.Raise, ast.Assign, ast.FunctionDef, ast.ClassDef)))))
    return tuple(found)


@functools.lru_cache(maxsize=None)
def code_uses() -> Tuple[Use, ...]:
    """Every place of the package where an issue code is given."""
    positions = _code_positions(modules())
    found: List[Use] = []
    for module in modules():
        for node in module.nodes:
            for expression, severity in _codes_at(node, positions):
                found += [Use(pattern, severity, module.path, expression.lineno)
                          for pattern in _patterns(expression, module.constants)]
    return tuple(found)


def _constants_of(tree: ast.Module) -> Iterator[Tuple[str, ast.expr]]:
    for node in tree.body:
        for target in node.targets if isinstance(node, ast.Assign) else []:
            if isinstance(target, ast.Name):
                yield target.id, node.value
            elif isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                yield from ((name.id, value) for name, value in zip(target.elts, node.value.elts)
                            if isinstance(name, ast.Name))


def _code_positions(sources: Iterable[Module]) -> Dict[str, Set[int]]:
    """By the name of a function or class: at which positions it takes an issue code."""
    found: Dict[str, Set[int]] = {"say": {0}}  # a bound `report` or `tolerate`
    for module in sources:
        for node in module.nodes:
            names: List[str] = []
            owner = getattr(node, "name", "")
            if isinstance(node, ast.ClassDef):
                names = [item.target.id for item in node.body if isinstance(item, ast.AnnAssign)
                         and isinstance(item.target, ast.Name)]
                for item in node.body:
                    if isinstance(item, ast.FunctionDef) and item.name == "__init__":
                        names = [argument.arg for argument in item.args.args[1:]]
            elif isinstance(node, ast.FunctionDef):
                names = [argument.arg for argument in node.args.args]
                names = names[1:] if names[:1] == ["self"] else names
            for name in CARRIERS:
                if name in names and owner != "__init__":
                    found.setdefault(owner, set()).add(names.index(name))
    return found


def _codes_at(node: ast.AST, positions: Dict[str, Set[int]]
              ) -> Iterator[Tuple[ast.expr, str]]:
    """The expressions that give a code here, each with its severity."""
    if isinstance(node, ast.Call) and not _is_log_call(node):
        yield from _codes_of_call(node, positions)
    elif isinstance(node, ast.Assign):
        if any(isinstance(target, ast.Name) and target.id in CARRIERS for target in node.targets):
            yield node.value, ""
    elif isinstance(node, ast.FunctionDef):
        for argument, default in zip(reversed(node.args.args), reversed(node.args.defaults)):
            if argument.arg in CARRIERS:
                yield default, ""


def _is_log_call(call: ast.Call) -> bool:
    return (isinstance(call.func, ast.Attribute) and isinstance(call.func.value, ast.Name)
            and call.func.value.id in LOGGERS)


def _codes_of_call(call: ast.Call, positions: Dict[str, Set[int]]
                   ) -> Iterator[Tuple[ast.expr, str]]:
    name = _called(call)
    for position in positions.get(name, ()):
        if position < len(call.args):
            yield call.args[position], _severity(name, call)
    for keyword in call.keywords:
        if keyword.arg in CARRIERS and name in positions:
            yield keyword.value, ""
    if (name == "getattr" and len(call.args) == 3 and isinstance(call.args[1], ast.Constant)
            and call.args[1].value in CARRIERS):
        yield call.args[2], ""


def _called(call: ast.Call) -> str:
    """The last name of what is called."""
    return (call.func.id if isinstance(call.func, ast.Name)
            else call.func.attr if isinstance(call.func, ast.Attribute) else "")


_SEVERITIES = {
    "error": "error", "_fault": "error", "_unusable": "error", "_fatal": "error",
    "EditRefusedError": "error", "MeshError": "error", "warning": "warning", "warn": "warning",
    "tolerate": "warning",
}


def _severity(name: str, call: ast.Call) -> str:
    if name in _SEVERITIES:
        return _SEVERITIES[name]
    for node in [*call.args, *(keyword.value for keyword in call.keywords)]:
        if isinstance(node, ast.Attribute) and node.attr in ("ERROR", "WARNING", "NOTE"):
            return node.attr.lower()
        if isinstance(node, ast.Attribute) and node.attr in ("FATAL", "LEFT_OUT"):
            return "error"
    return "error" if name == "Fault" else ""


def _patterns(expression: ast.expr, constants: Dict[str, ast.expr]) -> Iterator[str]:
    """The codes that an expression may be, as regular expressions."""
    if isinstance(expression, ast.Constant):
        if isinstance(expression.value, str) and _CODE.match(expression.value):
            yield expression.value
    elif isinstance(expression, ast.JoinedStr):
        pattern = "".join(part.value if isinstance(part, ast.Constant) else "[a-z-]+"
                          for part in expression.values)
        if " " not in pattern:
            yield pattern
    elif isinstance(expression, ast.IfExp):
        yield from _patterns(expression.body, constants)
        yield from _patterns(expression.orelse, constants)
    elif isinstance(expression, ast.Name) and expression.id in constants:
        yield from _patterns(constants[expression.id], {})
