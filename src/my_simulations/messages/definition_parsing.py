"""Reads statements of .msg and .srv files: fields and constants of message types."""
from __future__ import annotations

import re
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from ..errors import SimulationError

Constant = Union[int, float, str, bool]

INTEGERS = {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
            "int64": "q", "uint64": "Q", "byte": "b", "char": "B"}
"""The code of `struct` for each type of whole numbers."""

FLOATS = {"float32": "f", "float64": "d"}
SIMPLE = {*INTEGERS, *FLOATS, "bool", "string", "time", "duration"}

_FIELD = re.compile(r"([A-Za-z]\w*(?:/\w+)?)(\[(\d*)\])?\s+([A-Za-z]\w*)$")
_CONSTANT = re.compile(r"([a-z]\w*)\s+([A-Za-z]\w*)\s*=(.*)$")


class DefinitionError(SimulationError):
    """A definition of a message type that cannot be read."""


class Field(NamedTuple):
    """A field of a message.

    Attributes:
        name: of the field.
        kind: a type of `SIMPLE`, or `package/Name`.
        is_array: whether it is an array of that type.
        length: of an array of fixed length; None for any.
    """

    name: str
    kind: str
    is_array: bool
    length: Optional[int]


class Definition(NamedTuple):
    """A message type.

    Attributes:
        kind: `package/Name`.
        fields: in order.
        constants: by name.
    """

    kind: str
    fields: Tuple[Field, ...]
    constants: Dict[str, Constant]


def parse_definition(kind: str, statements: Sequence[str]) -> Definition:
    """Return the definition that statements make. Raises DefinitionError."""
    package = kind.partition("/")[0]
    fields: List[Field] = []
    constants: Dict[str, Constant] = {}
    for statement in statements:
        constant = _CONSTANT.match(statement)
        if constant is not None:
            constants[constant.group(2)] = _constant(constant.group(1), constant.group(3))
            continue
        found = _FIELD.match(statement)
        if found is None:
            raise DefinitionError(f"{kind}: {statement!r} is neither a field nor a constant")
        base, array, length, name = found.groups()
        fields.append(Field(name, _full_name(base, package), array is not None,
                            int(length) if length else None))
    return Definition(kind, tuple(fields), constants)


def statements_of(text: str) -> List[str]:
    """The statements of the text of a .msg file, without comments."""
    found = []
    for line in text.split("\n"):
        stripped = line.strip()
        if not re.match(r"string\s+\w+\s*=", stripped):  # whose value may contain a #
            stripped = stripped.partition("#")[0].strip()
        if stripped:
            found.append(stripped)
    return found


def _full_name(base: str, package: str) -> str:
    if base in SIMPLE or "/" in base:
        return base
    return "std_msgs/Header" if base == "Header" else f"{package}/{base}"


def _constant(kind: str, text: str) -> Constant:
    try:
        if kind == "string":
            return text.strip()
        if kind in FLOATS:
            return float(text)
        return bool(int(text)) if kind == "bool" else int(text, 0)
    except ValueError as fault:
        raise DefinitionError(f"{text!r} is not a value of type {kind}") from fault
