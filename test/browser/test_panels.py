"""The bars, panels and dialogs around the view, against a real node."""
from __future__ import annotations

import base64
import math
import os

import trimesh
from gazebo_msgs.srv import GetModelState, GetPhysicsProperties
from pytest import approx
from support import wait_for

HINGED = """<sdf version="1.7"><model name="gate"><pose>0 0 1 0 0 0</pose>
  <link name="post"><inertial><mass>1</mass></inertial></link>
  <link name="leaf"><inertial><mass>1</mass></inertial></link>
  <joint name="fixed_to_world" type="fixed"><parent>world</parent><child>post</child></joint>
  <joint name="hinge" type="revolute"><parent>post</parent><child>leaf</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
</model></sdf>"""


def tag_of(editor, row):
    return editor.get(f"[...document.querySelectorAll('[role=treeitem]')].find((one) =>"
                      f" one.textContent.startsWith({row!r}))?.querySelector('.tag')?.textContent")


def test_a_plugin_of_the_world_is_added_set_undone_and_removed(editor):
    plugins = "editor.store.document.plugins"
    editor.row("Plugins (0)").click()
    editor.button("Add wind plugin").click()
    editor.until(f"{plugins}.length === 1", "the plugin")
    editor.page.keyboard.press("Escape")
    editor.row("Plugins (1)").click()
    editor.page.keyboard.press("ArrowRight")
    editor.row("WindPlugin").click()
    wait_for(lambda: tag_of(editor, "WindPlugin") == "running", "the running plugin")
    factor = editor.field("force_approximation_scaling_factor")
    factor.fill("0")
    factor.press("Enter")
    wait_for(lambda: tag_of(editor, "WindPlugin") == "failed", "the reason to fail")
    editor.get("editor.actions.undo()")
    wait_for(lambda: tag_of(editor, "WindPlugin") == "running", "the plugin that runs again")
    source = editor.page.locator("textarea.xml")
    text = source.input_value()
    source.fill(text.replace("</plugin>", "</plug>"))
    source.press("Control+Enter")
    editor.page.locator(".field-note", has_text="line 3").wait_for()
    assert "</plug>" in source.input_value()
    source.fill(text.replace("WindPlugin\"", "breeze\""))
    source.press("Control+Enter")
    editor.until(f"{plugins}[0].name === 'breeze'", "the other name")
    editor.button("Remove plugin").click()
    editor.until(f"{plugins}.length === 0", "the end of the plugin")
    editor.get("editor.actions.undo()")
    editor.until(f"{plugins}[0]?.name === 'breeze'", "its return")


# -- properties -----------------------------------------------------------------------------------

def test_a_typed_position_moves_the_model_and_is_what_services_tell(editor, node):
    editor.place("Box")
    editor.row("unit_box").click()
    field = editor.field("pose x")
    field.fill("1.5")
    field.press("Enter")
    wait_for(lambda: node.ask("get_model_state", GetModelState, model_name="unit_box")
             .pose.position.x == approx(1.5), "the move")
    editor.field("pose yaw").fill("90deg")
    editor.field("pose yaw").press("Enter")
    wait_for(lambda: editor.field("pose yaw").input_value() == "1.5708", "the turn")
    assert editor.field("pose x").input_value() == "1.5"


def open_inertial(editor):
    """Select the link of a new box and open its section Inertial."""
    editor.place("Box")
    editor.row("unit_box").click()
    editor.page.keyboard.press("ArrowRight")
    editor.row("link").click()
    editor.page.get_by_text("Inertial", exact=True).click()


def test_masses_sizes_and_friction_are_set_where_they_are_shown(editor):
    open_inertial(editor)
    for label, text, path in (("mass", "2.5", "inertial.mass"),
                              ("size z", "0.5", "collisions[0].geometry.size[2]"),
                              ("friction mu", "0.3", "collisions[0].surface.mu")):
        field = editor.field(label).first
        field.fill(text)
        field.press("Enter")
        wait_for(lambda path=path, text=text: editor.get(
            f"editor.store.model('unit_box').links[0].{path}") == float(text), label)
    editor.until("editor.store.history.undo.length === 4", "each of them in the history")


def show_link_of_box(editor):
    editor.place("Box")
    editor.row("unit_box").click()
    editor.page.keyboard.press("ArrowRight")
    editor.row("link").click()
    editor.field("size z").first.wait_for()


def add_visual(editor):
    """Gives the link of the box another visual, as another user would: its panel is built again."""
    editor.get("editor.request('edit', {op: {kind: 'add_shape', link: 'unit_box::link',"
               " part: 'visual', shape: 'sphere'}})")
    editor.page.locator('.field[data-target$="visual_0"]').first.wait_for()


