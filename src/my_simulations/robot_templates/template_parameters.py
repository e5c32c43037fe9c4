"""Declared parameters of a template, and the values that a user gives for them."""
from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Dict, Mapping, Sequence, Union

from ..errors import CommandError
from ..geometry import is_finite_number

Value = Union[float, str, bool]
Values = Dict[str, Any]
"""Checked values by name: float, str or bool as the parameter's default."""

_GRAPH_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*\Z")
_MODEL_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")


@dataclass(frozen=True)
class Parameter:
    """One field of the form.

    Attributes:
        name: key of the value.
        title: label of the field.
        default: a float for a number, a bool for a check box, a str for a name.
        unit: of a number, as it is shown.
        minimum: the least number.
        maximum: the largest number.
        optional: whether a name may be empty.
    """

    name: str
    title: str
    default: Value
    unit: str = ""
    minimum: float = 0.0
    maximum: float = 0.0
    optional: bool = False

    @property
    def kind(self) -> str:
        """`number`, `flag` or `text`."""
        if isinstance(self.default, bool):
            return "flag"
        return "text" if isinstance(self.default, str) else "number"

    def checked(self, value: Any) -> Value:
        """The value, if it is allowed. Raises CommandError."""
        if self.kind == "flag":
            if not isinstance(value, bool):
                raise CommandError(f"{self.title} must be true or false, found {value!r:.60}")
            return value
        if self.kind == "number":
            if not is_finite_number(value) or not self.minimum <= value <= self.maximum:
                raise CommandError(f"{self.title} must be {self.minimum:g} to {self.maximum:g} "
                                   f"{self.unit}".rstrip() + f", found {value!r:.60}")
            return float(value)
        return self._checked_name(value)

    def _checked_name(self, value: Any) -> str:
        pattern = _MODEL_NAME if self.name == "name" else _GRAPH_NAME
        text = value.strip().strip("/") if isinstance(value, str) else None
        if text == "" and self.optional:
            return text
        if text is None or not pattern.match(text):
            raise CommandError(f"{self.title} must start with a letter and contain only letters, "
                               f"digits and '_', found {value!r:.60}")
        return text


def number(name: str, title: str, default: float, unit: str, minimum: float,
           maximum: float) -> Parameter:
    """A number in a closed range."""
    return Parameter(name, title, default, unit, minimum, maximum)


def checked_values(parameters: Sequence[Parameter], given: Mapping[str, Any]) -> Values:
    """A value for each parameter; the default for one that is not given.

    Raises CommandError for an unknown name and for a value that is not allowed.
    """
    names = [one.name for one in parameters]
    for name in given:
        if name not in names:
            raise CommandError(f"unknown parameter {name!r:.60}; known parameters: "
                               + ", ".join(names))
    return {one.name: one.checked(given.get(one.name, one.default)) for one in parameters}
