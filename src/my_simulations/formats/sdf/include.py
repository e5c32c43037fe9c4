"""`<include>`: the model or light of another file, with overrides."""
from __future__ import annotations

import functools
import os
from dataclasses import replace
from typing import Any, Callable, List, Optional, Sequence, Union

from ...description.actor import Actor
from ...description.cost_budget import MODEL_BUDGET
from ...description.light import Light
from ...errors import InputError
from ...geometry import IDENTITY
from ...resources.resolver import ResourceNotFoundError
from ..include_overrides import IncludeOverrides
from ..xml.binding import fill, has_prefix
from ..xml.parsing import parse, read_content
from ..xml.source import FaultLevel, Source
from .light import LightPlacement, read_light
from .link import relative_to
from .model_flags import ModelFlags
from .model_tables import INCLUDE
from .parsed_model import ParsedModel
from .plugin import read_plugin
from .upgrade import upgrade
from .world_scene import read_actor

_DEEPEST = 20
_MOST = MODEL_BUDGET.links
"""Most includes of one model: nearly each of a useful model adds a link."""

Included = Union[ParsedModel, LightPlacement, Actor]
ModelReader = Callable[..., ParsedModel]
"""Type of `model.read_model`, which is passed in because models contain includes."""


def read_include(element: Any, source: Source, read_model: ModelReader, static: bool = False,
                 outer: Sequence[str] = (), alone: bool = True) -> Optional[Included]:
    """The entity of an `<include>`; None, with an issue, if it cannot be used.

    Name, pose and static replace those of the included model; plugins are added. Source: SDF spec
    1.7, include; an include whose file is missing is skipped, and the world loads (Gazebo
    behaviour).

    Args:
        element: the `<include>`.
        source: its file.
        read_model: reads a `<model>`; see `model.read_model`.
        static: True if an outer model is static.
        outer: names of the models around the include, outermost first.
        alone: False if joints may refer to links of other models.
    """
    probe = _Include()
    kept: List[str] = []
    found = fill(probe, element, INCLUDE, source, kept)
    if not probe.uri:
        say = source.tolerate if outer else functools.partial(source.report, FaultLevel.ERROR)
        say("include-uri-missing", "<include> has no <uri>; it is skipped", element)
        return None
    if probe.pose is None and element.find("pose") is not None:
        probe.pose = IDENTITY  # an empty pose replaces that of the model, too
    changes = IncludeOverrides(
        probe.name or None, probe.pose, relative_to(found), probe.static,
        [read_plugin(plugin, source) for plugin in found.get("plugin", ())],
        [xml for xml in kept if has_prefix(xml)],
        next(((e.text or "").strip() for e in found.get("placement_frame", ())), ""),
    )
    read = functools.partial(read_model, static=static, outer=outer, alone=alone and not outer)
    try:
        path = source.model_file(probe.uri, element)
    except ResourceNotFoundError as missing:
        text, hint = source.resolver.explain(
            missing, "install it in ~/.gazebo/models or a folder of GAZEBO_MODEL_PATH, or name a"
            " model database in GAZEBO_MODEL_DATABASE_URI")
        if outer:
            source.tolerate("model-not-found", f"the included model {text}; model {outer[-1]!r}"
                            " is loaded without it", element, hint)
        else:
            source.report(FaultLevel.ERROR, "model-not-found", f"the included model {text}",
                          element, hint)
        return None
    return _read_file(path, element, source, changes, read, probe.uri, not outer)


class _Include:
    """The values of an `<include>`."""

    def __init__(self) -> None:
        self.uri = ""
        self.name = ""
        self.pose: Any = None
        self.static: Optional[bool] = None


def _read_file(path: str, element: Any, source: Source, changes: IncludeOverrides,
               read: ModelReader, uri: str, alone: bool) -> Optional[Included]:
    if path in source.trail or len(source.trail) >= _DEEPEST:
        chain = " -> ".join(os.path.basename(os.path.dirname(p)) for p in (*source.trail, path))
        source.report(FaultLevel.ERROR, "include-cycle", f"models include each other: {chain}",
                      element)
        return None
    if alone and not source.trail:
        source.log.includes = 0
    source.log.includes += 1
    if source.log.includes > _MOST:
        if source.log.includes == _MOST + 1:
            source.report(FaultLevel.FATAL, "include-many", "the model has more than"
                          f" {_MOST} includes", element)
        return None
    inner = replace(source, file=path, base_dir=os.path.dirname(path),
                    trail=(*source.trail, path))
    root = _root(path, inner, element, source)
    if root is None:
        return None
    if root.tag == "robot":
        model = source.read_robot(root, inner, changes)
        model.uri = uri
        model.extra += changes.extra
        flags = ModelFlags(static=True if model.static else None)
        return ParsedModel(model, changes.relative_to, flags=flags)
    for child in root:
        if child.tag == "model":
            placement = read(child, inner, changes)
            placement.model.uri = uri
            placement.model.extra += changes.extra
            return placement
        if child.tag == "light":
            light = read_light(child, inner)
            return _changed_light(light, changes)
        if child.tag == "actor":
            source.warn("actor-unsupported", f"{uri!r} is an actor: it is shown, but not"
                        " simulated", element)
            return _changed_actor(read_actor(child, inner), changes)
    source.report(FaultLevel.ERROR, "include-empty", f"{path} contains no model and no light",
                  element)
    return None


def _changed_actor(actor: Actor, changes: IncludeOverrides) -> Actor:
    actor.name = changes.name if changes.name is not None else actor.name
    actor.pose = changes.pose if changes.pose is not None else actor.pose
    actor.plugins += changes.plugins
    return actor


def _changed_light(placement: LightPlacement, changes: IncludeOverrides) -> LightPlacement:
    light: Light = placement.light
    if changes.name is not None:
        light.name = changes.name
    if changes.pose is not None:
        light.pose = changes.pose
        return LightPlacement(light, changes.relative_to)
    return placement


def _root(path: str, inner: Source, element: Any, source: Source) -> Optional[Any]:
    if path in source.parsed:
        return source.parsed[path]
    root: Optional[Any] = None
    try:
        root = parse(read_content(path), path, source.log)
        if root.tag in ("sdf", "gazebo"):
            root = upgrade(root, inner)
        elif root.tag != "robot":
            source.report(FaultLevel.ERROR, "include-empty", f"{path} is neither SDF nor URDF, its"
                          f" root is <{root.tag}>", element)
            root = None
    except OSError as fault:
        source.report(FaultLevel.ERROR, "file-unreadable", f"{path} cannot be read:"
                      f" {fault.strerror or fault}", element)
    except InputError as fault:
        for issue in fault.issues:
            source.log.add(issue)
    source.parsed[path] = root
    return root

