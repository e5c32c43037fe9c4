"""Rules of WCAG 2.1 AA, tested by axe-core on what a person opens."""
from __future__ import annotations

import os
import re

import pytest
import trimesh
from axe_playwright_python.sync_playwright import Axe
from test_building import Sheet
from test_model_editor import build_cart
from test_panels import drop
from test_templates import form_of

RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"],
         "rules": {"region": {"enabled": False}}, "resultTypes": ["violations"]}
"""Splitters lie between two landmarks and menus over all of them, so not all is in a region."""
DIALOGS = ["open", "saveAs", "cloneWorld", "recover", "applyForce", "hotkeys", "about", "logs",
           "array", "commands", "topics", "joints", "plot", "newWorld"]


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
    name = editor.place("Box")
    editor.row(name).click()
    for summary in editor.page.locator(".properties details:not([open]) > summary").all():
        summary.click()
    check(editor)
    editor.page.emulate_media(color_scheme="dark")


@pytest.mark.parametrize("tab", ["Insert", "Layers"])
def test_the_tabs_of_the_left_panel(editor, tab):
    editor.page.get_by_role("tab", name=tab).click()
    check(editor)


def test_the_insert_tab_with_an_added_path(editor, tmp_path):
    editor.page.get_by_role("tab", name="Insert").click()
    editor.button("Add Path").click()
    editor.page.get_by_role("dialog").get_by_label("Model directory").fill(str(tmp_path))
    editor.page.keyboard.press("Enter")
    remove = editor.page.get_by_role("button", name=re.compile(f"^Remove .*{tmp_path.name}$"))
    remove.wait_for()
    check(editor)
    remove.click()
    remove.wait_for(state="detached")


@pytest.mark.parametrize("name", DIALOGS)
def test_dialogs_and_panels(editor, name):
    editor.row(editor.place("Box")).click()
    editor.get(f"editor.store.emit('dialog', {{name: {name!r}}})")
    check(editor)


@pytest.mark.parametrize("title", ["Differential drive", "Arm with gripper"])
def test_the_form_of_a_template(editor, title):
    form = form_of(editor, title)
    form.wait_for()
    check(editor)
    editor.page.keyboard.press("Escape")
    form.wait_for(state="detached")
    editor.until("document.activeElement !== document.body", "the focus of before")


def test_a_joint_and_the_plugins_in_the_model_editor(editor):
    build_cart(editor)
    editor.page.get_by_role("treeitem").filter(has_text="joint").first.click()
    check(editor)


def test_the_inspector_of_a_wall_and_the_dialog_that_saves_a_building(editor):
    sheet = Sheet(editor)
    sheet.open()
    editor.page.locator("[data-tool=wall]").click()
    for point in ((0, 0), (2, 0)):
        sheet.click(point)
    editor.page.keyboard.press("Escape")
    editor.page.keyboard.press("Escape")
    x, y = sheet.pixel((1, 0))
    editor.page.mouse.dblclick(x, y)
    editor.page.get_by_role("dialog").wait_for()
    check(editor)
    editor.page.keyboard.press("Escape")
    editor.page.get_by_role("dialog").wait_for(state="detached")
    editor.page.keyboard.press("Control+s")
    editor.page.get_by_role("dialog").wait_for()
    check(editor)


def close_dialog(editor):
    """Closes the dialog on top with Escape; then something has the focus."""
    count = editor.page.get_by_role("dialog").count()
    editor.page.keyboard.press("Escape")
    editor.until(f"document.querySelectorAll('dialog[open]').length < {count}", "a closed dialog")
    editor.until("document.activeElement !== document.body", "the focus of before")


def open_button(editor, name):
    editor.button(name).click()
    editor.page.get_by_role("dialog").first.wait_for()
    check(editor)


