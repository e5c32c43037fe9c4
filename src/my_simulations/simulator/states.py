"""Poses, twists and contacts of a running world: read from snapshots, set by commands."""
from __future__ import annotations

from typing import Dict, List, Optional, Tuple

from ..engine.commands import (
    Batch,
    Command,
    Contact,
    Frame,
    Pause,
    Ping,
    ReadContacts,
    SetClock,
    SetLinkState,
    SetModelState,
)
from ..engine.ring import LINK_WIDTH, Snapshot
from ..engine.timed_forces import AddTimedForces
from ..errors import CommandError
from ..geometry import (
    IDENTITY,
    Pose,
    Twist,
    compose,
    conjugate,
    inverse,
    multiply,
    normalised,
    pose_is_finite,
    rotate,
    subtract,
)
from .clock import SimClock
from .entity import Entity
from .nested_models import NestedModel
from .registry import ReferenceFrame, nested_frame
from .session import Session
from .world_state import WorldState
from .wrenches import Wrenches


class States:
    """States of models and links. Reads never wait for the engine and take the registry lock.

    Poses are those of model or link frames; twists are those of the link origins. Both are in the
    world frame unless a reference frame is given.
    """

    def __init__(self, session: Session, clock: SimClock, wrenches: Wrenches) -> None:
        self._session = session
        self._clock = clock
        self._wrenches = wrenches

    # -- reading -----------------------------------------------------------------------------------

    def model_state(self, name: str, frame: str = "") -> Tuple[Pose, Twist]:
        """Pose and twist of a model frame, also a nested one's, in `frame` (see `Registry.frame`).

        Raises UnknownEntityError, UnknownFrameError.
        """
        session = self._session
        session.await_posted()
        with session.registry_lock:
            nested = session.registry.nested_model(name)
            if nested is not None:
                anchor, snapshot = session.registry.frame(frame), session.snapshot()
                return relative_state(nested_frame(*nested).state(snapshot), anchor, snapshot)
            entity = session.registry.model(name)
            anchor = session.registry.frame(frame)
            if anchor is None and entity.link_names:
                pose, twist = session.ring.link(entity.canonical_row)
                if entity.link_from_model != IDENTITY:
                    pose = compose(pose, entity.link_from_model)
                return pose, twist
            snapshot = session.snapshot()
        return relative_state(entity.state(snapshot), anchor, snapshot)

    def link_state(self, name: str, frame: str = "") -> Tuple[Pose, Twist]:
        """Pose and twist of a link in `frame`. Raises UnknownEntityError, UnknownFrameError."""
        session = self._session
        session.await_posted()
        with session.registry_lock:
            row = session.link_row(name)
            anchor = session.registry.frame(frame)
            if anchor is None:
                return session.ring.link(row)
            snapshot = session.snapshot()
        return relative_state(snapshot.link(row), anchor, snapshot)

    def await_posted(self) -> None:
        """Wait until snapshots show all states that were set. Raises CommandError."""
        self._session.await_posted()

    def frame_mount(self, frame: str) -> Tuple[int, Pose]:
        """Return the row of the link that carries a frame, and the frame's pose in it.

        -1 and the world pose for a fixed frame. Raises UnknownFrameError.
        """
        with self._session.registry_lock:
            found = self._session.registry.frame(frame)
        return (-1, IDENTITY) if found is None else (found.row, found.offset)

    def link_at(self, row: int) -> Tuple[Pose, Twist]:
        """World pose and twist of the link in a row, for callers that know the row."""
        self._session.await_posted()
        return self._session.ring.link(row)

    def axis_at(self, row: int) -> Tuple[float, float]:
        """Position (rad or m) and rate (rad/s or m/s) of the joint axis in a row."""
        self._session.await_posted()
        return self._session.ring.joint(row)

    def latest(self) -> Tuple[List[Entity], Snapshot]:
        """All entities in load order, and the newest snapshot (an old one if nothing moves)."""
        session = self._session
        session.await_posted()
        with session.registry_lock:
            entities, snapshot = session.registry.entities(), session.snapshot()
        # A model that is being deleted may be gone from the engine, and its rows from the table.
        rows = len(snapshot.links) // LINK_WIDTH
        return [entity for entity in entities
                if entity.first_link_row + len(entity.link_names) <= rows
                or not entity.link_names], snapshot

    def fresh(self) -> Tuple[List[Entity], Snapshot]:
        """As `latest`, after the engine has written a new snapshot. Raises CommandError."""
        self._session.call(Ping())
        return self.latest()

    def capture(self) -> WorldState:
        """States of all models and the clock, for `restore`."""
        return WorldState.of(*self.latest(), self._clock.now())

    def link_names(self) -> Dict[int, str]:
        """Scoped names of all links, by row."""
        return {row: link for entity in self._session.entities()
                for row, link in zip(entity.link_ids, entity.scoped_links)}

    def contacts(self) -> List[Tuple[str, str, Contact]]:
        """The contacts of the last step, with the scoped names of both links."""
        return self.named_contacts(self._session.call(ReadContacts()).value)

    def named_contacts(self, found: object) -> List[Tuple[str, str, Contact]]:
        """The reply value of `ReadContacts` with the scoped names of both links."""
        names = self.link_names()
        return [(names[contact.row_a], names[contact.row_b], contact)
                for contact in (found if isinstance(found, tuple) else ())
                if contact.row_a in names and contact.row_b in names]

    # -- setting -----------------------------------------------------------------------------------

    def set_model_state(self, name: str, pose: Pose, twist: Twist, frame: str = "") -> None:
        """Move a model; all its links get the rigid body's velocity. Raises CommandError.

        A nested model can be moved if it has one link. The engine does so between its steps: this
        method does not wait for that, what reads states does.
        """
        session = self._session
        pose = check_state(pose, twist)
        with session.registry_lock:
            nested = session.registry.nested_model(name)
            entity = session.registry.model(name) if nested is None else nested[0]
        if nested is not None:
            self._set_nested_state(name, *nested, pose, twist, frame)
            return
        if not entity.link_names:
            session.await_posted()
            with session.registry_lock:
                anchor = session.registry.frame(frame)
                if anchor is not None:
                    pose = compose(anchor.state(session.snapshot())[0], pose)
                entity.pose = pose
                session.registry.revision += 1
                return

        def look_up() -> SetModelState:
            found, anchor = session.registry.model(name), session.registry.frame(frame)
            at, speed, reference = in_frame(pose, twist, anchor)
            return SetModelState(found.model_id, at, speed, reference, self._owner(reference))

        session.post(look_up)

    def _set_nested_state(self, name: str, entity: Entity, nested: NestedModel, pose: Pose,
                          twist: Twist, frame: str) -> None:
        if len(nested.links) != 1:
            raise CommandError(f"'{name}' is a nested model of {len(nested.links)} links; move its "
                               f"links or the model '{entity.model.name}'")
        self.set_link_state(entity.scoped_links[nested.frame_link],
                            compose(pose, inverse(nested.link_from_model)), twist, frame)

    def set_link_state(self, name: str, pose: Pose, twist: Twist, frame: str = "") -> None:
        """Move a link (see `engine.commands.SetLinkState`). Raises CommandError."""
        session = self._session
        pose = check_state(pose, twist)

        def look_up() -> Command:
            (entity, number), anchor = session.registry.link(name), session.registry.frame(frame)
            at, speed, reference = in_frame(pose, twist, anchor)
            return SetLinkState(entity.first_link_row + number, at, speed, reference,
                                (entity.model_id, *self._owner(reference)))

        session.call_looked_up(look_up)

    def _owner(self, frame: Optional[Frame]) -> Tuple[int, ...]:
        """The id of the model whose link a frame is. Requires the registry lock."""
        return () if frame is None else tuple(
            entity.model_id for entity in self._session.registry.entities()
            if entity.has_link_row(frame.row))

    def restore(self, state: WorldState, clock: bool = True) -> None:
        """Restore poses, velocities, joints and, with `clock`, the time; models added since stay.

        Models that were deleted, or have other links now, are skipped. Timed wrenches last as long
        as they would have.
        """
        session = self._session
        with session.structure_lock:
            with session.registry_lock:
                commands = state.commands(session.registry.entities())
                session.registry.revision += 1
            if not clock:
                session.call(Batch((Pause(), *commands, *self._clock.resume_commands())))
                return
            pending = self._wrenches.shift_pending(session.call(Pause()).step, state.step)
            session.call(Batch((SetClock(state.step, state.sim_ns), *commands,
                                AddTimedForces(tuple(pending)), *self._clock.resume_commands())))
            self._wrenches.replace_all(pending)