def test_text_that_is_typed_stays_where_the_panel_is_built_again(editor):
    show_link_of_box(editor)
    # The second of its name: a collision has one, too.
    editor.field("size z").nth(1).click()
    editor.page.keyboard.type("0.")
    add_visual(editor)
    assert editor.get("editor.store.history.undo[0]") == "Add visual to unit_box::link"
    editor.page.keyboard.type("25")
    editor.page.keyboard.press("Enter")
    editor.until("editor.store.model('unit_box').links[0].visuals[0].geometry.size[2] === 0.25",
                 "the typed size")
    assert editor.get("editor.store.model('unit_box').links[0].collisions[0].geometry.size") == [
        1, 1, 1]


def test_text_that_is_typed_is_committed_where_another_panel_comes(editor):
    show_link_of_box(editor)
    editor.field("size z").first.click()
    editor.page.keyboard.type("0.25")
    editor.get("editor.store.select(['ground_plane'])")
    editor.until("editor.store.model('unit_box').links[0].collisions[0].geometry.size[2] === 0.25",
                 "the typed size")


def test_parts_of_a_vector_that_are_typed_quickly_are_all_kept(editor):
    show_link_of_box(editor)
    for part, text in zip("xyz", ("0.5", "0.6", "0.7")):
        editor.field(f"size {part}").first.fill(text)
    editor.field("size z").first.press("Enter")
    editor.until("editor.store.model('unit_box').links[0].collisions[0].geometry.size.join()"
                 " === '0.5,0.6,0.7'", "all three")


def test_a_number_that_makes_no_sense_is_refused_and_the_old_one_comes_back(editor):
    open_inertial(editor)
    mass = editor.field("mass")
    mass.fill("-1")
    mass.press("Enter")
    editor.page.get_by_text("mass: must be greater than 0").wait_for()
    assert mass.input_value() == "1"
    assert editor.get("editor.store.history.undo.length") == 1


def test_a_name_that_is_taken_is_refused_by_the_simulator_and_said_at_the_field(editor):
    editor.place("Box")
    editor.place("Box", (2.0, 1.0, 0.0))
    editor.row("unit_box_0").click()
    name = editor.field("name")
    name.fill("unit_box")
    name.press("Enter")
    note = editor.page.locator('[data-path="name"] .field-note')
    wait_for(lambda: "unit_box" in note.text_content(), "the refusal")
    wait_for(lambda: name.input_value() == "unit_box_0", "the name of before")
    assert set(editor.names()) == {"ground_plane", "unit_box", "unit_box_0"}


def test_the_world_s_own_properties_reach_the_engine_and_can_be_undone(editor, node):
    editor.row("Physics").click()
    gravity = editor.field("gravity z")
    gravity.fill("-1.62")
    gravity.press("Enter")

    def in_node():
        return node.ask("get_physics_properties", GetPhysicsProperties).gravity.z

    wait_for(lambda: in_node() == approx(-1.62), "the moon's gravity")
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Control+z")
    wait_for(lambda: in_node() == approx(-9.8), "the earth's gravity")
    wait_for(lambda: gravity.input_value() == "-9.8", "the echo")


def test_lights_scene_and_fog_are_edited_in_the_panel(editor):
    editor.row("Scene").click()
    editor.page.get_by_role("checkbox", name="fog").check()
    editor.until("editor.store.document.scene.fog !== null", "the fog")
    density = editor.field("density")
    density.fill("0.25")
    density.press("Enter")
    editor.until("editor.store.document.scene.fog.density === 0.25", "the density")
    editor.row("sun").click()
    editor.page.get_by_role("combobox", name="type").select_option("point")
    editor.until("editor.store.light('sun').type === 'point'", "the other type")
    editor.field("range").wait_for()


# -- history ---------------------------------------------------------------------------------------

def test_the_history_is_in_words_and_takes_back_several_steps_at_once(editor):
    editor.place("Box")
    editor.place("Sphere", (2.0, 1.0, 0.0))
    editor.place("Point light", (-1.0, 1.0, 0.0))
    editor.button("Undo history").click()
    labels = editor.page.locator(".menu.history button").all_text_contents()
    assert [label.lower() for label in labels] == [
        "insert user_point_light_0", "insert unit_sphere", "insert unit_box"]
    editor.page.locator(".menu.history button").nth(1).click()
    wait_for(lambda: editor.names() == ["ground_plane", "unit_box"], "the world before")
    editor.button("Redo history").click()
    editor.page.locator(".menu.history button").nth(1).click()
    wait_for(lambda: len(editor.names()) == 3, "the sphere's return")
    editor.until("editor.store.document.lights.length === 2", "the light's return")


