"""A world that a Python program opens, steps and closes."""
from __future__ import annotations

import os
from dataclasses import replace
from types import TracebackType
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple, Type

from ..description.model import Model
from ..engine.api import Engine
from ..engine.process_engine import ProcessEngine
from ..errors import CommandError, EngineLostError, Issue
from ..formats.reading import LoadedWorld
from ..resources.resolver import Resolver
from ..sensing.api import CameraSpec
from ..simulator.saving import save_world
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator
from ..workspace_python import require
from .controllers import Controllers, Parameters, read_parameters
from .furnishing import Furnisher
from .kept_files import FileCache
from .plain_values import pose_of, vector_of, whole_number
from .ray_casts import RayReading, cast_rays
from .readings import (
    ContactReading,
    JointReadings,
    Readings,
    SavedState,
    contact_reading,
    forces_by_pair,
    joint_readings,
    link_readings,
    model_readings,
)
from .robots import Plugins, RobotOptions, Robots, classes_of
from .world_changes import FilePath, WorldChanges
from .world_choice import WorldChoice
from .world_pictures import Photographer, Picture, PictureRequest, camera_pose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike

    from ..plugins.local_parameters import LocalParameters
    from .topics import Topics

Log = Callable[[Issue], None]

_MOST_STEPS = 1_000_000
_LOST = ("engine-died", "engine-lost", "engine-stalled")


