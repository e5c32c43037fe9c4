"""Operations of the page as operations on the simulator, each with words for the history."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Callable, Dict, List, Optional, Set, Tuple

from ...description.light import Light
from ...description.model import Model
from ...description.model_group import group_of
from ...description.scoped_names import split_scoped
from ...description.shapes import MeshTable
from ...description.unflatten import unflatten_model
from ...engine.timed_forces import JointPid
from ...errors import CommandError, Issue
from ...formats.sdf.writer.entities import write_world
from ...geometry import Pose, compose, inverse, normalised, pose_is_finite
from ...resources.resolver import Resolver
from ...simulator.effort_operations import ApplyWrench, DriveJoint
from ...simulator.history import History
from ...simulator.joint_gains import default_gains
from ...simulator.operations import (
    AddLight,
    AddModel,
    EditLight,
    EditModel,
    Group,
    Operation,
    RemoveLight,
    RemoveModel,
    Reset,
    SetGroups,
    SetPoses,
    entity_of,
    pose_of,
)
from ...simulator.simulator import Simulator
from ...simulator.spawn_advice import overlap_warnings
from ..scene.plain_json import pose_of as pose_from
from ..transport.protocol import Protocol
from . import history_labels
from .history_labels import join_names
from .inserts import (
    Entity,
    check_meshes,
    entities_of_text,
    entity_of_text,
    entity_of_uri,
    simple_shape,
    used_names,
    with_new_groups,
    world_of,
)
from .model_building import ModelBuilding
from .model_parts import FreeNames, free_name
from .model_scaling import resize_model
from .property_path import dataclass_from_json
from .property_target import is_of_light, property_change, split_target

_MOST_IN_A_GROUP = 5000
_MOST_STEPS = 1000000
_DEEPEST_GROUP = 4
_MOST_GAIN = 1e9

Planned = Tuple[str, Operation, Dict[str, Any]]
"""Words, what to do, and the reply's value."""


