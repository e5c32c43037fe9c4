"""A world that a Python program opens, steps and closes."""
from __future__ import annotations

import math
import os
from dataclasses import replace
from types import TracebackType
from typing import Callable, List, Optional, Sequence, Type, Union

from ..description.model import Model
from ..engine.api import Engine
from ..engine.process_engine import ProcessEngine
from ..errors import CommandError, EngineLostError, Issue
from ..formats.reading import LoadedWorld, Text
from ..geometry import ZERO3, Twist
from ..resources.resolver import Resolver
from ..sensing.api import CameraSpec
from ..simulator.saving import save_world
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator
from ..workspace_python import require
from .furnishing import Furnisher
from .kept_files import KeptFiles
from .plain_values import nanoseconds_of, pose_of, twist_of, vector_of, whole_number
from .readings import (
    ContactReading,
    JointReadings,
    Readings,
    SavedState,
    contact_reading,
    joint_readings,
    link_readings,
    model_readings,
)
from .world_choice import WorldChoice
from .world_pictures import Photographer, Picture, camera_pose

Log = Callable[[Issue], None]
FilePath = Union[str, "os.PathLike[str]"]

_MOST_STEPS = 1_000_000
_LOST = ("engine-died", "engine-lost", "engine-stalled")


def open_world(world: FilePath = "worlds/empty.world", *, seed: int = 0, profile: str = "",
               objects: Sequence[str] = (), object_list: FilePath = "",
               resolver: Optional[Resolver] = None, log: Optional[Log] = None,
               engine: Callable[[], Engine] = ProcessEngine) -> OpenWorld:
    """Open a world; it stands at its start until `OpenWorld.step` is called.

    Args:
        world: a world file, as `roslaunch gazebo_ros empty_world.launch world_name:=` takes it.
        seed: seed of what the file places at random.
        profile: name of the physics preset of the file; "" for its default.
        objects: names, and groups, of the object list to spawn.
        object_list: the YAML file of objects; "" for config/WORLD/object_locations.yaml of this
            package, WORLD being the name of the world's file.
        resolver: finds what URIs name; None for Gazebo's variables, our models and ROS packages.
        log: hears of every issue; they are in `OpenWorld.issues`, too.
        engine: makes the engine, which is a process of its own.

    Raises:
        InputError: the world, or one of the objects, cannot be used.
        CommandError: the engine cannot be started.
    """
    choice = WorldChoice(os.fspath(world), seed, profile, tuple(objects), os.fspath(object_list))
    return OpenWorld(choice, resolver=resolver, log=log, engine=engine)


