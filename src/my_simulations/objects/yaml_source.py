"""Reads a YAML file and remembers on which line every key stands."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Sequence, Tuple

import yaml

from ..errors import InputError, Issue, error, warning

KeyPath = Tuple[str, ...]


@dataclass(frozen=True)
class Source:
    """Where a tree of values came from.

    Attributes:
        root: parameter path of the tree, e.g. `/objects`.
        file: path of the file, "" for values read from the parameter server.
        lines: 1-based line of each key, by its path of keys below the root.
    """

    root: str
    file: str = ""
    lines: Dict[KeyPath, int] = field(default_factory=dict)

    def param(self, path: Sequence[str]) -> str:
        """The parameter path of a key, e.g. `/objects/table/position`."""
        return "/".join([self.root, *path])

    def where(self, path: Sequence[str]) -> Dict[str, Any]:
        """Keywords for an `Issue` about the key, or its nearest known parent."""
        known = tuple(path)
        while known and known not in self.lines:
            known = known[:-1]
        return {"file": self.file, "line": self.lines.get(known, 0), "xpath": self.param(path)}


def read_yaml(file: str, root: str) -> Tuple[Any, Source, List[Issue]]:
    """Reads one YAML document.

    Args:
        file: path of the file.
        root: parameter path under which its content is known, for messages.

    Returns:
        The plain values (None for an empty file), their source, and warnings about repeated keys.

    Raises:
        InputError: the file cannot be read or is not YAML.
    """
    try:
        with open(file, encoding="utf-8") as stream:
            text = stream.read()
    except OSError as fault:
        raise InputError([error("list-unreadable", f"cannot read the list: {fault.strerror}",
                                file=file)]) from fault
    except UnicodeDecodeError as fault:
        raise InputError([error("list-not-utf8", f"the list is not UTF-8 text: {fault}",
                                file=file, hint="save it as UTF-8")]) from fault
    lines: Dict[KeyPath, int] = {}
    issues: List[Issue] = []
    loader = yaml.SafeLoader(text)
    try:
        node = loader.get_single_node()
        if node is None:
            return None, Source(root, file), []
        # Lines are collected first: constructing flattens `<<` merges into the nodes.
        _collect_lines(node, (), lines, issues, Source(root, file, lines))
        data = loader.construct_document(node)
    except yaml.YAMLError as fault:
        raise InputError([_yaml_issue(fault, file)]) from fault
    finally:
        loader.dispose()
    return data, Source(root, file, lines), issues


def _collect_lines(node: yaml.Node, path: KeyPath, lines: Dict[KeyPath, int],
                   issues: List[Issue], source: Source) -> None:
    if not isinstance(node, yaml.MappingNode):
        return
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            continue
        below = (*path, str(key.value))
        if below in lines and key.value != "<<":
            issues.append(warning(
                "repeated-key", f"'{key.value}' is given twice; the last one counts",
                file=source.file, line=key.start_mark.line + 1, xpath=source.param(below),
                hint=f"the first is on line {lines[below]}"))
        lines[below] = key.start_mark.line + 1
        # An alias may point back at its own parent: such a tree has no end.
        if len(path) < 32:
            _collect_lines(value, below, lines, issues, source)


def _yaml_issue(fault: yaml.YAMLError, file: str) -> Issue:
    mark = getattr(fault, "problem_mark", None) or getattr(fault, "context_mark", None)
    problem = getattr(fault, "problem", None) or str(fault).splitlines()[0]
    return error("list-not-yaml", f"not well-formed YAML: {problem}", file=file,
                 line=mark.line + 1 if mark else 0, column=mark.column + 1 if mark else 0,
                 hint="check indentation (blanks, no tabs), brackets and colons")
