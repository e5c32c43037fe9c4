"""An editor's server on a world without physics, and browsers without a screen."""
from __future__ import annotations

import asyncio
import json
import struct

import aiohttp
from inline_engine import InlineEngine

from my_simulations import editor
from my_simulations.description.light import Light
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Visual
from my_simulations.description.world import World
from my_simulations.editor.topics.topic_frame import TOPIC
from my_simulations.geometry import Pose
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.simulator import Simulator

DEADLINE = 60.0
HEAD = struct.Struct("<IIQddII")
RECORD = struct.Struct("<I7f")


def box(name, position=(0.0, 0.0, 0.5), **changes):
    inertial = Inertial(1.0, ixx=1 / 6, iyy=1 / 6, izz=1 / 6)
    link = Link("link", inertial=inertial, collisions=[Collision("collision", Box())],
                visuals=[Visual("visual", Box())])
    return Model(name, Pose(position), links=[link], **changes)


def arm(name):
    made = Model(name, links=[
        Link("base", inertial=Inertial(1.0), collisions=[Collision("c", Box())]),
        Link("tip", Pose((0.0, 0.0, 1.0)), Inertial(1.0), [Collision("c", Box())])])
    made.joints.append(Joint("hinge", "revolute", "base", "tip", axis=JointAxis()))
    return made


class Case:
    """One world and its editor, with folders of its own below `folder`."""

    def __init__(self, folder, models=(), lights=(), paused=True, resolver=None, **options):
        self.folder = folder
        self.worlds = folder / "worlds"
        self.worlds.mkdir(exist_ok=True)
        self.issues = []
        self.engine = InlineEngine()
        world = World(models=list(models), lights=list(lights))
        self.sim = Simulator(world, engine_factory=lambda: self.engine, paused=paused,
                             log=self.issues.append)
        self.sim.start()
        self.options = editor.EditorOptions(**{
            "port": 0, "token": "", "save_roots": [str(self.worlds)],
            "config_dir": str(folder / "config"),
            "cache_dir": str(folder / "cache"), "data_dir": str(folder / "data" / "log"),
            "check_outgoing": True, "log": self.issues.append, **options})
        self.resolver = resolver or Resolver.from_environment()
        self.server = editor.start(self.sim, self.resolver, self.options)
        self.url = self.server.url

    def close(self):
        self.server.stop()
        self.sim.close()

    def browse(self, scenario, **options):
        """Run a coroutine with one browser that has the world."""
        async def run():
            async with aiohttp.ClientSession() as session:
                browser = await Browser.open(session, self.url, **options)
                return await asyncio.wait_for(scenario(browser), 3 * DEADLINE)

        return asyncio.run(run())


def cases(tmp_path):
    """What makes cases, and ends them: make a fixture of it."""
    made = []

    def make(*models, **options):
        made.append(Case(tmp_path, models, **options))
        return made[-1]

    yield make
    for one in made:
        one.close()


class Refused(Exception):
    """A request was refused; `code` is that of the first issue."""

    def __init__(self, issues):
        super().__init__(issues[0]["message"])
        self.issues = issues
        self.code = issues[0]["code"]


COME_AGAIN = 1012
"""Close code of a server that goes on as another one (RFC 6455 registry)."""


class Browser:
    """Keeps what a page would: the document, the poses, and all pushes."""

    def __init__(self, session, socket):
        self.session = session
        self.socket = socket
        self.pushes = []
        self.frames = []
        self.views = []
        self.poses = {}
        self.document = None
        self.changes = asyncio.Condition()
        self._replies = {}
        self._number = 0
        self._reader = asyncio.ensure_future(self._read())

    @classmethod
    async def open(cls, session, url, hello=True, **headers):
        base, mark, query = url.partition("?")
        while True:
            socket = await session.ws_connect(base + "ws" + mark + query, max_msg_size=0,
                                              headers=headers or None)
            browser = cls(session, socket)
            if not hello:
                return browser
            try:
                await browser.ask("hello", version=1)
            except ConnectionError:
                # Served while the world was loaded: as the page does, come again.
                if socket.close_code != COME_AGAIN:
                    raise
            else:
                await browser.until(lambda: browser.document is not None)
                return browser

    async def ask(self, kind, **fields):
        """The answer's value; raises Refused."""
        self._number += 1
        number = self._number
        self._replies[number] = asyncio.get_running_loop().create_future()
        if self._reader.done():
            raise ConnectionError(f"closed: {self.socket.close_code}")
        await self.socket.send_json({"type": kind, "id": number, **fields})
        reply = await asyncio.wait_for(self._replies[number], DEADLINE)
        if not reply["ok"]:
            raise Refused(reply["issues"])
        return reply["value"]

    async def edit(self, kind, **fields):
        return await self.ask("edit", op={"kind": kind, **fields})

    async def notify(self, kind, **fields):
        """Send a notice."""
        await self.socket.send_json({"type": kind, **fields})

    async def until(self, condition):
        """Wait until something that was received makes a condition true."""
        async with self.changes:
            await asyncio.wait_for(self.changes.wait_for(condition), DEADLINE)

    def last(self, kind):
        return next((push for push in reversed(self.pushes) if push["type"] == kind), None)

    def model(self, name):
        return next((one for one in self.document["models"] if one["name"] == name), None)

    def light(self, name):
        return next((one for one in self.document["lights"] if one["name"] == name), None)

    def link_pose(self, model, link=0):
        """Position of a link in the last frames that told of it."""
        found = self.model(model)
        known = self.poses.get(found["links"][link]["id"]) if found else None
        return None if known is None else known[:3]

    async def _read(self):
        async for message in self.socket:
            async with self.changes:
                if message.type == aiohttp.WSMsgType.BINARY:
                    self._frame(message.data)
                else:
                    self._text(json.loads(message.data))
                self.changes.notify_all()
        for waiting in self._replies.values():
            waiting.set_exception(ConnectionError(f"closed: {self.socket.close_code}"))
        self._replies.clear()

    def _frame(self, data):
        if data[0] == TOPIC:
            self.views.append(data)
            return
        kind, revision, step, sim, real, count, _ = HEAD.unpack_from(data)
        assert len(data) == HEAD.size + count * RECORD.size
        self.frames.append((kind, revision, sim, count))
        for n in range(count):
            known, *pose = RECORD.unpack_from(data, HEAD.size + n * RECORD.size)
            self.poses[known] = pose

    def _text(self, message):
        if message["type"] == "reply":
            self._replies.pop(message["id"]).set_result(message)
            return
        self.pushes.append(message)
        if message["type"] == "world":
            self.document, self.poses = message["document"], {}
        elif message["type"] == "change":
            self.document.update(message.get("world", {}))
            for kind in ("models", "lights"):
                for name, value in message.get(kind, {}).items():
                    kept = [one for one in self.document[kind] if one["name"] != name]
                    self.document[kind] = kept + ([value] if value else [])
            places = {name: n for n, name in enumerate(message.get("order", ()))}
            for kind in ("models", "lights") if places else ():
                self.document[kind].sort(key=lambda one: places.get(one["name"], len(places)))


def sun():
    return Light("sun", "directional", Pose((0.0, 0.0, 10.0)))
