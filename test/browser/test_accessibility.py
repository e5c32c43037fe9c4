"""Rules of WCAG 2.1 AA, tested by axe-core on what a person opens."""
from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe
from test_panels import with_box

RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"],
         "rules": {"region": {"enabled": False}}, "resultTypes": ["violations"]}
"""Splitters lie between two landmarks and menus over all of them, so not all is in a region."""
DIALOGS = ["open", "saveAs", "cloneWorld", "recover", "applyForce", "hotkeys", "about", "logs",
           "array", "commands", "topics", "joints", "plot"]


def check(editor):
    """Compare the rules that axe-core reports as violated on the whole page with none."""
    editor.rest()
    found = Axe().run(editor.page, options=RULES).response["violations"]
    faults = "\n".join(f"{one['id']} {node['target']}: {node['failureSummary']}"
                       for one in found for node in one["nodes"])
    assert not faults, faults


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_the_window_with_a_selected_model(editor, scheme):
    editor.page.emulate_media(color_scheme=scheme)
    name = with_box(editor)
    editor.row(name).click()
    for summary in editor.page.locator(".properties details:not([open]) > summary").all():
        summary.click()
    check(editor)
    editor.page.emulate_media(color_scheme="dark")


@pytest.mark.parametrize("tab", ["Insert", "Layers"])
def test_the_tabs_of_the_left_panel(editor, tab):
    editor.page.get_by_role("tab", name=tab).click()
    check(editor)


@pytest.mark.parametrize("name", DIALOGS)
def test_dialogs_and_panels(editor, name):
    editor.row(with_box(editor)).click()
    editor.get(f"editor.store.emit('dialog', {{name: {name!r}}})")
    check(editor)


def test_a_menu(editor):
    editor.page.get_by_role("menuitem", name="Edit").click()
    check(editor)


@pytest.mark.parametrize("keys", ["Control+m", "Control+b"], ids=["model", "building"])
def test_the_editors_of_models_and_buildings(editor, keys):
    editor.page.keyboard.press(keys)
    editor.until("editor.store.modelEditing || document.querySelector('.building')", "the editor")
    check(editor)
