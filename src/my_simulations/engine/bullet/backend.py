"""PyBullet as a backend: models by number, commands, steps."""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Callable, Dict, List, Optional, Tuple, Type

import pybullet

from ...geometry import (
    STILL,
    Pose,
    Twist,
    add,
    compose,
    conjugate,
    cross,
    inverse,
    multiply,
    pose_is_finite,
    rotate,
    subtract,
)
from ..api import (
    AddLoads,
    Clear,
    ClearLoads,
    Command,
    Connect,
    Event,
    Frame,
    Hold,
    LinkState,
    LoadModel,
    ModelState,
    PhysicsSettings,
    ReadContacts,
    Refused,
    RemoveModel,
    SetAxes,
    SetJoints,
    SetLinkState,
    SetModelState,
)
from ..plan import PlanError, open_joints, plan_bodies
from ..ring import JOINTS, LINKS
from ..rows import axis_rows
from . import bodies, joints
from .bodies import Body, Builder, Part
from .constraints import Constraints
from .contacts import read_contacts
from .decay import Decay
from .forces import Forces
from .friction import EVERY, FrictionBalance
from .holds import Holds
from .readout import Readout
from .restore import Entry, inherited, restore
from .shapes import ShapeError, ShapeFactory
from .spin import SpinKeeper
from .ties import Ties
from .wake import Waker


