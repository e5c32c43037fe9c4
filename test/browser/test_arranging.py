"""Copies, arrays, hidden and locked models, and the search for commands."""
from __future__ import annotations

from pytest import approx
from support import wait_for


def test_a_duplicate_stands_beside_and_is_one_step(editor):
    editor.place("Box")
    editor.page.keyboard.press("Control+d")
    wait_for(lambda: "unit_box_clone" in editor.names(), "the copy")
    editor.until("editor.store.selection.join() === 'unit_box_clone'", "its selection")
    own, other = (editor.model(name)["pose"] for name in ("unit_box", "unit_box_clone"))
    assert other[0] - own[0] == approx(1.1, abs=0.01)
    assert other[1:3] == approx(own[1:3], abs=0.01)
    editor.until("editor.store.history.undo[0] === 'Duplicate unit_box'", "the label")
    editor.page.keyboard.press("Control+z")
    wait_for(lambda: "unit_box_clone" not in editor.names(), "the copy's end")


def test_an_array_is_typed_in_a_dialog(editor):
    editor.place("Box")
    editor.page.get_by_role("menuitem", name="Edit", exact=True).click()
    editor.page.get_by_role("menuitem", name="Array…").click()
    dialog = editor.page.get_by_role("dialog", name="Array")
    dialog.get_by_label("Count X").fill("2")
    dialog.get_by_label("Count Y").fill("0")
    dialog.get_by_text("Each count must be a whole number").wait_for()
    dialog.get_by_label("Count Y").fill("3")
    dialog.get_by_label("Spacing Y").fill("1.5")
    dialog.get_by_text("5 copies are added.").wait_for()
    dialog.get_by_role("button", name="Create").click()
    dialog.wait_for(state="detached")
    wait_for(lambda: len(editor.names()) == 7, "ground and six boxes")
    places = {(round(x, 1), round(y, 1)) for x, y in (
        editor.model(name)["pose"][:2] for name in editor.names() if name != "ground_plane")}
    assert places == {(x, y) for x in (0.0, 1.1) for y in (0.0, 1.5, 3.0)}
    editor.page.keyboard.press("Control+z")
    wait_for(lambda: len(editor.names()) == 2, "all copies undone at once")


def test_three_models_get_equal_gaps(editor):
    for name, x in (("left", 0.0), ("middle", 1.2), ("right", 4.0)):
        editor.get(f"editor.actions.edit({{kind: 'insert', shape: 'box', name: '{name}',"
                   f" pose: [{x}, 0, 0.5, 0, 0, 0, 1]}})")
    wait_for(lambda: len(editor.names()) == 4, "three boxes")
    editor.until("['left', 'middle', 'right'].every((one) => editor.view.bounds(one))", "all drawn")
    editor.get("editor.store.select(['right', 'left', 'middle'])")
    editor.page.get_by_role("menuitem", name="Edit", exact=True).click()
    editor.page.get_by_role("menuitem", name="Distribute Along X").click()
    wait_for(lambda: editor.model("middle")["pose"][0] == approx(2.0, abs=0.01), "the middle")
    editor.until("editor.store.history.undo[0]?.startsWith('Distribute')", "its label")


def test_hidden_and_locked_models_are_passed_over_by_the_mouse(editor):
    editor.place("Box")
    middle = (0.0, 0.0, 0.5)
    editor.page.keyboard.press("l")
    row = editor.row("unit_box")
    row.get_by_text("locked").wait_for()
    editor.page.keyboard.press("Escape")
    editor.click(middle)
    editor.frame()
    assert editor.get("editor.store.selection.length") == 0
    row.click()
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("l")
    row.get_by_text("locked").wait_for(state="detached")
    editor.page.keyboard.press("h")
    row.get_by_text("hidden").wait_for()
    editor.until("editor.view.bounds('unit_box') === null", "nothing drawn")
    editor.click(middle)
    assert editor.get("editor.store.selection.length") == 0
    editor.page.keyboard.press("Alt+h")
    editor.until("editor.view.bounds('unit_box') !== null", "the box again")
    editor.click(middle)
    editor.until("editor.store.selection.join() === 'unit_box'", "the box under the mouse")


