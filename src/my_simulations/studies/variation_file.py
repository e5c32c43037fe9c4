"""Reads one entry of `vary` of a study file."""
from __future__ import annotations

import difflib
import re
from typing import Any, List, Optional, Sequence, Tuple

from ..objects.yaml_source import KeyPath
from .value_reader import ValueReader
from .variation import (
    DISTRIBUTIONS,
    FORMS,
    NAME,
    NAMES,
    NUMBER,
    POSE,
    SCENARIO_FORMS,
    TEXT,
    Parameter,
    Setting,
    Target,
    target_of,
    value_requirement,
)

_MOST_VALUES = 1_000_000
_COLUMNS = ("index", "case", "seed", "status", "attempt", "flaky", "signal", "step", "issue",
            "hash", "processor", "trajectory", "scenario", "tests", "failures")
"""Columns that every table has, or every table of scenarios."""


def name_of_column(reader: ValueReader, name: str, path: KeyPath) -> None:
    """Note a fault if a name cannot be that of a column of the table."""
    if name in _COLUMNS or not re.fullmatch(r"[A-Za-z_]\w*", name):
        reader.fault(path, f"'{name}' cannot be the name of a column",
                     "use letters, digits and _, and none of " + ", ".join(_COLUMNS), "study-key")


def parameter_of(reader: ValueReader, name: str, value: Any, path: KeyPath,
                 forms: Sequence[str] = FORMS) -> Optional[Parameter]:
    """The parameter of an entry, whose target is one of `forms`; None where a fault was noted."""
    before = len(reader.issues)
    name_of_column(reader, name, path)
    inside = reader.mapping(value, path, ("set", "values", "range", "samples", *DISTRIBUTIONS))
    target = _target(reader, inside.get("set", "none"), (*path, "set"), forms)
    sources = [key for key in ("values", "range", *DISTRIBUTIONS) if key in inside]
    if len(sources) != 1:
        reader.fault(path, f"'{name}' needs one of values, range, " + ", ".join(DISTRIBUTIONS),
                     code="study-key")
        return None
    if target is None:
        return None
    (key,) = sources
    below = (*path, key)
    if key != "values" and target.value_kind not in (NUMBER, TEXT):
        reader.fault(below, f"'{name}' takes {target.value_kind}: list its values")
        return None
    if key == "values":
        values = _read_values(reader, target, inside[key], below)
        _check_values(reader, name, target, values, below)
        return Parameter(name, target, values) if len(reader.issues) == before else None
    if key == "range":
        numbers = _range(reader, inside[key], below)
        _check_values(reader, name, target, numbers, below)
        return Parameter(name, target, numbers) if len(reader.issues) == before else None
    drawn = reader.numbers(inside[key], below, (2,))
    if len(reader.issues) == before:
        _check_distribution(reader, key, drawn, below)
        needed = value_requirement(target, drawn[0])
        if needed and key == "uniform" and drawn[0] < 0.0:  # others are refused as they are drawn
            reader.fault(below, f"'{name}' must be {needed}, and may be {drawn[0]:g}")
    samples = reader.integer(inside.get("samples", 0), (*path, "samples"), 0, _MOST_VALUES)
    if len(reader.issues) > before:
        return None
    return Parameter(name, target, (), key, drawn, samples)


def _target(reader: ValueReader, value: Any, path: KeyPath, forms: Sequence[str]
            ) -> Optional[Target]:
    text = reader.text(value, path)
    target = target_of(text)
    scenarios = forms is SCENARIO_FORMS
    if target is not None and target.kind != "none" and scenarios != (target.kind == "arg"):
        target = None
    if target is None and text:
        close = difflib.get_close_matches(text, forms, 1)
        reader.fault(path, f"'{text}' cannot be varied" + (" in a scenario" if scenarios else ""),
                     (f"did you mean {close[0]}? " if close else "") + "Known are "
                     + ", ".join(forms))
    return target


def _read_values(reader: ValueReader, target: Target, value: Any, path: KeyPath
                 ) -> Tuple[Setting, ...]:
    if not isinstance(value, list) or not value:
        reader.fault(path, "'values' must be a list with at least one value")
        return ()
    found: List[Setting] = []
    for item in value:
        if target.value_kind == POSE:
            found.append(reader.numbers(item, path, (3, 6)))
        elif target.value_kind == NAMES:
            found.append(reader.names(item, path))
        elif target.value_kind == NAME:
            found.append(reader.world(item, path))
        elif target.value_kind == TEXT:
            found.append(_read_argument(reader, item, path))
        elif target.kind == "none" and isinstance(item, str):
            found.append(item)
        else:
            found.append(reader.number(item, path))
    if len(set(found)) < len(found):
        reader.fault(path, "'values' has the same value twice; use seeds to repeat a case")
    return tuple(found)


def _read_argument(reader: ValueReader, item: Any, path: KeyPath) -> Setting:
    """A value of a launch argument, as roslaunch takes it."""
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, int):
        return item
    return reader.number(item, path) if isinstance(item, float) else reader.text(item, path)


def _range(reader: ValueReader, value: Any, path: KeyPath) -> Tuple[float, ...]:
    inside = reader.mapping(value, path, ("from", "to", "step", "count"))
    first = reader.number(inside.get("from"), (*path, "from"))
    last = reader.number(inside.get("to"), (*path, "to"))
    if ("step" in inside) == ("count" in inside):
        reader.fault(path, "a range needs one of 'step' and 'count'", code="study-key")
        return ()
    if "count" in inside:
        count = reader.integer(inside["count"], (*path, "count"), 1, _MOST_VALUES)
        if first == last:
            reader.fault(path, "'from' and 'to' must differ")
        step = (last - first) / (count - 1) if count > 1 else 0.0
    else:
        step = reader.number(inside["step"], (*path, "step"))
        if step == 0.0 or (last - first) / step < 0.0:
            reader.fault((*path, "step"), "'step' does not lead from 'from' to 'to'")
            return ()
        whole = (last - first) / step
        if whole > _MOST_VALUES:
            reader.fault((*path, "step"), f"a range has at most {_MOST_VALUES} values")
            return ()
        count = int(whole + 1e-9) + 1
    return tuple(first + step * index for index in range(count))


def _check_values(reader: ValueReader, name: str, target: Target, values: Sequence[Setting],
                  path: KeyPath) -> None:
    """Note a fault of the first value that the target cannot have."""
    for value in values:
        needed = value_requirement(target, value)
        if target.part == "iterations" and isinstance(value, float) and not value.is_integer():
            needed = needed or "a whole number"  # else the table would show another value
        if needed:
            reader.fault(path, f"'{name}' must be {needed}, is {value:g}")
            return


def _check_distribution(reader: ValueReader, key: str, numbers: Tuple[float, ...],
                        path: KeyPath) -> None:
    if key == "normal" and numbers[1] <= 0.0:
        reader.fault(path, "the standard deviation must be above 0")
    if key != "normal" and numbers[1] <= numbers[0]:
        reader.fault(path, "the first number must be below the second")
    if key == "log_uniform" and numbers[0] <= 0.0:
        reader.fault(path, "both numbers must be above 0")