# -- keyboard --------------------------------------------------------------------------------------

def test_selecting_renaming_and_deleting_need_no_mouse(editor):
    editor.place("Box")
    editor.place("Box", (2.0, 1.0, 0.0))
    editor.row("unit_box_0").wait_for()
    press = editor.page.keyboard.press
    press("Escape")
    editor.until("editor.store.selection.length === 0", "an empty selection")
    for _ in range(12):
        if editor.get("document.activeElement.getAttribute('role')") == "tree":
            break
        press("F6")
    press("End")
    press("Home")
    for _ in range(9):
        press("ArrowDown")
    editor.until("editor.store.selection.join() === 'unit_box_0'", "the box, chosen in the tree")
    press("F2")
    editor.until("document.activeElement.value === 'unit_box_0'", "the name field")
    editor.page.keyboard.type("crate")
    press("Enter")
    editor.until("editor.store.selection.join() === 'crate'", "the new name")
    press("Tab")
    editor.until("document.activeElement.ariaLabel === 'pose x'", "the next field")
    editor.page.keyboard.type("3")
    press("Tab")
    wait_for(lambda: editor.model("crate")["pose"][0] == approx(3.0), "the typed place")
    editor.page.locator(".world-tree").focus()
    press("Delete")
    wait_for(lambda: "crate" not in editor.names(), "the deletion")
    press("Control+z")
    wait_for(lambda: "crate" in editor.names(), "the return")


def test_menus_open_and_run_by_keys_and_show_the_hotkeys(editor):
    editor.page.get_by_role("menuitem", name="File").focus()
    press = editor.page.keyboard.press
    press("ArrowRight")
    press("ArrowRight")
    press("ArrowRight")
    press("Enter")
    editor.page.get_by_role("menuitemcheckbox", name="Grid").wait_for()
    press("Enter")
    editor.until("editor.store.overlays.scene.grid === false", "the grid's end")
    press("F1")
    chart = editor.page.get_by_role("dialog", name="Hotkeys")
    assert "Ctrl+Shift+S" in chart.text_content()
    press("Escape")
    wait_for(lambda: chart.count() == 0, "the chart's end")
    editor.get("editor.store.setOverlay('grid', true)")


def test_a_menu_opens_on_the_press_and_closes_on_the_next(editor):
    box = editor.page.get_by_role("menuitem", name="File", exact=True).bounding_box()
    editor.page.mouse.move(box["x"] + 8, box["y"] + 8)
    editor.page.mouse.down()
    first = editor.get("document.querySelector('.popup [role=menu] [role=menuitem]')?.textContent")
    assert first and editor.get("document.activeElement.textContent") == first
    editor.page.mouse.up()
    assert editor.get("document.activeElement.textContent") == first
    editor.page.mouse.down()
    editor.page.mouse.up()
    assert editor.get("!document.querySelector('.popup')")


def test_letters_typed_into_fields_are_no_hotkeys(editor):
    editor.place("Box")
    editor.page.keyboard.press("Control+f")
    editor.page.keyboard.type("ts box")
    assert editor.get("editor.store.mode") == "select"
    assert editor.page.get_by_label("Find a model or light").input_value() == "ts box"


# -- time ------------------------------------------------------------------------------------------

def test_time_runs_stands_steps_and_is_reset(editor):
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Space")
    editor.until("!editor.store.stats.paused && editor.store.stats.iterations > 20", "running")
    editor.button("Pause").click()
    editor.until("editor.store.stats.paused", "the pause")
    wait_for(lambda: not editor.button("Step").is_disabled(), "the step button")
    before = editor.get("editor.store.stats.iterations")
    editor.page.get_by_role("spinbutton", name="Steps").fill("7")
    editor.button("Step").click()
    editor.until(f"editor.store.stats.iterations === {before + 7}", "seven steps")
    editor.button("Reset time").click()
    editor.until("editor.store.stats.sim_ns === 0", "the reset")
    shown = editor.page.get_by_label("Sim Time", exact=True)
    wait_for(lambda: shown.text_content() == "00 00:00:00.000", "the figure")


# -- files -----------------------------------------------------------------------------------------

def in_dialog(editor, title):
    dialog = editor.page.get_by_role("dialog", name=title)
    dialog.get_by_role("button", name="my_simulations/worlds").click()
    wait_for(lambda: dialog.get_by_label("Folder").text_content().endswith("/worlds"), "the folder")
    return dialog


def save(editor, name):
    editor.page.keyboard.press("Control+Shift+s")
    dialog = in_dialog(editor, "Save World As")
    dialog.get_by_role("textbox", name="File name").fill(name)
    dialog.get_by_role("button", name="Save", exact=True).click()
    return dialog


