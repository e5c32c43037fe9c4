"""Plans as JSON: in messages of the editor, and in the plan file of a saved building.

Every fault is reported with the path of the value, e.g. `levels[0].walls[3].start`.
"""
from __future__ import annotations

import json
import math
import re
from dataclasses import MISSING, asdict, fields
from typing import Any, Callable, Dict, List, Optional, Tuple, Type, Union

from ..errors import InputError, Issue, error
from ..geometry import is_finite_number
from ..xml_characters import forbidden_character
from .building_plan import Floor, FloorImage, Level, Opening, Plan, Roof, Stairs, Wall

FORMAT = 1
"""Version of the format, increased by incompatible changes."""

FARTHEST = 10000.0
"""Largest coordinate or size, m."""

MOST_ITEMS = 20000
MOST_STEPS = 500

_COLOR = re.compile(r"#[0-9a-f]{6}\Z")
_NO_CONTROL = re.compile(r"[^\x00-\x1f\x7f]{0,200}\Z")


class _UnexpectedValueError(ValueError):
    """Describes the expected value."""


Kind = Callable[[Any], Any]


def _number(value: Any) -> float:
    if not is_finite_number(value):
        raise _UnexpectedValueError("a number")
    if abs(value) > FARTHEST:
        raise _UnexpectedValueError(f"a number within {FARTHEST:g}")
    return float(value)


def _size(value: Any) -> float:
    number = _number(value)
    if number <= 0:
        raise _UnexpectedValueError("a number above 0")
    return number


def _not_negative(value: Any) -> float:
    number = _number(value)
    if number < 0:
        raise _UnexpectedValueError("a number of at least 0")
    return number


def _count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise _UnexpectedValueError("an integer")
    return value


def _steps(value: Any) -> int:
    if not 1 <= _count(value) <= MOST_STEPS:
        raise _UnexpectedValueError(f"an integer from 1 to {MOST_STEPS}")
    return int(value)


def _pitch(value: Any) -> float:
    if not 0 < _number(value) < math.radians(80):
        raise _UnexpectedValueError("an angle in radians between 0 and 1.39")
    return float(value)


def _point(value: Any) -> Tuple[float, float]:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise _UnexpectedValueError("a point [x, y]")
    return (_number(value[0]), _number(value[1]))


def _loop(value: Any) -> List[Tuple[float, float]]:
    if not isinstance(value, list) or len(value) < 3:
        raise _UnexpectedValueError("a list of at least 3 points")
    return [_point(point) for point in value]


def _loops(value: Any) -> List[List[Tuple[float, float]]]:
    if not isinstance(value, list):
        raise _UnexpectedValueError("a list of outlines")
    return [_loop(loop) for loop in value]


def _text(value: Any) -> str:
    if not isinstance(value, str) or not _NO_CONTROL.match(value):
        raise _UnexpectedValueError("a string of at most 200 characters")
    if forbidden_character(value):
        raise _UnexpectedValueError("a string without the character "
                                    f"{forbidden_character(value)}")
    return value


def _data(value: Any) -> str:
    if not isinstance(value, str):
        raise _UnexpectedValueError("a text")
    return value


def _color(value: Any) -> str:
    if not isinstance(value, str) or not _COLOR.match(value.lower()):
        raise _UnexpectedValueError("a colour such as #c2a9a0")
    return value.lower()


def _wall_id(value: Any) -> Optional[int]:
    return None if value is None else _count(value)


def _one_of(*words: str) -> Kind:
    def read(value: Any) -> str:
        if value not in words:
            raise _UnexpectedValueError(" or ".join(repr(word) for word in words))
        return str(value)

    return read


_LOOK: Dict[str, Kind] = {"color": _color, "texture": _text}

KINDS: Dict[Type[Any], Dict[str, Kind]] = {
    Wall: {"id": _count, "start": _point, "end": _point, "thickness": _size, "height": _size,
           **_LOOK},
    Opening: {"id": _count, "width": _size, "height": _size, "elevation": _not_negative,
              "depth": _size, "wall": _wall_id, "along": _number, "position": _point,
              "yaw": _number},
    Stairs: {"id": _count, "position": _point, "yaw": _number, "width": _size, "depth": _size,
             "height": _size, "steps": _steps, **_LOOK},
    Floor: {"id": _count, "outline": _loop, "holes": _loops, "thickness": _size,
            "fit": _one_of("none", "walls"), **_LOOK},
    FloorImage: {"file": _text, "resolution": _size, "data": _data},
    Level: {"name": _text, "height": _size},
    Roof: {"kind": _one_of("flat", "gable"), "thickness": _size, "overhang": _not_negative,
           "pitch": _pitch, **_LOOK},
    Plan: {"name": _text},
}
"""Readers of the plain fields, by class; a field with a default is optional."""

_LISTS: Dict[str, Type[Any]] = {"walls": Wall, "windows": Opening, "doors": Opening,
                                "stairs": Stairs, "floors": Floor}

COUNTERS = {"walls": "wall", "windows": "window", "doors": "door", "stairs": "stairs",
            "floors": "floor"}
