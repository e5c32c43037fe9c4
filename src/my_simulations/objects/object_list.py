"""Reads object lists in both formats of the Care-O-bot tools.

2012 format: `model` (file name without extension) and `model_type` (the extension), in the folder
`objects` of a package. Current format: `model: PACKAGE/relative/path.ext`, with nested `children`
whose poses are relative to their parent.

Where the object list of a world is kept in a package: config/WORLD/object_locations.yaml.
"""
from __future__ import annotations

import difflib
import math
import os
from dataclasses import dataclass, field, replace
from typing import Any, Dict, List, Mapping, Optional, Sequence, Set, Tuple

from ..errors import Issue, error, warning
from ..geometry import Vec3
from ..resources.package_files import file_in_package
from .yaml_source import KeyPath, Source

ENDINGS = {"urdf.xacro": "xacro", "sdf.xacro": "sdf.xacro", "xacro": "xacro",
           "urdf": "urdf", "sdf": "sdf"}
"""File extensions that can be spawned, longest first, with (xacro, SDF)."""

KEYS = ("model", "model_type", "position", "orientation", "children")
MAX_DEPTH = 16


@dataclass(frozen=True)
class ObjectFile:
    """The model file of an object.

    Attributes:
        package: ROS package that contains it.
        path: path in the package, with forward slashes.
        xacro: whether xacro is applied first.
        sdf: whether the result is SDF; otherwise URDF.
        named: whether the entry itself contains the package.
    """

    package: str
    path: str
    xacro: bool
    sdf: bool
    named: bool = True


@dataclass(frozen=True)
class PlacedObject:
    """One object of a list.

    Attributes:
        name: flattened name, `PARENT_CHILD_GRANDCHILD`; the model's name in the world.
        chain: the names it consists of, outermost first.
        file: its model file.
        position: position in the world frame, m.
        rpy: fixed-axis roll, pitch, yaw in the world frame, rad.
        param: parameter path of its entry.
    """

    name: str
    chain: Tuple[str, ...]
    file: ObjectFile
    position: Vec3
    rpy: Vec3
    param: str

    @property
    def old_name(self) -> str:
        """The name before August 2019: `GRANDCHILD_CHILD_PARENT`."""
        return "_".join(reversed(self.chain))


@dataclass
class ObjectList:
    """A list that was read: valid objects, and the faults of the others.

    Attributes:
        objects: by flattened name, in the order of the list.
        faults: by flattened name ("" for the list itself); includes warnings.
    """

    objects: Dict[str, PlacedObject] = field(default_factory=dict)
    faults: Dict[str, List[Issue]] = field(default_factory=dict)

    @property
    def names(self) -> List[str]:
        """All names of the list, including those of faulty objects."""
        return list(dict.fromkeys([*self.objects, *(name for name in self.faults if name)]))

    def issues(self) -> List[Issue]:
        """All faults, in the order of the list."""
        return [issue for found in self.faults.values() for issue in found]


def parse_objects(tree: Any, source: Source, package: str = "my_simulations") -> ObjectList:
    """Check and flatten an object list.

    Args:
        tree: the values of the file, or of the parameter `/objects`; None is an empty list.
        source: origin of the values, for messages.
        package: package whose folder `objects` contains the files of 2012-style entries.

    Returns:
        The list, with its faults; nothing is raised for them.
    """
    result = ObjectList()
    if tree is None:
        return result
    if not isinstance(tree, Mapping):
        result.faults[""] = [error(
            "list-wrong-type", f"an object list must map names to objects, is {_kind(tree)}",
            **source.where(()))]
        return result
    _Reader(source, package, result).entries(tree, (), (), (0.0, 0.0, 0.0), 0.0)
    return result