def test_a_file_is_replaced_only_after_a_question(editor, node):
    path = os.path.join(node.worlds, "twice.world")
    with open(path, "w", encoding="utf-8") as stream:
        stream.write("precious")
    editor.place("Box")
    dialog = save(editor, "twice")
    question = editor.page.get_by_role("dialog", name="Overwrite the file?")
    question.get_by_role("button", name="Cancel").click()
    assert open(path, encoding="utf-8").read() == "precious"
    dialog.get_by_role("button", name="Save", exact=True).click()
    question.get_by_role("button", name="Overwrite").click()
    wait_for(lambda: "unit_box" in open(path, encoding="utf-8").read(), "the new content")
    card = editor.page.locator(".notice", has_text="Saved")
    card.wait_for(state="visible")
    card.wait_for(state="detached")
    editor.place("Box", (2.0, 1.0, 0.0))
    editor.page.keyboard.press("Control+s")
    wait_for(lambda: "unit_box_0" in open(path, encoding="utf-8").read(), "Ctrl+S")
    card.wait_for(state="visible")


def test_unsaved_changes_are_asked_for_before_another_world_is_opened(editor, node):
    editor.place("Box")
    save(editor, "one_box").wait_for(state="detached")
    editor.until("!editor.store.history.dirty", "the saved world")
    editor.place("Box", (2.0, 1.0, 0.0))
    editor.page.keyboard.press("Control+o")
    question = editor.page.get_by_role("dialog", name="Save changes?")
    question.get_by_role("button", name="Don't Save").click()
    dialog = in_dialog(editor, "Open World")
    dialog.get_by_role("option", name="one_box.world").dblclick()
    wait_for(lambda: editor.names() == ["ground_plane", "unit_box"], "the opened world")
    wait_for(lambda: editor.page.title().startswith("one_box.world"), "its name")


def write_world(node, name, text):
    with open(os.path.join(node.worlds, name), "w", encoding="utf-8") as stream:
        stream.write(text)


def test_what_is_wrong_in_an_opened_file_is_told_with_its_line(editor, node):
    write_world(node, "nameless.world", """<sdf version="1.6">
 <world name="w">
  <model></model>
 </world>
</sdf>
""")
    editor.page.keyboard.press("Control+o")
    dialog = in_dialog(editor, "Open World")
    dialog.get_by_role("option", name="nameless.world").dblclick()
    editor.button("Messages").click()
    messages = editor.page.get_by_role("dialog", name="All messages")
    wait_for(lambda: "nameless.world:3" in messages.text_content(), "the place")
    assert "no name" in messages.text_content()


def test_a_file_that_cannot_be_read_leaves_the_world_and_says_why(editor, node):
    write_world(node, "hollow.world", "<sdf version='1.6'>\n</sdf>\n")
    editor.place("Box")
    save(editor, "kept").wait_for(state="detached")
    editor.until("!editor.store.history.dirty", "the saved world")
    editor.page.keyboard.press("Control+o")
    dialog = in_dialog(editor, "Open World")
    dialog.get_by_role("option", name="hollow.world").click()
    dialog.get_by_role("button", name="Open", exact=True).click()
    reason = dialog.get_by_role("alert")
    reason.wait_for()
    assert "world" in reason.text_content()
    dialog.get_by_role("button", name="Cancel").click()
    assert editor.names() == ["ground_plane", "unit_box"]


# -- library, forces, joints -----------------------------------------------------------------------

def test_a_model_of_the_library_follows_the_mouse_and_is_placed_by_a_click(editor):
    editor.page.get_by_role("tab", name="Insert").click()
    editor.page.get_by_role("searchbox", name="Find a model", exact=True).fill("table")
    card = editor.page.get_by_role("button", name="Table", exact=True)
    card.click()
    editor.until("editor.store.mode === 'insert'", "the ghost")
    editor.page.mouse.move(*editor.pixel((0.5, 0.5, 0.0)))
    editor.click((1.0, 1.0, 0.0))
    wait_for(lambda: "table" in editor.names(), "the table")
    assert editor.model("table")["pose"][:2] == approx([1.0, 1.0], abs=0.02)
    editor.until("editor.store.mode === 'select'", "the mode of before")


