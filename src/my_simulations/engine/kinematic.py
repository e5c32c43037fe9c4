"""A backend that moves nothing by itself but what has a velocity: for tests without PyBullet."""
from __future__ import annotations

import struct
from typing import Dict, List, Tuple

from ..description.model import Model
from ..geometry import Pose, Quat, add, compose, inverse, multiply, normalised, scale
from .api import (
    AddLoads,
    Clear,
    ClearLoads,
    Command,
    Event,
    LinkState,
    LoadModel,
    PhysicsSettings,
    Refused,
    RemoveModel,
    SetJoints,
    SetLinkState,
    SetModelState,
)
from .ring import JOINT_WIDTH, LINK_WIDTH
from .rows import axis_rows

_LINK = struct.Struct(f"={LINK_WIDTH}d")


class KinematicBackend:
    """Links fly straight on with their twists; no gravity, no contacts; loads are counted only."""

    def __init__(self) -> None:
        self.settings = PhysicsSettings()
        self.links: Dict[int, LinkState] = {}
        self.joints: Dict[int, Tuple[float, float]] = {}
        self.models: Dict[int, Tuple[Model, int, int, bool]] = {}
        self.loads: Dict[int, object] = {}
        self._dirty = True

    def apply(self, command: Command) -> object:
        """Carry out a command; raises `Refused`."""
        self._dirty = True
        if isinstance(command, LoadModel):
            self._load(command)
        elif isinstance(command, RemoveModel):
            self._remove(command.model_id)
        elif isinstance(command, Clear):
            for model_id in list(self.models):
                self._remove(model_id)
            self.loads.clear()
        elif isinstance(command, SetModelState):
            self._set_model(command)
        elif isinstance(command, SetLinkState):
            self.links[command.row] = LinkState(command.pose, command.twist or self.links[
                command.row].twist)
        elif isinstance(command, SetJoints):
            self.joints.update({row: (position, rate) for row, position, rate in command.joints})
        elif isinstance(command, AddLoads):
            self.loads.update({load.load_id: load for load in command.loads})
        elif isinstance(command, ClearLoads):
            for load_id in command.load_ids:
                self.loads.pop(load_id, None)
        else:
            raise Refused(f"a kinematic world knows no {type(command).__name__}")
        return None

    def configure(self, settings: PhysicsSettings) -> None:
        """Only the step size matters."""
        self.settings = settings

    def step(self, first: int, count: int) -> None:
        """Move every link along its twist."""
        span = self.settings.step_size * count
        for row, state in self.links.items():
            pose, twist = state.pose, state.twist
            spin: Quat = (*scale(twist.angular, span / 2.0), 1.0)
            self.links[row] = LinkState(
                Pose(add(pose.position, scale(twist.linear, span)),
                     normalised(multiply(spin, pose.orientation))), twist)
            self._dirty = self._dirty or any(twist.linear) or any(twist.angular)

    def read(self) -> bool:
        """Whether something may have changed."""
        dirty, self._dirty = self._dirty, False
        return dirty

    def tables(self) -> Tuple[memoryview, memoryview]:
        """The used rows."""
        links = bytearray(_LINK.size * (max(self.links, default=-1) + 1))
        for row, state in self.links.items():
            _LINK.pack_into(links, row * _LINK.size, *state.pose.position,
                            *state.pose.orientation, *state.twist.linear, *state.twist.angular)
        joints = bytearray(8 * JOINT_WIDTH * (max(self.joints, default=-1) + 1))
        for row, values in self.joints.items():
            struct.pack_into("=2d", joints, row * 8 * JOINT_WIDTH, *values)
        return memoryview(links), memoryview(joints)

    def events(self) -> List[Event]:
        """Nothing ever happens by itself."""
        return []

    def close(self) -> None:
        """Nothing to give back."""

    def _load(self, command: LoadModel) -> None:
        model = command.model
        self.models[command.model_id] = (model, command.first_link_row, command.first_joint_row,
                                         model.static)
        for n, link in enumerate(model.links):
            state = LinkState(compose(command.pose, link.pose))
            self.links[command.first_link_row + n] = (
                command.state.links[n] if command.state else state)
        for n, _ in enumerate(axis_rows(model)):
            self.joints[command.first_joint_row + n] = (
                command.state.joints[n] if command.state else (0.0, 0.0))

    def _remove(self, model_id: int) -> None:
        if model_id not in self.models:
            raise Refused("the model is not there any more")
        model, first_link, first_joint, _ = self.models.pop(model_id)
        for n in range(len(model.links)):
            del self.links[first_link + n]
        for n in range(len(axis_rows(model))):
            del self.joints[first_joint + n]

    def _set_model(self, command: SetModelState) -> None:
        if command.model_id not in self.models:
            raise Refused("the model is not there any more")
        model, first, _, static = self.models[command.model_id]
        wanted = command.pose
        if command.frame is not None:
            at = compose(self.links[command.frame.row].pose, command.frame.offset)
            wanted = compose(at, wanted)
        current = compose(self.links[first].pose, inverse(model.links[0].pose))
        for n in range(len(model.links)):
            old = self.links[first + n]
            twist = old.twist if command.twist is None or static else command.twist
            self.links[first + n] = LinkState(
                compose(wanted, compose(inverse(current), old.pose)), twist)
