"""Several browsers on one world, and what outlives a crash."""
from __future__ import annotations

import os
import signal
import xmlrpc.client

from free_ports import free_port
from pytest import approx
from support import wait_for

LOST_MESH = """<sdf version="1.6"><world name="default"><include><uri>model://sun</uri></include>
  <model name="post"><static>1</static><link name="link"><visual name="visual"><geometry>
    <mesh><uri>model://no_such/post.stl</uri></mesh>
  </geometry></visual></link></model></world></sdf>"""


def test_two_browsers_see_each_other_s_edits_and_share_one_history(launch, browser):
    node = launch("worlds/empty.world")
    first, second = browser.open(node.url), browser.open(node.url, color_scheme="light")
    first.place("Box", (0.0, 0.0, 0.0))
    wait_for(lambda: "unit_box" in second.names(), "the box in the other browser")
    second.row("unit_box").click()
    second.field("pose y").fill("1.25")
    second.field("pose y").press("Enter")
    wait_for(lambda: first.model("unit_box")["pose"][1] == approx(1.25), "the move in the first")
    # What is chosen is everybody's own.
    second.page.keyboard.press("Escape")
    second.page.keyboard.press("Escape")
    first.row("ground_plane").click()
    second.until("editor.store.selection.length === 0", "the second's own selection")
    for _ in range(2):
        first.page.locator("#view").focus()
        first.page.keyboard.press("Control+z")
    wait_for(lambda: "unit_box" not in second.names(), "the undone insertion")
    assert first.faults == second.faults == []
    first.close()
    second.close()


def test_two_people_at_one_world_see_whose_hand_is_where(launch, browser):
    node = launch("worlds/empty.world")
    first = browser.open(node.url)
    assert first.page.locator("#people").is_hidden()
    first.place("Box", (0.0, 0.0, 0.0))
    second = browser.open(node.url)
    first.page.get_by_role("group", name="Who is here").get_by_text("Guest 2").wait_for()
    wait_for(lambda: "by Guest 1" in second.button("Undo").get_attribute("title"), "the author")
    second.until("editor.view.sharedMarks.join() === 'unit_box'", "the first's selection")

    # The first drags; the second sees the hand, takes the box too, and both are told.
    first.page.keyboard.press("t")
    x, y = first.get("editor.view.pixelOf('unit_box')")
    first.page.mouse.move(x - 12, y + 12)
    first.page.mouse.down()
    first.page.mouse.move(x + 60, y + 12, steps=6)
    second.page.get_by_text("unit_box", exact=True).first.wait_for()
    wait_for(lambda: second.get("editor.store.others[0].held.join()") == "unit_box", "the hand")
    second.page.keyboard.press("t")
    x, y = second.get("editor.view.pixelOf('unit_box')")
    second.page.mouse.move(x, y)
    second.page.mouse.down()
    second.page.mouse.move(x - 60, y, steps=6)
    told(first, "Guest 2 is dragging unit_box too")
    second.page.mouse.up()
    told(first, "Guest 2 released unit_box, which you are dragging")
    first.page.mouse.up()
    first.until("editor.store.history.undo.length === 3", "two moves")

    # Another user deletes the dragged entity: the drag ends without an error.
    x, y = first.get("editor.view.pixelOf('unit_box')")
    first.page.mouse.move(x, y)
    first.page.mouse.down()
    first.page.mouse.move(x + 30, y, steps=4)
    wait_for(lambda: second.get("editor.store.others[0].held.join()") == "unit_box", "the hand")
    second.row("unit_box").click()
    second.page.keyboard.press("Delete")
    told(first, "unit_box, which you were dragging, was deleted by Guest 2")
    first.page.mouse.move(x + 50, y, steps=4)
    first.page.mouse.up()
    assert first.get("editor.store.issues.filter(({severity}) => severity === 'error')") == []

    # An undo of another's edit says whose it was.
    first.page.locator("#view").focus()
    first.page.keyboard.press("Control+z")
    told(first, "Undid an edit of Guest 2: Delete unit_box")
    told(second, "Guest 1 undid your edit: Delete unit_box")
    assert first.faults == second.faults == []
    first.close()
    second.close()


