"""Where things land that are inserted over tables and walls, and how they are turned meanwhile."""
from __future__ import annotations

import pytest
from pytest import approx
from support import wait_for, yaw_of

TABLE = "<box><size>1 1 0.8</size></box>"
WALL = "<box><size>0.2 4 2</size></box>"


def fixed(editor, name, shape, pose):
    """Adds a static model of one shape."""
    part = f"<geometry>{shape}</geometry>"
    sdf = (f"<sdf version='1.7'><model name='{name}'><static>1</static><pose>{pose}</pose>"
           f"<link name='l'><collision name='c'>{part}</collision><visual name='v'>{part}</visual>"
           "</link></model></sdf>")
    editor.get(f"editor.actions.edit({{kind: 'insert', sdf: `{sdf}`}})")
    editor.until(f"editor.view.bounds('{name}')", f"the drawn {name}")


def test_a_box_is_put_on_the_table_under_the_mouse(editor):
    fixed(editor, "table", TABLE, "0 0 0.4 0 0 0")
    name = editor.place("Box", (0.1, 0.0, 0.8))
    assert editor.model(name)["pose"][:3] == approx([0.1, 0.0, 1.3], abs=0.03)


def test_a_copy_of_what_stands_on_a_table_is_put_on_another_one(editor):
    fixed(editor, "table", TABLE, "0 0 0.4 0 0 0")
    fixed(editor, "shelf", TABLE, "0 2 0.4 0 0 0")
    editor.place("Box", (0.0, 0.0, 0.8))
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Control+c")
    editor.until("editor.store.clipboard", "the copy")
    editor.page.keyboard.press("Control+v")
    x, y = editor.pixel((0.0, 2.0, 0.8))
    editor.page.mouse.move(x - 20, y)
    editor.page.mouse.move(x, y)
    editor.page.mouse.click(x, y)
    wait_for(lambda: editor.model("unit_box_clone"), "the pasted box")
    assert editor.model("unit_box_clone")["pose"][:3] == approx([0.0, 2.0, 1.3], abs=0.03)


def test_what_is_copied_in_one_page_is_pasted_in_another_page_of_the_browser(editor):
    editor.place("Box")
    page = editor.context.new_page()
    try:
        page.goto(editor.page.url)
        wait_for(lambda: page.evaluate("Boolean(window.editor && editor.store.document)"),
                 "the world in the second page")
        editor.get("editor.actions.copy(['unit_box'])")
        wait_for(lambda: page.evaluate("editor.store.clipboard?.items.length === 1"), "the copy")
        page.locator("#view").focus()
        page.keyboard.press("Control+v")
        page.keyboard.press("Enter")
        wait_for(lambda: editor.model("unit_box_clone"), "the pasted box")
    finally:
        page.close()


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_a_box_over_a_wall_lands_in_front_of_it(editor, turn):
    # The first view is from x = 5, y = -5.
    fixed(editor, "wall", WALL, f"0 0 1 0 0 {turn}")
    name = editor.place("Box", (0.1, 0.0, 1.5))
    x, y, z = editor.model(name)["pose"][:3]
    assert z == approx(0.5, abs=0.01)
    editor.until(f"editor.view.bounds('{name}')", "the drawn box")
    if not turn:
        assert x == approx(0.61, abs=0.02)
        assert y == approx(0.0, abs=0.05)
    assert x > 0.6
    editor.click((x, y, z))
    editor.until(f"editor.store.selection.join() === '{name}'", "the box, which is seen")


def test_what_is_hidden_or_behind_the_mouse_carries_nothing(editor):
    fixed(editor, "wall", WALL, "0 0 1 0 0 0")
    editor.get("editor.actions.hide(['wall'])")
    editor.until("editor.view.bounds('wall') === null", "the hidden wall")
    name = editor.place("Box", (0.1, 0.0, 0.0))
    assert editor.model(name)["pose"][:3] == approx([0.1, 0.0, 0.5], abs=0.03)


def test_keys_turn_what_is_being_inserted(editor):
    editor.button("Box").click()
    editor.page.locator(".hint-line").get_by_text("turn by 15°").wait_for()
    x, y = editor.pixel((0.0, 0.0, 0.0))
    editor.page.mouse.move(x - 30, y)
    editor.page.mouse.move(x, y)
    for key in ("q", "q", "Shift+Q", "e"):
        editor.page.keyboard.press(key)
    editor.page.mouse.click(x, y)
    wait_for(lambda: editor.model("unit_box"), "the box")
    assert yaw_of(editor.model("unit_box")["pose"]) == approx(105.0, abs=0.1)
    editor.until("editor.store.selection.join() === 'unit_box'", "its selection")
    # The next thing is not turned, and the keys do nothing without one.
    editor.page.keyboard.press("q")
    other = editor.place("Box", (1.5, 1.5, 0.0))
    assert yaw_of(editor.model(other)["pose"]) == approx(0.0, abs=0.1)


def test_folders_are_made_where_a_world_is_saved_and_not_where_one_is_opened(editor):
    for keys, title, count in (("Control+o", "Open World", 0),
                               ("Control+Shift+s", "Save World As", 1)):
        editor.page.keyboard.press(keys)
        dialog = editor.page.get_by_role("dialog", name=title)
        dialog.get_by_role("listbox", name="Files").wait_for()
        assert dialog.get_by_role("button", name="New Folder…").count() == count
        editor.page.keyboard.press("Escape")
        dialog.wait_for(state="detached")