def test_messages_the_folder_dialogs_and_the_history(editor):
    editor.place("Box")
    editor.get("editor.store.emit('issue', {severity: 'warning', message: 'odd', file: 'a.world',"
               " line: 3, xpath: '/sdf/world'})")
    open_button(editor, "Messages")
    editor.page.keyboard.press("Escape")
    editor.page.get_by_role("tab", name="Insert").click()
    open_button(editor, "Add Path")
    close_dialog(editor)
    editor.page.keyboard.press("Control+Shift+s")
    editor.page.get_by_role("dialog", name="Save World As").wait_for()
    open_button(editor, "New Folder…")
    close_dialog(editor)
    close_dialog(editor)


def test_what_a_dropped_mesh_is_asked_for(editor):
    drop(editor, "block.stl", trimesh.creation.box((1.0, 1.0, 1.0)).export(file_type="stl"),
         (0.0, 0.0, 0.0))
    editor.page.get_by_role("dialog").wait_for()
    check(editor)
    close_dialog(editor)


def test_the_dialogs_of_the_model_editor(editor):
    build_cart(editor)
    for name in ("Mesh…", "SVG…", "Model…", "Plugins…", "Inertia of all links", "Save As…"):
        open_button(editor, name)
        close_dialog(editor)
    editor.get("editor.store.select(['untitled::link_1'])")
    for name in ("Rename…", "Inertia…", "Shapes…", "Size…"):
        open_button(editor, name)
        close_dialog(editor)
    editor.page.locator(".model-joints button").first.click()
    editor.page.get_by_role("dialog").wait_for()
    check(editor)
    close_dialog(editor)
    editor.page.keyboard.press("Control+e")
    editor.page.get_by_role("region", name="Schematic").wait_for()
    check(editor)
    editor.page.keyboard.press("Control+m")
    editor.page.get_by_role("dialog", name="Exit model editor?").wait_for()
    check(editor)
    close_dialog(editor)


def test_the_dialogs_of_the_building_editor(editor):
    sheet = Sheet(editor)
    sheet.open()
    sheet.tool("wall")
    sheet.click((0, 0), (2, 0))
    editor.page.keyboard.press("Escape")
    sheet.tool("door")
    sheet.click((1, 0))
    sheet.shows(doors=1)
    editor.page.mouse.dblclick(*sheet.pixel((1, 0)))
    editor.page.get_by_role("dialog").wait_for()
    check(editor)
    close_dialog(editor)
    for name in ("Roof", "Level inspector"):
        open_button(editor, name)
        close_dialog(editor)
    editor.page.keyboard.press("Control+o")
    editor.page.get_by_role("dialog", name="Save building?").wait_for()
    check(editor)
    editor.page.get_by_role("button", name="Don't Save").click()
    editor.page.get_by_role("dialog", name="Open Building").wait_for()
    check(editor)
    close_dialog(editor)
    editor.button("Done").click()
    editor.page.get_by_role("dialog", name="Exit building editor?").wait_for()
    check(editor)
    close_dialog(editor)


def test_the_import_of_a_floor_plan(editor):
    Sheet(editor).open()
    open_button(editor, "Import")
    close_dialog(editor)


def test_the_questions_before_a_file_or_a_model_is_replaced(editor, node):
    editor.place("Box")
    with open(os.path.join(node.typed, "there.world"), "w", encoding="utf-8") as there:
        there.write("<sdf version='1.6'><world name='default'/></sdf>")
    editor.page.keyboard.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    editor.until("getSelection().toString() !== ''", "the suggested name, selected")
    editor.page.keyboard.type("there.world")
    dialog.get_by_role("button", name="Save", exact=True).click()
    editor.page.get_by_role("dialog", name="Overwrite the file?").wait_for()
    check(editor)
    close_dialog(editor)
    close_dialog(editor)
    block = trimesh.creation.box((1.0, 1.0, 1.0)).export(file_type="stl")
    for question in (None, "Replace the model?"):
        drop(editor, "replaced.stl", block, (0.0, 0.0, 0.0))
        dialog = editor.page.get_by_role("dialog").first
        dialog.wait_for()
        dialog.locator(".primary").click()
        if question:
            editor.page.get_by_role("dialog", name=question).wait_for()
            check(editor)
            close_dialog(editor)
            close_dialog(editor)
        else:  # a drop before that is ignored
            editor.until("editor.store.selection.includes('replaced')", "the model")


