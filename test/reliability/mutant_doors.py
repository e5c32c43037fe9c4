"""Feeds changed inputs to services, topics and the editor's messages."""
from __future__ import annotations

import asyncio
import importlib
import json
import os
import re
from pathlib import Path
from random import Random
from typing import Any, Callable, Dict, Hashable, Iterable, List, Tuple

import rospy
import service_requests
from editor_case import Case, arm, box
from mutant_run import Target, shape
from mutations import STRANGE_SCALARS, STRANGE_TEXTS, TreeKnowledge, strange_text

from my_simulations.editor.topics.message_views import ACCUMULATED, VIEWS, Viewer
from my_simulations.editor.transport.browser_client import Client, encode_message
from my_simulations.editor.transport.http_pages import Pages
from my_simulations.errors import SimulationError
from my_simulations.ros.endpoints import make_service_callback
from my_simulations.ros.services.state_services import StateServices

NAMES = ("a", "b", "a::link", "b::tip", "b::hinge", "hinge", "base", "new", "world", "map", "")
SANE = (0.0, 0.0, 0.5, 1.0, -1.0, 2.0, 0.001)
STRANGE = (float("nan"), float("inf"), float("-inf"), 1e308, -1e300, 1e155, 5e-324, -0.0)
STRANGE_FLOAT32 = (float("nan"), float("inf"), float("-inf"), 3.4e38, -3.4e38, 1e-45, -0.0)
ENCODINGS = ("rgb8", "bgr8", "rgba8", "mono8", "mono16", "16UC1", "32FC1", "bayer_rggb8", "yuv422",
             "8UC3", "64FC4", "jpeg", "png", "rgb8; jpeg compressed bgr8")
_SHORT = re.compile(r"\[(\d*)\]\Z")

Make = Callable[[Random], Any]


class Messages:
    """Makes messages of any type; most fields have values that may fit.

    Args:
        texts: what strings are made of.
    """

    def __init__(self, texts: Iterable[str]) -> None:
        self._texts = tuple(texts)
        self._made: Dict[str, Make] = {}

    def of(self, kind: str) -> Make:
        """Return a function that makes values of a field's type, in the range of its messages."""
        if kind not in self._made:
            self._made[kind] = self._maker(kind)
        return self._made[kind]

    def message(self, kind: Any) -> Make:
        """Return a function that makes messages of a class."""
        fields = [self.of(one) for one in kind._slot_types]
        return lambda chance: kind(*[make(chance) for make in fields])

    def _maker(self, kind: str) -> Make:
        several = _SHORT.search(kind)
        if several:
            return self._list(kind[:several.start()], several.group(1))
        if kind == "string":
            return self._text
        if kind == "bool":
            return lambda chance: chance.random() < 0.5
        if kind in ("float32", "float64"):
            strange = STRANGE if kind == "float64" else STRANGE_FLOAT32
            return lambda chance: chance.choice(strange if chance.random() < 0.03 else SANE)
        if kind in ("time", "duration"):
            return _time if kind == "time" else _duration
        if "/" in kind:
            package, name = kind.split("/")
            return self.message(getattr(importlib.import_module(f"{package}.msg"), name))
        bits = int("".join(filter(str.isdigit, kind)) or 8)
        low, high = (0, 2**bits - 1) if kind[0] in "ubc" else (-2**(bits - 1), 2**(bits - 1) - 1)
        return lambda chance: (chance.randint(low, high) if chance.random() < 0.2
                               else chance.choice((0, 1, 2, 3, 4, 7, 8, high, low)))

    def _list(self, kind: str, length: str) -> Make:
        if kind in ("uint8", "char", "byte"):
            return lambda chance: chance.randbytes(
                int(length) if length else chance.choice((0, 1, 4, 12, 16, 48, 64, 100, 1000)))
        one = self.of(kind)
        return lambda chance: [one(chance) for _ in range(
            int(length) if length else chance.choice((0, 0, 1, 1, 2, 3, 6)))]

    def _text(self, chance: Random) -> str:
        kind = chance.random()
        return (chance.choice(self._texts) if kind < 0.9 else
                chance.choice(STRANGE_TEXTS) if kind < 0.95 else
                strange_text(chance.choice(self._texts), [], chance))


