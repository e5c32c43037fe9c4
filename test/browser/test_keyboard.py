"""The editing part of the lab sheet by the keyboard alone."""
from __future__ import annotations

import json
import math
import os
from xml.etree import ElementTree

import pytest
from pytest import approx
from support import wait_for, yaw_of

MOUSE = """window.mouseEvents = [];
for (const type of ['pointerdown', 'pointermove', 'mousedown', 'mousemove', 'wheel', 'touchstart'])
  window.addEventListener(type, () => mouseEvents.push(type), true);"""
TABS = 60
"""Most presses of Tab from one control to another."""


class Hands:
    """Hands on a keyboard; after each key something has the focus."""

    def __init__(self, editor):
        self.editor, self.page = editor, editor.page

    def press(self, *keys):
        for key in keys:
            self.page.keyboard.press(key)
            self.editor.until("document.activeElement !== document.body", f"a focus after {key}")

    def type(self, text):
        self.page.keyboard.type(text)

    def go(self, key, selector):
        """Presses a key until the element of a selector has the focus."""
        reached = f"document.activeElement.matches({json.dumps(selector)})"
        for _ in range(TABS):
            if self.editor.get(reached):
                return
            self.press(key)
        raise AssertionError(f"{key} does not reach {selector}")

    def command(self, words):
        self.press("Control+k")
        self.type(words)
        self.press("Enter")

    def insert(self, shape):
        self.command(shape)
        self.editor.until("editor.store.mode === 'insert'", f"the {shape} that is placed")
        self.press("Enter")
        self.editor.until(f"editor.store.selection.join() === 'unit_{shape}' && "
                          f"Boolean(editor.store.model('unit_{shape}'))", f"the {shape}")

    def set_fields(self, **texts):
        """Types into fields of the selection's properties; `_` stands for a space in their name."""
        self.go("F6", ".properties input, .properties select")
        for name, text in texts.items():
            self.go("Tab", f".properties input[aria-label='{name.replace('_', ' ')}']")
            self.press("Control+a")
            self.type(text)
            self.press("Enter")


@pytest.fixture
def hands(editor):
    editor.get(MOUSE)
    editor.page.locator("#view").focus()
    yield Hands(editor)
    assert editor.get("mouseEvents") == []


def test_shapes_are_inserted_moved_turned_scaled_deleted_and_saved(hands, editor, node):
    hands.insert("box")
    hands.set_fields(pose_x="1", pose_y="-2", pose_yaw="45deg")
    wait_for(lambda: editor.model("unit_box")["pose"][:2] == approx([1.0, -2.0]) and
             yaw_of(editor.model("unit_box")["pose"]) == approx(45.0), "the box at its place")
    hands.go("F6", "#view")
    hands.insert("cylinder")
    hands.set_fields(pose_x="-2", pose_y="1", length="1.5")
    wait_for(lambda: editor.model("unit_cylinder")["links"][0]["collisions"][0]["geometry"]
             ["length"] == approx(1.5), "the longer cylinder")
    hands.go("F6", "#view")
    hands.insert("sphere")
    hands.press("Delete")
    wait_for(lambda: "unit_sphere" not in editor.names(), "the sphere's end")
    hands.press("Control+z")
    wait_for(lambda: "unit_sphere" in editor.names(), "the sphere's return")
    insert_from_library(hands, editor)
    hands.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    wait_for(lambda: dialog.get_by_label("Folder").text_content() == node.typed, "the folder")
    hands.type("my_world.sdf")
    hands.press("Enter")
    dialog.wait_for(state="detached")
    path = os.path.join(node.typed, "my_world.sdf")
    wait_for(lambda: os.path.isfile(path), "the file")
    names = {model.get("name") for model in ElementTree.parse(path).iter("model")}
    names |= {one.text for one in ElementTree.parse(path).iter("name")}
    assert {"unit_box", "unit_cylinder", "unit_sphere", "desk"} <= names
    os.remove(path)


def insert_from_library(hands, editor):
    hands.go("F6", "#toolbar *")
    hands.go("Tab", "[role=tab]")
    hands.press("ArrowRight", "Enter")
    hands.go("Tab", "[aria-label='Find a model']")
    hands.type("desk")
    editor.page.locator(".model-card[aria-label=Desk]").wait_for()
    hands.go("Tab", ".model-card[aria-label=Desk]")
    hands.press("Enter")
    editor.until("editor.store.mode === 'insert'", "the desk that is placed")
    hands.press("Enter")
    wait_for(lambda: "desk" in editor.names(), "the desk")


def test_a_room_with_a_door_is_drawn(hands, editor):
    hands.press("Control+b")
    editor.until("document.activeElement.matches('.plan-sheet')", "the sheet")
    hands.press("F6", "F6")
    hands.go("Tab", "[data-tool=wall]")
    hands.press("Enter")
    editor.until("document.activeElement.matches('.plan-sheet')", "the sheet with the keys")
    hands.press(*["ArrowLeft"] * 8, *["ArrowUp"] * 6, "Space")
    for way, count in (("ArrowRight", 16), ("ArrowDown", 12), ("ArrowLeft", 16), ("ArrowUp", 12)):
        hands.press(*[way] * count, "Space")
    items = editor.page.locator(".plan-sheet .layer.walls > g")
    wait_for(lambda: items.count() == 4, "four walls")
    hands.press("Shift+F6")
    hands.go("Tab", "[data-tool=door]")
    hands.press("Enter", *["ArrowDown"] * 6, "Space")
    doors = editor.page.locator(".plan-sheet .layer.doors > g")
    wait_for(lambda: doors.count() == 1, "the door")
    hands.press("Control+s")
    dialog = editor.page.get_by_role("dialog", name="Save Building")
    dialog.wait_for()
    hands.type("by_keys")
    hands.press("Enter")
    dialog.wait_for(state="detached")
    hands.press("Control+x")
    wait_for(lambda: "by_keys" in editor.names(), "the building in the world")
    door = [link for link in editor.model("by_keys")["links"] if len(link["collisions"]) > 1]
    assert len(door) == 1, "one wall has an opening"
    editor.until("document.activeElement !== document.body", "a focus in the world")


def test_enter_places_a_shape_where_it_is_seen(editor):
    editor.button("Box").click()
    editor.until("editor.store.mode === 'insert'", "the box that is placed")
    x, y = editor.pixel((2.0, -1.0, 0.0))
    editor.page.mouse.move(x - 40, y - 25)
    editor.page.mouse.move(x, y, steps=5)
    editor.page.keyboard.press("Enter")
    editor.until("editor.store.selection.join() === 'unit_box'", "the box")
    assert editor.model("unit_box")["pose"][:2] == approx((2.0, -1.0), abs=0.05)


def test_enter_places_a_second_shape_beside_the_first(editor):
    for name in ("unit_box", "unit_box_0"):
        editor.button("Box").press("Enter")
        editor.until("editor.store.mode === 'insert'", "the box that is placed")
        editor.page.keyboard.press("Enter")
        editor.until(f"editor.store.selection.join() === '{name}'", name)
    first, second = (editor.model(name)["pose"] for name in ("unit_box", "unit_box_0"))
    assert math.dist(first[:2], second[:2]) > 1.0
    assert first[2] == second[2]