def test_a_force_from_the_dialog_pushes_the_box(editor):
    editor.place("Box")
    editor.click((0.0, 0.0, 0.5), button="right")
    editor.page.get_by_role("menuitem", name="Apply Force/Torque").click()
    dialog = editor.page.get_by_role("dialog", name="Apply Force/Torque")
    dialog.get_by_role("textbox", name="Force x").fill("60")
    dialog.get_by_role("textbox", name="Force y").fill("80")
    dialog.get_by_role("textbox", name="Force y").press("Enter")
    magnitude = dialog.get_by_role("textbox", name="Force magnitude")
    wait_for(lambda: magnitude.input_value() == "100", "the magnitude")
    dialog.get_by_role("textbox", name="Steps").fill("100")
    dialog.get_by_role("textbox", name="Steps").press("Tab")
    dialog.get_by_role("button", name="Apply Force").click()
    editor.until("document.activeElement.textContent === 'Apply Force'", "the focus on its button")
    dialog.get_by_role("button", name="Cancel").click()
    editor.get("editor.request('step', {steps: 150})")
    x, y = wait_for(lambda: editor.model("unit_box")["pose"][0] > 0.05 and
                    editor.model("unit_box")["pose"][:2], "the push")
    assert y / x == approx(80 / 60, rel=0.05)


def opened_force_dialog(editor):
    editor.click((0.0, 0.0, 0.5), button="right")
    editor.page.get_by_role("menuitem", name="Apply Force/Torque").click()
    dialog = editor.page.get_by_role("dialog", name="Apply Force/Torque")
    dialog.wait_for()
    return dialog


def test_escape_in_the_view_closes_the_force_dialog_before_it_clears_the_selection(editor):
    editor.place("Box")
    dialog = opened_force_dialog(editor)
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Escape")
    dialog.wait_for(state="detached")
    assert editor.get("editor.store.selection") == ["unit_box"]
    editor.page.keyboard.press("Escape")
    assert editor.get("editor.store.selection") == []


def test_the_force_dialog_closes_with_its_model(editor):
    editor.place("Box")
    dialog = opened_force_dialog(editor)
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Delete")
    dialog.wait_for(state="detached")


def test_the_hotkey_chart_is_scrolled_by_keys_in_a_small_window(editor):
    page = editor.page
    size = page.viewport_size
    page.set_viewport_size({"width": 800, "height": 450})
    page.keyboard.press("F1")
    chart = page.get_by_role("dialog", name="Hotkeys")
    last = chart.locator("dd").last
    assert chart.get_by_role("button", name="Close").last.is_visible()
    page.keyboard.press("End")
    wait_for(lambda: last.bounding_box()["y"] + last.bounding_box()["height"] <
             chart.locator(".dialog-buttons").bounding_box()["y"] + 1, "the chart's end")
    page.keyboard.press("Escape")
    chart.wait_for(state="detached")
    page.set_viewport_size(size)


def test_the_joints_panel_turns_a_hinge(editor):
    editor.get(f"editor.request('edit', {{op: {{kind: 'insert', sdf: {HINGED!r}}}}})")
    wait_for(lambda: "gate" in editor.names(), "the gate")
    editor.button("Joints panel").click()
    editor.row("gate").click()
    panel = editor.page.locator("#right")
    panel.get_by_role("tab", name="Velocity").click()
    speed = panel.get_by_role("textbox", name="hinge velocity")
    speed.fill("1")
    speed.press("Enter")
    editor.button("Play").click()

    def angle():
        return float((panel.get_by_label("hinge state").text_content() or "0").split()[0])

    wait_for(lambda: abs(angle()) > 0.05, "the hinge's turn")
    position = panel.get_by_role("textbox", name="hinge position")
    panel.get_by_role("tab", name="Position").click()
    for gain, value in (("P gain", "400"), ("D gain", "40")):
        panel.get_by_role("textbox", name=f"hinge {gain}").fill(value)
        panel.get_by_role("textbox", name=f"hinge {gain}").press("Enter")
    position.fill("0.5")
    position.press("Enter")
    wait_for(lambda: abs(angle() - 0.5) < 0.02, "the hinge at 0.5")
    # What the panel shows is what the simulator says drives the joint.
    editor.get("editor.request('undo', {})")
    wait_for(lambda: position.input_value() == "0", "the loop undone")
    panel.get_by_role("tab", name="Velocity").click()
    wait_for(lambda: speed.input_value() == "1", "the speed of before")
    # Gains of 0 stop a motor: that is said beside them.
    idle = panel.get_by_text("All gains are 0")
    assert idle.count() == 0
    for gain in "PID":
        panel.get_by_role("textbox", name=f"hinge {gain} gain").fill("0")
        panel.get_by_role("textbox", name=f"hinge {gain} gain").press("Enter")
    idle.wait_for()
    panel.get_by_role("textbox", name="hinge P gain").fill("2")
    panel.get_by_role("textbox", name="hinge P gain").press("Enter")
    idle.wait_for(state="detached")
    panel.get_by_role("button", name="Reset").click()
    wait_for(lambda: speed.input_value() == "0", "nothing asked of the hinge")
    editor.button("Pause").click()
    editor.button("Joints panel").click()
    wait_for(lambda: panel.is_hidden(), "the closed panel")


