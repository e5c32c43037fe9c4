"""What an editor does to a world: each operation carries itself out and answers with its inverse.

An inverse restores what the operation has changed, not the world of that time: what physics or
others did meanwhile stays.
"""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Callable, Dict, List, Optional, Protocol, Tuple

from ..description.light import Light
from ..description.model import Joint, Model
from ..description.scoped_names import split_scoped
from ..description.shapes import MeshTable
from ..description.world import Physics
from ..engine.commands import ModelState
from ..errors import CommandError
from ..geometry import STILL, ZERO3, Pose, Vec3, rotate, subtract
from .inter_model_joints import DeletedModel
from .order_slot import OrderSlot
from .scene import SceneSettings
from .simulator import Simulator
from .world_state import WorldState
from .wrenches import Effort


class Operation(Protocol):
    """One change."""

    def apply(self, world: Simulator) -> "Operation":
        """Carry it out; returns what undoes it. Raises CommandError, then nothing has changed."""


@dataclass(frozen=True)
class Group:
    """Several as one: all of them or none."""

    parts: Tuple[Operation, ...]

    def apply(self, world: Simulator) -> Operation:
        """In order; undone in the opposite order."""
        done: List[Operation] = []
        for part in self.parts:
            try:
                done.append(part.apply(world))
            except CommandError:
                for inverse in reversed(done):
                    inverse.apply(world)
                raise
        return Group(tuple(reversed(done)))


@dataclass(frozen=True)
class AddModel:
    """A model comes, at `pose`, or with the state it had; or it comes back."""

    model: Model
    pose: Pose
    meshes: MeshTable = field(default_factory=dict)
    state: Optional[ModelState] = None
    deleted: Optional[DeletedModel] = None

    def apply(self, world: Simulator) -> Operation:
        """Put it in."""
        world.models.spawn(self.model, self.pose, meshes=self.meshes, state=self.state,
                           deleted=self.deleted)
        return RemoveModel(self.model.name)


@dataclass(frozen=True)
class RemoveModel:
    """A model goes."""

    name: str

    def apply(self, world: Simulator) -> Operation:
        """Take it out, remembering where everything of it was."""
        world.models.get(self.name)  # says when there is none
        entities, snapshot = world.states.latest()
        entity = next(one for one in entities if one.model.name == self.name)
        state = entity.saved(snapshot) if entity.link_names else None
        pose = entity.pose
        back = AddModel(entity.model, entity.initial_pose, entity.meshes, state,
                        world.models.delete(self.name))
        return back if state is not None else Group((back, SetPoses({self.name: pose})))


@dataclass(frozen=True)
class EditModel:
    """A model gets another description, perhaps another name."""

    name: str
    model: Model
    meshes: MeshTable = field(default_factory=dict)

    def apply(self, world: Simulator) -> Operation:
        """Change it; states stay."""
        old = world.models.get(self.name)
        world.models.edit(self.name, self.model, self.meshes)
        return EditModel(self.model.name, old)


@dataclass(frozen=True)
class EditJoint:
    """A joint of `model` gets other properties."""

    model: str
    joint: Joint

    def apply(self, world: Simulator) -> Operation:
        """Change it in place where the engine can."""
        scoped = f"{self.model}::{self.joint.name}"
        _, old, _ = world.joints.find(scoped)
        world.joints.edit(scoped, self.joint)
        return EditJoint(self.model, old)


@dataclass(frozen=True)
class SetPoses:
    """Models, lights and links (`model::link`) go to world poses, at rest.

    `before`: where they were, when that is not where they are (a drag moved them already).
    """

    poses: Dict[str, Pose]
    before: Dict[str, Pose] = field(default_factory=dict)

    def apply(self, world: Simulator) -> Operation:
        """Move them all; those before one that cannot be moved go back."""
        done: Dict[str, Pose] = {}
        try:
            for name, pose in self.poses.items():
                was = pose_of(world, name)
                place(world, name, pose)
                done[name] = was
        except CommandError:
            for name, pose in done.items():
                place(world, name, pose)
            raise
        before = {name: pose for name, pose in self.before.items() if name in done}
        return SetPoses({**done, **before})


def pose_of(world: Simulator, name: str) -> Pose:
    """World pose of a model, light or link. Raises CommandError for none of them."""
    if world.models.has(name):
        return world.states.model_state(name)[0]
    for light in world.lights.all():
        if light.name == name:
            return light.pose
    if "::" not in name:
        world.models.get(name)  # says that there is none
    return world.states.link_state(name)[0]


def place(world: Simulator, name: str, pose: Pose) -> None:
    """Put a model, light or link at a world pose, at rest. Raises CommandError."""
    if world.models.has(name):
        world.states.set_model_state(name, pose, STILL)
    elif any(light.name == name for light in world.lights.all()):
        world.lights.set(name, replace(world.lights.get(name), pose=pose))
    elif "::" in name:
        world.states.set_link_state(name, pose, STILL)
    else:
        world.models.get(name)