class OpenWorld:
    """An open world, for one thread; use it as a context manager, or call `close`.

    Names are Gazebo's: `model`, `model::link`, `model::joint`; link and joint names may stand
    alone where they are unique. Positions are in m, angles in rad, in the world frame. A pose is
    given as 3 numbers (x y z), 6 (x y z roll pitch yaw) or 7 (x y z and a quaternion x y z w).

    Every method raises CommandError for a name that does not exist or a request that the engine
    refuses, and EngineLostError when the engine died: the world has lost its state then, and
    `reset` opens it again.

    Attributes:
        issues: faults and advice found so far, in order.
        simulator: the simulator, which can do more (see doc/dev/architecture.md).
    """

    def __init__(self, choice: WorldChoice, *, resolver: Optional[Resolver] = None,
                 log: Optional[Log] = None, engine: Callable[[], Engine] = ProcessEngine,
                 files: Optional[KeptFiles] = None) -> None:
        """See `open_world`; `files` reads the files instead of a reader of its own."""
        self.issues: List[Issue] = []
        self._listener = log
        self._lost: Optional[str] = None  # how the engine was lost
        self._furnished = 0  # the revision of the models when the world was opened
        self._choice = choice
        self._files = files or KeptFiles(resolver or Resolver.from_environment())
        self._furnisher = Furnisher(self._files, self._log)
        self._new_engine = engine
        if engine is ProcessEngine:
            require("pybullet")
        self._start(self._furnisher.load(choice))

    def __enter__(self) -> OpenWorld:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], fault: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def close(self) -> None:
        """End the engine. Nothing else may be called afterwards."""
        self._photographer.close()
        self.simulator.close()

    # -- time --------------------------------------------------------------------------------------

    @property
    def time(self) -> float:
        """Sim time in s."""
        return self.simulator.clock.sim_ns * 1e-9

    @property
    def step_size(self) -> float:
        """Sim time of one step in s."""
        return self.simulator.physics.settings.max_step_size

    def step(self, steps: int = 1) -> None:
        """Make steps, as fast as possible; at most a million at a time.

        An exception that interrupts it, such as that of Ctrl-C, ends it after the running step.
        """
        steps = whole_number(steps, "steps")
        if not 0 <= steps <= _MOST_STEPS:
            raise CommandError(f"steps must be between 0 and {_MOST_STEPS}, is {steps}")
        self._whole()
        if steps:
            try:
                self.simulator.clock.advance(steps)
            except EngineLostError as fault:
                self._lost = self._lost or str(fault)
            except CommandError:
                raise
            except BaseException:
                self.simulator.clock.end_advance()
                raise
        self._whole()

    def reset(self, seed: Optional[int] = None) -> None:
        """Open the world again, with another seed if one is given.

        What follows repeats bit for bit what followed `open_world` with the same seed.
        """
        again = self._choice.seed if seed is None else seed
        unchanged = self.simulator.models.revision == self._furnished and self._lost is None
        if again == self._choice.seed and unchanged:
            self.simulator.resets.reset_simulation(to_start=True)
            self._furnished = self.simulator.models.revision
            if self._lost is None:  # else the engine has died just now
                return
        self.open(replace(self._choice, seed=again))

    def open(self, choice: WorldChoice) -> None:
        """Open another world in the same engine; it behaves bit for bit as in a new one.

        Issues found in the former world are forgotten. An engine that is lost for good is
        replaced, and `simulator` with it.

        Raises:
            InputError: the world cannot be used; the one before is still open if it is its file
                that cannot be, else there is none until another call.
        """
        self.issues.clear()
        before, self._choice = self._choice, choice
        try:
            loaded = self._furnisher.load(choice)
        except BaseException:
            self._choice = before
            raise
        try:
            if self.simulator.over:
                self.close()
                self._start(loaded)
            else:
                self.simulator.load_world(loaded.world, loaded.meshes)
                self._furnish()
        except BaseException as fault:
            self._lost = f"there is no world: {fault}"
            raise
        self._lost = None  # an engine that has died in between has restored the start

    # -- reading -----------------------------------------------------------------------------------

    @property
    def names(self) -> List[str]:
        """Names of the models, in the order in which they were loaded."""
        return self.simulator.models.names()

    def states(self) -> Readings:
        """Where the models are, and how they move."""
        return model_readings(*self._whole().states.latest())

    def links(self) -> Readings:
        """Where all links are, and how they move."""
        return link_readings(*self._whole().states.latest())

    def joints(self) -> JointReadings:
        """Positions and rates of all joint axes."""
        return joint_readings(*self._whole().states.latest())

    def render(self, pose: Sequence[float], *, frame: str = "",
               look_at: Optional[Sequence[float]] = None, width: int = 320, height: int = 240,
               hfov: float = 1.047, near: float = 0.05, far: float = 100.0,
               outputs: Sequence[str] = ("rgb",)) -> Picture:
        """A picture of the world as it is now, without screen or graphics card.

        The process that draws starts with the first picture and takes what `pip install
        my_simulations[sensors]` and EGL bring. Same world, same picture.

        Args:
            pose: of the camera in `frame`: +x looks forward, y is left, z up.
            frame: model or link that carries the camera; "" for the world.
            look_at: point of `frame` that the camera is turned to; only the position of `pose`
                counts then.
            width: pixels.
            height: pixels.
            hfov: horizontal angle of view, rad.
            near: m along the optical axis; nearer points are not drawn.
            far: m along the optical axis; farther points are not drawn.
            outputs: some of "rgb", "depth" and "labels".

        Raises:
            CommandError: also if nothing is installed to draw with; it says what is missing.
        """
        self._whole()
        at = pose_of(pose)
        if look_at is not None:
            at = camera_pose(at.position, vector_of(look_at, "look_at"))
        camera = CameraSpec(int(width), int(height), float(hfov), float(near), float(far))
        return self._photographer.take(frame, at, camera, outputs)

    def contacts(self) -> List[ContactReading]:
        """The contact points of the last step."""
        return [contact_reading(*found) for found in self._whole().states.contacts()]

    def description(self, name: str) -> Model:
        """The description of a model, with all links and joints."""
        return self.simulator.models.get(name)

    # -- changing ----------------------------------------------------------------------------------

    def spawn(self, document: Union[Text, FilePath], name: Optional[str] = None,
              pose: Sequence[float] = ZERO3) -> str:
        """Put a model into the world; returns its name.

        Args:
            document: path of a URDF or SDF file, or its text.
            name: in the world; None for the document's own.
            pose: of the model; a pose of the document's own comes on top, as in Gazebo.

        Raises:
            InputError: the document has no usable model.
        """
        text = os.fspath(document)  # which leaves texts as they are
        return self._furnisher.spawn(self._whole(), text, name, pose_of(pose), lambda model: model)

    def remove(self, name: str) -> None:
        """Take a model out of the world."""
        self._whole().models.delete(name)

    def set_pose(self, name: str, pose: Sequence[float], twist: Optional[Sequence[float]] = None
                 ) -> None:
        """Move a model, or a link of one (`model::link`).

        Args:
            name: of the model or link.
            pose: of its frame.
            twist: m/s and rad/s (vx vy vz wx wy wz) that it then has; None for at rest.
        """
        speed = Twist() if twist is None else twist_of(twist)
        states = self._whole().states
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
        self._whole().wrenches.apply_wrench(
            link, vector_of(force, "force"), vector_of(torque, "torque"), frame=frame,
            point=vector_of(point, "point"), duration_ns=nanoseconds_of(duration))

    def apply_effort(self, joint: str, effort: float, *, duration: Optional[float] = None) -> None:
        """Drive a joint axis by a torque (N m) or force (N) from the next step on.

        Args:
            joint: the joint.
            effort: adds to others on the same axis.
            duration: s of sim time; None for until the world is reset.
        """
        self._whole().wrenches.apply_effort(joint, float(effort),
                                             duration_ns=nanoseconds_of(duration))

    def drive_joint(self, joint: str, rate: float, effort: float) -> None:
        """Drive a joint axis at a rate by a motor of limited effort, until another call.

        Args:
            joint: the joint.
            rate: rad/s or m/s.
            effort: most that the motor spends, N m or N.
        """
        self._whole().drives.drive_axis(joint, float(rate), float(effort))

    def move_joint(self, joint: str, position: float, effort: float, rate: float = math.inf
                   ) -> None:
        """Move a joint axis to a position and hold it there, until another call.

        Args:
            joint: the joint.
            position: rad or m.
            effort: most that the motor spends, N m or N.
            rate: fastest that it moves, rad/s or m/s.
        """
        self._whole().drives.hold_axis(joint, float(position), float(effort), float(rate))

    def release_joint(self, joint: str) -> None:
        """Switch off what `drive_joint` or `move_joint` has set."""
        self._whole().drives.release_axis(joint)

    # -- keeping -----------------------------------------------------------------------------------

    def save(self) -> SavedState:
        """Return the state of the world, and build the world again from it; see `SavedState`."""
        return SavedState(self.time, self._whole().exact_states.save())

    def restore(self, saved: SavedState) -> None:
        """Put the world back to a state, which any world returned; see `SavedState`.

        Models that were spawned since are removed, and removed ones come back. Raises CommandError.
        """
        self._whole().exact_states.restore(saved.state)

    def save_world(self, path: FilePath, *, overwrite: bool = False, state: bool = False) -> str:
        """Write the world to a .world file; returns its absolute path.

        Args:
            path: where to.
            overwrite: replace a file of that name.
            state: with sim time and velocities.
        """
        target = os.path.abspath(os.path.expanduser(path))
        return save_world(self._whole(), target, roots=[os.path.dirname(target)],
                          resolver=self._files.resolver, overwrite=overwrite, state=state)

    # -- helpers -----------------------------------------------------------------------------------

    def _start(self, loaded: LoadedWorld) -> None:
        """Start an engine with a world."""
        self.simulator = Simulator(loaded.world, engine_factory=self._new_engine, paused=True,
                                   log=self._log, meshes=loaded.meshes)
        self._photographer = Photographer(self.simulator, SceneSensing(self.simulator, self._log))
        try:
            self.simulator.start()
            self._furnish()
        except BaseException:
            self.simulator.close()
            raise

    def _furnish(self) -> None:
        self._furnisher.furnish(self.simulator, self._choice)
        self._furnished = self.simulator.models.revision

    def _log(self, issue: Issue) -> None:
        self.issues.append(issue)
        if issue.code in _LOST and self._lost is None:
            self._lost = issue.message
        if self._listener is not None:
            self._listener(issue)

    def _whole(self) -> Simulator:
        """The simulator, whose engine was not lost. Raises EngineLostError."""
        if self._lost is not None:
            raise EngineLostError(f"the world has lost its state, call reset: {self._lost}")
        return self.simulator
