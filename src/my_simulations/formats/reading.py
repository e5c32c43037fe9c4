"""Reads files and texts: worlds, models and lights, in SDF or URDF."""
from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, Union

from ..description.actor import Actor
from ..description.light import Light
from ..description.model import Model
from ..description.shapes import MeshTable
from ..description.validate import closest_name_hint
from ..description.world import World
from ..errors import InputError, Issue, error, errors_of
from ..resources.resolver import Resolver
from .include_overrides import IncludeOverrides
from .loading_advice import ADVICE_LIMIT, Written, advice_issues
from .mesh.loading import collision_meshes
from .mesh.visual_files import decoded_visual_issues, visual_file_issues
from .sdf.include import read_include
from .sdf.light import LightPlacement, read_light
from .sdf.model import read_model
from .sdf.parsed_model import ParsedModel
from .sdf.state_applied import apply_state
from .sdf.upgrade import upgrade
from .sdf.world import read_world_element
from .sdf.world_scene import read_actor
from .xml.parsing import parse, read_content
from .xml.source import FaultLevel, IssueCollector, Source

Text = Union[str, bytes]
Entity = Union[Model, Light]

Progress = Callable[[str, int, int], None]
"""Hears which model's meshes are read: its name, how many are done, of how many."""

_UNNAMED = "unnamed"
_SDF_ROOTS = ("sdf", "gazebo")  # root element of the first SDF versions


@dataclass(frozen=True)
class LoadedWorld:
    """A world that is ready to be simulated.

    Attributes:
        world: the description; a saved state of the file is applied.
        meshes: the collision meshes of its models, by model name. A collision without its mesh
            does not collide; it stays in the description, so that saving keeps it.
        issues: all faults of the file and of the files it refers to, and advice.
    """

    world: World
    meshes: Dict[str, MeshTable]
    issues: List[Issue]


def _silent(_name: str, _done: int, _of: int) -> None:
    """Ignore progress."""


def read_world(path: str, resolver: Resolver, *, seed: int = 0, profile: str = "",
               advice_limit: Optional[int] = ADVICE_LIMIT,
               progress: Progress = _silent) -> LoadedWorld:
    """Read the first world of a file, completely.

    An unusable model is skipped; its errors are among the issues and in `World.losses`.

    Args:
        path: the file.
        resolver: finds the files it refers to.
        seed: seed of populations that are placed at random.
        profile: name of the physics preset to use; "" for the default of the world.
        advice_limit: see `advice_issues`.
        progress: called before the meshes of each model are read, and when all are.

    Raises:
        InputError: nothing is usable: no such file, truncated XML, no `<world>`.
    """
    return read_world_text(_content(path), resolver, path, seed=seed, profile=profile,
                           advice_limit=advice_limit, progress=progress)


def read_world_text(text: Text, resolver: Resolver, file: str = "<world>", *, seed: int = 0,
                    profile: str = "", advice_limit: Optional[int] = ADVICE_LIMIT,
                    progress: Progress = _silent) -> LoadedWorld:
    """As `read_world`, from text; `file` names it and, if it is a path, anchors relative URIs.

    Raises InputError: nothing is usable.
    """
    source, root = _open(text, resolver, file)
    return _loaded_world(root, source, _world_in(root, source, seed, profile), advice_limit,
                         progress)


def parse_world(text: Text, resolver: Resolver, file: str = "<world>", *, seed: int = 0,
                profile: str = "") -> Tuple[World, List[Issue]]:
    """The description in a document, without the further steps of `read_world`.

    `World.state` is not applied and no mesh is loaded. For copies, and for tools that inspect
    files. Arguments and errors as for `read_world_text`.
    """
    source, root = _open(text, resolver, file)
    return _world_in(root, source, seed, profile), source.log.issues


def _world_in(root: Any, source: Source, seed: int, profile: str) -> World:
    if root.tag not in _SDF_ROOTS:
        raise _unusable(source, "root-unknown", f"expected <sdf>, found <{root.tag}>", root,
                        _hint_for_world(root, source.file))
    element = root.find("world")
    if element is None:
        raise _unusable(source, "world-missing", "the file contains no <world>", root,
                        _spawn_hint(root.find("model"), "sdf", source.file)
                        or _child_suggestion(root, ("world",)))
    world = read_world_element(element, source, seed, profile)
    if len(root.findall("world")) > 1:
        source.warn("world-many", "the file contains several worlds; the first is used", root)
    return world


