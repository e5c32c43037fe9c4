"""Joint motors, planar velocities and wheel slips, which the engine applies in every step."""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from ..engine.commands import Batch, Command
from ..engine.drive_commands import (
    JointMotor,
    JointServo,
    PlanarVelocity,
    ReadEfforts,
    SetMotors,
    SetPlanarVelocities,
    SetServos,
    SetWheelSlips,
    WheelSlip,
)
from ..errors import CommandError
from ..geometry import is_finite
from .entity import Entity
from .session import Session


@dataclass(frozen=True)
class DriveSettings:
    """All drives: joint motors, planar velocities, joint servos and wheel slips."""

    motors: Tuple[JointMotor, ...] = ()
    planar: Tuple[PlanarVelocity, ...] = ()
    servos: Tuple[JointServo, ...] = ()
    slips: Tuple[WheelSlip, ...] = ()

    def commands(self) -> List[Command]:
        """Commands that set the drives in an engine without any."""
        kinds = ((SetMotors, self.motors), (SetPlanarVelocities, self.planar),
                 (SetServos, self.servos), (SetWheelSlips, self.slips))
        return [make(drives) for make, drives in kinds if drives]   # type: ignore[arg-type]


class Drives:
    """Owns joint motors, joint servos, planar velocities and wheel slips.

    Changes hold the structure lock.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._motors: Dict[int, JointMotor] = {}
        self._planar: Dict[int, PlanarVelocity] = {}
        self._servos: Dict[int, JointServo] = {}
        self._slips: Dict[int, WheelSlip] = {}

    def set_wheel_slips(self, wheels: Sequence[WheelSlip]) -> None:
        """Let wheels slip in proportion to their speed, until a reset; others stay.

        Raises CommandError when a link or joint is not there.
        """
        with self._session.structure_lock:
            self._session.call(SetWheelSlips(tuple(wheels)))
            self._slips.update({wheel.row: wheel for wheel in wheels})

    def set(self, motors: Sequence[JointMotor] = (),
            planar: Sequence[PlanarVelocity] = (), revision: Optional[int] = None,
            servos: Sequence[JointServo] = (), at_once: bool = True) -> bool:
        """Set motors and servos by joint row, planar velocities by model id; others stay.

        A command with motors only is posted: the engine applies it before later commands, and
        before steps that a plugin host allows later.

        Args:
            motors: joint motors by row; rate in rad/s or m/s, maximum effort in N m or N.
            planar: planar velocities by model id, m/s and rad/s.
            revision: `Models.revision` when the rows were looked up.
            servos: joint servos by row; one with an empty `drive` ends the servo.
            at_once: False to send motors with the next message, if no step precedes that.

        Returns:
            False if the models have changed since then; nothing is set.

        Raises CommandError if a joint does not exist.
        """
        with self._session.structure_lock:
            if revision is not None and revision != self._session.registry.revision:
                return False
            servos = self._with_ended_holds(motors, servos)
            commands: List[Command] = []
            new = [motor for motor in motors if self._motors.get(motor.row) != motor]
            if new:
                commands.append(SetMotors(tuple(new)))
            moved = {one.model_id: one for one in planar}
            if any(self._planar.get(number) != one for number, one in moved.items()):
                commands.append(SetPlanarVelocities(tuple({**self._planar, **moved}.values())))
            steered = [servo for servo in servos if self._servos.get(servo.row) != servo]
            if steered:
                commands.append(SetServos(tuple(steered)))
            if not commands:
                return True
            command = Batch(tuple(commands)) if len(commands) > 1 else commands[0]
            if not (isinstance(command, SetMotors)
                    and self._session.supervisor.post(command, at_once)):
                self._session.call(command)
            self._motors.update({motor.row: motor for motor in new})
            self._planar.update(moved)
            self._store_servos(steered)
            return True

    def _with_ended_holds(self, motors: Sequence[JointMotor],
                          servos: Sequence[JointServo]) -> List[JointServo]:
        """Servos, and the ends of those that hold axes which motors drive.

        A motor continues if a new servo only stops its axis, as those of unused ros_control joints.
        """
        if not motors and not any(servo.holds or _only_stops(servo) for servo in servos):
            return list(servos)
        now = {**self._motors, **{motor.row: motor for motor in motors}}
        driven = {row for row, motor in now.items() if motor.effort > 0.0}
        return [*(servo for servo in servos if not (servo.row in driven and (
            servo.holds or _only_stops(servo) and servo.row not in self._servos))),
                *(JointServo(row, "") for row, servo in self._servos.items()
                  if servo.holds and row in driven)]

    def drive_axes(self, rates: Mapping[str, Tuple[float, float]]) -> None:
        """Drive axes, given by name, in one command; with an error none of them.

        Args:
            rates: the rate (rad/s or m/s) of each axis, and the largest effort (N m or N).

        Raises CommandError: no such joint, or numbers that are not finite.
        """
        with self._session.structure_lock:
            motors = [JointMotor(self._session.axis_row(joint), *_finite(*values))
                      for joint, values in rates.items()]
            ended = [JointServo(motor.row, "") for motor in motors if motor.row in self._servos]
            if ended:
                self.set(servos=ended)
            # A paused world goes on with another message, which takes the motors along.
            self.set(motors, at_once=self._session.ring.running)

    def hold_axes(self, positions: Mapping[str, Tuple[float, float, float]]) -> None:
        """Move axes, given by name, to positions in one command and hold them there.

        Args:
            positions: the position (rad or m) of each axis, the largest effort (N m or N), and the
                largest rate (rad/s or m/s, infinite for any).

        Raises CommandError: no such joint, or a number that cannot be used; no axis moves then.
        """
        with self._session.structure_lock:
            servos = []
            for joint, (position, effort, rate) in positions.items():
                row = self._session.axis_row(joint)
                target, limit = _finite(position, effort)
                if math.isnan(rate):
                    raise CommandError("a joint's rate must be a number, not NaN")
                servos.append(JointServo(row, "position", target, most_rate=rate,
                                         most_effort=limit))
            self.set(servos=servos)

    def release_axis(self, joint: str) -> None:
        """Switch off motor and servo of an axis, given by name. Raises CommandError."""
        with self._session.structure_lock:
            row = self._session.axis_row(joint)
            if row in self._servos:
                self.set(servos=[JointServo(row, "")])
            if row in self._motors:
                self.set([JointMotor(row, 0.0, 0.0)])

    def efforts(self, rows: Sequence[int]) -> List[float]:
        """What servos and motors spent on joint axes in the last step, N m or N.

        Raises CommandError.
        """
        found: Any = self._session.call(ReadEfforts(tuple(rows))).value
        return list(found)

    def stop(self, entity: Entity) -> None:
        """Switch off the motors and the planar velocity of a model."""
        with self._session.structure_lock:
            mine = [motor for row, motor in self._motors.items() if entity.has_joint_row(row)]
            commands: List[Command] = []
            if mine:
                commands.append(SetMotors(tuple(replace(motor, effort=0.0) for motor in mine)))
            if entity.model_id in self._planar:
                commands.append(SetPlanarVelocities(tuple(
                    one for number, one in self._planar.items() if number != entity.model_id)))
            steered = [servo for row, servo in self._servos.items() if entity.has_joint_row(row)]
            if steered:
                commands.append(SetServos(tuple(replace(servo, drive="") for servo in steered)))
            self.forget_entity(entity)
            if commands:
                self._session.call(Batch(tuple(commands)))

    # -- for the other parts, which hold the structure lock ----------------------------------------

    @property
    def settings(self) -> DriveSettings:
        return DriveSettings(tuple(self._motors.values()), tuple(self._planar.values()),
                             tuple(self._servos.values()), tuple(self._slips.values()))

    def replace_all(self, settings: DriveSettings = DriveSettings()) -> None:
        """Store drives that the engine has already."""
        self._motors = {motor.row: motor for motor in settings.motors}
        self._planar = {one.model_id: one for one in settings.planar}
        self._servos = {servo.row: servo for servo in settings.servos}
        self._slips = {wheel.row: wheel for wheel in settings.slips}

    def forget_entity(self, entity: Entity) -> None:
        """Remove the drives of a model that was deleted from the engine."""
        self._planar.pop(entity.model_id, None)
        for row in entity.joint_rows:
            self._motors.pop(row, None)
            self._servos.pop(row, None)
        for row in entity.link_ids:
            self._slips.pop(row, None)

    def transfer_to_successor(self, old: Entity, new: Entity) -> DriveSettings:
        """Return the drives of a replaced model as those of its successor `new`.

        The planar velocities are those of all models, if the model has one.
        """
        links, axes = old.rows_in(new)
        planar = self._planar.get(old.model_id)
        return DriveSettings(
            tuple(replace(motor, row=axes[row]) for row, motor in self._motors.items()
                  if row in axes),
            () if planar is None else (
                *(one for one in self._planar.values() if one is not planar),
                replace(planar, model_id=new.model_id)),
            tuple(replace(servo, row=axes[row]) for row, servo in self._servos.items()
                  if row in axes),
            tuple(replace(wheel, row=links[row], joint_row=axes[wheel.joint_row])
                  for row, wheel in self._slips.items()
                  if row in links and wheel.joint_row in axes))

    def store_transferred(self, moved: DriveSettings) -> None:
        """Store the result of `transfer_to_successor`, after the engine has these drives."""
        self._motors.update({motor.row: motor for motor in moved.motors})
        if moved.planar:
            self._planar = {one.model_id: one for one in moved.planar}
        self._slips.update({wheel.row: wheel for wheel in moved.slips})
        self._store_servos(moved.servos)

    def _store_servos(self, servos: Sequence[JointServo]) -> None:
        for servo in servos:
            if servo.drive:
                self._servos[servo.row] = servo
            else:
                self._servos.pop(servo.row, None)


def _finite(first: float, second: float) -> Tuple[float, float]:
    if not is_finite(first, second):
        raise CommandError("rate and effort of a motor must be finite")
    return first, second


def _only_stops(servo: JointServo) -> bool:
    """Whether a servo is a motor with the rate 0, without loops."""
    return servo.drive == "velocity" and servo.target == 0.0 and (
        servo.spline is None and servo.gains is None and servo.drive_gains is None)