class _Reader:
    """Reads a tree; faults are collected by object name."""

    def __init__(self, source: Source, package: str, result: ObjectList) -> None:
        self._source = source
        self._package = package
        self._result = result

    def entries(self, tree: Mapping[Any, Any], path: KeyPath, chain: Tuple[str, ...],
                origin: Vec3, yaw: float) -> None:
        stray = self._stray_keys(tree, path, chain)
        for key, value in tree.items():
            if key in stray:
                continue
            if not isinstance(key, str) or not key.strip():
                self._fault("_".join([*chain, str(key)]), error(
                    "object-name", f"the name of an object must be a string, is {key!r}",
                    **self._source.where((*path, str(key))), hint="put the name in quotes"))
                continue
            self._entry(value, (*path, key), (*chain, key), origin, yaw)

    def _stray_keys(self, tree: Mapping[Any, Any], path: KeyPath,
                    chain: Tuple[str, ...]) -> Set[Any]:
        """Keys of an object that stand beside its name instead of below it, and that name.

        They get one fault, at the first of them.
        """
        names = list(tree)
        first = next((at for at, key in enumerate(names)
                      if key in KEYS and not isinstance(tree[key], Mapping)), None)
        if first is None:
            return set()
        owner = names[first - 1] if first else None
        name = "_".join([*chain, str(owner if first else names[0])])
        self._fault(name, error(
            "object-indentation", f"'{names[first]}' is not indented below the name of an object",
            **self._source.where((*path, str(names[first]))),
            hint=f"indent model, position and orientation below '{owner}:' by two spaces" if first
            else "write the name of the object and a colon above it, and indent this line"))
        return {owner, *(key for key in names[first:]
                         if key in KEYS and not isinstance(tree[key], Mapping))}

    def _entry(self, value: Any, path: KeyPath, chain: Tuple[str, ...],
               origin: Vec3, yaw: float) -> None:
        name = "_".join(chain)
        where = self._source.where(path)
        if not isinstance(value, Mapping):
            self._fault(name, error(
                "object-wrong-type",
                f"object '{name}' must have model, position and orientation, is {_kind(value)}",
                **where))
            return
        if name in self._result.objects:
            self._fault(name, error(
                "object-name-twice", f"two objects flatten to the name '{name}'", **where,
                hint=f"the other is {self._result.objects[name].param}"))
            return
        for key in value:
            if key not in KEYS:
                close = difflib.get_close_matches(str(key), KEYS, 1)
                self._fault(name, warning(
                    "unknown-key", f"object '{name}': unknown key '{key}' is ignored",
                    **self._source.where((*path, str(key))),
                    hint=f"did you mean '{close[0]}'?" if close else ""))
        file = self._file(value, path, name)
        position = self._triple(value, path, name, "position")
        rpy = self._triple(value, path, name, "orientation")
        if position is None or rpy is None:
            self._orphans(value.get("children"), chain, name)
            return
        c, s = math.cos(yaw), math.sin(yaw)
        placed: Vec3 = (origin[0] + c * position[0] - s * position[1],
                        origin[1] + s * position[0] + c * position[1], origin[2] + position[2])
        # Only the parent's yaw rotates a child, not its roll and pitch (Care-O-bot tools).
        turned: Vec3 = (rpy[0], rpy[1], rpy[2] + yaw)
        if file is not None:
            self._result.objects[name] = PlacedObject(
                name, chain, file, placed, turned, self._source.param(path))
        self._children(value, path, chain, placed, turned[2], name)

    def _children(self, value: Mapping[Any, Any], path: KeyPath, chain: Tuple[str, ...],
                  placed: Vec3, yaw: float, name: str) -> None:
        children = value.get("children")
        if children is None:
            return
        below = (*path, "children")
        if not isinstance(children, Mapping):
            self._fault(name, error(
                "children-wrong-type",
                f"object '{name}': children must map names to objects, is {_kind(children)}",
                **self._source.where(below)))
        elif len(chain) >= MAX_DEPTH:
            self._fault(name, error(
                "children-too-deep", f"object '{name}': children are nested deeper than "
                                     f"{MAX_DEPTH} levels",
                **self._source.where(below)))
        else:
            self.entries(children, below, chain, placed, yaw)

    def _orphans(self, children: Any, chain: Tuple[str, ...], parent: str) -> None:
        if not isinstance(children, Mapping) or len(chain) >= MAX_DEPTH:
            return
        for key, child in children.items():
            below = (*chain, str(key))
            self._fault("_".join(below), error(
                "parent-faulty",
                f"object '{'_'.join(below)}' cannot be placed: its parent '{parent}' has errors"))
            if isinstance(child, Mapping):
                self._orphans(child.get("children"), below, parent)

    def _file(self, value: Mapping[Any, Any], path: KeyPath, name: str) -> Optional[ObjectFile]:
        model = self._text(value, path, name, "model")
        if model is None:
            return None
        if "model_type" in value:
            kind = self._text(value, path, name, "model_type")
            if kind is None:
                return None
            found = self._read_typed_file(self._package, f"objects/{model}.{kind}", kind,
                                          (*path, "model_type"), name)
            return None if found is None else replace(found, named=False)
        package, slash, inside = model.partition("/")
        if not slash or not package or not inside:
            self._fault(name, error(
                "model-without-package", f"object '{name}': model '{model}' names no package",
                **self._source.where((*path, "model")),
                hint="write PACKAGE/path/file.urdf, or add model_type: urdf"))
            return None
        base = inside.rsplit("/", 1)[-1]
        ending = next((e for e in ENDINGS if base.endswith("." + e)), base.partition(".")[2])
        return self._read_typed_file(package, inside, ending, (*path, "model"), name)

    def _read_typed_file(self, package: str, inside: str, ending: str, path: KeyPath,
                         name: str) -> Optional[ObjectFile]:
        kind = ENDINGS.get(ending)
        if kind is None:
            hint = f"use one of {', '.join(ENDINGS)}"
            if ending == "model":
                hint = "Gazebo XML from before SDF is not supported; convert it to SDF or URDF"
            self._fault(name, error(
                "model-type", f"object '{name}': files of type '{ending}' cannot be spawned",
                **self._source.where(path), hint=hint))
            return None
        parts = [package, *inside.split("/")]
        if ".." in parts or "." in parts[:1] or inside.startswith("/") or "\0" in inside:
            self._fault(name, error(
                "object-file-outside", f"object '{name}': '{package}/{inside}' is not inside of the"
                " folder of its package", **self._source.where(path),
                hint="name the package that contains the file, without '..'"))
            return None
        return ObjectFile(package, inside, "xacro" in kind, "sdf" in kind)

    def _text(self, value: Mapping[Any, Any], path: KeyPath, name: str, key: str) -> Optional[str]:
        found = value.get(key)
        if isinstance(found, str) and found.strip():
            return found.strip()
        self._fault(name, self._bad(path, name, key, found, key in value, "a string"))
        return None

    def _triple(self, value: Mapping[Any, Any], path: KeyPath, name: str,
                key: str) -> Optional[Vec3]:
        found = value.get(key)
        if not isinstance(found, (list, tuple)) or len(found) != 3:
            self._fault(name, self._bad(path, name, key, found, key in value, "three numbers"))
            return None
        numbers = [_number(item) for item in found]
        for item, number in zip(found, numbers):
            if number is None:
                self._fault(name, self._bad(path, name, key, item, True, "three finite numbers"))
                return None
        x, y, z = (float(number) for number in numbers if number is not None)
        return (x, y, z)

    def _bad(self, path: KeyPath, name: str, key: str, found: Any, present: bool,
             wanted: str) -> Issue:
        where = self._source.where((*path, key))
        if not present:
            return error("missing-key", f"object '{name}' has no {key}", **where,
                         hint=f"{key} must be {wanted}")
        return error("wrong-value", f"object '{name}': {key} must be {wanted}, is {_kind(found)}",
                     **where)

    def _fault(self, name: str, issue: Issue) -> None:
        self._result.faults.setdefault(name, []).append(issue)


def _number(value: Any) -> Optional[float]:
    """A finite number, also from text, because YAML 1.1 reads `1e-3` as text."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def _kind(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, Mapping):
        return "a map"
    text = repr(value)
    text = text if len(text) <= 60 else text[:57] + "..."
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"a list of {len(value)}: {text}"
    return text


_LOCATIONS = "object_locations.yaml"
_GROUPS = "object_groups.yaml"
_WORLD_ENDINGS = (".world", ".sdf", ".xml")


def world_name(world: str) -> str:
    """The base name of a world, from its name or the path of its file."""
    base = os.path.basename(world.strip())
    root, ending = os.path.splitext(base)
    return root if ending in _WORLD_ENDINGS else base


def list_file(folder: str, package: str, world: str) -> str:
    """Path of the object list of a world, whether it exists or not.

    Args:
        folder: folder of the package.
        package: name of the package.
        world: name or file of the world.
    """
    inside = os.path.join("config", world_name(world), _LOCATIONS)
    return file_in_package(folder, package, inside)


def groups_file(locations: str) -> str:
    """Path of the groups that belong to an object list, whether it exists or not."""
    return os.path.join(os.path.dirname(locations), _GROUPS)