def test_other_users_and_the_dialog_of_the_own_name(editor, node, browser):
    other = browser.open(node.url)
    editor.page.get_by_role("group", name="Who is here").wait_for()
    check(editor)
    editor.page.locator("#people button").last.click()
    editor.page.get_by_role("dialog", name="Your name").wait_for()
    check(editor)
    close_dialog(editor)
    faults = other.faults
    other.close()
    assert faults == []


def test_the_offers_to_restore_changes(editor):
    editor.get("editor.store.emit('autosave', {found: true, file: 'a.world', time: 1e9})")
    editor.page.get_by_role("dialog", name="Restore unsaved changes?").wait_for()
    check(editor)
    close_dialog(editor)
    editor.get("(() => { const ask = editor.connection.request.bind(editor.connection);"
               "editor.connection.request = (type, fields) => type === 'autosave'"
               " ? Promise.resolve("
               "{entries: [{name: 'a', file: '/a.world', time: 1e9, discarded: true}]})"
               " : ask(type, fields); })()")
    editor.get("editor.store.emit('dialog', {name: 'recover'})")
    editor.page.get_by_role("button", name="Recover /a.world").wait_for()
    check(editor)


def test_a_menu(editor):
    editor.page.get_by_role("menuitem", name="Edit").click()
    check(editor)


@pytest.mark.parametrize("keys", ["Control+m", "Control+b"], ids=["model", "building"])
def test_the_editors_of_models_and_buildings(editor, keys):
    editor.page.keyboard.press(keys)
    editor.until("editor.store.modelEditing || document.querySelector('.building')", "the editor")
    check(editor)


def test_a_world_is_built_run_and_saved_by_the_keyboard_alone(editor, node):
    press = editor.page.keyboard.press

    def has_focus(what):
        editor.until("document.activeElement !== document.body", f"the focus after {what}")

    press("Control+k")
    editor.page.keyboard.type("box")
    press("Enter")
    editor.until("editor.store.mode === 'insert'", "the box that is placed")
    press("Enter")
    editor.until("editor.store.selection.join() === 'unit_box'", "the box")
    has_focus("inserting")
    press("F2")
    press("Control+a")
    editor.page.keyboard.type("crate")
    press("Enter")
    editor.until("editor.store.selection.join() === 'crate'", "the new name")
    has_focus("renaming")
    press("F6")
    has_focus("F6")
    press("Control+k")
    editor.page.keyboard.type("play")
    press("Enter")
    editor.until("!editor.store.stats.paused", "the running world")
    has_focus("a command")
    press("Control+k")
    editor.page.keyboard.type("pause")
    press("Enter")
    editor.until("editor.store.stats.paused", "the world that stands")
    press("Control+Shift+s")
    editor.page.get_by_role("dialog", name="Save World As").wait_for()
    editor.page.keyboard.type("by_keys.world")
    press("Enter")
    editor.until("!editor.store.history.dirty", "the saved world")
    has_focus("saving")
    assert os.path.isfile(os.path.join(node.typed, "by_keys.world"))


def test_a_dialog_that_a_menu_opened_gives_the_focus_back(editor):
    editor.row(editor.place("Box")).click(button="right")
    editor.page.get_by_role("menuitem", name="Apply Force/Torque").click()
    dialog = editor.page.get_by_role("dialog", name="Apply Force")
    dialog.wait_for()
    editor.page.keyboard.press("Escape")
    dialog.wait_for(state="detached")
    editor.until("document.activeElement !== document.body", "the focus of before")
