"""Reads single values of a YAML file and notes their faults with line and key."""
from __future__ import annotations

import difflib
import math
import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, TypeVar

from ..errors import CommandError, InputError, Issue, error, errors_of
from ..geometry import Pose, is_finite_number
from ..objects.yaml_source import KeyPath, Source, read_yaml
from ..python_api.plain_values import pose_of
from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.world_lookup import advice_on, find_world
from .study import PlacedModel

Reader = TypeVar("Reader", bound="ValueReader")
Document = TypeVar("Document")


def read_document(file: str, make: "Callable[[Source, str], Reader]",
                  build: "Callable[[Reader, Any, str], Optional[Document]]",
                  ) -> "Tuple[Document, List[Issue]]":
    """Read a YAML file; relative paths in it start at its folder.

    Args:
        file: path of the file.
        make: makes the reader.
        build: builds the document from the tree and the absolute path of the file; None if the
            tree has another form.

    Returns:
        The document, and warnings.

    Raises:
        InputError: the file has faults; all of them are named.
    """
    tree, source, issues = read_yaml(file, "")
    path = os.path.abspath(file)
    reader = make(source, os.path.dirname(path))
    reader.issues += issues
    found = build(reader, tree, path)
    reader.issues.sort(key=lambda issue: issue.line or math.inf)
    if found is None or errors_of(reader.issues):
        raise InputError(reader.issues)
    return found, reader.issues


class ValueReader:
    """Reads values; faults go to `issues`, and defaults take their place.

    Args:
        source: where the values stand.
        folder: where relative paths start.

    Attributes:
        document: the kind of document, for messages.
    """

    document = "study"

    def __init__(self, source: Source, folder: str) -> None:
        self.issues: List[Issue] = []
        self._source = source
        self._folder = folder
        self._resolver = Resolver.from_environment()

    def fault(self, path: Sequence[str], message: str, hint: str = "",
              code: str = "study-value") -> None:
        """Note a fault of the value at a path of keys."""
        self.issues.append(error(code, message, hint=hint, **self._source.where(path)))

    def file(self, value: Any, path: KeyPath) -> str:
        """The absolute path of an existing file."""
        name = self.text(value, path)
        found = os.path.join(self._folder, os.path.expanduser(name))
        if name and not os.path.isfile(found):
            self.fault(path, f"there is no file {found}",
                       f"paths start at the folder of the {self.document}", "file-not-found")
        return os.path.abspath(found)

    def models(self, value: Any, keys: Sequence[str] = ("file", "pose")
               ) -> Tuple[PlacedModel, ...]:
        """The models of the key `models`: a mapping of names to files, poses and namespaces."""
        found = []
        for name, entry in self.mapping(value, ("models",)).items():
            path = ("models", name)
            inside = self.mapping(entry, path, keys)
            pose = Pose()
            if "pose" in inside:
                numbers = self.numbers(inside["pose"], (*path, "pose"), (3, 6, 7))
                try:
                    pose = pose_of(numbers)
                except CommandError as fault:
                    self.fault((*path, "pose"), str(fault))
            found.append(PlacedModel(name, self.file(inside.get("file"), (*path, "file")), pose,
                                     self.text(inside["namespace"], (*path, "namespace"))
                                     if "namespace" in inside else ""))
        return tuple(found)

    def mapping(self, value: Any, path: KeyPath, known: Sequence[str] = ()) -> Dict[str, Any]:
        """A mapping with text keys, of the known ones only if any are given."""
        if value is None:
            return {}
        if not isinstance(value, Mapping):
            self.fault(path, f"'{_join_path(path)}' must be a mapping, is {describe_value(value)}")
            return {}
        found = {}
        for key, inner in value.items():
            if not isinstance(key, str):
                self.fault((*path, str(key)), f"a key must be text, is {key!r}",
                           "put it in quotes", "study-key")
            elif known and key not in known:
                close = difflib.get_close_matches(key, known, 1)
                self.fault((*path, key), f"unknown key '{key}'",
                           f"did you mean '{close[0]}'?" if close
                           else "known are " + ", ".join(known), "study-key")
            else:
                found[key] = inner
        return found

    def number(self, value: Any, path: KeyPath, *, least: float = -math.inf,
               most: float = math.inf, above: float = -math.inf) -> float:
        """A finite number in a range."""
        if not is_finite_number(value):
            self.fault(path, f"'{_join_path(path)}' must be a number, is {describe_value(value)}")
        elif not least <= value <= most or value <= above:
            bounds = f"above {above:g}" if above > -math.inf else f"at least {least:g}"
            more = f" and at most {most:g}" if most < math.inf else ""
            self.fault(path, f"'{_join_path(path)}' must be {bounds}{more}, is {value:g}")
        else:
            return float(value)
        return 1.0

    def integer(self, value: Any, path: KeyPath, least: int = 0, most: int = 2 ** 62) -> int:
        """A whole number in a range."""
        if isinstance(value, bool) or not isinstance(value, int):
            self.fault(path, f"'{_join_path(path)}' must be a whole number, "
                             f"is {describe_value(value)}")
        elif not least <= value <= most:
            self.fault(path, f"'{_join_path(path)}' must be between {least} and {most}, is {value}")
        else:
            return value
        return max(1, least)

    def text(self, value: Any, path: KeyPath) -> str:
        """A text that is not empty."""
        if isinstance(value, str) and value.strip():
            return value
        self.fault(path, f"'{_join_path(path)}' must be text, is {describe_value(value)}")
        return ""

    def numbers(self, value: Any, path: KeyPath, counts: Sequence[int]) -> Tuple[float, ...]:
        """A list of finite numbers; its length is one of `counts`."""
        if not isinstance(value, list) or len(value) not in counts:
            wanted = " or ".join(map(str, counts))
            self.fault(path, f"'{_join_path(path)}' must be a list of {wanted} numbers,"
                             f" is {describe_value(value)}")
            return (0.0,) * counts[0]
        return tuple(self.number(item, path) for item in value)

    def names(self, value: Any, path: KeyPath) -> Tuple[str, ...]:
        """A text or a list of texts."""
        items = value if isinstance(value, list) else [value]
        return () if value is None else tuple(self.text(item, path) for item in items)

    def world(self, value: Any, path: KeyPath) -> str:
        """The absolute path of a world file, found as by `open_world` or beside the study."""
        name = self.text(value, path)
        try:
            return find_world(name, self._resolver, self._folder) if name else ""
        except ResourceNotFoundError:
            self.fault(path, f"there is no world file '{name}'", advice_on(name, self._folder),
                       "world-not-found")
            return name


def _join_path(path: Sequence[str]) -> str:
    return ".".join(path)


def describe_value(value: Any) -> str:
    """Describe an unexpected value for a message: `empty`, `a list of 3`, `a mapping`, `'x'`."""
    if value is None:
        return "empty"
    if isinstance(value, (list, tuple)):
        return f"a list of {len(value)}"
    if isinstance(value, Mapping):
        return "a mapping"
    return f"'{value}'"[:60]