class EditRequests:
    """Makes operations of messages and has the history carry them out. One thread at a time.

    Args:
        simulator: the simulator whose world is edited.
        resolver: finds what texts and URIs name.
        history: remembers.
        protocol: says which operations there are.
        report: receives warnings about inserted and moved entities.
        dragged: poses from before a drag that a move ends, by name; forgets them.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, history: History,
                 protocol: Protocol, report: Callable[[Issue], None],
                 dragged: Callable[[List[str]], Dict[str, Pose]]) -> None:
        self._world = simulator
        self._resolver = resolver
        self._history = history
        self._protocol = protocol
        self._report = report
        self._dragged = dragged
        self._building = ModelBuilding(simulator, resolver, report)

    def do(self, op: Dict[str, Any], author: str = "") -> Dict[str, Any]:
        """Carry out one operation as one step of its author's; returns the reply's value.

        Raises CommandError, InputError; then nothing has changed.
        """
        label, operation, value = self._plan_operation(op, 0)
        self._history.do(label, operation, author)
        for issue in overlap_warnings(self._world, _list_moved_names(op, value)):
            self._report(issue)
        return value

    def copy(self, names: List[str]) -> str:
        """Models and lights as SDF text, where they are now. Raises CommandError."""
        models: List[Model] = []
        lights: List[Light] = []
        for name in names:
            if self._world.models.has(name):
                model = unflatten_model(self._world.models.get(name))
                models.append(replace(model, pose=self._world.states.model_state(name)[0]))
            else:
                lights.append(self._world.lights.get(name))
        if not models and not lights:
            raise CommandError("no models or lights are selected")
        return write_world(world_of(models, lights)).decode()

    def _plan_operation(self, op: Dict[str, Any], depth: int) -> Planned:
        kind = self._protocol.check_operation(op)
        if kind == "group":
            return self._group(op, depth)
        planners: Dict[str, Callable[[Dict[str, Any]], Planned]] = {
            "insert": self._insert, "insert_light": self._insert_light, "delete": self._delete,
            "move": self._move, "scale": self._scale, "rename": self._rename, "set": self._set,
            "paste": self._paste, "wrench": self._wrench, "reset": self._reset,
            "joint": self._joint, "set_group": self._set_group, **self._building.planners(),
        }
        return planners[kind](op)

    # -- coming and going ------------------------------------------------------------------------

    def _insert(self, op: Dict[str, Any]) -> Planned:
        given = [name for name in ("shape", "uri", "sdf") if op.get(name)]
        if len(given) != 1:
            raise CommandError("insert needs exactly one of shape, uri and sdf")
        issues: List[Issue] = []
        entity: Entity
        if given == ["shape"]:
            entity = simple_shape(op["shape"])
        elif given == ["uri"]:
            entity, issues = entity_of_uri(op["uri"], self._resolver)
        else:
            entity, issues = entity_of_text(op["sdf"], self._resolver, op.get("source"))
        for issue in issues:
            self._report(issue)
        if isinstance(entity, Model) and op.get("scale"):
            entity = resize_model(entity, tuple(op["scale"]))  # type: ignore[arg-type]
        name = free_name(op.get("name") or entity.name, used_names(self._world))
        pose = pose_from(op["pose"]) if op.get("pose") else entity.pose
        return f"Insert {name}", self._addition(entity, name, pose), {"name": name}

    def _addition(self, entity: Entity, name: str, pose: Pose,
                  meshes: Optional[MeshTable] = None) -> Operation:
        """Add an entity. `meshes`: those of a model that was checked before."""
        pose = _usable(pose)
        if isinstance(entity, Light):
            return AddLight(replace(entity, name=name, pose=pose))
        model = replace(entity, name=name, pose=pose)
        if meshes is None:
            meshes, issues = check_meshes(model)
            for issue in issues:
                self._report(issue)
        return AddModel(model, pose, meshes)

    def _insert_light(self, op: Dict[str, Any]) -> Planned:
        given = dict(op["light"])
        kind = given.setdefault("type", "point")
        if kind not in ("point", "spot", "directional"):
            raise CommandError(f"unknown light type {kind!r}; use point, spot or directional")
        taken = used_names(self._world)
        wanted = str(given.get("name") or "")
        number = 0
        while not wanted:
            name = f"user_{kind}_light_{number}"
            wanted = name if name not in taken else ""
            number += 1
        given["name"] = free_name(wanted, taken)
        light = dataclass_from_json(Light, given)
        light = replace(light, pose=_usable(light.pose))
        return f"Insert {light.name}", AddLight(light), {"name": light.name}

    def _delete(self, op: Dict[str, Any]) -> Planned:
        names = list(dict.fromkeys(op["names"]))
        if not names:
            raise CommandError("nothing is selected")
        parts: List[Operation] = []
        for name in names:
            is_light = is_of_light(self._world, name)
            if not is_light:
                self._world.models.get(name)
            parts.append(RemoveLight(name) if is_light else RemoveModel(name))
        return f"Delete {join_names(names)}", _as_one(parts), {"names": names}

    def _paste(self, op: Dict[str, Any]) -> Planned:
        entities, issues = entities_of_text(op["text"], self._resolver, op.get("source"))
        for issue in issues:
            self._report(issue)
        if not entities:
            raise CommandError("the pasted text contains no models or lights")
        targets: List[Optional[Pose]] = [
            _usable(pose_from(pose)) for pose in op.get("poses") or ()]
        if len(entities) * len(targets) > _MOST_IN_A_GROUP:
            raise CommandError(f"one paste adds at most {_MOST_IN_A_GROUP} models and lights")
        free, groups = FreeNames(used_names(self._world)), self._taken_groups()
        meshes: Dict[int, MeshTable] = {}
        names, parts = [], []
        for target in targets or [None]:
            copies = with_new_groups(entities, groups)
            groups.update(map(group_of, copies))
            for number, entity in enumerate(copies):
                # An entity from a file is the first of its name, not a copy.
                own = entity.name if op.get("source") else f"{entity.name}_clone"
                names.append(free.take(op.get("name") or own))
                # All of them keep their places about the last one, which goes to the pose.
                pose = entity.pose if target is None else (
                    target if entity is copies[-1] else
                    compose(target, compose(inverse(copies[-1].pose), entity.pose)))
                part = self._addition(entity, names[-1], pose, meshes.get(number))
                if isinstance(part, AddModel):
                    meshes[number] = part.meshes
                parts.append(part)
        verb = "Insert" if op.get("source") else "Paste"
        return f"{verb} {join_names(names)}", _as_one(parts), {"names": names, "name": names[-1]}

    # -- changing --------------------------------------------------------------------------------

    def _move(self, op: Dict[str, Any]) -> Planned:
        poses = {name: _usable(pose_from(pose)) for name, pose in op["poses"].items()}
        if not poses:
            raise CommandError("no poses are given")
        for name in poses:
            pose_of(self._world, name)
        label = str(op.get("label") or "move")[:40]
        operation = SetPoses(poses, self._dragged(list(poses)))
        return f"{label.capitalize()} {join_names(list(poses))}", operation, {}

    def _scale(self, op: Dict[str, Any]) -> Planned:
        model = self._world.models.get(op["name"])
        x, y, z = op["scale"]
        new = resize_model(model, (float(x), float(y), float(z)))
        meshes, _ = check_meshes(new)
        return f"Scale {model.name}", EditModel(model.name, new, meshes), {"name": model.name}

    def _rename(self, op: Dict[str, Any]) -> Planned:
        name, to = op["name"], op["to"].strip()
        if not to or "::" in to or to in ("world", "default"):
            raise CommandError(f"{to!r} is not a valid name for a model or light")
        label = f"Rename {name} to {to}"
        if is_of_light(self._world, name):
            return (label, EditLight(name, replace(self._world.lights.get(name), name=to)),
                    {"name": to})
        model = self._world.models.get(name)
        return label, EditModel(name, replace(model, name=to)), {"name": to}

    def _set(self, op: Dict[str, Any]) -> Planned:
        target, path = op["target"], op["path"]
        operation = property_change(self._world, self._resolver, target, path, op.get("value"))
        model = split_target(self._world, target)[0] if self._is_of_model(target) else None
        label = history_labels.set_property(target, path.replace("/", ".").replace("@", ""),
                                            op.get("value"), model)
        return label, operation, {}

    def _set_group(self, op: Dict[str, Any]) -> Planned:
        """An empty name removes the members from their groups; without a name it is a new group."""
        names = list(dict.fromkeys(op["names"]))
        if not names:
            raise CommandError("no models or lights are selected")
        groups = [group_of(entity_of(self._world, name)) for name in names]
        group = op.get("group")
        if group is None:
            group = free_name("group", self._taken_groups())
        group = group.strip()
        label = f"Group {join_names(names)}" if group else f"Ungroup {join_names(names)}"
        if group and len(set(groups)) == 1 and groups[0]:
            label = f"Rename group {groups[0]} to {group}"
        return label, SetGroups({name: group for name in names}), {"name": group}

    def _taken_groups(self) -> Set[str]:
        return {*(group_of(entity.model) for entity in self._world.models.inventory()[1]),
                *(group_of(light) for light in self._world.lights.all())}

    def _is_of_model(self, target: str) -> bool:
        return bool(split_scoped(target, self._world.models.has)[0])

    def _reset(self, op: Dict[str, Any]) -> Planned:
        words = {"time": "time", "poses": "model poses", "world": "world"}[op["what"]]
        return f"Reset {words}", Reset(op["what"]), {}

    # -- pushing and driving ---------------------------------------------------------------------

    def _wrench(self, op: Dict[str, Any]) -> Planned:
        steps = op.get("steps") or 1
        if not 0 < steps <= _MOST_STEPS:
            raise CommandError(f"steps must be 1 to {_MOST_STEPS}, not {steps}")
        link = op["link"]
        if self._world.models.has(link):
            model = self._world.models.get(link)
            if model.frame_link is None:
                raise CommandError(f"model {link!r} has no links")
            link = f"{link}::{model.frame_link.name}"
        point = op.get("point")
        force, torque = _vector(op["force"]), _vector(op["torque"])
        operation = ApplyWrench(link, force, torque,
                         None if point is None else _vector(point),
                         bool(op.get("in_link_axes")), steps)
        return history_labels.apply_wrench(link, force, torque), operation, {}

    def _joint(self, op: Dict[str, Any]) -> Planned:
        name, value = op["joint"], float(op["value"])
        owner, joint, number = self._world.joints.find(name)
        scoped = f"{owner}::{joint.name}" + ("::1" if number else "")
        axis = joint.axis2 if number else joint.axis
        if axis is None:
            raise CommandError(f"joint {joint.name!r} has no movable axis")
        if not math.isfinite(value):
            raise CommandError(f"the target of joint {joint.name!r} must be finite")
        mode = op["mode"]
        label = history_labels.set_joint(scoped, joint.type, mode, value)
        if mode == "force":
            return label, DriveJoint(scoped, (value,) if value else ()), {}
        rate = mode == "velocity"
        gains = default_gains(self._world.models.get(owner), joint, rate,
                              self._world.physics.settings.max_step_size, bool(number))
        servo = JointPid(value, rate, **{**gains, **_gains(op.get("gains") or {})})
        return label, DriveJoint(scoped, (servo,)), {}

    # -- several ---------------------------------------------------------------------------------

    def _group(self, op: Dict[str, Any], depth: int) -> Planned:
        if depth >= _DEEPEST_GROUP or len(op["ops"]) > _MOST_IN_A_GROUP or not op["ops"]:
            raise CommandError(f"a group contains 1 to {_MOST_IN_A_GROUP} operations, nested "
                               f"{_DEEPEST_GROUP} deep at most")
        label = str(op.get("label") or "")
        deferred = _Deferred(self, op["ops"], depth + 1)
        return label or f"{len(op['ops'])} changes", deferred, deferred.value


class _Deferred:
    """A group whose parts are planned one by one, since each may build on those before it."""

    def __init__(self, edits: EditRequests, ops: List[Dict[str, Any]], depth: int) -> None:
        self._edits, self._ops, self._depth = edits, ops, depth
        self.value: Dict[str, Any] = {"names": []}

    def apply(self, world: Simulator) -> Operation:
        """All of them or none."""
        done: List[Operation] = []
        try:
            for op in self._ops:
                _, operation, value = self._edits._plan_operation(op, self._depth)
                done.append(operation.apply(world))
                self.value["names"] += value.get("names") or (
                    [value["name"]] if value.get("name") else [])
        except Exception:
            for back in reversed(done):
                back.apply(world)
            raise
        return Group(tuple(reversed(done)))


def _list_moved_names(op: Dict[str, Any], value: Dict[str, Any]) -> List[str]:
    """Names of the models and lights that an operation has put at a new place."""
    if op["kind"] == "move":
        return list(op["poses"])
    if op["kind"] in ("insert", "paste"):
        return value.get("names") or [value["name"]]
    return []


def _as_one(parts: List[Operation]) -> Operation:
    return parts[0] if len(parts) == 1 else Group(tuple(parts))


def _gains(given: Dict[str, Any]) -> Dict[str, float]:
    """Those of a PID loop. Raises CommandError for what is no gain."""
    given = {name: gain for name, gain in given.items() if gain is not None}
    for name, gain in given.items():
        if not 0.0 <= gain <= _MOST_GAIN:
            raise CommandError(f"the gain {name.upper()} must be 0 to {_MOST_GAIN:g}, "
                               f"found {gain!r}")
    return {name: float(gain) for name, gain in given.items()}


def _vector(values: Any) -> Tuple[float, float, float]:
    x, y, z = values
    return (float(x), float(y), float(z))


def _usable(pose: Optional[Pose]) -> Pose:
    """A finite pose with a unit quaternion. Raises CommandError."""
    pose = pose or Pose()
    if not pose_is_finite(pose):
        raise CommandError("the pose contains NaN or infinite values")
    return Pose(pose.position, normalised(pose.orientation))
