"""What is read from a world, as NumPy arrays whose rows have names."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Dict, Iterator, Mapping, Optional, Sequence, Tuple

import numpy as np

from ..engine.commands import Contact
from ..engine.ring import JOINT_WIDTH, LINK_WIDTH, Snapshot
from ..geometry import IDENTITY, Pose, Twist
from ..simulator.entity import Entity
from ..simulator.exact_states import ExactState

POSE_WIDTH, TWIST_WIDTH = 7, 6


class NamedRows(Mapping[str, np.ndarray]):
    """Rows of an array by name, as views: `rows["robo::base_link"]`.

    Attributes:
        names: in the order of the rows.
        array: shape (names, width), or (names,) where a row is one number.
    """

    def __init__(self, names: Sequence[str], array: np.ndarray,
                 rows: Optional[Mapping[str, int]] = None) -> None:
        """`rows`: the row of each name, if it is known."""
        self.names: Tuple[str, ...] = tuple(names)
        self.array = array
        if rows is not None:
            self._rows = rows

    @cached_property
    def _rows(self) -> Mapping[str, int]:
        return {name: row for row, name in enumerate(self.names)}

    def __getitem__(self, name: str) -> np.ndarray:
        row = self._rows.get(name)
        if row is None:
            raise KeyError(f"there is no row {name!r}; rows are {', '.join(self.names) or 'none'}")
        return self.array[row]

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f"NamedRows({dict(self)!r})"


@dataclass(frozen=True)
class Readings:
    """Where models or links are, and how they move, at one time.

    The arrays are copies of that time: later steps do not change them.

    Attributes:
        time: sim time in s.
        pose: rows (x, y, z, qx, qy, qz, qw): metres and a unit quaternion, of the model's or
            link's frame in the world frame.
        twist: rows (vx, vy, vz, wx, wy, wz): m/s at the frame's origin and rad/s, along the axes
            of the world. That of a model is that of its canonical link.
    """

    time: float
    pose: NamedRows
    twist: NamedRows

    @property
    def names(self) -> Tuple[str, ...]:
        """The models, or the links as `model::link`, in the order of the rows."""
        return self.pose.names


@dataclass(frozen=True)
class JointReadings:
    """Positions and rates of all joint axes at one time.

    Attributes:
        time: sim time in s.
        position: rad of a revolute axis, m of a prismatic one, by `model::joint`; the axes of a
            joint with several are `model::joint`, `model::joint::1` and so on.
        rate: rad/s or m/s.
    """

    time: float
    position: NamedRows
    rate: NamedRows

    @property
    def names(self) -> Tuple[str, ...]:
        """The axes, in the order of the rows."""
        return self.position.names


@dataclass(frozen=True)
class ContactReading:
    """One contact point of the last step.

    Attributes:
        links: the scoped names of both links.
        position: (3,) m, world frame, on the second link.
        normal: (3,) unit vector along which the first link is pushed, world frame.
        depth: m, how far the links overlap; negative where they press each other
            across a gap.
        force: N along the normal.
        friction: (3,) N across the normal, on the first link, world frame.
    """

    links: Tuple[str, str]
    position: np.ndarray
    normal: np.ndarray
    depth: float
    force: float
    friction: np.ndarray


@dataclass(frozen=True)
class SavedState:
    """What `OpenWorld.save` keeps.

    Included: sim time, step size, solver and gravity; the models with their poses, twists and
    joints; which bodies sleep; motors, servos with their integrals, planar velocities and wheel
    slips; wrenches and efforts that act for a time; joints between models, and pins. Not included:
    lights, scene and wind. It can be pickled, and restored in a world of another process.

    What follows a `restore` is equal, bit for bit, to what followed the `save` with the same
    calls. PyBullet cannot store the impulses from which its contact solver starts. So both calls
    build the world again, and the solver starts without them: a body in contact moves some
    micrometres that it would not have moved without the call.

    Attributes:
        time: sim time in s.
    """

    time: float
    state: ExactState


@dataclass(frozen=True)
class _Layout:
    """Names of links or joints, and their rows in the tables of a snapshot."""

    names: Tuple[str, ...]
    rows: Dict[str, int]
    chosen: np.ndarray

    def named(self, array: np.ndarray) -> NamedRows:
        return NamedRows(self.names, array, self.rows)


@lru_cache(maxsize=64)
def _layout(models: Tuple[Tuple[int, Tuple[str, ...]], ...]) -> _Layout:
    """The layout of some models; of each its first row in the table, and its names.

    Cached, because programs read the same models after each action.
    """
    names = tuple(name for _, scoped in models for name in scoped)
    return _Layout(names, {name: row for row, name in enumerate(names)}, np.array(
        [row for first, scoped in models for row in range(first, first + len(scoped))], dtype=int))


def model_readings(entities: Sequence[Entity], snapshot: Snapshot) -> Readings:
    """Poses and twists of the models of a snapshot."""
    pose = np.empty((len(entities), POSE_WIDTH))
    twist = np.zeros((len(entities), TWIST_WIDTH))
    links = _link_table(snapshot)
    for row, entity in enumerate(entities):
        if entity.link_names and entity.link_from_model == IDENTITY:
            whole = links[entity.canonical_row]
            pose[row], twist[row] = whole[:POSE_WIDTH], whole[POSE_WIDTH:]
        else:
            at, moving = entity.state(snapshot)
            pose[row], twist[row] = pose_row(at), twist_row(moving)
    names = [entity.model.name for entity in entities]
    return Readings(snapshot.sim_ns * 1e-9, NamedRows(names, pose), NamedRows(names, twist))


def link_readings(entities: Sequence[Entity], snapshot: Snapshot) -> Readings:
    """Poses and twists of all links of a snapshot."""
    layout = _layout(tuple((entity.first_link_row, entity.scoped_links) for entity in entities))
    table = _link_table(snapshot)[layout.chosen]
    return Readings(snapshot.sim_ns * 1e-9, layout.named(table[:, :POSE_WIDTH]),
                    layout.named(table[:, POSE_WIDTH:]))


def joint_readings(entities: Sequence[Entity], snapshot: Snapshot) -> JointReadings:
    """Positions and rates of all joint axes of a snapshot."""
    layout = _layout(tuple((entity.first_joint_row, entity.scoped_joints) for entity in entities))
    values = np.asarray(snapshot.joints).reshape(-1, JOINT_WIDTH)[layout.chosen]
    return JointReadings(snapshot.sim_ns * 1e-9, layout.named(values[:, 0]),
                         layout.named(values[:, 1]))


def contact_reading(first: str, second: str, contact: Contact) -> ContactReading:
    """A contact between two links with their scoped names."""
    return ContactReading((first, second), np.array(contact.position), np.array(contact.normal),
                          contact.depth, contact.force, np.array(contact.friction))


def pose_row(pose: Pose) -> Tuple[float, ...]:
    """A pose as a row of `Readings.pose`."""
    return (*pose.position, *pose.orientation)


def twist_row(twist: Twist) -> Tuple[float, ...]:
    """A twist as a row of `Readings.twist`."""
    return (*twist.linear, *twist.angular)


def _link_table(snapshot: Snapshot) -> np.ndarray:
    return np.asarray(snapshot.links).reshape(-1, LINK_WIDTH)


def forces_by_pair(contacts: Sequence[ContactReading]) -> Dict[Tuple[str, str], np.ndarray]:
    """The sums of normal and friction forces on the first link of each pair, N, world frame."""
    found: Dict[Tuple[str, str], np.ndarray] = {}
    for one in contacts:
        force = one.force * one.normal + one.friction
        first, second = one.links
        if (second, first) in found:
            found[second, first] = found[second, first] - force
        else:
            found[one.links] = found.get(one.links, np.zeros(3)) + force
    return found