"""Name of the id counter in `Plan.next`, by the list of a level."""


def plan_from_text(text: Union[str, bytes], file: str = "") -> Plan:
    """As `plan_from_json`, from the text of a plan file.

    Raises InputError: not JSON, or not a plan.
    """
    try:
        tree = json.loads(text)
    except json.JSONDecodeError as fault:
        raise InputError([error("plan-not-json", "the plan is not valid JSON: "
                                                 f"{fault.msg}", file=file,
                                line=fault.lineno, column=fault.colno)]) from None
    except (ValueError, RecursionError) as fault:  # no UTF-8; an integer without an end
        raise InputError([error("plan-not-json", f"the plan is not valid JSON: {fault}",
                                file=file)]) from None
    return plan_from_json(tree, file)


def plan_from_json(tree: Any, file: str = "") -> Plan:
    """A plan from JSON values.

    Args:
        tree: the parsed JSON.
        file: name of the document in issues.

    Raises:
        InputError: with all faults.
    """
    reader = _Reader(file)
    plan = reader.plan(tree)
    if reader.issues:
        raise InputError(reader.issues)
    assert plan is not None
    return plan


def plan_to_json(plan: Plan) -> Dict[str, Any]:
    return {"format": FORMAT, **asdict(plan)}


def plan_to_text(plan: Plan) -> str:
    """The text of a plan file, one line for each item, for readable diffs."""
    tree = plan_to_json(plan)
    return json.dumps(tree, indent=1, ensure_ascii=False) + "\n"


class _Reader:
    def __init__(self, file: str) -> None:
        self.issues: List[Issue] = []
        self._file = file

    def plan(self, tree: Any) -> Optional[Plan]:
        plan = self._object(Plan, tree, "")
        if plan is None:
            return None
        if tree.get("format") != FORMAT:
            self._fault("plan-format", f"expected a plan of format {FORMAT}, found"
                        f" {_format_value(tree.get('format'))}", "format")
            return None
        levels = tree.get("levels")
        if not isinstance(levels, list) or not levels:
            self._wrong("levels", "a list of at least one level", levels)
            return None
        plan.levels = [level for n, entry in enumerate(levels)
                       if (level := self._level(entry, f"levels[{n}]")) is not None]
        if tree.get("roof") is not None:
            plan.roof = self._object(Roof, tree["roof"], "roof")
        self._number_items(plan, tree.get("next"))
        return plan

    def _level(self, tree: Any, path: str) -> Optional[Level]:
        level = self._object(Level, tree, path)
        if level is None:
            return None
        for name, of in _LISTS.items():
            entries = tree.get(name, [])
            if not isinstance(entries, list) or len(entries) > MOST_ITEMS:
                self._wrong(f"{path}.{name}", f"a list of at most {MOST_ITEMS}", entries)
                continue
            items = (self._object(of, entry, f"{path}.{name}[{n}]")
                     for n, entry in enumerate(entries))
            setattr(level, name, [item for item in items if item is not None])
        if tree.get("image") is not None:
            level.image = self._object(FloorImage, tree["image"], f"{path}.image")
        return level

    def _object(self, of: Type[Any], tree: Any, path: str) -> Any:
        """An object of a class of the plan, with empty lists; None, with an issue, if faulty."""
        if not isinstance(tree, dict):
            self._wrong(path or "the plan", "an object", tree)
            return None
        known = len(self.issues)
        values: Dict[str, Any] = {}
        required = {item.name for item in fields(of) if item.default is MISSING
                    and item.default_factory is MISSING}
        for name, read in KINDS[of].items():
            at = f"{path}.{name}" if path else name
            if name not in tree:
                if name in required:
                    self._wrong(at, "a value", None)
                continue
            try:
                values[name] = read(tree[name])
            except _UnexpectedValueError as fault:
                self._wrong(at, str(fault), tree[name])
        return of(**values) if len(self.issues) == known else None

    def _number_items(self, plan: Plan, following: Any) -> None:
        """Set missing or too low id counters, and report repeated ids."""
        counters = following if isinstance(following, dict) else {}
        for name, kind in COUNTERS.items():
            seen: Dict[int, str] = {}
            for at, level in enumerate(plan.levels):
                for n, item in enumerate(getattr(level, name)):
                    path = f"levels[{at}].{name}[{n}]"
                    if item.id in seen:
                        self._fault("plan-id-repeated", f"two {name} have the id {item.id}", path)
                    seen[item.id] = path
            given = counters.get(kind)
            start = given if isinstance(given, int) and not isinstance(given, bool) else 0
            plan.next[kind] = max([start, *(number + 1 for number in seen)])

    def _wrong(self, path: str, expected: str, found: Any) -> None:
        self._fault("plan-value",
                    f"{path}: expected {expected}, found {_format_value(found)}", path)

    def _fault(self, code: str, message: str, path: str) -> None:
        self.issues.append(error(code, message, file=self._file, xpath=path))


def _format_value(value: Any) -> str:
    if value is None:
        return "nothing"
    text = json.dumps(value, ensure_ascii=False, default=repr)
    return text if len(text) <= 60 else text[:57] + "..."