# -- plots, logs, messages -------------------------------------------------------------------------

def test_a_falling_box_is_plotted_and_exported(editor, tmp_path):
    name = editor.place("Box")
    editor.get(f"editor.actions.move({{{name!r}: [0, 0, 40, 0, 0, 0, 1]}})")
    editor.page.keyboard.press("Control+p")
    editor.page.get_by_label("Find a variable").fill(f"{name}.vz")
    editor.page.get_by_role("option", name=f"{name}.vz").click()
    editor.get("editor.actions.play()")
    editor.until("editor.store.stats.sim_ns > 1.5e9", "some time of falling")
    editor.get("editor.actions.pause()")
    with editor.page.expect_download() as csv:
        editor.button("CSV").click()
    csv.value.save_as(tmp_path / "plot.csv")
    head, *rows = (tmp_path / "plot.csv").read_text().splitlines()
    assert head == f"time,{name}.vz"
    pairs = [tuple(map(float, row.split(","))) for row in rows]
    falling = [(time, rate) for time, rate in pairs if 0.05 < time < 1.5]
    assert len(falling) > 3
    for time, rate in falling:
        # The clock may be some steps ahead of the state that was read.
        assert rate == approx(-9.8 * time, rel=0.02, abs=0.1)
    with editor.page.expect_download() as png:
        editor.button("PNG").click()
    png.value.save_as(tmp_path / "plot.png")
    assert (tmp_path / "plot.png").read_bytes()[:4] == b"\x89PNG"
    editor.button("Close plots").click()


def test_what_was_recorded_is_replayed_with_a_slider(editor):
    name = editor.place("Box")
    editor.get(f"editor.actions.move({{{name!r}: [0, 0, 3, 0, 0, 0, 1]}})")
    editor.page.keyboard.press("Alt+r")
    dialog = editor.page.get_by_role("dialog", name="Log Data")
    dialog.get_by_role("textbox", name="Log name").fill("falling")
    dialog.get_by_role("button", name="Record").click()
    dialog.get_by_role("button", name="Stop recording").wait_for()
    editor.get("editor.actions.play()")
    wait_for(lambda: editor.model(name)["pose"][2] < 1.5, "the fall")
    editor.get("editor.actions.pause()")
    dialog.get_by_role("button", name="Stop recording").click()
    dialog.get_by_role("button", name="Replay falling").click()
    slider = editor.page.get_by_role("slider", name="Log time")
    slider.wait_for()
    wait_for(lambda: editor.model(name) and editor.model(name)["pose"][2] > 2.9, "its beginning")
    slider.focus()
    editor.page.keyboard.press("End")
    wait_for(lambda: editor.model(name)["pose"][2] < 1.5, "its end")
    editor.button("Close log").click()
    editor.button("Play").wait_for()


def test_a_video_of_the_view_is_recorded(editor, tmp_path):
    editor.place("Box")
    editor.button("Record video").click()
    editor.page.keyboard.press("Escape")
    seen = [editor.get("editor.view.pixelOf('unit_box')")]
    editor.get("editor.actions.viewFrom('top')")

    def flown():
        seen.append(editor.get("editor.view.pixelOf('unit_box')"))
        return seen[-1] != seen[0] and len(seen) > 3 and seen[-1] == seen[-2] == seen[-3]

    wait_for(flown, "the flight")
    with editor.page.expect_download() as video:
        editor.button("Record video").click()
    video.value.save_as(tmp_path / "view.webm")
    assert (tmp_path / "view.webm").read_bytes()[:4] == b"\x1aE\xdf\xa3"


# -- screens ---------------------------------------------------------------------------------------

def test_everything_fits_a_small_laptop(editor):
    for bar in ("#menubar", "#toolbar", "#timebar", "#left", "#app"):
        wide = editor.get(f"(() => {{ const bar = document.querySelector('{bar}');"
                          " return [bar.scrollWidth, bar.clientWidth]; })()")
        assert wide[0] <= wide[1], bar
    assert editor.get("document.querySelector('#view').clientHeight") > 600


def test_dark_and_light_follow_the_browser_until_the_user_chooses(node, browser):
    light = browser.open(node.url, color_scheme="light")

    def brightness():
        color = light.get("getComputedStyle(document.querySelector('#left')).backgroundColor")
        return sum(int(part) for part in color[4:-1].split(",")[:3])

    assert brightness() > 600
    light.page.get_by_role("menuitem", name="Window").click()
    light.page.get_by_role("menuitemcheckbox", name="Theme: dark").click()
    wait_for(lambda: brightness() < 200, "the dark")
    light.page.reload()
    light.until("Boolean(window.editor && editor.store.document)", "the world again")
    assert brightness() < 200
    light.close()


