"""What passes between browsers, the tutor's page and the editors of students."""
from __future__ import annotations

import asyncio
import json
import socket
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest
from free_ports import free_port

from my_simulations.classroom.class_file import read_class
from my_simulations.classroom.monitor import Monitor
from my_simulations.classroom.relay import Relay, filtered_head
from my_simulations.classroom.tutor_page import TutorPage
from my_simulations.errors import CommandError
from my_simulations.grading.mark import GRADED, CheckResult, Mark

HEAD = (b"GET / HTTP/1.1\r\nHost: h:1\r\nCookie: a=1; my_simulations_editor_5=mine; x=2\r\n"
        b"Connection: keep-alive\r\n\r\n")


def test_an_editor_receives_its_own_cookie_only():
    found = filtered_head(HEAD, "my_simulations_editor_5")
    assert found == (b"GET / HTTP/1.1\r\nHost: h:1\r\nCookie: my_simulations_editor_5=mine\r\n"
                     b"Connection: close\r\n\r\n")
    assert b"mine" not in filtered_head(HEAD, "my_simulations_editor_55")
    other = HEAD.replace(b"Cookie", b"cOOkie")
    assert b"ookie" not in filtered_head(other, "my_simulations_editor")


def test_a_web_socket_stays_open():
    head = (b"GET /ws HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            b"Cookie: other=1\r\n\r\n")
    assert filtered_head(head, "mine") == (b"GET /ws HTTP/1.1\r\nConnection: Upgrade\r\n"
                                      b"Upgrade: websocket\r\n\r\n")


def test_a_relay_passes_on_a_request_and_its_answer():
    async def run():
        seen = []

        async def answer(reader, writer):
            seen.append(await reader.readuntil(b"\r\n\r\n"))
            writer.write(b"HTTP/1.1 200 OK\r\n\r\nthere")
            writer.close()

        server = await asyncio.start_server(answer, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        activity, writing = socket.socketpair()
        listening, monitoring = (socket.create_server(("127.0.0.1", 0)) for _ in range(2))
        address = listening.getsockname()
        task = asyncio.ensure_future(Relay(port, "mine", writing.fileno()).serve(
            listening.detach(), monitoring.detach()))
        reader, writer = await asyncio.open_connection(*address)
        writer.write(b"GET / HTTP/1.1\r\nCookie: mine=1; other=2\r\n\r\n")
        found = await asyncio.wait_for(reader.read(), 60.0)
        writer.close()
        task.cancel()
        server.close()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert activity.recv(10)[:1] == b"."
        activity.close()
        writing.close()
        return seen, found

    seen, found = asyncio.run(run())
    assert seen == [b"GET / HTTP/1.1\r\nCookie: mine=1\r\nConnection: close\r\n\r\n"]
    assert found.endswith(b"there")


def test_a_monitor_shows_what_the_editor_says():
    monitor = Monitor(1)
    for message in (
            {"type": "world", "document": {"name": "lab", "models": [1, 2]}},
            {"type": "stats", "factor": 0.5, "sim_ns": 2e9, "paused": False},
            {"type": "people", "people": [{}, {}]},
            {"type": "issue", "issue": {"severity": "warning", "message": "harmless"}},
            {"type": "issue", "issue": {"severity": "error", "message": "x" * 1000}}):
        monitor.receive(json.dumps(message))
    assert (monitor.world, monitor.models, monitor.factor, monitor.time) == ("lab", 2, 0.5, 2.0)
    assert monitor.is_connected and monitor.people == 1 and len(monitor.error) == 300


@pytest.mark.parametrize("message", [
    [], {"type": "world"}, {"type": "world", "document": 3}, {"type": "stats", "factor": "much"},
    {"type": "issue", "issue": None}, {"type": "people", "people": 1},
    {"type": "stats", "factor": 10 ** 400}, {"type": "change", "models": []},
    {"type": "change", "models": {"a": {"pose": 1}}}])
def test_a_monitor_survives_what_is_no_message_of_the_editor(message):
    monitor = Monitor(1)
    monitor.receive(json.dumps(message))
    assert not monitor.is_connected


@pytest.mark.parametrize("data", ["no JSON", "[" * 100000, b"", b"\1\0\0\0" + b"x" * 77])
def test_a_monitor_survives_what_is_no_message_at_all(data):
    monitor = Monitor(1)
    monitor.receive(data)
    assert not monitor.is_connected


class Control:
    """A class with one student."""

    def __init__(self):
        self.calls = []

    def tiles(self):
        return [{"name": "anna", "link": "http://127.0.0.1:1/?token=secret"}]

    def picture(self, name):
        if name != "anna":
            raise CommandError(f"there is no student {name!r}")
        return "<svg/>"

    async def start_world(self, name):
        if name != "anna":
            raise CommandError(f"there is no student {name!r}")
        self.calls.append(("start", name))

    async def stop_world(self, name):
        self.calls.append(("stop", name))


def test_the_tutors_page_needs_the_token_of_the_tutor(tmp_path):
    port = free_port()
    (tmp_path / "class.yaml").write_text(f"students: [anna]\nport: {port}\n")
    plan = read_class(str(tmp_path / "class.yaml"))[0]
    control = Control()
    base = f"http://127.0.0.1:{port}/"

    def ask(path, data=None, **headers):
        try:
            with urlopen(Request(base + path, data, headers), timeout=60.0) as answer:
                return answer.status, answer.read().decode()
        except HTTPError as refusal:
            with refusal:
                return refusal.code, refusal.read().decode()

    def attempts():
        cookie = {"Cookie": f"my_simulations_class_{port}=right"}
        found = [ask("status.json")[0], ask("?token=wrong")[0], ask("students/anna/stop", b"")[0],
                 ask("students/anna/picture.svg")[0],
                 ask("status.json", Cookie="my_simulations_class_1=right")[0],
                 ask("status.json", **cookie, Origin="http://127.0.0.1:1")[0],
                 ask("students/anna/stop", b"", **cookie, **{"Sec-Fetch-Site": "same-site"})[0]]
        assert found == [403] * 7 and control.calls == []
        assert ask("?token=right")[1].startswith("<!doctype html>")
        assert json.loads(ask("status.json", **cookie)[1])["students"][0]["name"] == "anna"
        assert [ask(path, **cookie)[0] for path in ("tutor.js", "tutor.css")] == [200, 200]
        assert ask("students/anna/picture.svg", **cookie) == (200, "<svg/>")
        assert ask("students/carl/picture.svg", **cookie)[0] == 404
        assert [ask(f"marks/{path}", **cookie)[0] for path in (
            "", "students/anna/index.html", "../tokens.json", "%2e%2e/tokens.json", "link.html")
            ] == [404] * 5
        folder = tmp_path / "class" / "class" / "marks" / "students" / "anna"
        folder.mkdir(parents=True)
        (folder.parents[2] / "tokens.json").write_text("secret")
        (folder.parents[1] / "link.html").symlink_to(folder.parents[2] / "tokens.json")
        (folder / "mark.json").write_text(Mark("anna", GRADED, [
            CheckResult("a", 4.0, 3.0)]).to_json())
        (folder / "index.html").write_text("<b>page</b>")
        (folder / "replay.html").write_text("<script></script>")
        assert json.loads(ask("status.json", **cookie)[1])["students"][0]["mark"] == {
            "points": 3.0, "most": 4.0, "status": "graded"}
        assert [ask(f"marks/{path}", **cookie)[0] for path in (
            "students/anna/index.html", "../tokens.json", "%2e%2e/tokens.json", "link.html")
            ] == [200, 404, 404, 404]
        assert ask("marks/students/anna/index.html")[0] == 403
        with urlopen(Request(base + "marks/students/anna/replay.html", None, cookie)) as answer:
            assert answer.headers["Content-Security-Policy"].startswith("sandbox allow-scripts;")
        assert [ask(f"students/{name}", b"", **cookie)[0] for name in (
            "anna/start", "anna/stop", "carl/start", "anna/remove")] == [200, 200, 404, 404]
        assert control.calls == [("start", "anna"), ("stop", "anna")]

    async def run():
        page = TutorPage(plan, "right", control)
        assert await page.start() == f"{base}?token=right"
        try:
            await asyncio.get_running_loop().run_in_executor(None, attempts)
        finally:
            await page.close()

    asyncio.run(run())