def check_state(pose: Pose, twist: Twist) -> Pose:
    """Return the pose with a unit quaternion. Raises CommandError for NaN or infinity."""
    if not pose_is_finite(pose):
        raise CommandError("the pose contains NaN or infinity")
    if not pose_is_finite(Pose(twist.linear, (*twist.angular, 0.0))):
        raise CommandError("the twist contains NaN or infinity")
    return Pose(pose.position, normalised(pose.orientation))


def in_frame(pose: Pose, twist: Twist,
              frame: Optional[ReferenceFrame]) -> Tuple[Pose, Twist, Optional[Frame]]:
    """Arguments of an engine command: fixed frames are resolved here, moving ones there."""
    if frame is None:
        return pose, twist, None
    if frame.row >= 0:
        return pose, twist, Frame(frame.row, frame.offset)
    turn = frame.offset.orientation
    return (compose(frame.offset, pose),
            Twist(rotate(turn, twist.linear), rotate(turn, twist.angular)), None)


def relative_state(state: Tuple[Pose, Twist], frame: Optional[ReferenceFrame],
              snapshot: Snapshot) -> Tuple[Pose, Twist]:
    """Express a state in a frame as Gazebo does: velocity differences, without w x r."""
    if frame is None:
        return state
    (position, turn), (linear, angular) = state
    (at, axes), (frame_linear, frame_angular) = frame.state(snapshot)
    back = conjugate(axes)
    pose = Pose(rotate(back, subtract(position, at)), multiply(back, turn))
    return pose, Twist(rotate(back, subtract(linear, frame_linear)),
                       rotate(back, subtract(angular, frame_angular)))