def _loaded_world(root: Any, source: Source, parsed: World, advice_limit: Optional[int],
                  progress: Progress = _silent) -> LoadedWorld:
    issues = source.log.issues
    world = replace(apply_state(parsed), losses=[str(issue) for issue in errors_of(issues)])
    meshes: Dict[str, MeshTable] = {}
    for number, model in enumerate(world.models):
        progress(model.name, number, len(world.models))
        meshes[model.name], faults = collision_meshes(model, Written(source.file, root))
        issues += faults
    progress("", len(world.models), len(world.models))
    issues += visual_file_issues(world.models, source.resolver)
    issues += advice_issues(world.models, meshes, Written(source.file, root), limit=advice_limit)
    return LoadedWorld(world, meshes, issues)


def read_file(path: str, resolver: Resolver) -> Tuple[Entity, List[Issue]]:
    """The first model or light of a file; see `read_entity`. Raises InputError: nothing usable."""
    return read_entity(_content(path), resolver, path)


def read_entity(text: Text, resolver: Resolver,
                file: str = "<model_xml>") -> Tuple[Entity, List[Issue]]:
    """The first model or light of a document: `<robot>`, or `<sdf>` with a model, light or world.

    If an issue has severity ERROR, the result differs from the document.

    Args:
        text: the document; bytes in any declared encoding.
        resolver: finds the files it refers to.
        file: name of the document in issues; if it is a path, relative URIs start from its folder.

    Raises:
        InputError: nothing usable.
    """
    return parse_document(text, resolver, file).read_entity()


class ParsedDocument:
    """A parsed document whose root element can be inspected before its entity is read.

    Attributes:
        root_tag: tag of the root element: `robot`, `sdf`, ...
    """

    def __init__(self, source: Source, root: Any) -> None:
        self._source = source
        self._root = root
        self.root_tag: str = root.tag

    def take_attributes(self, names: Iterable[str]) -> Dict[str, str]:
        """Remove attributes from the root element; returns those that existed, by name."""
        return {name: self._root.attrib.pop(name) for name in names if name in self._root.attrib}

    def set_file(self, file: str) -> None:
        """Change the document's name in issues, including issues that were already found."""
        log = self._source.log
        log.issues = [replace(issue, file=file) if issue.file == self._source.file else issue
                      for issue in log.issues]
        self._source.file = file

    def written(self, name: str) -> Written:
        """Where its model is written, which has this name in the document."""
        return Written(self._source.file, self._root, name)

    def read_entity(self) -> Tuple[Entity, List[Issue]]:
        """The first model or light; see the function `read_entity`. Call it once."""
        entity = _entity_in(self._root, self._source)
        shown = ([] if isinstance(entity, Light)
                 else visual_file_issues([entity], self._source.resolver))
        return entity, [*self._source.log.issues, *shown]


def parse_document(text: Text, resolver: Resolver, file: str = "<model_xml>") -> ParsedDocument:
    """Parse a document; arguments and errors as for the function `read_entity`."""
    source, root = _open(text, resolver, file)
    return ParsedDocument(source, root)


def _entity_in(root: Any, source: Source) -> Entity:
    if root.tag == "robot":
        _refuse_xacro(root, source)
        return _read_robot(root, source, _name_if_missing(root, source))
    if root.tag in _SDF_ROOTS:
        return _first_entity(root, source)
    hint = ("put it into <sdf version='1.7'>…</sdf>"
            if root.tag in ("model", "light", "world") else
            _suggestion(root, ("sdf", "robot", "world", "model", "light")))
    raise _unusable(source, "root-unknown", f"expected <sdf> or <robot>, found <{root.tag}>",
                    root, hint)


def read_any(text: Text, resolver: Resolver,
             file: str) -> Tuple[Union[World, Model, Light, Actor], List[Issue]]:
    """The first world of a document, else its first model or light, else an actor.

    The issues are complete, as those of `read_world`, and include all advice and faults of meshes
    that are only shown. Raises InputError: nothing is usable.
    """
    source, root = _open(text, resolver, file)
    issues = source.log.issues
    if root.find("world") is not None:
        loaded = _loaded_world(root, source, _world_in(root, source, 0, ""), None)
        return loaded.world, [*loaded.issues, *decoded_visual_issues(loaded.world.models,
                                                                     loaded.issues)]
    actor = root.find("actor")
    if actor is not None and not any(root.find(tag) is not None
                                     for tag in ("model", "light", "include")):
        source.report_unused(actor)
        return read_actor(actor, source), issues
    entity = _entity_in(root, source)
    if isinstance(entity, Model):
        issues += visual_file_issues([entity], resolver)
        issues += decoded_visual_issues([entity], issues)
        meshes, faults = collision_meshes(entity, Written(file, root))
        issues += faults
        issues += advice_issues([entity], {entity.name: meshes}, Written(file, root), limit=None)
    return entity, issues