DROP = """([name, data, x, y]) => {
  const moved = new DataTransfer();
  moved.items.add(new File([Uint8Array.from(atob(data), (one) => one.charCodeAt(0))], name));
  const canvas = document.querySelector('#view canvas');
  for (const type of ['dragover', 'drop']) {
    canvas.dispatchEvent(new DragEvent(type, {dataTransfer: moved, clientX: x, clientY: y,
      bubbles: true, cancelable: true}));
  }
}"""


def drop(editor, name, data, point):
    editor.page.evaluate(DROP, [name, base64.b64encode(data).decode(), *editor.pixel(point)])


def test_the_first_number_of_a_dialog_is_replaced_by_what_is_typed(editor):
    name = editor.place("Box")
    editor.get(f"editor.store.select([{name!r}])")
    editor.get("editor.actions.arrayOfSelection()")
    field = editor.page.locator("dialog input").first
    wait_for(lambda: field.evaluate("(one) => one === document.activeElement"), "its focus")
    editor.page.keyboard.type("3")
    assert field.input_value() == "3"
    editor.page.keyboard.press("Escape")


def test_the_ghost_of_a_card_follows_the_drag_and_goes_with_it(editor):
    editor.page.get_by_role("tab", name="Insert").click()
    card = editor.page.locator(".model-card").first
    card.hover()
    editor.page.mouse.down()
    editor.page.mouse.move(*editor.pixel((0.5, 0.0, 0.0)), steps=4)
    editor.until("Boolean(editor.store.placing?.uri)", "what is dragged")
    editor.page.mouse.move(*editor.pixel((0.0, 0.0, 0.0)), steps=4)
    editor.page.keyboard.press("Escape")
    editor.page.mouse.up()
    editor.until("editor.store.placing === null", "the end of the drag")
    assert editor.names() == ["ground_plane"]


def test_a_card_of_the_gallery_is_dragged_to_its_place(editor):
    editor.page.get_by_role("tab", name="Insert").click()
    card = editor.page.get_by_role("button", name="crate", exact=True).or_(
        editor.page.locator(".model-card")).first
    card.wait_for()
    before = set(editor.names())
    box = editor.page.locator("#view").bounding_box()
    x, y = editor.pixel((1.0, -1.0, 0.0))
    card.drag_to(editor.page.locator("#view canvas"),
                 target_position={"x": x - box["x"], "y": y - box["y"]})
    [name] = wait_for(lambda: set(editor.names()) - before, "the model")
    assert editor.model(name)["pose"][:2] == approx([1.0, -1.0], abs=0.05)


def test_an_sdf_file_that_is_dropped_stands_where_it_was_dropped(editor):
    drop(editor, "gate.sdf", HINGED.encode(), (1.0, 0.5, 0.0))
    wait_for(lambda: "gate" in editor.names(), "the gate")
    assert editor.model("gate")["pose"][:2] == approx([1.0, 0.5], abs=0.05)
    drop(editor, "bad.sdf", b"<sdf version='1.6'><model name='m'>", (1.0, 0.5, 0.0))
    editor.page.locator(".notice").get_by_text("cut off").wait_for()
    editor.page.locator(".notice").get_by_text("bad.sdf:1").wait_for()


def test_the_models_of_a_dropped_world_keep_their_names(editor):
    world = HINGED.replace('1.7">', '1.7"><world name="yard">').replace("</sdf>", "</world></sdf>")
    drop(editor, "yard.world", world.encode(), (1.0, 0.5, 0.0))
    wait_for(lambda: "gate" in editor.names(), "the gate")
    editor.until("editor.store.history.undo[0] === 'Insert gate'", "its label")


def test_a_mesh_that_is_dropped_becomes_a_body_of_the_density_asked_for(editor):
    drop(editor, "ball.stl", trimesh.creation.icosphere(4, 0.25).export(file_type="stl"),
         (-1.0, 0.0, 0.0))
    asked = editor.page.get_by_role("dialog", name="Import Mesh")
    asked.get_by_label("Density").fill("500")
    asked.get_by_role("button", name="Import").click()
    wait_for(lambda: "ball" in editor.names(), "the ball")
    assert editor.model("ball")["pose"][:3] == approx([-1.0, 0.0, 0.25], abs=0.05)
    mass = editor.model("ball")["links"][0]["inertial"]["mass"]
    assert mass == approx(500 * 4 / 3 * math.pi * 0.25 ** 3, rel=0.01)


