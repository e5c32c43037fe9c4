#!/usr/bin/env python3
"""Writes doc/messages.md: every text that users meet, as it stands in the sources."""
from __future__ import annotations

import ast
import pathlib
import sys
from typing import Callable, Dict, Iterator, List, Sequence, Tuple

from source_messages import REPOSITORY, Module, called, code_uses, modules, text_of

PAGE = REPOSITORY / "doc" / "messages.md"
SERVICES = "ros/services/"

HEAD = """# Messages

All texts of services, errors, logs and options, collected from the sources, so that they can be
read at one sitting. `{name}` stands for a value. Codes of issues are explained in
[issue codes](issue_codes.md).
"""

Rows = List[Tuple[str, str]]


def _texts(sources: Sequence[Module], finds: Callable[[ast.AST], Iterator[ast.expr]]) -> Rows:
    """Module and text of the expressions that `finds` yields, in order, without repeats."""
    found: Dict[Tuple[str, str], None] = {}
    for module in sources:
        at = [(node.lineno, node.col_offset, text_of(node, module.constants))
              for outer in module.nodes for node in finds(outer)]
        found.update(dict.fromkeys((module.path, text) for _, _, text in sorted(at) if text))
    return list(found)


def _returned(node: ast.AST) -> Iterator[ast.expr]:
    """The texts that handlers of services return."""
    if isinstance(node, ast.FunctionDef) and getattr(node.returns, "id", "") == "str":
        for inner in ast.walk(node):
            if isinstance(inner, ast.Return) and inner.value is not None:
                yield inner.value


def _prefixes(node: ast.AST) -> Iterator[ast.expr]:
    """Gazebo's own messages, which are put before those of unknown names."""
    if isinstance(node, ast.Call) and called(node) == "gazebo_prefix":
        yield from node.args


def _raised(node: ast.AST) -> Iterator[ast.expr]:
    """The first text of an error that is raised; those of issues are listed by code."""
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and node.exc.args:
        name = called(node.exc)
        if name.endswith("Error") and name != "EditRefusedError":
            yield node.exc.args[0]


def _logged(node: ast.AST) -> Iterator[ast.expr]:
    """Log lines, and lines that programs print."""
    if isinstance(node, ast.Call) and node.args:
        function = node.func
        owner = (function.value.id if isinstance(function, ast.Attribute)
                 and isinstance(function.value, ast.Name) else "")
        name = called(node)
        if (owner == "rospy" and name.startswith("log")) or name in (
                "say", "_say", "_complain", "print", "failed", "done"):
            yield node.args[0]


def _options(node: ast.AST) -> Iterator[ast.expr]:
    """Descriptions and help texts of command lines."""
    if isinstance(node, ast.Call) and called(node) in ("add_argument", "Parser", "parser_of"):
        for keyword in node.keywords:
            if keyword.arg in ("help", "description", "epilog"):
                yield keyword.value
        if called(node) == "parser_of" and len(node.args) > 1:
            yield node.args[1]


def _section(title: str, rows: Rows) -> List[str]:
    lines, last = ["", f"## {title}"], ""
    for path, text in rows:
        if path != last:
            lines += ["", f"`{path}`", ""]
            last = path
        lines.append("- " + _escaped(text))
    return lines


def _escaped(text: str) -> str:
    return " ".join(text.split()).replace("<", "&lt;").replace("|", "\\|").replace("*", "\\*")


def page() -> str:
    """The text of doc/messages.md."""
    services = [module for module in modules() if module.path.startswith(SERVICES)]
    lines = [HEAD.rstrip()]
    lines += _section("Status messages of services: success", _texts(services, _returned))
    lines += _section("Status messages of services: prefixes of Gazebo",
                      _texts(services, _prefixes))
    lines += _section("Errors of requests, tools and downloads", _texts(modules(), _raised))
    lines += _section("Log lines and output of programs", _texts(modules(), _logged))
    lines += _section("Options of command lines", _texts(modules(), _options))
    lines += ["", "## Issues by code", "", "| code | text |", "|---|---|"]
    issues = sorted({(use.pattern, _escaped(use.text)) for use in code_uses() if use.text})
    lines += [f"| `{code}` | {text} |" for code, text in issues]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(__file__).parent))
    PAGE.write_text(page(), encoding="utf-8")
