"""A YAML loader for untrusted files: plain values only, with limits of size and depth."""
from __future__ import annotations

from typing import Any, Dict, List

import yaml

from ..xml_characters import forbidden_character

DEEPEST = 64
MOST_VALUES = 100_000
"""Largest number of values in a document, with aliases expanded."""
LARGEST = 8 << 20
"""Largest file in bytes."""

_LONGEST_NUMBER = 1000
"""Characters; to read millions of digits, or to write them in a message, would take hours."""


class GuardedLoader(yaml.SafeLoader):
    """Raises yaml.MarkedYAMLError, with line and column, for all that it does not accept.

    Dates are read as text, because a name or path may look like a date. What other modules add to
    yaml.SafeLoader, as rosparam does, changes nothing.

    Attributes:
        keys: keys of the mappings that were being read when a fault was raised; empty after the
            whole document was read.
    """

    yaml_implicit_resolvers = {
        first: [(tag, pattern) for tag, pattern in resolvers
                if tag != "tag:yaml.org,2002:timestamp"]
        for first, resolvers in yaml.resolver.Resolver.yaml_implicit_resolvers.items()}
    yaml_constructors = dict(yaml.constructor.SafeConstructor.yaml_constructors)

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.keys: List[str] = []
        self._depth = 0
        self._values: Dict[int, int] = {}

    def compose_node(self, parent: Any, index: Any) -> Any:
        """The next node; raises if it is too deep, too large, or contains itself."""
        is_value = isinstance(parent, yaml.MappingNode) and isinstance(index, yaml.ScalarNode)
        if is_value:
            self.keys.append(str(index.value))
        node = self._composed(parent, index)
        if is_value:
            self.keys.pop()
        return node

    def _composed(self, parent: Any, index: Any) -> Any:
        start = self.peek_event().start_mark
        self._depth += 1
        if self._depth > DEEPEST:
            raise _fault(f"nested deeper than {DEEPEST} levels", start)
        is_alias = self.check_event(yaml.AliasEvent)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if is_alias:
            if id(node) not in self._values:
                raise _fault("alias refers to itself", start)
            return node
        count = 1 + sum(self._values[id(child)] for child in _children(node))
        if count > MOST_VALUES:
            raise _fault(f"more than {MOST_VALUES} values, aliases expanded", start)
        self._values[id(node)] = count
        return node

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """A node's value; exceptions of conversions are reported as faults of the file."""
        # Names and paths of a list are written to XML.
        bad = forbidden_character(node.value) if isinstance(node, yaml.ScalarNode) else ""
        if bad:
            raise _fault(f"text contains the character {bad}, which an XML file cannot hold",
                         node.start_mark)
        if (isinstance(node, yaml.ScalarNode) and len(node.value) > _LONGEST_NUMBER
                and node.tag.endswith((":int", ":float", "!degrees", "!radians"))):
            raise _fault(f"a number of more than {_LONGEST_NUMBER} characters", node.start_mark)
        try:
            return super().construct_object(node, deep)
        except (ValueError, ArithmeticError, LookupError, TypeError,
                AttributeError) as fault:
            kind = node.tag.rpartition(":")[2]
            raise _fault(f"invalid {kind}: {fault}", node.start_mark) from None


def _children(node: Any) -> Any:
    if isinstance(node, yaml.MappingNode):
        return [child for pair in node.value for child in pair]
    return node.value if isinstance(node, yaml.SequenceNode) else ()


def _fault(problem: str, mark: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=mark)
