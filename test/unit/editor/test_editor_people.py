"""Several people at one world: who is here, who holds what, whose edits are undone."""
from __future__ import annotations

import json
import os
import struct

import pytest
from editor_case import Browser, box, cases

case = pytest.fixture(cases)

POSE = [1.0, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0]
FARTHER = [2.0, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0]


def notes(browser):
    return [push["issue"]["message"] for push in browser.pushes
            if push["type"] == "issue" and push["issue"]["code"] == "shared-edit"]


def people(browser):
    push = browser.last("people")
    return {one["name"]: one for one in push["people"]} if push else {}


async def another(first, url, **fields):
    browser = await Browser.open(first.session, url, hello=False)
    await browser.ask("hello", version=1, **fields)
    await browser.until(lambda: browser.document is not None)
    return browser


def test_everybody_knows_who_is_here_and_what_they_have_selected(case):
    made = case(box("a"))

    async def meet(first):
        second = await another(first, made.url, person="key", name="Anna")
        await first.until(lambda: set(people(first)) == {"Guest 1", "Anna"})
        await second.notify("presence", selected=["a"])
        await first.until(lambda: people(first)["Anna"]["selected"] == ["a"])
        await second.notify("presence", name="Guest 1")   # another's
        await second.notify("presence", name="  Bea\n M. ")
        await first.until(lambda: set(people(first)) == {"Guest 1", "Bea M."})
        await second.socket.close()
        await first.until(lambda: set(people(first)) == {"Guest 1"})
        third = await another(first, made.url, person="key")  # the page was loaded again
        await third.until(lambda: set(people(third)) == {"Guest 1", "Bea M."})

    made.browse(meet)


def test_the_last_release_wins_and_both_hands_are_told(case):
    made = case(box("a"))

    async def pull(first):
        second = await another(first, made.url)
        await first.notify("drag", names=["a"], poses=[POSE])
        await second.until(lambda: people(second)["Guest 1"]["held"] == ["a"])
        await second.notify("drag", names=["a"], poses=[FARTHER])
        await first.until(lambda: any("Guest 2 is dragging a too" in text for text in
                                      notes(first)))
        await second.until(lambda: any("Guest 1 is dragging a too" in text for text in
                                       notes(second)))
        await first.edit("move", poses={"a": POSE})
        await second.until(lambda: any("Guest 1 released a" in text for text in notes(second)))
        await second.until(lambda: people(second)["Guest 1"]["held"] == [])
        assert people(second)["Guest 2"]["held"] == ["a"]
        await second.edit("move", poses={"a": FARTHER})
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(2.0)
        # Each undo takes back one hand's move.
        await second.ask("undo")
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(1.0)
        await second.ask("undo")
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(0.0)

    made.browse(pull)


def test_deleting_what_somebody_drags_says_so_to_both(case):
    made = case(box("a"))

    async def delete(first):
        second = await another(first, made.url)
        await first.notify("drag", names=["a"], poses=[POSE])
        await second.until(lambda: people(second)["Guest 1"]["held"] == ["a"])
        await second.edit("delete", names=["a"])
        await first.until(lambda: "a, which you were dragging, was deleted by Guest 2"
                          in notes(first))
        await second.until(lambda: "Guest 1 was dragging a, which you deleted" in notes(second))
        await second.until(lambda: people(second)["Guest 1"]["held"] == [])

    made.browse(delete)


def test_undoing_another_s_edit_says_whose_it_is(case):
    made = case()

    async def undo(first):
        second = await another(first, made.url)
        await first.edit("insert", shape="box")
        await second.edit("insert", shape="sphere")
        await second.until(lambda: second.last("history")["undo_by"] == ["Guest 2", "Guest 1"])
        assert (await second.ask("undo"))["by"] == []
        assert (await second.ask("undo"))["by"] == ["Guest 1"]
        await first.until(lambda: "Guest 2 undid your edit: Insert unit_box" in notes(first))
        assert second.last("history")["redo_by"] == ["Guest 1", "Guest 2"]
        assert (await first.ask("redo", to=1))["by"] == ["Guest 2"]
        await second.until(lambda: "Guest 1 redid your edit: Insert unit_sphere" in notes(second))

    made.browse(undo)


def test_a_hand_that_lets_go_without_release_leaves_what_another_holds(case):
    made = case(box("a"))

    async def leave(first):
        second = await another(first, made.url)
        await first.notify("drag", names=["a"], poses=[POSE])
        await second.until(lambda: people(second)["Guest 1"]["held"] == ["a"])
        await second.notify("drag", names=["a"], poses=[FARTHER])
        await first.until(lambda: people(first)["Guest 2"]["held"] == ["a"])
        await first.notify("drag_end")
        await second.until(lambda: people(second)["Guest 1"]["held"] == [])
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(2.0)

    made.browse(leave)


def frame(kind, payload):
    """A frame of a web socket's client (RFC 6455, 5.2) with a mask of zeros."""
    assert len(payload) < 126
    return bytes((0x80 | kind, 0x80 | len(payload))) + bytes(4) + payload


def test_what_comes_with_the_farewell_is_done_before_what_its_client_held_falls(case):
    made = case(box("a"))

    async def leave(first):
        second = await another(first, made.url)
        await first.until(lambda: "Guest 2" in people(first))
        drag = {"type": "drag", "names": ["a"], "poses": [FARTHER]}
        wire = second.socket.get_extra_info("socket")
        os.write(wire.fileno(),
                 frame(1, json.dumps(drag).encode()) + frame(8, struct.pack(">H", 1000)))
        await first.until(lambda: "Guest 2" not in people(first))
        await first.ask("step", steps=1)    # in the same thread as the end of the drag
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(0.0)

    made.browse(leave)