def _time(chance: Random) -> Any:
    import genpy

    return genpy.Time(chance.choice((0, 0, 1, 10, 2**32 - 1)), chance.choice((0, 1, 999999999)))


def _duration(chance: Random) -> Any:
    import genpy

    return genpy.Duration(chance.choice((0, 0, 1, 10, -1, -2**31, 2**31 - 1)),
                          chance.choice((0, 1, 999999999, -999999999)))


class Services:
    """All services of a world without physics, which restarts before each round."""

    def __init__(self, _folder: Path) -> None:
        rospy.rostime.set_rostime_initialized(True)  # for log lines, which have a time
        makes = Messages((*NAMES, *service_requests.DOCUMENTS))
        self._simulator, endpoints = service_requests.start(box("a"), arm("b"))
        self._requests = [(endpoint.name, makes.message(endpoint.type._request_class))
                          for endpoint in endpoints]
        self.renew()
        self.target = Target("service requests", list(range(len(endpoints))),
                             lambda made, chance: made, self._encode, self._feed, self.renew,
                             ".request")

    def renew(self) -> None:
        """Start another world."""
        self._simulator.close()
        self._simulator, endpoints = service_requests.start(box("a"), arm("b"))
        self._answers = {endpoint.name: make_service_callback(endpoint) for endpoint in endpoints}
        self._left = 300

    def close(self) -> None:
        """End the world; it still takes models."""
        self._simulator.models.spawn(box("the last"))
        self._simulator.close()

    def _encode(self, made: int, chance: Random) -> Tuple[str, Any]:
        name, make = self._requests[made]
        return name, make(chance)

    def _feed(self, made: Tuple[str, Any]) -> List[Hashable]:
        name, request = made
        self._left -= 1
        if not self._left:
            self.renew()  # what it has grown to costs time
        try:
            answer = self._answers[name](request)
        except rospy.ServiceException as fault:
            assert "internal error" not in str(fault), fault
            return [(name, shape(str(fault)))]
        text = getattr(answer, "status_message", "")
        assert "internal error" not in text, text
        return [(name, shape(text))]


class Topics:
    """The topics that the node hears."""

    def __init__(self, _folder: Path) -> None:
        from gazebo_msgs.msg import LinkState, ModelState

        rospy.rostime.set_rostime_initialized(True)
        makes = Messages(NAMES)
        self._simulator, _ = service_requests.start(box("a"), arm("b"))
        states = StateServices(self._simulator)
        self._heard = [(makes.message(ModelState), states.on_model_state),
                       (makes.message(LinkState), states.on_link_state)]
        self.target = Target("topics of the node", [0, 1], lambda made, chance: made,
                             lambda made, chance: (made, self._heard[made][0](chance)),
                             self._feed, suffix=".message")

    def close(self) -> None:
        """End the world; all of it is finite."""
        for name in ("a", "b"):
            pose, twist = self._simulator.states.model_state(name)
            assert all(abs(value) <= 1.8e308 for value in (*pose.position, *twist.linear))
        self._simulator.close()

    def _feed(self, made: Tuple[int, Any]) -> List[Hashable]:
        number, message = made
        self._heard[number][1](message)
        return [number]