def test_a_drag_on_a_locked_model_moves_nothing_behind_it(editor):
    for name, x in (("front", 0.0), ("behind", -1.5)):
        editor.get(f"editor.actions.edit({{kind: 'insert', shape: 'box', name: '{name}',"
                   f" pose: [{x}, 0, 0.5, 0, 0, 0, 1]}})")
    editor.until("['front', 'behind'].every((one) => editor.view.bounds(one))", "both boxes")
    editor.get("editor.actions.lock(['front'])")
    editor.get("editor.store.setOverlay('locked', null, 'behind')")
    before = {name: editor.model(name)["pose"] for name in ("front", "behind")}
    editor.page.keyboard.press("t")
    editor.drag((0.0, 0.0, 0.5), (0.0, 1.0, 0.5))
    editor.frame()
    assert {name: editor.model(name)["pose"] for name in before} == before


def test_all_means_no_ground(editor):
    editor.place("Box")
    editor.page.keyboard.press("Escape")
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Control+a")
    editor.until("editor.store.selection.join() === 'unit_box'", "the box without the ground")


def test_a_light_is_flown_to_from_the_present_direction(editor):
    before = editor.get("editor.view.camera")
    editor.get("editor.view.moveTo('sun')")
    editor.rest()
    after = editor.get("editor.view.camera")
    assert after["position"] != before["position"]
    assert (after["yaw"], after["pitch"]) == (before["yaw"], before["pitch"])


def test_a_new_world_is_seen_from_afar_and_an_opened_one_as_a_whole(editor):
    editor.place("Box")
    editor.get("editor.view.moveTo('unit_box')")
    editor.rest()
    editor.get("editor.request('save', {path: 'seen_as_a_whole.world', overwrite: true})")
    editor.get("editor.actions.newWorld({discard: true})")
    editor.until("editor.view.camera.position.join() === '5,-5,2'", "Gazebo's first view")
    editor.get("editor.actions.open('seen_as_a_whole.world', {discard: true})")
    editor.until("editor.view.bounds('unit_box') !== null", "the box")
    editor.until("editor.view.camera.position.join() !== '5,-5,2'", "a view of the box")


def test_a_command_is_found_by_a_part_of_its_name(editor):
    editor.page.keyboard.press("Control+k")
    dialog = editor.page.get_by_role("dialog", name="Commands")
    dialog.get_by_role("combobox").fill("insert cyl")
    dialog.get_by_role("option", selected=True).get_by_text("Insert cylinder").wait_for()
    editor.page.keyboard.press("Enter")
    dialog.wait_for(state="detached")
    editor.until("editor.store.placing?.shape === 'cylinder'", "the cylinder at the mouse")
    editor.page.locator(".hint-line").get_by_text("Enter place").wait_for()
    editor.page.keyboard.press("Escape")
    editor.page.keyboard.press("Control+k")
    dialog.get_by_role("combobox").fill("grid")
    editor.page.keyboard.press("ArrowDown")
    editor.page.keyboard.press("ArrowUp")
    editor.page.keyboard.press("Enter")
    editor.until("editor.store.overlays.scene.grid === false", "the grid's end")
    editor.get("editor.store.setOverlay('grid', true)")


def two_grouped_boxes(editor):
    """Boxes at y = -1.5 and 1.5, grouped by the keyboard, with nothing selected."""
    for name, y in (("left", -1.5), ("right", 1.5)):
        editor.get(f"editor.actions.edit({{kind: 'insert', shape: 'box', name: '{name}',"
                   f" pose: [0, {y}, 0.5, 0, 0, 0, 1]}})")
    editor.until("['left', 'right'].every((one) => editor.view.bounds(one))", "both boxes drawn")
    editor.get("editor.store.select(['left', 'right'])")
    editor.page.keyboard.press("Control+g")
    editor.until("['left', 'right'].every((one) => editor.store.model(one).group === 'group')",
                 "the group")
    editor.page.keyboard.press("Escape")
    editor.until("editor.store.selection.length === 0", "nothing selected")