def open_world(world: FilePath = "worlds/empty.world", *, seed: int = 0, profile: str = "",
               objects: Sequence[str] = (), object_list: FilePath = "",
               plugins: Plugins = True, sensors: bool = True, isolate: bool = False,
               parameters: Parameters = {},  # noqa: B006
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
        plugins: whether the robots' plugins run; or further classes of plugins by library, as
            `{"libfoo.so": "package.module:Class"}`.
        sensors: whether the plugins of `<sensor>` elements run.
        isolate: run each plugin that is not of this package in a process of its own.
        parameters: of plugins and controllers by name, as on ROS's parameter server; or the path
            of a YAML file of them.
        resolver: finds what URIs name; None for Gazebo's variables, our models and ROS packages.
        log: hears of every issue; they are in `OpenWorld.issues`, too.
        engine: makes the engine, which is a process of its own.

    Raises:
        InputError: the world, or one of the objects, cannot be used.
        CommandError: an argument cannot be used, or the engine cannot be started.
    """
    if isinstance(objects, str):
        raise CommandError(f"objects are a list of names, not {objects!r}")
    choice = WorldChoice(os.fspath(world), whole_number(seed, "seed"), profile, tuple(objects),
                         os.fspath(object_list))
    robots = RobotOptions(plugins is not False, sensors, classes_of(plugins),
                          read_parameters(parameters), isolate)
    return OpenWorld(choice, resolver=resolver, log=log, engine=engine, robots=robots)


class OpenWorld(WorldChanges):
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
                 files: Optional[FileCache] = None,
                 robots: RobotOptions = RobotOptions()) -> None:  # noqa: B008
        """See `open_world`; `files` reads the files instead of a reader of its own."""
        self.issues: List[Issue] = []
        self._listener = log
        self._lost: Optional[str] = None  # how the engine was lost
        self._joints_of = {}
        self._furnished = 0  # the revision of the models when the world was opened
        self._choice = choice
        self._files = files or FileCache(resolver or Resolver.from_environment())
        self._furnisher = Furnisher(self._files, self._log)
        self._new_engine = engine
        self._robots = Robots(robots, self._log, self.step, lambda: self.step_size)
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
        self._robots.close()
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

        When it returns, all messages that robots publish in these steps have arrived.
        An exception that interrupts it, such as that of Ctrl-C, ends it after the running step.
        """
        steps = whole_number(steps, "steps")
        if not 0 <= steps <= _MOST_STEPS:
            raise CommandError(f"steps must be between 0 and {_MOST_STEPS}, is {steps}")
        self._running_simulator()
        if steps:
            try:
                self._robots.wait_until_loaded()
                self.simulator.clock.advance(steps)
                self._robots.finish()
            except EngineLostError as fault:
                self._lost = self._lost or str(fault)
            except CommandError:
                raise
            except BaseException:
                self.simulator.clock.end_advance()
                raise
        self._running_simulator()

    def reset(self, seed: Optional[int] = None) -> None:
        """Open the world again, with another seed if one is given.

        What follows repeats bit for bit what followed `open_world` with the same seed.
        """
        again = self._choice.seed if seed is None else whole_number(seed, "seed")
        unchanged = self.simulator.models.revision == self._furnished and self._lost is None
        if again == self._choice.seed and unchanged:
            self._robots.end()
            self.simulator.resets.reset_simulation(to_start=True)
            self._furnished = self.simulator.models.revision
            if self._lost is None:  # else the engine has died just now
                self._robots.begin(self.simulator)
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
            if self.simulator.is_over:
                self.close()
                self._start(loaded)
            else:
                self._robots.end()
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
        return model_readings(*self._running_simulator().states.latest())

    def links(self) -> Readings:
        """Where all links are, and how they move."""
        return link_readings(*self._running_simulator().states.latest())

    def joints(self) -> JointReadings:
        """Positions and rates of all joint axes."""
        return joint_readings(*self._running_simulator().states.latest())

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
        return self.request_picture(
            pose, frame=frame, look_at=look_at, width=width, height=height, hfov=hfov, near=near,
            far=far, outputs=outputs).result()

    def request_picture(self, pose: Sequence[float], *, frame: str = "",
                        look_at: Optional[Sequence[float]] = None, width: int = 320,
                        height: int = 240, hfov: float = 1.047, near: float = 0.05,
                        far: float = 100.0, outputs: Sequence[str] = ("rgb",)) -> PictureRequest:
        """Request a picture of the world as it is now, and return while it is drawn.

        Arguments are those of `render`; `result` of the request waits for the picture.
        """
        self._running_simulator()
        at = pose_of(pose)
        if look_at is not None:
            at = camera_pose(at.position, vector_of(look_at, "look_at"))
        camera = CameraSpec(int(width), int(height), float(hfov), float(near), float(far))
        return self._photographer.request(frame, at, camera, outputs)

    def contacts(self) -> List[ContactReading]:
        """The contact points of the last step."""
        return [contact_reading(*found) for found in self._running_simulator().states.contacts()]

    def contact_forces(self) -> Dict[Tuple[str, str], np.ndarray]:
        """The forces between links in the last step: what the second pushes the first with.

        (3,) N in the world frame, by pair of links as `model::link`, the sum over their contact
        points; each pair once, in the order of `contacts`.
        """
        return forces_by_pair(self.contacts())

    def cast_rays(self, origins: ArrayLike, directions: ArrayLike, *, far: float = 100.0,
                  frame: str = "", visuals: bool = False) -> RayReading:
        """Cast rays into the world as it is now. It needs the extra `sensors`.

        Args:
            origins: m, shape (n, 3), or (3,) for one origin of all rays.
            directions: shape (n, 3), or (3,) for one direction; of any length.
            far: m; farther surfaces are not met.
            frame: model or link whose frame these are given in; "" for the world.
            visuals: meet what is drawn instead of what collides.
        """
        return cast_rays(self._running_simulator(), self._scene, origins, directions, far, frame,
                         visuals)

    def description(self, name: str) -> Model:
        """The description of a model, with all links and joints."""
        return self.simulator.models.get(name)

    # -- robots ------------------------------------------------------------------------------------

    @property
    def topics(self) -> Topics:
        """The topics of the robots' plugins by name; a look-up begins to listen to the topic."""
        return self._robots.topics

    @property
    def services(self) -> Dict[str, str]:
        """The types of the services that plugins offer, by name."""
        return self._robots.services()

    @property
    def parameters(self) -> LocalParameters:
        """The parameters of plugins and controllers; plugins read them when they are loaded."""
        return self._robots.graph.parameters

    @property
    def controllers(self) -> Controllers:
        """The controllers of ros_control."""
        return Controllers(self._robots, lambda: self.issues)

    def publish(self, topic: str, message: Any) -> None:
        """Send a message to the plugins that hear a topic; it acts from the next step on.

        Args:
            topic: its name.
            message: of `my_simulations.messages` or of ROS, or a dictionary of its fields.
        """
        self._running_simulator()
        self._robots.publish(topic, message)

    def call(self, service: str, request: Any = None, **fields: Any) -> Any:
        """Ask a service of a plugin; returns its response.

        Args:
            service: its name.
            request: a message, or a dictionary of its fields.
            fields: instead of `request`.
        """
        self._running_simulator()
        return self._robots.call(service, fields if request is None else request)

    # -- keeping -----------------------------------------------------------------------------------

    def save(self) -> SavedState:
        """Return the state of the world, and build the world again from it; see `SavedState`."""
        return SavedState(self.time, self._running_simulator().exact_states.save())

    def restore(self, saved: SavedState) -> None:
        """Put the world back to a state, which any world returned; see `SavedState`.

        Models that were spawned since are removed, and removed ones come back. Raises CommandError.
        """
        if not isinstance(saved, SavedState):
            raise CommandError(f"restore takes what save has returned, not {saved!r}")
        self._running_simulator().exact_states.restore(saved.state)

    def save_world(self, path: FilePath, *, overwrite: bool = False, state: bool = False) -> str:
        """Write the world to a .world file; returns its absolute path.

        Args:
            path: where to.
            overwrite: replace a file of that name.
            state: with sim time and velocities.
        """
        target = os.path.abspath(os.path.expanduser(path))
        return save_world(self._running_simulator(), target, roots=[os.path.dirname(target)],
                          resolver=self._files.resolver, overwrite=overwrite, state=state)

    # -- helpers -----------------------------------------------------------------------------------

    def _start(self, loaded: LoadedWorld) -> None:
        self.simulator = Simulator(loaded.world, engine_factory=self._new_engine, paused=True,
                                   log=self._log, meshes=loaded.meshes)
        self._scene = SceneSensing(self.simulator, self._log)
        self._photographer = Photographer(self.simulator, self._scene)
        try:
            self.simulator.start()
            self._furnish()
        except BaseException:
            self._robots.close()
            self.simulator.close()
            raise

    def _furnish(self) -> None:
        self._furnisher.furnish(self.simulator, self._choice)
        self._furnished = self.simulator.models.revision
        self._robots.begin(self.simulator)

    def _log(self, issue: Issue) -> None:
        self.issues.append(issue)
        if issue.code in _LOST and self._lost is None:
            self._lost = issue.message
        if self._listener is not None:
            self._listener(issue)

    def _running_simulator(self) -> Simulator:
        if self._lost is not None:
            raise EngineLostError(f"the world has lost its state, call reset: {self._lost}")
        return self.simulator
