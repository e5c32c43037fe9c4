"""Pages that end at any moment: the node stays well and keeps what it accepted."""
from __future__ import annotations

import os
import random
import signal
import time
import xml.etree.ElementTree as ElementTree

import pytest
from gazebo_msgs.srv import GetModelState, GetWorldProperties
from support import wait_for

SEEDS = 100 if os.environ.get("MY_SIMULATIONS_LONG") == "1" else 10
EDITS = 40
LONGEST_S = 1.5
"""Until a page is ended, in seconds after its first edit."""
UNTOLD = 6
"""The worlds that may be there: the one that was told last, and after some requests more."""
CELL = 3.0
"""Distance of models, so that none touches another, in metres."""
WORK = """(async (edits) => {
  for (const [number, [type, fields]] of edits.entries()) {
    await editor.request(type, fields).then(() => console.log(`accepted ${number}`),
      (fault) => console.log(`refused ${number}: ${fault}`));
  }
})"""


def planned(chance, folder, seed):
    """(edits, worlds): requests of a page, and the world and the saved file after each of them.

    A world is the place of each box by its name.
    """
    edits, worlds, done, world, saved = [], [({}, None)], [], {}, None
    free = [(CELL * (1 + n % 7), CELL * (n // 7)) for n in range(4 * EDITS)]
    path = os.path.join(folder, f"kept_{seed}.world")
    for number in range(EDITS):
        pose = [*free[number], 0.5, 0.0, 0.0, 0.0, 1.0]
        kind = chance.choice(("insert", "insert", "move", "delete", "undo", "save"))
        name = chance.choice(sorted(world)) if world else ""
        if kind == "save":
            edits.append(("save", {"path": path, "overwrite": True}))
            saved = set(world)
        elif kind == "undo" and done:
            edits.append(("undo", {}))
            world = done.pop()
        elif kind == "delete" and name:
            edits.append(("edit", {"op": {"kind": "delete", "names": [name]}}))
            done.append(world)
            world = {key: place for key, place in world.items() if key != name}
        elif kind == "move" and name:
            edits.append(("edit", {"op": {"kind": "move", "poses": {name: pose}}}))
            done.append(world)
            world = {**world, name: free[number]}
        else:
            name = f"box_{number}"
            edits.append(("edit", {"op": {"kind": "insert", "shape": "box", "name": name,
                                          "pose": pose}}))
            done.append(world)
            world = {**world, name: free[number]}
        worlds.append((world, saved))
    return edits, worlds, path


def truth(node):
    """The boxes of the node by name, as ROS clients see them."""
    names = [name for name in node.ask("get_world_properties", GetWorldProperties).model_names
             if name != "ground_plane"]
    found = {name: node.ask("get_model_state", GetModelState, model_name=name) for name in names}
    return {name: (round(state.pose.position.x, 3), round(state.pose.position.y, 3))
            for name, state in found.items() if state.success}


def saved_names(path):
    """The boxes of a saved file, which is whole at any time; None if there is none."""
    if not os.path.exists(path):
        return None
    world = ElementTree.parse(path).getroot().find("world")
    return {model.get("name") for model in world.findall("model")} - {"ground_plane"}


def kill_renderers(editor):
    session = editor.context.browser.new_browser_cdp_session()
    for process in session.send("SystemInfo.getProcessInfo")["processInfo"]:
        if process["type"] == "renderer":
            os.kill(process["id"], signal.SIGKILL)
    session.detach()


ENDS = {"killed": kill_renderers, "reloaded": lambda editor: editor.page.reload(),
        "closed": lambda editor: editor.page.close(),
        "left": lambda editor: editor.page.goto("about:blank")}


def told(editor, word):
    """Return the numbers of the page's console messages that begin with a word, in order."""
    return [int(text.split()[1].rstrip(":")) for text in editor.said if text.startswith(word + " ")]


def test_pages_that_end_amid_their_edits_lose_nothing_that_was_accepted(node, browser):
    edits_done = 0
    editor = browser.open(node.url)
    for seed in range(SEEDS):
        chance = random.Random(seed)
        for request, fields in (("pause", {}), ("new", {"discard": True})):
            editor.page.evaluate("([type, fields]) => editor.request(type, fields)",
                                 [request, fields])
        wait_for(lambda: truth(node) == {}, "the empty world")
        edits, worlds, path = planned(chance, node.worlds, seed)
        editor.page.evaluate(f"(edits) => void {WORK}(edits)", edits)
        until = time.monotonic() + chance.uniform(0.0, LONGEST_S)
        while time.monotonic() < until:
            editor.page.wait_for_timeout(20)  # receives the page's console messages
        end = sorted(ENDS)[seed % len(ENDS)]
        ENDS[end](editor)
        where = f"seed {seed}, {end}"
        editor.context.browser.new_browser_cdp_session().detach()  # receives all earlier messages
        accepted = told(editor, "accepted")
        assert accepted == list(range(len(accepted))), where
        assert told(editor, "refused") == [], (where, editor.said)
        # The last request may or may not have been carried out, and the last console messages of a
        # killed page can be lost.
        possible = worlds[len(accepted):len(accepted) + UNTOLD]
        wait_for(lambda possible=possible: truth(node) in [world for world, _ in possible],
                 f"{where}: one of {possible}")
        wait_for(lambda possible=possible, path=path: saved_names(path) in
                 [saved for _, saved in possible], f"{where}: a saved file of {possible}")
        editor.context.close()

        following = browser.open(node.url)
        real = truth(node)
        assert set(following.names()) - {"ground_plane"} == set(real), where
        for name, (x, y) in real.items():
            assert following.model(name)["pose"][:2] == pytest.approx([x, y], abs=1e-3), where
        assert following.faults == [], where
        editor = following
        edits_done += len(accepted)
    editor.close()
    assert edits_done > SEEDS  # pages ended during their edits


@pytest.mark.parametrize("end", sorted(ENDS))
def test_what_an_ended_page_was_dragging_falls(node, browser, end):
    editor = browser.open(node.url)
    for request, fields in (("new", {"discard": True}), ("edit", {"op": {
            "kind": "insert", "shape": "box", "name": "held", "pose": [0, 0, 0.5, 0, 0, 0, 1]}}),
            ("play", {})):
        editor.page.evaluate("([type, fields]) => editor.request(type, fields)", [request, fields])
    editor.page.evaluate("editor.connection.send('drag', {names: ['held'],"
                         " poses: [[0, 0, 4, 0, 0, 0, 1]]})")
    wait_for(lambda: height(node, "held") > 3.0, "the body in the hand")
    ENDS[end](editor)
    wait_for(lambda: height(node, "held") < 0.6, "the fall")
    editor.context.close()


def height(node, name):
    """In metres."""
    return node.ask("get_model_state", GetModelState, model_name=name).pose.position.z
