"""Changes of an open world: models that come, go and move; forces; joints that are driven."""
from __future__ import annotations

import os
from typing import Dict, Optional, Sequence, Union

from ..errors import CommandError
from ..formats.reading import Text
from ..geometry import ZERO3, Twist
from ..simulator.simulator import Simulator
from .furnishing import Furnisher
from .joint_limits import drive_within_limits, move_within_limits
from .plain_values import (
    limit_of,
    name_of,
    nanoseconds_of,
    number_of,
    pose_of,
    twist_of,
    vector_of,
)
from .robot_joints import Robot
from .robots import Robots

FilePath = Union[str, "os.PathLike[str]"]


class WorldChanges:
    """The methods of `OpenWorld` that change the world."""

    simulator: Simulator
    _furnisher: Furnisher
    _robots: Robots
    _joints_of: Dict[str, Robot]

    def _running_simulator(self) -> Simulator:
        """The simulator, whose engine was not lost. Raises EngineLostError."""
        raise NotImplementedError

    def spawn(self, document: Union[Text, FilePath], name: Optional[str] = None,
              pose: Sequence[float] = ZERO3, *, namespace: str = "") -> str:
        """Put a model into the world, and load its plugins; returns its name.

        Args:
            document: path of a URDF or SDF file, or its text.
            name: in the world; None for the document's own.
            pose: of the model; a pose of the document's own comes on top, as in Gazebo.
            namespace: `<robotNamespace>` of the plugins that set none, as `-robot_namespace` of
                `spawn_model`, which gives "/" unless told otherwise; "" leaves the plugins as they
                are, most of them below the model's name.

        Raises:
            InputError: the document has no usable model.
        """
        if not isinstance(document, (str, bytes, os.PathLike)):
            raise CommandError("the document of a model is the path or the text of a URDF or SDF,"
                               f" not {document!r}")
        text = os.fspath(document)  # which leaves texts as they are
        name = self._furnisher.spawn(self._running_simulator(), text, name, pose_of(pose),
                                     lambda model: model, namespace)
        self._robots.wait_until_loaded()
        return name

    def remove(self, name: str) -> None:
        """Take a model out of the world."""
        self._running_simulator().models.delete(name)

    def set_pose(self, name: str, pose: Sequence[float], twist: Optional[Sequence[float]] = None
                 ) -> None:
        """Move a model, or a link of one (`model::link`).

        Args:
            name: of the model or link.
            pose: of its frame.
            twist: m/s and rad/s (vx vy vz wx wy wz) that it then has; None for at rest.
        """
        speed = Twist() if twist is None else twist_of(twist)
        states = self._running_simulator().states
        if self.simulator.models.has(name):
            states.set_model_state(name, pose_of(pose), speed)
        else:
            states.set_link_state(name, pose_of(pose), speed)

    def apply_wrench(self, link: str, force: Sequence[float] = ZERO3,
                     torque: Sequence[float] = ZERO3, *, duration: Optional[float] = None,
                     frame: str = "", point: Sequence[float] = ZERO3) -> None:
        """Push and turn a link from the next step on.

        Args:
            link: the link.
            force: N, at the centre of mass unless `point` says where else.
            torque: N m.
            duration: s of sim time; None for until the world is reset.
            frame: model or link along whose axes all is given, and with which it turns then; ""
                for the world.
            point: m from the centre of mass, or from the frame's origin where one is given.
        """
        self._running_simulator().wrenches.apply_wrench(
            link, vector_of(force, "force"), vector_of(torque, "torque"), frame=frame,
            point=vector_of(point, "point"), duration_ns=nanoseconds_of(duration))

    def apply_effort(self, joint: str, effort: float, *, duration: Optional[float] = None) -> None:
        """Drive a joint axis by a torque (N m) or force (N) from the next step on.

        Args:
            joint: the joint.
            effort: adds to others on the same axis.
            duration: s of sim time; None for until the world is reset.
        """
        self._running_simulator().wrenches.apply_effort(
            joint, number_of(effort, "effort"), duration_ns=nanoseconds_of(duration))

    def drive_joint(self, joint: str, rate: float, effort: float) -> None:
        """Drive a joint axis at a rate by a motor of limited effort, until another call.

        Args:
            joint: the joint.
            rate: rad/s or m/s.
            effort: most that the motor spends, N m or N.
        """
        drive_within_limits(self._running_simulator(), {joint: number_of(rate, "rate")},
                            limit_of(effort, "effort"))

    def move_joint(self, joint: str, position: float, effort: Optional[float] = None,
                   rate: Optional[float] = None) -> None:
        """Move a joint axis to a position and hold it there, until another call.

        Args:
            joint: the joint.
            position: rad or m.
            effort: most that the motor spends, N m or N; None for the limit of the joint's file.
            rate: fastest that it moves, rad/s or m/s; None for the limit of the file, if it has
                one.
        """
        move_within_limits(self._running_simulator(), {joint: number_of(position, "position")},
                           limit_of(effort, "effort"), limit_of(rate, "rate"))

    def release_joint(self, joint: str) -> None:
        """Switch off what `drive_joint` or `move_joint` has set."""
        self._running_simulator().drives.release_axis(joint)

    def robot(self, name: str) -> Robot:
        """The joints of a model: positions, efforts, motors, Jacobians, inverse kinematics."""
        return self._joints_of.setdefault(name, Robot(self._running_simulator, name))

    def attach(self, name: str, parent: str, child: str) -> None:
        """Fix a link to another one, or to the `world`, as they are now.

        Args:
            name: of the fixed joint, for `detach`.
            parent: the link, as `model::link`; or `world`.
            child: a link of another model.

        Raises CommandError, also while a joint of that name attaches something.
        """
        for value, what in ((name, "joint"), (parent, "parent"), (child, "child")):
            name_of(value, f"the name of the {what}")
        models = self._running_simulator().models
        for one in models.attachments(name):
            raise CommandError(f"the joint '{name}' attaches '{one.child}' to '{one.parent}':"
                               " detach it, or choose another name")
        models.attach(name, parent, child)

    def detach(self, name: str) -> None:
        """Remove a joint that `attach` has made."""
        if not self._running_simulator().models.detach(name):
            raise CommandError(f"nothing is attached by a joint '{name}'")
