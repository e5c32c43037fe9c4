"""The page of a world that belongs to a program: it shows, and hides what edits."""
from __future__ import annotations

import pytest
from support import wait_for

from my_simulations.editor.editor_options import EditorOptions
from my_simulations.editor.server import EditorServer
from my_simulations.python_api import open_world
from my_simulations.resources.resolver import Resolver

BOX = """<sdf version="1.6"><model name="box"><link name="link"><collision name="c"><geometry><box>
<size>1 1 1</size></box></geometry></collision><visual name="v"><geometry><box><size>1 1 1</size>
</box></geometry></visual></link></model></sdf>"""


@pytest.fixture(params=[True, False], ids=["read-only", "editable"])
def page(request, browser, tmp_path):
    """The page of a world with a box, and whether it is read-only."""
    with open_world("worlds/empty.world") as world:
        world.spawn(BOX, "box")
        server = EditorServer(world.simulator, Resolver.from_environment(),
                              EditorOptions(read_only=request.param,
                                            cache_dir=str(tmp_path)))
        opened = browser.open(server.url)
        opened.until("'readOnly' in editor.store && editor.store.connected", "the greeting")
        yield opened, request.param
        assert opened.faults == []
        opened.close()
        server.stop("the test has ended")


def shown(opened, role, within):
    """Names of the visible elements of a role in a part of the page."""
    return [element.get_attribute("aria-label") or element.inner_text()
            for element in opened.page.locator(within).get_by_role(role).all()
            if element.is_visible()]


def test_tools_menus_and_fields_that_edit_are_hidden(page):
    opened, read_only = page
    edits = ({"Undo", "Box", "Point light", "Paste", "Align"}, {"File", "Edit"},
             {"Step", "Reset time"}, {"Insert"})
    places = (("button", "#toolbar"), ("menuitem", "#menubar"), ("button", "#timebar"),
              ("tab", "#left"))
    for hidden, (role, within) in zip(edits, places):
        names = set(shown(opened, role, within))
        assert names and hidden & names == (set() if read_only else hidden)
    assert {"Measure", "Screenshot", "Plot"} <= set(shown(opened, "button", "#toolbar"))
    opened.get("editor.store.select(['box'])")
    name = opened.page.locator("#left [data-path='static'] input")
    wait_for(lambda: name.count() == 1, "the properties of the box")
    assert name.is_disabled() == read_only


def test_keys_and_menus_do_not_edit(page):
    opened, read_only = page
    opened.get("editor.store.select(['box'])")
    opened.get("editor.store.emit('contextmenu', {name: 'box', x: 300, y: 300})")
    wait_for(lambda: shown(opened, "menuitem", ".popup"), "the menu of the box")
    assert ("Delete" in str(shown(opened, "menuitem", ".popup"))) != read_only
    assert "Follow" in str(shown(opened, "menuitem", ".popup"))
    opened.page.keyboard.press("Escape")
    wait_for(lambda: not shown(opened, "menuitem", ".popup"), "the end of the menu")
    opened.get("document.getElementById('view').focus()")
    opened.page.keyboard.press("t")
    opened.page.keyboard.press("m")  # the keys are handled in order
    opened.until("editor.store.mode === 'measure'", "the tool that reads")
    opened.get("editor.store.select(['box'])")
    opened.page.keyboard.press("Delete")
    if read_only:
        opened.page.keyboard.press("h")
        opened.until("editor.store.overlay('hidden', 'box') === true", "the hidden box")
        assert "box" in opened.names() and opened.get("editor.store.issues") == []
    else:
        wait_for(lambda: "box" not in opened.names(), "the removal")
