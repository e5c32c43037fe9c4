"""Reads a YAML file with the line number of every key.

The angle forms of rosparam in YAML: `deg(90)`, `rad(pi/2)`, `!degrees 90`, `!radians pi/2`.

rosparam hands radians to `eval`; here they are sums of products and quotients of numbers and pi.
"""
from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Tuple

import yaml

from ..errors import InputError, Issue, error, warning
from ..resources.limited_file import at_most
from .guarded_yaml import LARGEST, GuardedLoader

KeyPath = Tuple[str, ...]


@dataclass(frozen=True)
class Source:
    """Origin of a tree of values.

    Attributes:
        root: parameter path of the tree, e.g. `/objects`.
        file: path of the file, "" for values read from the parameter server.
        lines: 1-based line number of each key, by its path of keys below the root.
    """

    root: str
    file: str = ""
    lines: Dict[KeyPath, int] = field(default_factory=dict)

    def param(self, path: Sequence[str]) -> str:
        """The parameter path of a key, e.g. `/objects/table/position`."""
        return "/".join([self.root, *path])

    def where(self, path: Sequence[str]) -> Dict[str, Any]:
        """Arguments of an `Issue` about the key, or its nearest known parent."""
        known = tuple(path)
        while known and known not in self.lines:
            known = known[:-1]
        return {"file": self.file, "line": self.lines.get(known, 0), "xpath": self.param(path)}


def read_yaml(file: str, root: str, angles: bool = False) -> Tuple[Any, Source, List[Issue]]:
    """Read one YAML document.

    Args:
        file: path of the file.
        root: parameter path of its content, for messages.
        angles: whether rosparam's angle forms, such as `deg(90)`, are read as numbers in rad.

    Returns:
        The plain values (None for an empty file), their source, and warnings about repeated keys.

    Raises:
        InputError: the file cannot be read or is not YAML.
    """
    text = _text(file)
    lines: Dict[KeyPath, int] = {}
    issues: List[Issue] = []
    source = Source(root, file, lines)
    loader: Optional[GuardedLoader] = None
    try:
        loader = (AngleLoader if angles else GuardedLoader)(text)
        node = loader.get_single_node()
        if node is None:
            return None, Source(root, file), []
        # Lines are collected first, because construction merges `<<` into the nodes.
        _collect_lines(node, (), lines, issues, source)
        data = loader.construct_document(node)
    except yaml.YAMLError as fault:
        raise InputError([_yaml_issue(fault, text, source, loader)]) from fault
    finally:
        if loader is not None:
            loader.dispose()
    return data, source, issues


def _text(file: str) -> str:
    try:
        with open(file, "rb") as stream:
            data = at_most(stream, LARGEST)
    except OSError as fault:
        raise InputError([error("list-unreadable", f"cannot read the file: {fault.strerror}",
                                file=file)]) from fault
    if len(data) > LARGEST:
        raise InputError([error("list-too-large", f"the file is larger than {LARGEST} bytes",
                                file=file)])
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as fault:
        raise InputError([error("list-not-utf8", f"the file is not UTF-8 text: {fault}", file=file,
                                line=data.count(b"\n", 0, fault.start) + 1,
                                hint="save it as UTF-8")]) from fault


def _collect_lines(node: yaml.Node, path: KeyPath, lines: Dict[KeyPath, int],
                   issues: List[Issue], source: Source) -> None:
    if isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            if isinstance(item, yaml.MappingNode):
                lines[(*path, str(index))] = item.start_mark.line + 1
                _collect_lines(item, (*path, str(index)), lines, issues, source)
    if not isinstance(node, yaml.MappingNode):
        return
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            continue
        below = (*path, str(key.value))
        if below in lines and key.value != "<<":
            issues.append(warning(
                "repeated-key", f"'{key.value}' is given twice; the last one is used",
                file=source.file, line=key.start_mark.line + 1, xpath=source.param(below),
                hint=f"the first is on line {lines[below]}"))
        lines[below] = key.start_mark.line + 1
        _collect_lines(value, below, lines, issues, source)


def _yaml_issue(fault: yaml.YAMLError, text: str, source: Source,
                loader: Optional[GuardedLoader]) -> Issue:
    line, column = _place(fault, text)
    problem = (getattr(fault, "problem", None) or getattr(fault, "reason", None)
               or str(fault).splitlines()[0])
    # The fault is in the value of the last key before it.
    above = [path for path, begins in source.lines.items() if begins <= line]
    key = max(above, key=lambda path: (source.lines[path], len(path)), default=())
    if not above and loader is not None:
        key = tuple(loader.keys)
    return error("list-not-yaml", f"invalid YAML: {problem}", file=source.file, line=line,
                 column=column, xpath=source.param(key),
                 hint="check indentation (spaces, no tabs), brackets and colons")


def _place(fault: yaml.YAMLError, text: str) -> Tuple[int, int]:
    """Line and column, from 1; 0 if unknown."""
    if isinstance(fault, yaml.reader.ReaderError):  # position of an invalid character
        before = text[:fault.position]
        return before.count("\n") + 1, len(before) - before.rfind("\n")
    mark = getattr(fault, "problem_mark", None) or getattr(fault, "context_mark", None)
    return (mark.line + 1, mark.column + 1) if mark else (0, 0)


_VALUE = r"[-+]?\s*(?:pi|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_PRODUCT = re.compile(rf"\s*({_VALUE})((?:\s*[*/]\s*{_VALUE})*)\s*")
_FACTOR = re.compile(rf"([*/])\s*({_VALUE})")


class AngleLoader(GuardedLoader):
    """Reads the angle forms as numbers in rad."""


def _degrees(loader: AngleLoader, node: Any) -> float:
    text = _inside(loader.construct_scalar(node), "deg")
    try:
        return math.radians(float(text))
    except ValueError:
        raise ValueError(f"{text!r} is not a number of degrees") from None


def _radians(loader: AngleLoader, node: Any) -> float:
    text = _inside(loader.construct_scalar(node), "rad")
    total, at = 0.0, 0
    while at < len(text) or not at:
        found = _PRODUCT.match(text, at)
        if found is None or (at and found.group(1)[0] not in "+-"):
            raise ValueError(f"{text!r} is not an angle in radians; write, for example, 3*pi/4")
        total += _product(found)
        at = found.end()
    return total


def _inside(text: str, name: str) -> str:
    """What is between the brackets of `name(...)`, or the whole text."""
    text = text.strip()
    return text[len(name) + 1:-1].strip() if text.startswith(f"{name}(") else text


def _product(found: "re.Match[str]") -> float:
    value = _parse_factor(found.group(1))
    for sign, factor in _FACTOR.findall(found.group(2)):
        value = value * _parse_factor(factor) if sign == "*" else value / _parse_factor(factor)
    return value


def _parse_factor(text: str) -> float:
    """Parse `pi` or a number, with a sign."""
    plain = text.lstrip("+- ")
    value = math.pi if plain == "pi" else float(plain)
    return -value if text.startswith("-") else value


for _tag, _read, _name in (("!degrees", _degrees, "deg"), ("!radians", _radians, "rad")):
    AngleLoader.add_constructor(_tag, _read)
    AngleLoader.add_implicit_resolver(_tag, re.compile(rf"^{_name}\([^)]*\)$"), [_name[0]])