def delay_next(editor, kind):
    """Delays a request of the page of this kind until the script `goOn()`."""
    editor.get(f"""(() => {{ const {{connection}} = editor, ask = connection.request;
        connection.request = async (kind, ...rest) => {{
          if (kind === {kind!r}) {{
            connection.request = ask;
            await new Promise((go) => {{ window.goOn = go; }});
          }}
          return ask.call(connection, kind, ...rest);
        }}; }})()""")


def test_what_is_dropped_while_an_import_goes_on_is_imported_too(editor):
    block = trimesh.creation.box((1, 1, 1)).export(file_type="stl")
    asked = editor.page.get_by_role("dialog", name="Import Mesh")
    delay_next(editor, "library_get")
    drop(editor, "first.stl", block, (-1.0, 0.0, 0.0))
    asked.get_by_role("button", name="Import").click()
    editor.until("Boolean(window.goOn)", "the import without its dialog")
    drop(editor, "second.stl", block, (1.0, 0.0, 0.0))
    asked.get_by_role("button", name="Import").click()
    wait_for(lambda: "second" in editor.names(), "the second body")
    editor.get("window.goOn()")
    wait_for(lambda: "first" in editor.names(), "the first body")


def test_an_import_that_takes_long_says_so_and_is_not_left_by_escape(editor):
    drop(editor, "slow.stl", trimesh.creation.box((1, 1, 1)).export(file_type="stl"),
         (-1.0, 0.0, 0.0))
    asked = editor.page.get_by_role("dialog", name="Import Mesh")
    delay_next(editor, "import_model")
    asked.get_by_role("button", name="Import").click()
    asked.get_by_role("alert").get_by_text("Working ...").wait_for()
    editor.page.keyboard.press("Escape")
    asked.get_by_role("button", name="Close").click()
    assert asked.is_visible()
    editor.get("window.goOn()")
    wait_for(lambda: "slow" in editor.names(), "the body")
    asked.wait_for(state="detached")


def test_a_model_s_own_panel_sets_mass_size_and_colour(editor):
    editor.place("Box", (0.0, 0.0, 0.0))
    editor.until("editor.store.selection.join() === 'unit_box'", "the selection")
    size = editor.field("size x")
    size.fill("0.4")
    size.press("Enter")
    editor.until("editor.store.model('unit_box').links[0].visuals[0].geometry.size[0] === 0.4",
                 "the size")
    link = "editor.store.model('unit_box').links[0]"
    assert editor.get(f"{link}.collisions[0].geometry.size") == [0.4, 1, 1]
    assert editor.get(f"{link}.inertial.iyy") == approx((0.16 + 1) / 12, rel=1e-3)
    editor.field("mass").fill("3")
    editor.field("mass").press("Enter")
    editor.until(f"{link}.inertial.mass === 3", "the mass")
    editor.until("editor.store.history.undo[0] === 'Set mass of unit_box to 3'", "its label")
    # What was made by hand is no solid's: computing it mends that, in one step.
    editor.get("editor.actions.setProperty('unit_box::link', 'inertial.ixx', 0.9)")
    editor.until(f"{link}.inertial.ixx === 0.9", "the odd inertia")
    editor.button("Compute inertia").click()
    editor.until(f"Math.abs({link}.inertial.ixx - 3 * 2 / 12) < 1e-6", "the computed inertia")


def test_several_models_are_set_together_and_an_empty_selection_gives_room(editor):
    editor.place("Box", (0.0, 0.0, 0.0))
    editor.place("Sphere", (2.0, 0.0, 0.0))
    editor.page.keyboard.press("Escape")
    editor.page.keyboard.press("Escape")
    editor.until("editor.store.selection.length === 0", "an empty selection")
    editor.frame()
    tall = editor.page.locator(".world-tree").bounding_box()["height"]
    editor.get("editor.store.select(['unit_box', 'unit_sphere'])")
    editor.page.get_by_text("2 models", exact=True).wait_for()
    wait_for(lambda: editor.page.locator(".world-tree").bounding_box()["height"] < tall - 100,
             "less room for the tree")
    editor.field("friction mu").fill("0.25")
    editor.field("friction mu").press("Enter")
    editor.until("['unit_box', 'unit_sphere'].every((name) => "
                 "editor.store.model(name).links[0].collisions[0].surface.mu === 0.25)",
                 "the friction of both")
    editor.until("editor.store.history.undo[0] === 'Set friction of 2 models to 0.25'", "one step")


def test_rows_of_the_tree_say_whether_they_are_selected(editor):
    editor.place("Box")
    editor.get("editor.store.select(['unit_box'])")
    for name, selected in (("unit_box", "true"), ("ground_plane", "false")):
        row = editor.row(name)
        wait_for(lambda one=row, said=selected: one.get_attribute("aria-selected") == said,
                 f"the row of {name}")