@dataclass(frozen=True)
class AddLight:
    """A light comes: last, or where its turn is."""

    light: Light
    slot: Optional[OrderSlot] = None

    def apply(self, world: Simulator) -> Operation:
        """Put it in."""
        world.lights.add(self.light, slot=self.slot)
        return RemoveLight(self.light.name)


@dataclass(frozen=True)
class RemoveLight:
    """A light goes."""

    name: str

    def apply(self, world: Simulator) -> Operation:
        """Take it out."""
        names = [light.name for light in world.lights.all()]
        return AddLight(world.lights.delete(self.name), OrderSlot.of(names, self.name))


@dataclass(frozen=True)
class EditLight:
    """A light gets other properties, perhaps another name."""

    name: str
    light: Light

    def apply(self, world: Simulator) -> Operation:
        """Change it."""
        old = world.lights.get(self.name)
        world.lights.set(self.name, self.light)
        return EditLight(self.light.name, old)


@dataclass(frozen=True)
class SetPhysics:
    """Other physics settings and gravity."""

    physics: Physics
    gravity: Vec3

    def apply(self, world: Simulator) -> Operation:
        """Set both."""
        back = SetPhysics(world.physics.settings, world.physics.gravity)
        world.physics.set(self.physics, self.gravity)
        return back


SETTERS: Dict[str, Callable[[SceneSettings, Any], None]] = {
    "scene": SceneSettings.set_scene, "gui_camera": SceneSettings.set_gui_camera,
    "wind": SceneSettings.set_wind, "atmosphere": SceneSettings.set_atmosphere,
    "magnetic_field": SceneSettings.set_magnetic_field,
    "spherical_coordinates": SceneSettings.set_spherical_coordinates,
}
"""Fields of a world besides models, lights and physics, and what sets them."""


@dataclass(frozen=True)
class SetWorldField:
    """Another value of one of `SETTERS`."""

    name: str
    value: Any

    def apply(self, world: Simulator) -> Operation:
        """Set it."""
        back = SetWorldField(self.name, getattr(world.world, self.name))
        SETTERS[self.name](world.scene, self.value)
        return back


@dataclass(frozen=True)
class RestoreState:
    """States as they were at a moment."""

    moment: WorldState

    def apply(self, world: Simulator) -> Operation:
        """Put them back."""
        back = RestoreState(world.states.capture())
        world.states.restore(self.moment)
        return back


@dataclass(frozen=True)
class Reset:
    """`what`: time, poses (of models), or world (all of it, as loaded)."""

    what: str

    def apply(self, world: Simulator) -> Operation:
        """Reset it."""
        back = RestoreState(world.states.capture())
        {"time": world.resets.reset_time, "poses": world.resets.reset_world,
         "world": world.resets.reset_simulation}[self.what]()
        return back


@dataclass(frozen=True)
class ApplyWrench:
    """A wrench on a link for some steps.

    `point`: of attack in the link frame, m; None for the centre of mass. Force (N) and torque (N m)
    in world axes, or in the link's, with which they turn then.
    """

    link: str
    force: Vec3
    torque: Vec3
    point: Optional[Vec3]
    in_link_axes: bool
    steps: int

    def apply(self, world: Simulator) -> Operation:
        """Push the link; undone, the model is where it was, as fast as it was."""
        name, plain = split_scoped(self.link, world.models.has)
        model = world.models.get(name)
        com = next((link.inertial.pose.position for link in model.links if link.name == plain),
                   None)
        pose, _ = world.states.link_state(self.link)
        back = world.states.capture()
        if com is None:
            raise CommandError(f"unknown link '{self.link}'")
        lever = ZERO3 if self.point is None else subtract(self.point, com)
        duration = round(self.steps * world.physics.settings.max_step_size * 1e9)
        if self.in_link_axes:
            at = com if self.point is None else self.point
            world.wrenches.apply_wrench(self.link, self.force, self.torque, frame=self.link,
                                        point=at, duration_ns=duration)
        else:
            world.wrenches.apply_wrench(self.link, self.force, self.torque, duration_ns=duration,
                                        point=rotate(pose.orientation, lever))
        return _RestoreModel(WorldState(back.step, back.sim_ns, {name: back.models[name]}), self)


@dataclass(frozen=True)
class _RestoreModel:
    """Undoes a push: states go back, the clock does not; its own inverse is the push again."""

    moment: WorldState
    wrench: ApplyWrench

    def apply(self, world: Simulator) -> Operation:
        """Put the model back."""
        world.states.restore(self.moment, clock=False)
        return self.wrench


@dataclass(frozen=True)
class DriveJoint:
    """What drives a joint axis until something else does; nothing lets go of it."""

    joint: str
    efforts: Tuple[Effort, ...] = ()

    def apply(self, world: Simulator) -> Operation:
        """Replace what drives it."""
        before = world.wrenches.efforts_on(self.joint)
        world.wrenches.clear_efforts(self.joint)
        for effort in self.efforts:
            world.wrenches.apply_effort(self.joint, effort)
        return DriveJoint(self.joint, before)
