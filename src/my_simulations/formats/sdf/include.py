"""`<include>`: the model or light of another file, with changes."""
from __future__ import annotations

import functools
import os
from dataclasses import replace
from typing import Any, Callable, List, Optional, Sequence, Union

from ...description.world import Actor, Light
from ...errors import InputError
from ...geometry import IDENTITY
from ...resources.resolver import ResourceNotFoundError
from ..xml.binding import fill
from ..xml.parsing import content, parse
from ..xml.source import Level, Source
from .flags import Said
from .light import LightPlacement, read_light
from .model import IncludeOverrides, ParsedModel, read_model, relative_to
from .model_tables import INCLUDE
from .sensor import read_plugin
from .upgrade import upgrade
from .world_scene import read_actor

_DEEPEST = 20
_MOST = 20000

Included = Union[ParsedModel, LightPlacement, Actor]


def read_include(element: Any, source: Source, static: bool = False,
                 outer: Sequence[str] = (), alone: bool = True) -> Optional[Included]:
    """What an `<include>` brings; None, with an issue, where nothing usable comes.

    Name, pose and static replace those of the included model; plugins are added. Source: SDF spec
    1.7, include; a missing file leaves the include out, and the world loads (Gazebo behaviour).
    """
    probe = _Include()
    found = fill(probe, element, INCLUDE, source, [])
    if not probe.uri:
        say = source.tolerate if outer else functools.partial(source.report, Level.ERROR)
        say("include-uri-missing", "<include> has no <uri>; it is left out", element)
        return None
    if probe.pose is None and element.find("pose") is not None:
        probe.pose = IDENTITY  # an empty one, too, replaces that of the model
    changes = IncludeOverrides(
        probe.name or None, probe.pose, relative_to(found), probe.static,
        [read_plugin(plugin, source) for plugin in found.get("plugin", ())],
        next(((e.text or "").strip() for e in found.get("placement_frame", ())), ""),
    )
    read = functools.partial(read_model, static=static, outer=outer, alone=alone and not outer)
    try:
        path = source.resolver.model_file(probe.uri, source.base_dir)
    except ResourceNotFoundError as missing:
        hint = (source.resolver.meant(missing) + "install it in ~/.gazebo/models or a folder of"
                " GAZEBO_MODEL_PATH, or name a model database in GAZEBO_MODEL_DATABASE_URI")
        if outer:
            source.tolerate("model-not-found", f"the included model {missing}; model {outer[-1]!r}"
                            " goes without it", element, hint)
        else:
            source.report(Level.ERROR, "model-not-found", f"the included model {missing}", element,
                          hint)
        return None
    return _read_file(path, element, source, changes, read, probe.uri)


class _Include:
    """The values of an `<include>`."""

    def __init__(self) -> None:
        self.uri = ""
        self.name = ""
        self.pose: Any = None
        self.static: Optional[bool] = None


def _read_file(path: str, element: Any, source: Source, changes: IncludeOverrides,
               read: Callable[..., ParsedModel], uri: str) -> Optional[Included]:
    if path in source.trail or len(source.trail) >= _DEEPEST:
        chain = " -> ".join(os.path.basename(os.path.dirname(p)) for p in (*source.trail, path))
        source.report(Level.ERROR, "include-cycle", f"models include each other: {chain}", element)
        return None
    source.log.includes += 1
    if source.log.includes > _MOST:
        source.report(Level.ERROR, "include-many", f"more than {_MOST} includes; the rest is left"
                      " out", element)
        return None
    inner = replace(source, file=path, base_dir=os.path.dirname(path),
                    trail=(*source.trail, path))
    root = _root(path, inner, element, source)
    if root is None:
        return None
    if root.tag == "robot":
        from ..urdf.robot import read_robot

        model = read_robot(root, inner, changes)
        model.uri = uri
        said = Said(static=True if model.static else None)
        return ParsedModel(model, changes.relative_to, said=said)
    for child in root:
        if child.tag == "model":
            placement = read(child, inner, changes)
            placement.model.uri = uri
            return placement
        if child.tag == "light":
            light = read_light(child, inner)
            return _changed_light(light, changes)
        if child.tag == "actor":
            source.warn("actor-unsupported", f"{uri!r} is an actor: it is shown, but nothing of it"
                        " is simulated", element)
            return _changed_actor(read_actor(child, inner), changes)
    source.report(Level.ERROR, "include-empty", f"{path} holds no model and no light", element)
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
        root = parse(content(path), path, source.log)
        if root.tag in ("sdf", "gazebo"):
            root = upgrade(root, inner)
        elif root.tag != "robot":
            source.report(Level.ERROR, "include-empty", f"{path} is neither SDF nor URDF, its root"
                          f" is <{root.tag}>", element)
            root = None
    except OSError as fault:
        source.report(Level.ERROR, "file-unreadable", f"{path} cannot be read:"
                      f" {fault.strerror or fault}", element)
    except InputError as fault:
        for issue in fault.issues:
            source.log.add(issue)
    source.parsed[path] = root
    return root


__all__: List[str] = ["read_include", "Included"]