class TopicViews:
    """The views of messages of any node that pages show."""

    def __init__(self, _folder: Path) -> None:
        makes = Messages((*NAMES, *ENCODINGS, "x", "y", "z", "rgb", "intensity"))
        kinds = [*VIEWS, *ACCUMULATED, "gazebo_msgs/ModelStates", "sensor_msgs/JointState",
                 "diagnostic_msgs/DiagnosticArray", "std_msgs/UInt8MultiArray",
                 "dynamic_reconfigure/ConfigDescription"]
        self._kinds: List[Tuple[str, Make]] = []
        for kind in kinds:
            package, name = kind.split("/")
            try:
                module = importlib.import_module(f"{package}.msg")
            except ImportError:
                continue  # not on this system
            self._kinds.append((kind, makes.message(getattr(module, name))))
        self._viewers = {kind: Viewer(kind, lambda: 1.0) for kind, _ in self._kinds}
        self.target = Target("views of topics", list(range(len(self._kinds))),
                             lambda made, chance: made, self._encode, self._feed, self._renew,
                             ".message")

    def close(self) -> None:
        """Do nothing: nothing is open."""

    def _renew(self) -> None:
        self._viewers = {kind: Viewer(kind, lambda: 1.0) for kind in self._viewers}

    def _encode(self, made: int, chance: Random) -> Tuple[str, Any]:
        kind, make = self._kinds[made]
        message = make(chance)
        if hasattr(message, "step") and chance.random() < 0.8:
            _fitting(message, chance)
        return kind, message

    def _feed(self, made: Tuple[str, Any]) -> List[Hashable]:
        kind, message = made
        viewer = self._viewers[kind]
        viewer.receive(message)
        try:
            frame, stamp, (fields, data) = viewer.view()
        except SimulationError as fault:
            return [(kind, shape(str(fault)))]
        encode_message({"frame": frame, "stamp": stamp, **fields})
        return [(kind, fields.get("type"), min(len(data), 3))]


def _fitting(message: Any, chance: Random) -> None:
    """Sizes of an image or a cloud that its bytes have."""
    message.width, message.height = chance.choice((0, 1, 2, 5)), chance.choice((0, 1, 3))
    wide = getattr(message, "point_step", 0) and chance.choice((4, 12, 16, 32))
    if wide:
        message.point_step = wide
        for field in message.fields:
            field.offset = chance.choice((0, 4, 8, 12, 31, 2**32 - 1))
            field.datatype = chance.choice((1, 2, 4, 6, 7, 7, 7, 8, 0, 9))
            field.count = chance.choice((1, 1, 1, 0, 2, 2**32 - 1))
    message.step = message.width * (wide or chance.choice((1, 2, 3, 4, 6, 8)))
    if hasattr(message, "row_step"):
        message.row_step = message.step
    message.data = chance.randbytes(message.step * message.height)


class Page:
    """Stands for a browser's socket, and keeps what it was sent."""

    closed = False

    def __init__(self) -> None:
        self.client = Client(1_000_000, self)  # type: ignore[arg-type]
        self.sent: List[Dict[str, Any]] = []
        self.client.append = self._append  # type: ignore[method-assign]

    def _append(self, data: Any) -> None:
        if isinstance(data, str):
            self.sent.append(json.loads(data))


ELSEWHERE = ("hello", "open", "new", "save", "autosave", "library", "log_", "building_save", "step",
             "import_model", "building_load", "building_list", "topics", "drive", "play")
"""Requests that write files, replace the world or take long by nature have tests of their own."""

REQUESTS_A_WORLD = 2000


