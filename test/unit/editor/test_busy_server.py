"""Requests while a world is being opened, while an edit takes long, and by the thousand."""
from __future__ import annotations

import asyncio
import threading

import pytest
from editor_case import DEADLINE, Browser, Refused, box, cases

from my_simulations.editor.library import world_files
from my_simulations.editor.transport.web_socket import MOST_REQUESTS
from my_simulations.simulator.models import Models

case = pytest.fixture(cases)

SMALL = '<sdf version="1.6"><world name="small"><model name="new"><static>1</static>' \
        '<link name="link"/></model></world></sdf>'


class Gate:
    """Lets a function wait until `release`."""

    def __init__(self, monkeypatch, owner, name):
        self._reached = threading.Event()
        self.opened = threading.Event()
        function = getattr(owner, name)

        def waiting(*arguments, **options):
            self._reached.set()
            assert self.opened.wait(DEADLINE)
            return function(*arguments, **options)

        monkeypatch.setattr(owner, name, waiting)

    async def reached(self):
        """Wait until the function was called."""
        loop = asyncio.get_running_loop()
        assert await loop.run_in_executor(None, self._reached.wait, DEADLINE)

    def release(self):
        self.opened.set()


@pytest.fixture(params=["reading", "loading"])
def opening(request, case, monkeypatch):
    """A case and the gate at which it stops when a world is opened."""
    made = case(box("old"))
    (made.worlds / "small.world").write_text(SMALL)
    gate = (Gate(monkeypatch, world_files, "load_world") if request.param == "reading"
            else Gate(monkeypatch, Models, "load_all"))
    yield made, gate
    gate.release()


def test_cheap_requests_are_answered_while_a_world_opens(opening):
    made, gate = opening

    async def ask(browser):
        pending = asyncio.ensure_future(browser.ask("open", path="small.world"))
        await gate.reached()
        assert (await browser.ask("folders"))["files"]
        assert await browser.ask("autosave", action="list") == {"entries": []}
        await browser.ask("library")
        await browser.ask("play")
        await browser.ask("pause")
        await browser.ask("play")
        other = await Browser.open(browser.session, made.url)
        await other.ask("folders")
        assert not pending.done()
        gate.release()
        await pending
        await browser.until(lambda: browser.model("new"))
        assert not made.sim.clock.paused

    made.browse(ask)


def test_changes_are_refused_while_a_world_opens_and_possible_afterwards(opening):
    made, gate = opening

    async def ask(browser):
        pending = asyncio.ensure_future(browser.ask("open", path="small.world"))
        await gate.reached()
        for change in (browser.edit("delete", names=["old"]), browser.ask("undo"),
                       browser.ask("save", path="other.world"), browser.ask("step", steps=1),
                       browser.ask("open", path="small.world"), browser.ask("new"),
                       browser.ask("autosave", action="restore")):
            with pytest.raises(Refused) as refused:
                await change
            assert refused.value.code == "opening"
        assert not pending.done()
        gate.release()
        await pending
        await browser.edit("delete", names=["new"])
        await browser.ask("undo")

    made.browse(ask)


def test_a_world_that_cannot_be_opened_leaves_the_old_one_editable(case):
    made = case(box("old"))
    (made.worlds / "broken.world").write_text("no world")

    async def ask(browser):
        with pytest.raises(Refused):
            await browser.ask("open", path="broken.world")
        await browser.edit("delete", names=["old"])

    made.browse(ask)


def test_other_pages_are_greeted_while_an_edit_takes_long(case, monkeypatch):
    made = case(box("old"))
    gate = Gate(monkeypatch, Models, "delete_all")

    async def ask(browser):
        try:
            pending = asyncio.ensure_future(browser.edit("delete", names=["old"]))
            await gate.reached()
            other = await Browser.open(browser.session, made.url)
            assert other.last("history")["undo"] == []
            await browser.notify("presence", selected=["old"])
            await other.ask("folders")
            assert not pending.done()
        finally:
            gate.release()
        await pending
        await other.until(lambda: len(other.last("history")["undo"]) == 1)

    made.browse(ask)


def test_a_flood_of_requests_is_refused_beyond_a_limit_and_others_are_answered(case, monkeypatch):
    made = case(box("old"))
    gate = Gate(monkeypatch, Models, "delete_all")
    count = 4000

    async def ask(browser):
        try:
            pending = asyncio.ensure_future(browser.edit("delete", names=["old"]))
            await gate.reached()
            flood = [asyncio.ensure_future(browser.ask("step", steps=1)) for _ in range(count)]
            refused = flood[MOST_REQUESTS - 1:]  # the edit has no answer either
            await asyncio.wait_for(asyncio.wait(refused), DEADLINE)
            assert {one.exception().code for one in refused} == {"busy"}
            other = await Browser.open(browser.session, made.url)
            await other.ask("folders")
        finally:
            gate.release()
        await pending
        await asyncio.gather(*flood[:MOST_REQUESTS - 1])

    made.browse(ask)
