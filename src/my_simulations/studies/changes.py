"""Puts the settings of a case into descriptions of worlds and models."""
from __future__ import annotations

from dataclasses import replace
from typing import Callable, Dict, List, Sequence, Set, Tuple

from ..description.model import Inertial, Link, Model
from ..description.shapes import Surface
from ..description.world import World
from ..geometry import Pose, quat_from_rpy, rpy_from_quat
from ..python_api.plain_values import pose_of
from .variation import Parameter, Setting, Target

_ON_MODELS = ("pose", "mass", "friction", "restitution")
_AXES = "xyz"
_ANGLES = ("roll", "pitch", "yaw")


class CaseChanges:
    """The changes of one case; descriptions that are given are left as they are."""

    def __init__(self, parameters: Sequence[Parameter], settings: Dict[str, Setting]) -> None:
        self._changes = [(parameter.target, settings[parameter.name]) for parameter in parameters]
        self._applied: Set[Target] = set()

    def unused(self) -> List[str]:
        """Models and links that were to be changed and are not there."""
        return [target.name for target, _ in self._changes
                if target.kind in _ON_MODELS and target not in self._applied]

    def world(self, world: World) -> World:
        """The world with its models, physics and gravity as set."""
        physics, gravity = world.physics, list(world.gravity)
        for target, value in self._changes:
            if target.kind == "gravity":
                gravity[_AXES.index(target.part)] = _number(value)
            elif target.kind == "physics" and target.part == "step_size":
                physics = replace(physics, max_step_size=_number(value))
            elif target.kind == "physics":
                physics = replace(physics, ode=replace(physics.ode, iters=int(_number(value))))
        return replace(world, physics=physics, gravity=(gravity[0], gravity[1], gravity[2]),
                       models=[self.model(model) for model in world.models])

    def model(self, model: Model) -> Model:
        for target, value in self._changes:
            name, _, link = target.name.partition("::")
            if target.kind not in _ON_MODELS or name != model.name:
                continue
            if target.kind == "pose":
                changed = replace(model, pose=_set_pose_part(model.pose, target.part, value))
                found = not link
            elif target.kind == "mass":
                changed, found = _change_mass(model, link, _number(value))
            else:
                changed, found = _with_surface(model, link, target.kind, _number(value))
            if found:
                self._applied.add(target)
                model = changed
        return model


def _number(value: Setting) -> float:
    if isinstance(value, (int, float)):
        return float(value)
    raise TypeError(f"{value!r} is no number")


def _set_pose_part(pose: Pose, part: str, value: Setting) -> Pose:
    if not part:
        if not isinstance(value, tuple):
            raise TypeError(f"{value!r} is no pose")
        return pose_of([float(number) for number in value])
    position, angles = list(pose.position), list(rpy_from_quat(pose.orientation))
    if part in _ANGLES:
        angles[_ANGLES.index(part)] = _number(value)
        return Pose(pose.position, quat_from_rpy(*angles))
    position[_AXES.index(part)] = _number(value)
    return Pose((position[0], position[1], position[2]), pose.orientation)


def _change_mass(model: Model, link: str, mass: float) -> Tuple[Model, bool]:
    """With another mass of a link, or of all together; inertia grows with mass."""
    before = sum(found.inertial.mass for name, found in _links(model) if link in ("", name))
    if before <= 0.0:
        return model, False
    factor = mass / before

    def heavier(found: Link) -> Link:
        old = found.inertial
        return replace(found, inertial=Inertial(
            old.mass * factor, old.pose, old.ixx * factor, old.ixy * factor, old.ixz * factor,
            old.iyy * factor, old.iyz * factor, old.izz * factor))

    return _edit_link(model, link, heavier), True


def _with_surface(model: Model, link: str, kind: str, value: float) -> Tuple[Model, bool]:
    """With another friction or restitution of all collisions."""
    def other(found: Link) -> Link:
        return replace(found, collisions=[
            replace(collision, surface=_surface(collision.surface, kind, value))
            for collision in found.collisions])

    there = any(link in ("", name) for name, _ in _links(model))
    return _edit_link(model, link, other), there


def _surface(surface: Surface, kind: str, value: float) -> Surface:
    if kind == "friction":
        return replace(surface, mu=value, mu2=value)
    return replace(surface, restitution=value, bounce_threshold=0.0)


def _links(model: Model, before: str = "") -> List[Tuple[str, Link]]:
    """All links with their names inside the model, also those of nested models."""
    found = [(before + link.name, link) for link in model.links]
    for inner in model.models:
        found += _links(inner, f"{before}{inner.name}::")
    return found


def _edit_link(model: Model, link: str, change: Callable[[Link], Link], before: str = "") -> Model:
    return replace(
        model, links=[change(found) if link in ("", before + found.name) else found
               for found in model.links],
        models=[_edit_link(inner, link, change, f"{before}{inner.name}::")
                for inner in model.models])
