"""The context of a plugin in its own process (see `plugins.context.Context`)."""
from __future__ import annotations

import pickle
from functools import partial
from typing import Any, Callable, Dict, Sequence

from ...engine.wrench_laws import WrenchLaw
from ...geometry import Pose, Twist, Vec3
from ..checked_arguments import check_finite, check_number, check_pose, check_vector
from ..parameters import Parameters
from .connection import Connection
from .messages import CONTEXT, HANDLES, METHODS, PROPERTIES, HandleMade, Start


class RemoteHandle:
    """An object in the node that the plugin uses by its number."""

    def __init__(self, connection: Connection, made: HandleMade) -> None:
        self._connection, self.number = connection, made.number
        connection.readings.states[made.number] = made.state

    def _call_handle(self, name: str, *arguments: Any) -> None:
        self._connection.call_handle(self.number, name, *arguments)


class RemoteLink(RemoteHandle):
    def __init__(self, connection: Connection, made: HandleMade) -> None:
        super().__init__(connection, made)
        self.name, self.inertial = made.facts["name"], made.facts["inertial"]

    @property
    def pose(self) -> Pose:
        pose: Pose = self._connection.state(self.number)[0]
        return pose

    @property
    def twist(self) -> Twist:
        """Twist at the link's origin, world axes."""
        twist: Twist = self._connection.state(self.number)[1]
        return twist


class RemoteJoint(RemoteHandle):
    def __init__(self, connection: Connection, made: HandleMade) -> None:
        super().__init__(connection, made)
        self.name, self.spec = made.facts["name"], made.facts["spec"]
        self.parent, self.child = made.facts["parent"], made.facts["child"]

    @property
    def position(self) -> float:
        """rad or m."""
        return float(self._connection.state(self.number)[0])

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""
        return float(self._connection.state(self.number)[1])

    @property
    def set_count(self) -> float:
        """The number of times the position was set directly."""
        return float(self._connection.state(self.number)[2])

    def drive(self, rate: float, effort: float, ramp: Any = None) -> None:
        self._call_handle("drive", check_finite(rate, "the rate of a motor"),
                          check_number(effort, "the effort of a motor"), ramp)

    def set_servo(self, servo: Any) -> None:
        """Drive the axis by a servo of the engine."""
        self._call_handle("set_servo", servo)


class RemoteTopic(RemoteHandle):
    """A topic that the plugin publishes."""

    @property
    def wanted(self) -> bool:
        return bool(self._connection.state(self.number))

    def publish(self, message: Any) -> None:
        self._call_handle("publish", message)

    def publish_later(self, make: Callable[[], Any]) -> None:
        """Publish what `make` returns. The process has one thread: it is called at once."""
        self._call_handle("publish", make())

    def close(self) -> None:
        self._call_handle("close")


class RemoteCallHandle(RemoteHandle):
    """A scheduled call, an observation, a subscription or a service."""

    def end(self) -> None:
        self._call_handle("end")

    def close(self) -> None:
        self._call_handle("close")


_KINDS: Dict[str, Any] = {
    "link": RemoteLink, "joint": RemoteJoint, "topic": RemoteTopic, "end": RemoteCallHandle}


class RemoteContext:
    """See `plugins.context.Context`. For the thread that calls the plugin."""

    def __init__(self, connection: Connection, start: Start) -> None:
        self._connection = connection
        self.sensor, self.sensor_link = start.sensor, start.sensor_link
        self.sensor_joint, self.spec = start.sensor_joint, start.spec
        self.parameters = Parameters(start.spec.xml, self.warn)
        self._found: Dict[str, RemoteHandle] = {}
        self._messages: Dict[str, bytes] = {}

    def __getattr__(self, name: str) -> Any:
        if name in PROPERTIES:
            return self._connection.query(name)
        if name in METHODS:
            return partial(self._connection.query, name)
        if name in HANDLES:
            return partial(self._handle, name)
        raise AttributeError(f"the context has no '{name}'")

    def _handle(self, name: str, *arguments: Any, **named: Any) -> Any:
        """Return the handle of a method of the context; links and joints are looked up once."""
        key = f"{name} {arguments} {named}" if HANDLES[name] in ("link", "joint") else ""
        if key in self._found:
            return self._found[key]
        made = self._connection.query(name, *arguments, **named)
        handle = _KINDS[made.kind](self._connection, made)
        if key:
            self._found[key] = handle
        return handle

    # -- time ------------------------------------------------------------------------------------

    @property
    def model(self) -> str:
        return self._connection.readings.model

    @property
    def now_ns(self) -> int:
        return self._connection.readings.now_ns

    @property
    def step(self) -> int:
        return self._connection.readings.step

    def observe(self, hertz: float, call: Callable[[], None], topics: Sequence[Any] = (),
                **options: Any) -> RemoteCallHandle:
        made: RemoteCallHandle = self._handle("observe", hertz, call, list(topics), **options)
        return made

    # -- the model -------------------------------------------------------------------------------

    def set_planar_velocity(self, x: float, y: float, yaw_rate: float) -> None:
        self._call_handle("set_planar_velocity", check_finite(x, "x"), check_finite(y, "y"),
                          check_finite(yaw_rate, "yaw_rate"))

    def set_wrench(self, link: str, force: Vec3, torque: Vec3) -> None:
        self._call_handle("set_wrench", link, check_vector(force, "force"),
                          check_vector(torque, "torque"))

    def set_wrench_law(self, link: str, law: WrenchLaw, joint: str = "") -> None:
        self._call_handle("set_wrench_law", link, law, joint)

    def _call_handle(self, name: str, *arguments: Any) -> None:
        self._connection.call_handle(CONTEXT, name, *arguments)

    # -- topics, services, log -------------------------------------------------------------------

    def message(self, kind: str) -> Any:
        if kind not in self._messages:
            self._messages[kind] = pickle.dumps(self._connection.query("message", kind))
        return pickle.loads(self._messages[kind])

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> RemoteCallHandle:
        def answer(request: Any, response: Any) -> Any:
            call(request, response)
            return response

        made: RemoteCallHandle = self._handle("serve", name, kind, answer)
        return made

    def transform(self, parent: str, child: str, pose: Pose) -> None:
        self._call_handle("transform", str(parent), str(child), check_pose(pose, "a transform"))

    def declare_parameters(self) -> None:
        """Report to the node which parameters the plugin has read."""
        self._call_handle("declare_parameters", self.parameters.declared())

    def info(self, text: str) -> None:
        self._call_handle("info", str(text))

    def warn(self, text: str) -> None:
        self._call_handle("warn", str(text))