def test_a_group_is_selected_moved_hidden_and_deleted_together(editor):
    two_grouped_boxes(editor)
    editor.click((0.0, -1.5, 0.5))
    editor.until("editor.store.selection.join() === 'right,left'", "the group under the mouse")
    editor.page.keyboard.press("t")
    editor.drag((0.0, -1.5, 0.5), (1.0, -1.5, 0.5))
    for name, y in (("left", -1.5), ("right", 1.5)):
        wait_for(lambda: editor.model(name)["pose"][:2] == approx([1.0, y], abs=0.1), f"{name}")
    editor.page.keyboard.press("h")
    editor.until("['left', 'right'].every((one) => editor.view.bounds(one) === null)",
                 "both hidden")
    editor.page.keyboard.press("Alt+h")
    editor.row("group (2)").click()
    editor.until("editor.store.selection.length === 2", "the group from the tree")
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Delete")
    wait_for(lambda: editor.names() == ["ground_plane"], "both deleted")
    editor.page.keyboard.press("Control+z")
    editor.until("editor.store.model('left')?.group === 'group'", "the box in its group again")


def test_a_second_click_selects_one_model_of_a_group_and_ungroup_is_undone(editor):
    two_grouped_boxes(editor)
    editor.click((0.0, 1.5, 0.5))
    editor.until("editor.store.selection.length === 2", "the group")
    editor.click((0.0, 1.5, 0.5))
    editor.until("editor.store.selection.join() === 'right'", "the model")
    editor.page.keyboard.press("Control+Shift+g")
    editor.until("['left', 'right'].every((one) => !editor.store.model(one).group)", "no group")
    editor.page.keyboard.press("Control+z")
    editor.until("editor.store.model('right').group === 'group'", "the group again")


def test_a_light_is_moved_hidden_and_deleted_with_the_model_of_its_group(editor):
    editor.get("editor.actions.edit({kind: 'insert', shape: 'box', name: 'post',"
               " pose: [0, 0, 0.5, 0, 0, 0, 1]})")
    editor.get("editor.actions.edit({kind: 'insert_light', light: {type: 'point', name: 'bulb',"
               " pose: [0, 0, 1.5, 0, 0, 0, 1]}})")
    editor.until("editor.view.bounds('post')", "the drawn box")
    editor.get("editor.store.select(['post', 'bulb'])")
    editor.page.keyboard.press("Control+g")
    editor.until("editor.store.light('bulb').group === 'group'", "the group")
    editor.page.keyboard.press("Escape")
    editor.until("editor.store.selection.length === 0", "nothing selected")
    editor.click((0.0, 0.0, 1.5))
    editor.until("editor.store.selection.join() === 'post,bulb'", "the group under the mouse")
    editor.page.keyboard.press("t")
    editor.drag((0.0, 0.0, 0.5), (1.0, 0.0, 0.5))
    wait_for(lambda: editor.get("editor.store.light('bulb').pose")[0] > 0.5, "the moved light")
    x, y, _ = editor.get("editor.store.light('bulb').pose")[:3]
    assert editor.model("post")["pose"][:3] == approx([x, y, 0.5], abs=1e-3)
    editor.page.keyboard.press("h")
    editor.until("editor.store.selection.length === 0", "nothing selected")
    editor.click((x, y, 1.5))
    editor.frame()
    assert editor.get("editor.store.selection") == []
    editor.page.keyboard.press("Alt+h")
    editor.row("group (2)").click()
    name = editor.field("name")
    name.fill("lamp")
    name.press("Enter")
    editor.row("lamp (2)").click()
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Delete")
    editor.until("!editor.store.light('bulb') && !editor.store.model('post')", "both deleted")
    editor.page.keyboard.press("Control+z")
    editor.until("editor.store.light('bulb')?.group === 'lamp'", "the light in its group again")


def test_a_group_survives_save_and_load(editor, node):
    two_grouped_boxes(editor)
    editor.get("editor.request('save', {path: 'grouped.world', overwrite: true})")
    editor.get("editor.request('new', {discard: true})")
    wait_for(lambda: editor.names() == ["ground_plane"], "an empty world")
    editor.get("editor.request('open', {path: 'grouped.world', discard: true})")
    editor.until("editor.store.model('left')?.group === 'group'", "the group of the file")
    editor.row("right").get_by_text("group").wait_for()