class Editor:
    """The editor's messages, as they come out of a page's socket."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._number = 0
        self._case: Any = None
        with open(os.path.join(Pages.own_folder(), "protocol.json"), encoding="utf-8") as stream:
            self._protocol = json.load(stream)
        self._known = TreeKnowledge(tuple(one for one in STRANGE_SCALARS
                                          if one == one or not isinstance(one, float)))
        self._allowed = [kind for kind in sorted(self._protocol["requests"])
                         if not kind.startswith(ELSEWHERE)]
        seeds = self._seeds(Random(7))
        for seed in seeds:
            self._known.learn(seed)
        self.renew()
        self.target = Target("editor messages", seeds, self._change, self._encode, self._feed,
                             self.renew, ".json")

    def renew(self) -> None:
        """Start another world and its editor."""
        self.close()
        self._number += 1
        place = self._folder / f"editor{self._number}"
        place.mkdir()
        self._case = Case(place, [box("a"), arm("b")])
        self._page = Page()
        server = self._case.server
        self._loop = server._loop
        self._handle = server._editor.sockets._handle
        self._left = REQUESTS_A_WORLD
        self._ask({"type": "hello", "id": 0, "version": self._protocol["version"]})
        server._editor.hub.clients[self._page.client.number] = self._page.client

    def close(self) -> None:
        """End both; the world still takes edits."""
        if self._case is None:
            return
        del self._case.server._editor.hub.clients[self._page.client.number]
        reply = self._ask({"type": "edit", "id": 1, "op": {
            "kind": "insert", "shape": "box", "name": "the last"}})
        assert reply["ok"] and self._case.sim.models.has(reply["value"]["name"])
        self._case.close()
        self._case = None

    def _seeds(self, chance: Random) -> List[Dict[str, Any]]:
        found = [{"type": "edit", "id": 1, "op": {"kind": kind, **self._fields(fields, chance)}}
                 for kind, fields in self._protocol["operations"].items() for _ in range(6)]
        found += [{"type": kind, "id": 1, **self._fields(
            self._protocol["requests"][kind]["fields"], chance)}
            for kind in self._allowed for _ in range(2)]
        found += [{"type": kind, **self._fields(fields, chance)}
                  for kind, fields in self._protocol["notices"].items()]
        return found

    def _fields(self, fields: Dict[str, str], chance: Random, depth: int = 0) -> Dict[str, Any]:
        return {name: self._value(kind.rstrip("?"), chance, depth)
                for name, kind in fields.items() if not kind.endswith("?")
                or (chance.random() < 0.5 and depth < 4)}

    def _value(self, kind: str, chance: Random, depth: int) -> Any:
        plain = {"string": NAMES + ("pose", "static", "links.0.name"), "boolean": (True, False),
                 "number": (0.0, 0.5, 1.0), "integer": (0, 1, 3),
                 "any": (1.0, "a", True, [0, 0, 1]),
                 "Operation": ({"kind": "delete", "names": ["a"]},), "object": ({},)}
        types = self._protocol["types"]
        if kind in plain:
            return chance.choice(plain[kind])
        if kind.startswith("'"):
            return chance.choice(kind.replace("'", "").split("|"))
        if kind.endswith("]"):
            head, _, length = kind[:-1].rpartition("[")
            return [self._value(head, chance, depth + 1) for _ in range(int(length or 2))]
        if kind.startswith("{"):
            return {chance.choice(NAMES): self._value(kind[1:-1], chance, depth + 1)}
        if kind.startswith("some "):
            fields = {name: f"{one.rstrip('?')}?" for name, one in types[kind[5:]].items()}
            return self._fields(fields, chance, depth + 1)
        if "|" in kind and kind not in types:
            return self._value(chance.choice(kind.split("|")), chance, depth)
        found = types[kind]
        return (self._value(found, chance, depth + 1) if isinstance(found, str)
                else self._fields(found, chance, depth + 1))

    def _change(self, made: Any, chance: Random) -> Any:
        changed = self._known.change(made, chance)
        kind = changed.get("type") if isinstance(changed, dict) else None
        if isinstance(kind, str) and (kind.startswith(ELSEWHERE)):
            changed = {**changed, "type": "edit"}
        return changed

    @staticmethod
    def _encode(made: Any, chance: Random) -> str:
        text = json.dumps(made, ensure_ascii=chance.random() < 0.5)
        if chance.random() < 0.03:
            at = chance.randrange(len(text))
            text = text[:at] + chance.choice(("", "{", "]", "\0", '"', "NaN", "1e999")) + text[at:]
        return text

    def _feed(self, text: str) -> List[Hashable]:
        self._left -= 1
        if not self._left:
            self.renew()
        self._page.sent.clear()
        asyncio.run_coroutine_threadsafe(
            self._handle(self._page.client, text, False), self._loop).result(60)
        found: List[Hashable] = []
        for one in self._page.sent:
            issues = one.get("issues") or ([one["issue"]] if "issue" in one else [])
            assert not any("server failed" in issue["message"] for issue in issues), issues
            found += [(issue["code"], shape(issue["message"])) for issue in issues]
            if one.get("ok"):
                found.append(text[:40])
        return found

    def _ask(self, message: Dict[str, Any]) -> Any:
        self._page.sent.clear()
        asyncio.run_coroutine_threadsafe(
            self._handle(self._page.client, json.dumps(message), False), self._loop).result(60)
        return next(one for one in self._page.sent
                    if one.get("type") == "reply" and one["id"] == message["id"])


DOORS = {"service requests": Services, "topics of the node": Topics, "views of topics": TopicViews,
         "editor messages": Editor}