class BulletBackend:
    """One PyBullet world; there may be one in a process (module-wide client 0)."""

    def __init__(self) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._settings = PhysicsSettings()
        self._shapes = ShapeFactory()
        self._models: Dict[int, Entry] = {}
        self._bodies: Dict[int, Body] = {}
        self._rows: Dict[int, Tuple[Body, Part]] = {}
        self._axes: Dict[int, Tuple[Body, bodies.Axis]] = {}
        self._readout = Readout(self._on_diverged)
        self._waker = Waker(self._bodies, self._readout.touch)
        self._forces = Forces(self._waker.around)
        self._friction = FrictionBalance(self._on_misfit)
        self._spin = SpinKeeper()
        self._holds = Holds(self._waker.around)
        self._ties = Ties()
        self._decay = Decay()
        # Everything that remembers bodies one by one.
        self._keepers = (self._forces, self._friction, self._spin, self._holds, self._ties,
                         self._decay, self._readout)
        self._events: List[Event] = []
        self._appliers: Dict[Type[Command], Callable[[Any], object]] = {
            LoadModel: self._load, RemoveModel: self._remove, Clear: self._clear,
            SetModelState: self._set_model, SetLinkState: self._set_link,
            SetJoints: self._set_joints, SetAxes: self._set_axes, Hold: self._hold,
            Connect: self._connect,
            ReadContacts: lambda command: read_contacts(self._bodies, command.limit),
            AddLoads: self._add_loads, ClearLoads: self._clear_loads,
        }
        self._configure_bullet()

    # -- Backend ---------------------------------------------------------------------------------

    def apply(self, command: Command) -> object:
        """Carry out a command; raises `Refused`."""
        return self._appliers[type(command)](command)

    def configure(self, settings: PhysicsSettings) -> None:
        """Use other settings from the next step on; a changed gravity wakes everything."""
        before, self._settings = self._settings, settings
        if settings.gravity != before.gravity:
            self._waker.everything()  # first: Bullet tells only awake bodies of a new gravity
        self._configure_bullet()
        if settings.step_size != before.step_size:
            for entry in self._models.values():
                for body in entry.bodies:
                    joints.set_up(body, entry.model, self._forces, settings.step_size)
                    if body.rigid and body.moves:
                        link = entry.model.links[body.parts[0].row - entry.first_row]
                        bodies.set_decay(body.uid, link, settings.step_size)

    def step(self, first: int, count: int) -> None:
        """Make `count` steps."""
        self._readout.stepped()
        one = pybullet.stepSimulation
        if all(part.idle for part in (self._forces, self._friction, self._spin, self._holds,
                                      self._decay)):
            for _ in range(count):
                one()
            self._forces.stepped()
            return
        dt, gravity = self._settings.step_size, self._settings.gravity
        for step in range(first, first + count):
            if not self._friction.idle and step % EVERY == 0:
                self._friction.balance()
            self._forces.apply(step, dt, gravity)
            self._decay.apply(dt)
            free = self._spin.before(step, dt)
            one()
            self._spin.after(free, self._forces.loaded_links, dt)
            self._holds.apply()

    def read(self) -> bool:
        """Bring the tables up to date."""
        return self._readout.read()

    def tables(self) -> Tuple[memoryview, memoryview]:
        """The used rows."""
        return self._readout.tables()

    def events(self) -> List[Event]:
        """What has happened since the last call."""
        found, self._events = self._events, []
        return found

    def close(self) -> None:
        """Disconnect and remove scratch files."""
        pybullet.disconnect(self._client)
        self._shapes.close()

    # -- settings --------------------------------------------------------------------------------

    def _configure_bullet(self) -> None:
        settings = self._settings
        pybullet.setGravity(*settings.gravity)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=settings.step_size, numSolverIterations=settings.iterations,
            numSubSteps=0, deterministicOverlappingPairs=1, enableFileCaching=0,
            # Overlaps are pushed out at 5 / s whatever the step: Bullet's default throws a body
            # that starts 0.2 m deep to 3 m, and makes bounces erratic (measured).
            contactERP=min(0.2, 5.0 * settings.step_size),
        )

    # -- models ----------------------------------------------------------------------------------

    def _load(self, command: LoadModel) -> None:
        self._check_load(command)
        joint_rows = {row.name: command.first_joint_row + n
                      for n, row in enumerate(axis_rows(command.model))}
        try:
            plans = plan_bodies(command.model)
            built = Builder(command.model_id, command.model, command.pose, command.meshes,
                            self._shapes, command.first_link_row, joint_rows,
                            self._settings.step_size, command.articulated).build(plans)
        except (PlanError, ShapeError) as fault:
            raise Refused(str(fault)) from fault
        constraints = Constraints(command.model, plans, built, command.pose,
                                  open_joints(command.model, plans), command.first_link_row)
        entry = Entry(command.model, built, command.first_link_row, command.pose,
                      constraints)
        self._models[command.model_id] = entry
        for body in built:
            self._register(body)
            for part in body.parts:
                self._decay.add(body, part, command.model.links[part.row - entry.first_row])
            joints.set_up(body, command.model, self._forces, self._settings.step_size)
        state = self._inherited(command) if command.inherit else command.state
        if state is not None:
            restore(entry, state)
        self._waker.around(built)

    def _inherited(self, command: LoadModel) -> ModelState:
        self._readout.read()
        before = self._entry(command.inherit)
        return inherited(before, command.model, self._model_pose(before), self._link_state,
                         self._readout.joints)

    def _model_pose(self, entry: Entry) -> Pose:
        names = [link.name for link in entry.model.links]
        if not names:
            return entry.pose
        lead = names.index(entry.model.canonical_link) if entry.model.canonical_link else 0
        return compose(self._link_state(entry.first_row + lead).pose,
                       inverse(entry.model.links[lead].pose))

    def _check_load(self, command: LoadModel) -> None:
        if command.model_id in self._models:
            raise Refused(f"model number {command.model_id} is taken")
        if not pose_is_finite(command.pose):
            raise Refused(f"the pose of model '{command.model.name}' is not finite")
        if (command.first_link_row + len(command.model.links) > LINKS
                or command.first_joint_row + len(command.model.joints) > JOINTS):
            raise Refused(f"the world is full: {LINKS} links and {JOINTS} joints are its limit")

    def _register(self, body: Body) -> None:
        for uid in body.uids:
            self._bodies[uid] = body
        for part in body.parts:
            self._rows[part.row] = (body, part)
        for axis in body.axes:
            self._axes[axis.row] = (body, axis)
        self._forces.add_body(body)
        self._friction.add(body)
        self._spin.add(body)
        self._readout.add(body)

    def _remove(self, command: RemoveModel) -> None:
        entry = self._entry(command.model_id)
        self._waker.around(entry.bodies)
        del self._models[command.model_id]
        entry.constraints.remove()
        for body in entry.bodies:
            for keeper in self._keepers:
                keeper.forget(body)
            for uid in body.uids:
                del self._bodies[uid]
            for part in body.parts:
                del self._rows[part.row]
            for axis in body.axes:
                del self._axes[axis.row]
            bodies.remove(body)

    def _connect(self, command: Connect) -> None:
        self._ties.connect(command, self._rows)
        self._waker.around([self._rows[row][0] for row in (command.child_row, command.parent_row)
                            if row >= 0])

    def _clear(self, _: Clear) -> None:
        for entry in self._models.values():
            for body in entry.bodies:
                self._readout.forget(body)
                self._forces.forget(body)
        self._models.clear()
        self._forces.clear_all()
        for keeper in (self._friction, self._spin, self._holds, self._ties, self._decay):
            keeper.clear()
        for table in (self._bodies, self._rows, self._axes):
            table.clear()
        pybullet.resetSimulation()
        self._configure_bullet()

    def _entry(self, model_id: int) -> Entry:
        if model_id not in self._models:
            raise Refused("the model is not there any more")
        return self._models[model_id]

    # -- states ----------------------------------------------------------------------------------

    def _link_state(self, row: int) -> LinkState:
        values = self._readout.links[row].tolist()
        return LinkState(Pose((values[0], values[1], values[2]),
                              (values[3], values[4], values[5], values[6])),
                         Twist((values[7], values[8], values[9]),
                               (values[10], values[11], values[12])))

    def _in_world(self, pose: Pose, twist: Optional[Twist],
                  frame: Optional[Frame]) -> Tuple[Pose, Optional[Twist]]:
        if not pose_is_finite(pose):
            raise Refused("the pose is not finite")
        if frame is None:
            return pose, twist
        if frame.row not in self._rows:
            raise Refused("the reference frame is not there any more")
        at = compose(self._link_state(frame.row).pose, frame.offset)
        if twist is not None:
            twist = Twist(rotate(at.orientation, twist.linear),
                          rotate(at.orientation, twist.angular))
        return compose(at, pose), twist

    def _set_model(self, command: SetModelState) -> None:
        entry = self._entry(command.model_id)
        self._readout.read()
        pose, twist = self._in_world(command.pose, command.twist, command.frame)
        if not entry.model.links:
            return
        current = self._model_pose(entry)
        self._waker.around(entry.bodies)
        for body in entry.bodies:
            self._move(body, current, pose, twist)
        self._waker.around(entry.bodies)

    def _set_link(self, command: SetLinkState) -> None:
        if command.row not in self._rows:
            raise Refused("the link is not there any more")
        self._readout.read()
        body, part = self._rows[command.row]
        if not body.rigid and body.base is None:
            raise Refused("the link belongs to a body that is joined to the world")
        pose, twist = self._in_world(command.pose, command.twist, command.frame)
        current = self._link_state(part.row).pose
        self._waker.around([body])
        self._move(body, current, pose, twist)
        self._waker.around([body])

    def _move(self, body: Body, current: Pose, wanted: Pose, twist: Optional[Twist]) -> None:
        """Move a body as if `current`, a pose fixed to it, became `wanted` with `twist` there."""
        lead = self._link_state(body.parts[0].row)
        if body.rigid or body.base is not None:
            target = compose(wanted, compose(inverse(current), lead.pose))
            bodies.place(body, target)
        else:
            position, turn = pybullet.getBasePositionAndOrientation(body.uid)
            target = compose(wanted, compose(inverse(current), Pose(position, turn)))
            pybullet.resetBasePositionAndOrientation(body.uid, target.position,
                                                     target.orientation)
        for axis in body.axes:
            position_rate = pybullet.getJointState(body.uid, axis.index)[:2]
            rate = position_rate[1] if twist is None else 0.0
            pybullet.resetJointState(body.uid, axis.index, position_rate[0], rate)
        self._forces.disturbed(body)
        if body.moves and (body.rigid or body.base is not None):
            bodies.launch(body, target, _carried(lead, target, wanted, twist))
        self._holds.moved(body)
        self._spin.moved(body)
        self._readout.touch(body)

    def _set_joints(self, command: SetJoints) -> None:
        for row, position, rate in command.joints:
            if row not in self._axes:
                raise Refused("the joint is not there any more")
            if not (abs(position) < 1e12 and abs(rate) < 1e12):
                raise Refused("the joint position is not finite")
        for row, position, rate in command.joints:
            body, axis = self._axes[row]
            self._waker.around([body])
            pybullet.resetJointState(body.uid, axis.index, position, rate)
            self._forces.disturbed(body)
            self._spin.moved(body)
            self._readout.touch(body)

    def _set_axes(self, command: SetAxes) -> None:
        entry = self._entry(command.model_id)
        entry.model = replace(entry.model, joints=list(command.joints))
        self._waker.around(entry.bodies)
        for body in entry.bodies:
            joints.set_up(body, entry.model, self._forces, self._settings.step_size)

    def _hold(self, command: Hold) -> None:
        self._holds.set(body for number in command.model_ids
                        for body in self._entry(number).bodies)

    # -- loads and events ------------------------------------------------------------------------

    def _add_loads(self, command: AddLoads) -> None:
        refusal = self._forces.add_loads(command.loads)
        if refusal:
            raise Refused(refusal)

    def _clear_loads(self, command: ClearLoads) -> None:
        self._forces.clear(command.load_ids)

    def _on_misfit(self, uid: int, share: float) -> None:
        body = self._bodies[uid]
        self._events.append(Event(
            "log", f"model '{self._models[body.model_id].model.name}' touches others in a ring, "
            f"for which no friction fits all pairs: it is {100 * share:.0f} % off", body.model_id))

    def _on_diverged(self, body: Body) -> None:
        """Put a body whose state is no number back where it last was one, at rest."""
        for part in body.parts[:1]:
            last = self._link_state(part.row)
            if body.rigid or body.base is not None:
                bodies.place(body, last.pose)
                bodies.launch(body, last.pose, STILL)
        for axis in body.axes:
            pybullet.resetJointState(body.uid, axis.index,
                                     float(self._readout.joints[axis.row, 0]), 0.0)
        self._forces.disturbed(body)
        self._spin.moved(body)
        name = self._models[body.model_id].model.name
        self._events.append(Event("diverged", f"the state of model '{name}' became infinite; it "
                                  "was put back where it was, at rest", body.model_id))


def _carried(lead: LinkState, target: Pose, wanted: Pose, twist: Optional[Twist]) -> Twist:
    """The twist at `target` of a body that moves with `twist` at `wanted`; None: keep, turned."""
    if twist is None:
        turn = multiply(target.orientation, conjugate(lead.pose.orientation))
        return Twist(rotate(turn, lead.twist.linear), rotate(turn, lead.twist.angular))
    lever = subtract(target.position, wanted.position)
    return Twist(add(twist.linear, cross(twist.angular, lever)), twist.angular)
