"""One property of an object of the description, set from JSON by its dotted path."""
from __future__ import annotations

import functools
import typing
from dataclasses import MISSING, fields, is_dataclass, replace
from typing import Any, Callable, Dict, Hashable, List, Sequence, Type, TypeVar, Union

from ...description.shapes import Empty, Geometry
from ...errors import CommandError
from ...geometry import Pose, is_finite_number, normalised
from ..scene.plain_json import HIDDEN
from ..scene.scene_json import NAMES

T = TypeVar("T")

_SHAPES: Dict[str, Type[Any]] = {**{name: shape for shape, name in NAMES.items()}, "empty": Empty}
_FIXED = frozenset(("links", "joints", "models", "lights", "plugins", "uri", "canonical_link",
                    "actors", "roads", "parent", "child"))
"""What is not set as a property: structure, and what files brought."""


def with_value(target: T, path: str, value: Any) -> T:
    """A copy of a dataclass with one property replaced.

    Args:
        target: a dataclass; it stays as it is.
        path: names of fields joined by dots; numbers are places in lists.
        value: JSON; null for an optional field without a value.

    Raises:
        CommandError: no such property, or the value does not fit it.
    """
    return _replace_value(target, path.split("."), value, path)  # type: ignore[no-any-return]


def dataclass_from_json(kind: Type[T], values: Dict[str, Any], base: Any = None) -> T:
    """An object of a dataclass from JSON fields, others as in `base` or by default.

    Raises CommandError.
    """
    return _convert_value(values, kind, kind.__name__.lower(), base)  # type: ignore[no-any-return]


def _replace_value(target: Any, names: Sequence[str], value: Any, path: str) -> Any:
    name, rest = names[0], names[1:]
    if isinstance(target, list):
        if not name.isdigit() or int(name) >= len(target):
            raise CommandError(f"unknown property {path!r}")
        items = list(target)
        items[int(name)] = _replace_value(items[int(name)], rest, value, path)
        return items
    hint = _hints_of(target).get(name)
    if hint is None or name in HIDDEN or name in _FIXED:
        known = [field for field in _hints_of(target) if field not in HIDDEN | _FIXED]
        raise CommandError(f"unknown property {path!r}; known: {', '.join(known)}")
    present = getattr(target, name)
    if not rest:
        return replace(target, **{name: _convert_value(value, hint, path, present)})
    if present is None:
        present = _fresh(hint, path)
    if not is_dataclass(present) and not isinstance(present, list):
        raise CommandError(f"unknown property {path!r}")
    return replace(target, **{name: _replace_value(present, rest, value, path)})


@functools.lru_cache(maxsize=None)
def _hints(kind: Hashable) -> Dict[str, Any]:
    if not is_dataclass(kind):
        return {}
    found = typing.get_type_hints(kind)
    return {field.name: found[field.name] for field in fields(kind)}


def _hints_of(target: Any) -> Dict[str, Any]:
    kind: Any = type(target)
    return _hints(kind)


def _fresh(hint: Any, path: str) -> Any:
    """A default object for an optional field without a value."""
    for option in typing.get_args(hint):
        if is_dataclass(option) and all(
                one.default is not MISSING or one.default_factory is not MISSING
                for one in fields(option)):
            return option()  # type: ignore[operator]
    raise CommandError(f"unknown property {path!r}")


def _convert_value(value: Any, hint: Any, path: str, present: Any) -> Any:
    """JSON as a value of a type hint. Raises CommandError."""
    if hint == Geometry:
        return _geometry(value, path, present)
    if hint is Pose:
        return _pose(value, path)
    origin, inside = typing.get_origin(hint), typing.get_args(hint)
    if origin is Union:
        if value is None and type(None) in inside:
            return None
        [option] = [one for one in inside if one is not type(None)]
        return _convert_value(value, option, path, present)
    if origin is tuple:
        return _tuple(value, inside, path)
    if origin is list:
        if not isinstance(value, list):
            raise CommandError(f"{path} must be a list, found {value!r:.60}")
        return [_convert_value(item, inside[0], f"{path}.{n}", None)
                for n, item in enumerate(value)]
    if is_dataclass(hint):
        return _object(value, hint, path, present)
    check = _PLAIN.get(hint)
    if check is None:
        raise CommandError(f"{path!r} cannot be set")
    return check(value, path)


def _object(value: Any, kind: Any, path: str, present: Any) -> Any:
    if not isinstance(value, dict):
        raise CommandError(f"{path} must be an object, found {value!r:.60}")
    hints = _hints(kind)
    base = present if isinstance(present, kind) else None
    given: Dict[str, Any] = {}
    for name, item in value.items():
        if name in hints and name not in HIDDEN:
            given[name] = _convert_value(item, hints[name], f"{path}.{name}",
                                         getattr(base, name, None))
    if base is not None:
        return replace(base, **given)
    missing = [field.name for field in fields(kind) if field.name not in given
               and field.default is MISSING and field.default_factory is MISSING]
    if missing:
        raise CommandError(f"{path} needs {', '.join(missing)}")
    return kind(**given)


def _geometry(value: Any, path: str, present: Any) -> Any:
    if not isinstance(value, dict):
        raise CommandError(f"{path} must be an object, found {value!r:.60}")
    name = value.get("type", NAMES.get(type(present)))
    kind = _SHAPES.get(str(name))
    if kind is None:
        raise CommandError(f"{path}: unknown shape {name!r}; known: {', '.join(_SHAPES)}")
    return _object(value, kind, path, present)


def _pose(value: Any, path: str) -> Pose:
    numbers = _floats(value, 7, path)
    return Pose((numbers[0], numbers[1], numbers[2]),
                normalised((numbers[3], numbers[4], numbers[5], numbers[6])))


def _tuple(value: Any, inside: Sequence[Any], path: str) -> Any:
    if not isinstance(value, (list, tuple)) or len(value) != len(inside):
        raise CommandError(f"{path} must be {len(inside)} numbers, found {value!r:.60}")
    return tuple(_convert_value(item, hint, path, None) for item, hint in zip(value, inside))


def _floats(value: Any, count: int, path: str) -> List[float]:
    if not isinstance(value, (list, tuple)) or len(value) != count:
        raise CommandError(f"{path} must be {count} numbers, found {value!r:.60}")
    return [_float(item, path) for item in value]


def _float(value: Any, path: str) -> float:
    if not is_finite_number(value):
        raise CommandError(f"{path} must be a finite number, found {value!r:.60}")
    return float(value)


def _int(value: Any, path: str) -> int:
    if not is_finite_number(value) or value != int(value):
        raise CommandError(f"{path} must be an integer, found {value!r:.60}")
    return int(value)


def _bool(value: Any, path: str) -> bool:
    if not isinstance(value, bool):
        raise CommandError(f"{path} must be true or false, found {value!r:.60}")
    return value


def _str(value: Any, path: str) -> str:
    if not isinstance(value, str):
        raise CommandError(f"{path} must be a string, found {value!r:.60}")
    return value


_PLAIN: Dict[Any, Callable[[Any, str], Any]] = {float: _float, int: _int, bool: _bool, str: _str}
