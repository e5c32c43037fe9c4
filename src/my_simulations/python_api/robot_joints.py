"""One model of an open world as a robot: its joints, Jacobians and inverse kinematics."""
from __future__ import annotations

from typing import Callable, Dict, Iterable, Mapping, Optional, Sequence, Tuple

import numpy as np

from ..description.model import Model
from ..errors import CommandError
from ..geometry import ZERO3, Pose, compose, inverse
from ..simulator.simulator import Simulator
from .joint_limits import JointLimits, drive_within_limits, limits_of, move_within_limits
from .kinematics import Chain, InverseKinematics, Target
from .plain_values import limit_of, name_of, nanoseconds_of, numbers_by_name, pose_of, vector_of
from .readings import JointReadings, NamedRows, joint_readings


class Robot:
    """The joints of a model; see `OpenWorld.robot`. Names of joints and links are the model's own.

    Attributes:
        name: of the model.

    Args:
        whole: gives the simulator; it raises EngineLostError.
        name: of the model. Raises CommandError if there is no such model.
    """

    def __init__(self, whole: Callable[[], Simulator], name: str) -> None:
        self._running_simulator, self.name = whole, name_of(name, "the name of a robot")
        self._chains: Dict[str, Tuple[Model, Chain]] = {}
        whole().models.get(name)

    @property
    def joints(self) -> Tuple[str, ...]:
        """The axes of the joints, in the order of the rows of `positions` and `rates`."""
        return self.positions.names

    @property
    def positions(self) -> NamedRows:
        """Positions of the axes, rad or m, as they are now."""
        return self._mine(self._read().position)

    @property
    def rates(self) -> NamedRows:
        """Rates of the axes, rad/s or m/s, as they are now."""
        return self._mine(self._read().rate)

    @property
    def efforts(self) -> NamedRows:
        """What motors, servos and controllers applied to the axes in the last step, N m or N."""
        simulator, names = self._running_simulator(), self.joints
        rows = [simulator.joints.row(self._scoped(name)) for name in names]
        return NamedRows(names, np.array(simulator.drives.efforts(rows), float))

    @property
    def applied_efforts(self) -> NamedRows:
        """The sums of applied efforts that act in the next step, N m or N; see `apply_efforts`."""
        simulator, names = self._running_simulator(), self.joints
        return NamedRows(names, np.array([simulator.wrenches.effort_sum(self._scoped(name))
                                          for name in names], float))

    def limits(self, joint: str) -> JointLimits:
        """The limits of an axis in the robot's file."""
        return limits_of(self._running_simulator(), self._scoped(joint))

    # -- changing ----------------------------------------------------------------------------------

    def set_positions(self, positions: Mapping[str, float], rates: Mapping[str, float] = {}
                      ) -> None:
        """Put axes to positions at once, within their limits; motors stay as they are.

        Args:
            positions: rad or m.
            rates: rad/s or m/s that these axes then have; 0 for those not named.
        """
        positions, rates = self._scoped_numbers(positions, "positions"), self._scoped_numbers(
            rates, "rates")
        unknown = sorted(set(rates) - set(positions))
        if unknown:
            raise CommandError(f"a rate needs a position of the same joint: {', '.join(unknown)}")
        self._running_simulator().joints.set_positions(positions, rates)

    def move(self, positions: Mapping[str, float], *, effort: Optional[float] = None,
             rate: Optional[float] = None) -> None:
        """Move axes to positions and hold them there, until another call.

        Args:
            positions: rad or m.
            effort: most that each motor spends, N m or N; None for the limit of the robot's file.
            rate: fastest that each axis moves, rad/s or m/s; None for the limit of the file.
        """
        move_within_limits(
            self._running_simulator(), self._scoped_numbers(positions, "positions"),
            limit_of(effort, "effort"), limit_of(rate, "rate"))

    def drive(self, rates: Mapping[str, float], *, effort: Optional[float] = None) -> None:
        """Drive axes at rates, until another call.

        Args:
            rates: rad/s or m/s.
            effort: most that each motor spends, N m or N; None for the limit of the robot's file.
        """
        drive_within_limits(self._running_simulator(), self._scoped_numbers(rates, "rates"),
                            limit_of(effort, "effort"))

    def apply_efforts(self, efforts: Mapping[str, float], *, duration: Optional[float] = None
                      ) -> None:
        """Apply efforts to axes from the next step on; they add to others.

        Args:
            efforts: N m or N.
            duration: s of sim time; None for until `clear_efforts` or a reset of the world.
        """
        for name, effort in self._scoped_numbers(efforts, "efforts").items():
            self._running_simulator().wrenches.apply_effort(
                name, effort, duration_ns=nanoseconds_of(duration))

    def clear_efforts(self, joints: Iterable[str] = ()) -> None:
        """End the applied efforts on some joints, or on all."""
        for name in tuple(joints) or self.joints:
            self._running_simulator().wrenches.clear_efforts(self._scoped(name))

    def release(self, joints: Iterable[str] = ()) -> None:
        """Switch off what `move` and `drive` have set, for some joints or for all."""
        for name in tuple(joints) or self.joints:
            self._running_simulator().drives.release_axis(self._scoped(name))

    # -- kinematics --------------------------------------------------------------------------------

    def jacobian(self, link: str, point: Sequence[float] = ZERO3) -> np.ndarray:
        """Return the derivative of the twist of a link by the rates of the joints.

        The base of the robot counts as fixed. A joint that mimics another has a column of its own.

        Args:
            link: of the robot.
            point: of the link whose velocity is meant, m in its frame.

        Returns:
            Shape (6, joints), in the order of `joints`: m/s of the point and rad/s, along the axes
            of the world.
        """
        chain, now = self._chain(link), self.positions
        found = np.zeros((6, len(now)))
        found[:, [now.names.index(name) for name in chain.joints]] = chain.jacobian(
            chain.poses(dict(zip(now.names, now.array.tolist()))), self._pose(link),
            vector_of(point, "point"))
        return found

    def inverse_kinematics(self, link: str, pose: Sequence[float], *,
                           joints: Sequence[str] = (), point: Sequence[float] = ZERO3,
                           tolerance: float = 1e-4) -> Dict[str, float]:
        """Return positions of joints, within their limits, at which a link reaches a pose.

        Nothing moves: give the result to `set_positions` or `move`.

        Args:
            link: of the robot.
            pose: in the world; 3 numbers for a position with any orientation, else as everywhere.
            joints: that may move; none for all.
            point: of the link that reaches the position, m in its frame.
            tolerance: m, and rad of the orientation.

        Raises:
            CommandError: no positions are found; the message has the smallest error.
        """
        model = self._running_simulator().models.get(self.name)
        chain, now = self._chain(link), self.positions
        positions = dict(zip(now.names, now.array.tolist()))
        root = compose(self._pose(link), inverse(chain.poses(positions).last))
        wanted = pose_of(pose)
        target = Target(wanted.position, wanted.orientation if len(pose) > 3 else None,
                        vector_of(point, "point"), float(tolerance))
        return InverseKinematics(chain, model, tuple(joints) or self.joints).solve(
            root, positions, target)

    # -- inside ------------------------------------------------------------------------------------

    def _chain(self, link: str) -> Chain:
        """The chain to a link; chains are kept while the model is the same."""
        model = self._running_simulator().models.get(self.name)
        found = self._chains.get(link)
        if found is None or found[0] is not model:
            found = self._chains[link] = model, Chain(model, link)
        return found[1]

    def _pose(self, link: str) -> Pose:
        """The pose of a link now, in the world."""
        return self._running_simulator().states.link_state(self._scoped(link))[0]

    def _read(self) -> JointReadings:
        return joint_readings(*self._running_simulator().states.latest())

    def _mine(self, rows: NamedRows) -> NamedRows:
        begin = f"{self.name}::"
        at = [n for n, name in enumerate(rows.names) if name.startswith(begin)]
        return NamedRows([rows.names[n][len(begin):] for n in at], rows.array[at])

    def _scoped_numbers(self, values: Mapping[str, float], what: str) -> Dict[str, float]:
        return {self._scoped(name): value
                for name, value in numbers_by_name(values, what).items()}

    def _scoped(self, name: str) -> str:
        return f"{self.name}::{name}"
