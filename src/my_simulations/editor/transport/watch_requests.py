"""The request `watch`: contacts, joints and values for plots, and the pushes with them."""
from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, Iterable, List, Optional, Protocol, Sequence, Set, Tuple

from ...description.scoped_names import split_scoped
from ...engine.ring import Snapshot
from ...engine.timed_forces import JointPid
from ...errors import CommandError, SimulationError
from ...geometry import Pose, Twist, rpy_from_quat
from ...simulator.entity import Entity
from ...simulator.joint_gains import default_gains
from ...simulator.simulator import Simulator
from ...simulator.wrenches import Effort
from .browser_client import Client, encode_message
from .clock_statistics import ClockStatistics
from .hub import Hub
from .pose_messages import Poses
from .web_socket import Route

PREFIX = "ros:"
"""Begins what a page watches of ROS, before the name of the topic."""


class RosTopics(Protocol):
    """What of ROS pages watch (`editor.topics`)."""

    def subscribe(self, client: Client, names: Set[str], plotted: Set[str]) -> None:
        """Subscribe a page to views and to numbers of topics. Raises CommandError."""

    def number_of(self, variable: str) -> Optional[float]:
        """The number of a field now; None before the first message. Raises CommandError."""


class WatchRequests:
    """Reads each topic once for all clients, in a thread of its own, as often as it can.

    Topics of ROS are handed on to `live`.
    """

    def __init__(self, hub: Hub, live: RosTopics) -> None:
        self._hub, self._live = hub, live
        self._watches = WatchedValues(hub.simulator, hub.clock, live.number_of)
        self._thread = ThreadPoolExecutor(1, "editor watches")
        self._due = 0.0
        self._task: "Optional[asyncio.Future[None]]" = None
        self._last_sent: Tuple[int, int] = (-1, -1)
        self._fresh = False
        hub.on_tick.append(self._tick)

    def routes(self) -> Dict[str, Route]:
        return {"watch": Route(self._watch, None)}

    async def _watch(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        topics = list(dict.fromkeys(message["topics"]))
        of_ros = {topic for topic in topics if topic.startswith(PREFIX)}
        if len(topics) > MOST_TOPICS:
            raise CommandError(f"at most {MOST_TOPICS} topics can be watched")
        for topic in topics:
            if topic not in of_ros:
                check_topic(topic)
        plotted = {topic[len(PLOT):].partition(".")[0] for topic in topics
                   if topic.startswith(f"{PLOT}/")}
        self._live.subscribe(client, {topic[len(PREFIX):] for topic in of_ros}, plotted)
        client.topics = set(topics) - of_ros
        self._fresh = True
        self._hub.wake()
        return {"topics": topics}

    def _tick(self, _poses: Optional[Poses], _revision: int) -> None:
        loop = asyncio.get_running_loop()
        if loop.time() < self._due or (self._task is not None and not self._task.done()):
            return
        topics: Set[str] = set()
        for client in self._hub.clients.values():
            if client.live:
                topics |= client.topics
        # Twists and joints are read for frames only when they happen to be.
        self._hub.request_states(self._hub.protocol.limits["watch_hz"] if topics else 0.0)
        simulator = self._hub.simulator
        now = (simulator.clock.step, simulator.feed.latest)
        if not topics or (now == self._last_sent and not self._fresh):
            return
        self._last_sent, self._fresh = now, False
        self._due = loop.time() + 1.0 / self._hub.protocol.limits["watch_hz"]
        self._task = asyncio.ensure_future(self._send(topics))

    async def _send(self, topics: Set[str]) -> None:
        loop = asyncio.get_running_loop()
        try:
            pushes = await loop.run_in_executor(self._thread, self._watches.pushes, topics)
        except CommandError:
            return  # no engine for the moment; the next tick asks again
        texts = {topic: encode_message(push) for topic, push in pushes.items()}
        self._hub.check(pushes.values())
        for client in self._hub.clients.values():
            for topic in client.topics & topics if client.live and not client.is_full else ():
                client.append(texts[topic])


MOST_TOPICS = 200
PLOT = "plot:"
"""Begins what a page plots: a variable of the world, or `/TOPIC.FIELD` of ROS."""

_POSE = {"x": 0, "y": 1, "z": 2, "roll": 3, "pitch": 4, "yaw": 5}
_TWIST = {"vx": 0, "vy": 1, "vz": 2, "wx": 3, "wy": 4, "wz": 5}
_JOINT = {"position": (0, 0), "rate": (0, 1), "position2": (1, 0), "rate2": (1, 1)}
_WORLD = ("sim_time", "real_time", "real_time_factor", "iterations")


class WatchedEntityMissingError(SimulationError):
    """What a topic is about is not there (any more)."""


def check_topic(topic: str) -> None:
    """Raises CommandError for a topic that could never be."""
    kind, colon, rest = topic.partition(":")
    if topic == "contacts" or (kind == "joints" and rest):
        return
    if kind == "plot" and colon:
        owner, _, field = rest.rpartition(".")
        name, dot, path = rest.partition(".")
        if rest.startswith("/") and name != "/" and dot and path:
            return
        if rest in _WORLD or (owner and field in {**_POSE, **_TWIST, **_JOINT}):
            return
    raise CommandError(f"unknown topic {topic!r}; known: contacts, joints:MODEL,"
                       " plot:sim_time, plot:NAME.x and the like, plot:/TOPIC.FIELD,"
                       " ros:/NAME")


class WatchedValues:
    """Makes the pushes of topics, of one moment each. For one thread at a time.

    Args:
        simulator: the world.
        clock: real time.
        ros_number: the number of `/TOPIC.FIELD` now, or None. Raises CommandError.
    """

    def __init__(self, simulator: Simulator, clock: ClockStatistics,
                 ros_number: Callable[[str], Optional[float]]) -> None:
        self._ros_number = ros_number
        self._world = simulator
        self._clock = clock
        self._step, self._time = 0, 0.0
        self._gains: Optional[Tuple[Entity, float, List[Dict[str, Dict[str, float]]]]] = None

    def pushes(self, topics: Iterable[str]) -> Dict[str, Dict[str, Any]]:
        # The clock first: a snapshot of a later time is harmless, one of an earlier time is not.
        self._step, clock = self._world.clock.now()
        entities, snapshot = self._world.states.latest()
        names = {entity.model.name: entity for entity in entities}
        if snapshot.step > self._step:
            self._step, clock = snapshot.step, snapshot.clock
        self._time = clock.sim_ns(self._step) * 1e-9
        found = {}
        for topic in topics:
            # A busy engine is ahead of its snapshots.
            push: Dict[str, Any] = {"type": "watch", "topic": topic, "time": snapshot.sim_ns * 1e-9
                                    if _is_state(topic) else self._time}
            try:
                push.update(self._read(topic, names, snapshot))
            except (WatchedEntityMissingError, CommandError) as fault:
                push["problem"] = str(fault)
            found[topic] = push
        return found

    def _read(self, topic: str, names: Dict[str, Entity], snapshot: Snapshot) -> Dict[str, Any]:
        kind, _, rest = topic.partition(":")
        if kind == "contacts":
            return {"contacts": self._contacts()}
        if kind == "joints":
            return {"joints": self._driven_joints(_owner(names, rest), snapshot)}
        value = self._value(rest, names, snapshot)
        return {} if value is None else {"value": value}

    def _driven_joints(self, entity: Entity, snapshot: Snapshot) -> List[Dict[str, Any]]:
        found = list(_joints(entity, snapshot))
        for state, gains in zip(found, self._default_gains(entity)):
            state["default_gains"] = gains
        for state, row in zip(found, entity.joint_names):
            drive = _drive(self._world.wrenches.efforts_on(f"{entity.model.name}::{row}"))
            if drive is not None:
                state["drive"] = drive
        return found

    def _default_gains(self, entity: Entity) -> List[Dict[str, Dict[str, float]]]:
        """By axis and mode; computed once for a model that stays as it is."""
        dt = self._world.physics.settings.max_step_size
        if self._gains is None or self._gains[0] is not entity or self._gains[1] != dt:
            joints = {joint.name: joint for joint in entity.model.joints}
            rows = [(joints[row[:-3] if row.endswith("::1") else row], row.endswith("::1"))
                    for row in entity.joint_names]
            self._gains = (entity, dt, [
                {mode: default_gains(entity.model, joint, mode == "velocity", dt, second)
                 for mode in ("position", "velocity")} for joint, second in rows])
        return self._gains[2]

    def _contacts(self) -> List[Dict[str, Any]]:
        return [{"a": a, "b": b, "position": list(one.position), "normal": list(one.normal),
                 "depth": one.depth, "force": one.force} for a, b,
                one in self._world.states.contacts()]

    def _value(self, variable: str, names: Dict[str, Entity],
               snapshot: Snapshot) -> Optional[float]:
        if variable.startswith("/"):
            return self._ros_number(variable)
        if variable in _WORLD:
            known = {"sim_time": lambda: self._time,
                     "real_time": lambda: self._clock.real_ns * 1e-9,
                     "real_time_factor": lambda: self._clock.factor,
                     "iterations": lambda: float(self._step)}
            return float(known[variable]())
        owner, _, field = variable.rpartition(".")
        if field in _JOINT:
            return _joint_value(names, owner, *_JOINT[field], snapshot)
        pose, twist = _state(names, owner, snapshot)
        if field in _POSE:
            return (*pose.position, *rpy_from_quat(pose.orientation))[_POSE[field]]
        return (*twist.linear, *twist.angular)[_TWIST[field]]


def _is_state(topic: str) -> bool:
    """Whether a topic has values of a snapshot: states of models, links or joints."""
    kind, _, rest = topic.partition(":")
    return kind == "joints" or kind == "plot" and rest[:1] != "/" and rest not in _WORLD


def _owner(names: Dict[str, Entity], name: str) -> Entity:
    found = names.get(name)
    if found is None:
        raise WatchedEntityMissingError(f"unknown model {name!r}")
    return found


def _split(names: Dict[str, Entity], scoped: str) -> Tuple[Entity, str]:
    model, rest = split_scoped(scoped, names.__contains__)
    if not model:
        raise WatchedEntityMissingError(f"unknown name {scoped!r}")
    return names[model], rest


def _state(names: Dict[str, Entity], name: str, snapshot: Snapshot) -> Tuple[Pose, Twist]:
    if name in names:
        return names[name].state(snapshot)
    entity, link = _split(names, name)
    if link not in entity.link_names:
        raise WatchedEntityMissingError(f"unknown link {name!r}")
    return entity.link_state(snapshot, link)


def _joint_value(names: Dict[str, Entity], name: str, axis: int, which: int,
                 snapshot: Snapshot) -> float:
    entity, joint = _split(names, name)
    for state in _joints(entity, snapshot):
        if state["name"] == joint and state["axis"] == axis:
            return float(state["rate" if which else "position"])
    raise WatchedEntityMissingError(f"joint {name!r} does not exist or has no axis {axis}")


def _drive(efforts: Sequence[Effort]) -> Optional[Dict[str, Any]]:
    """What an axis was asked for last, as a page asks for it."""
    if not efforts:
        return None
    last = efforts[-1]
    if not isinstance(last, JointPid):
        return {"mode": "force", "value": last}
    return {"mode": "velocity" if last.rate else "position", "value": last.target,
            "gains": {"p": last.p, "i": last.i, "d": last.d}}


def _joints(entity: Entity, snapshot: Snapshot) -> Iterable[Dict[str, Any]]:
    """Positions and rates of all axes of a model."""
    for joint, number, position, rate in entity.axis_states(snapshot):
        yield {"name": joint, "axis": number, "position": position, "rate": rate}