def test_unsaved_changes_survive_a_killed_node_and_are_offered_again(launch, browser):
    node = launch("worlds/empty.world")
    editor = browser.open(node.url)
    editor.place("Cylinder", (0.5, 1.0, 0.0))
    pose = editor.model("unit_cylinder")["pose"]
    kept = os.path.join(node.home, ".cache", "my_simulations", "autosave")
    wait_for(lambda: os.path.isdir(kept) and autosaved(kept, "unit_cylinder"), "the autosave")
    os.kill(server_pid(node), signal.SIGKILL)
    editor.page.get_by_text("Connection to the simulator lost").wait_for()
    editor.close()
    node.close()

    again = browser.open(launch("worlds/empty.world").url)
    offer = again.page.get_by_role("dialog", name="Restore unsaved changes?")
    offer.wait_for()
    again.page.keyboard.press("Space")  # a key pressed by chance loses nothing
    wait_for(lambda: "unit_cylinder" in again.names(), "the cylinder's return")
    assert again.model("unit_cylinder")["pose"] == approx(pose, abs=1e-5)
    again.until("editor.store.history.dirty", "the mark of unsaved changes")
    again.close()


def test_an_open_page_says_how_to_open_a_simulator_that_was_started_again(launch, browser):
    port = free_port()
    node = launch("worlds/empty.world", f"editor_port:={port}")
    left_open = browser.open(node.url)
    node.close()
    again = launch("worlds/empty.world", f"editor_port:={port}")
    assert again.url != node.url and again.url.partition("?")[0] == node.url.partition("?")[0]
    left_open.page.get_by_text("Run “gzclient”").wait_for()
    assert left_open.get("editor.store.connected") is False
    # What gzclient does: it opens the new address, whose token the browser keeps.
    page = left_open.context.new_page()
    page.goto(again.url)
    left_open.until("editor.store.connected", "the connection of the page that was left open")
    assert not left_open.page.get_by_text("Run “gzclient”").is_visible()
    page.close()
    left_open.close()


def test_a_page_that_is_loaded_again_shows_no_cards_of_old_issues(launch, browser, tmp_path):
    world = tmp_path / "lost.world"
    world.write_text(LOST_MESH, encoding="utf-8")
    editor = browser.open(launch(str(world)).url)
    cards = editor.page.locator("#notices .notice.warning")
    cards.filter(has_text="no_such").wait_for()
    unseen = editor.page.locator(".notices-button .badge")
    assert unseen.text_content() == "1"
    editor.page.reload()
    editor.wait_for_world()
    told(editor, "no_such")
    assert cards.count() == 0 and not unseen.is_visible()
    editor.button("Messages").click()
    editor.page.get_by_role("dialog", name="All messages").get_by_text("no_such").wait_for()
    # A later issue has a card again.
    editor.get(f"editor.request('open', {{path: {str(world)!r}, discard: true}})")
    cards.filter(has_text="no_such").wait_for()
    assert editor.faults == []
    editor.close()


def test_a_page_that_meets_another_simulator_without_a_token_says_which_world_it_shows(
        launch, browser, tmp_path):
    port = free_port()
    options = f"editor_port:={port}", "editor_token:=false"
    node = launch("worlds/empty.world", *options)
    editor = browser.open(node.url)
    node.close()
    world = tmp_path / "lost.world"
    world.write_text(LOST_MESH, encoding="utf-8")
    launch(str(world), *options)
    told(editor, "another start of a simulator, with the world lost.world")
    told(editor, "no_such")
    assert editor.faults == []
    editor.close()


def told(editor, text):
    """Waits for a message; its card may have gone by then."""
    editor.until(f"editor.store.issues.some(({{message}}) => message.includes({text!r}))", text)


def autosaved(folder, name):
    """Whether an autosave that is complete (its .json comes last) holds a name."""
    for entry in os.listdir(folder):
        if not entry.endswith(".json"):
            continue
        with open(os.path.join(folder, entry[:-5] + ".world"), encoding="utf-8") as stream:
            if name in stream.read():
                return True
    return False


def server_pid(node):
    """The process of the node /gazebo, as it tells itself."""
    code, _, address = xmlrpc.client.ServerProxy(node.master).lookupNode("/test", "/gazebo")
    assert code == 1
    return xmlrpc.client.ServerProxy(address).getPid("/test")[2]
