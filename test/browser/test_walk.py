"""A house is drawn, furnished, left by a car through its door, and saved under a typed name."""
from __future__ import annotations

import os

from pytest import approx
from support import wait_for
from test_building import Sheet, save_building
from test_templates import form_of

WALLS = ((-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5), (-2, -1.5))
DOOR_X = 2.0
"""The wall with the door."""


def draw_house(editor):
    """Draws one room with a door; the Insert tab opens the building editor."""
    editor.page.get_by_role("tab", name="Insert").click()
    editor.page.get_by_role("button", name="Draw a building").click()
    sheet = Sheet(editor)
    wait_for(lambda: editor.page.locator("[data-tool=wall]").is_visible(), "the palette")
    sheet.wheel(-3)
    sheet.tool("wall")
    sheet.click(*WALLS)
    sheet.shows(walls=4)
    sheet.tool("door")
    sheet.click((DOOR_X, 0))
    sheet.shows(doors=1)
    save_building(sheet, "House")
    editor.button("Done").click()
    wait_for(lambda: "House" in editor.names(), "the house in the world")
    editor.until("editor.view.camera.pitch < -1.1", "a look into the house from above")


def put(editor, name, place):
    """Clicks where what follows the mouse is to stand; returns its pose."""
    editor.until("editor.store.mode === 'insert'", "what follows the mouse")
    before = set(editor.names())
    x, y = editor.pixel((*place, 0.0))
    editor.page.mouse.move(x - 20, y - 10)
    editor.page.mouse.move(x, y, steps=3)
    editor.page.mouse.click(x, y)
    new = wait_for(lambda: set(editor.names()) - before, name)
    return editor.model(new.pop())["pose"]


def test_a_house_is_drawn_furnished_left_by_car_and_saved(launch, browser):
    node = launch("worlds/empty.world")
    editor = browser.open(node.url)
    draw_house(editor)
    editor.page.get_by_role("tab", name="Insert").click()
    editor.page.get_by_role("searchbox", name="Find a model", exact=True).fill("furniture")
    editor.page.get_by_role("button", name="Desk", exact=True).click()
    assert not editor.button("Draw a building").is_visible(), "what the search does not mean"
    desk = put(editor, "the desk", (-1.2, 0.8))
    assert desk[:3] == approx((-1.2, 0.8, 0.0), abs=0.05)
    editor.page.get_by_role("searchbox", name="Find a model", exact=True).fill("")
    form = form_of(editor, "Differential drive")
    form.get_by_label("Model name").fill("taxi")
    form.get_by_role("button", name="Insert").click()
    form.wait_for(state="detached")
    car = put(editor, "the car", (0.0, 0.0))
    assert abs(car[1]) < 0.05 and car[0] < 1.0

    editor.page.keyboard.press("Space")
    editor.until("!editor.store.stats.paused", "the running world")
    editor.page.keyboard.down("ArrowUp")
    wait_for(lambda: editor.model("taxi")["pose"][0] > DOOR_X + 0.6, "the car outside of the house")
    editor.page.keyboard.up("ArrowUp")
    assert abs(editor.model("taxi")["pose"][1]) < 0.45, "through the door"
    editor.page.keyboard.press("Space")
    editor.until("editor.store.stats.paused", "the world at rest")

    editor.page.keyboard.press("Control+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    editor.until("getSelection().toString() !== ''", "the suggested name, selected")
    editor.page.keyboard.type("my_house.sdf")
    dialog.get_by_role("button", name="Save", exact=True).click()
    editor.until("!editor.store.history.dirty", "the saved world")
    wait_for(lambda: os.path.isfile(os.path.join(node.typed, "my_house.sdf")), "the saved file")
    assert os.listdir(node.typed) == ["my_house.sdf"]
    assert editor.faults == []
    editor.close()