def _read_robot(root: Any, source: Source, overrides: Optional[IncludeOverrides]) -> Model:
    """`urdf.robot.read_robot`, imported when the first URDF file is read."""
    from .urdf.robot import read_robot

    return read_robot(root, source, overrides)


def _first_entity(root: Any, source: Source) -> Entity:
    for child in root:
        holders = child if child.tag == "world" else (child,)
        for element in holders:
            found: Any = None
            if element.tag == "model":
                found = read_model(element, source, _name_if_missing(element, source))
            elif element.tag == "light":
                found = read_light(element, source)
            elif element.tag == "include":
                if element.find("pose") is None:
                    # Gazebo writes the pose of the request into the include, which replaces the
                    # pose in the model's file.
                    element.append(element.makeelement("pose"))
                    element[-1].text = "0 0 0 0 0 0"
                found = read_include(element, source, read_model)
                if found is None:
                    raise InputError(source.log.issues)
            if isinstance(found, ParsedModel):
                return found.model
            if isinstance(found, LightPlacement):
                return found.light
    raise _unusable(source, "model-missing", "the document contains no world, model or light",
                    root, _child_suggestion(root, ("world", "model", "light", "include", "actor")))


def _hint_for_world(root: Any, file: str) -> str:
    """Hint for a file that was given as a world and is something else."""
    if root.tag == "launch":
        return f"this is a launch file; run roslaunch {file}"
    return (_spawn_hint(root, "urdf", file) if root.tag == "robot"
            else _suggestion(root, ("sdf", "gazebo", "world")))


def _spawn_hint(element: Any, kind: str, file: str) -> str:
    """How to spawn the model of an element; "" for None."""
    if element is None:
        return ""
    name = (element.get("name") or "").strip() or "NAME"
    return (f"this is a model; start another world and run rosrun gazebo_ros spawn_model -{kind}"
            f" -file {file} -model {name}")


def _suggestion(element: Any, known: Sequence[str]) -> str:
    """Hint for an unknown element: the known name most similar to its tag."""
    return closest_name_hint(element.tag.lower() if isinstance(element.tag, str) else "",
                             list(known))


def _child_suggestion(root: Any, known: Sequence[str]) -> str:
    """Hint for a root with unknown children: the similar known name and the line of the first."""
    for child in root:
        hint = _suggestion(child, known)
        if hint:
            return f"line {child.sourceline} has <{child.tag}>; {hint}"
    return ""


def _name_if_missing(element: Any, source: Source) -> IncludeOverrides:
    """Set a name if the document has none: a spawn request provides its own."""
    if (element.get("name") or "").strip():
        return IncludeOverrides()
    source.warn("name-missing", f"<{element.tag}> has no name; it is named {_UNNAMED!r}", element)
    return IncludeOverrides(name=_UNNAMED)


def _refuse_xacro(root: Any, source: Source) -> None:
    for element in root.iter("{http://www.ros.org/wiki/xacro}*", "{http://wiki.ros.org/xacro}*",
                             "{http://ros.org/wiki/xacro}*"):
        source.report(FaultLevel.FATAL, "xacro-unexpanded", "the text is xacro, not URDF", element,
                      "expand it with the xacro command first")
        return


def _content(path: str) -> bytes:
    try:
        return read_content(path)
    except OSError as fault:
        code = "file-not-found" if isinstance(fault, FileNotFoundError) else "file-unreadable"
        raise InputError(
            [error(code, f"cannot be read: {fault.strerror or fault}", file=path)]
        ) from None


def _open(text: Text, resolver: Resolver, file: str) -> Tuple[Source, Any]:
    resolver.begin()
    log = IssueCollector()
    base_dir = os.path.dirname(os.path.abspath(file)) if os.path.isfile(file) else ""
    trail = (os.path.abspath(file),) if base_dir else ()
    source = Source(file, base_dir, resolver, _read_robot, log, trail)
    try:
        root = parse(text, file, log)
    except InputError as fault:
        raise InputError([*fault.issues, *log.issues]) from None
    return source, upgrade(root, source) if root.tag in _SDF_ROOTS else root


def _unusable(source: Source, code: str, message: str, element: Any, hint: str = "") -> InputError:
    issue = error(code, message, hint=hint, **source.where(element))
    return InputError([issue, *errors_of(source.log.issues)])
