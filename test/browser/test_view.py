"""The 3D view as a person uses it: camera, tools, live drags, and what goes wrong round it."""
from __future__ import annotations

import math

from free_ports import free_port
from gazebo_msgs.srv import GetModelState
from pytest import approx
from support import wait_for


def insert(editor, name, pose, shape="box"):
    editor.get(f"editor.actions.edit({{kind: 'insert', shape: '{shape}', name: '{name}', "
               f"pose: {list(pose)}}})")
    editor.until(f"Boolean(editor.store.model('{name}') && editor.view.pixelOf('{name}'))", name)
    editor.frame()


def standing(x, y):
    return (x, y, 0.5, 0, 0, 0, 1)


def pixel_of(editor, name):
    return editor.get(f"editor.view.pixelOf('{name}')")


def at_rest(editor, name):
    """Where a thing is on the page once the camera has stopped."""
    editor.rest()
    return pixel_of(editor, name)


def drag(editor, start, end, button="left"):
    mouse = editor.page.mouse
    mouse.move(*start)
    mouse.down(button=button)
    mouse.move(*end, steps=8)
    mouse.up(button=button)


def test_turning_the_camera_leaves_the_point_under_the_mouse_in_its_place(editor):
    insert(editor, "box", standing(0, 0))
    insert(editor, "far", standing(-6, 6))
    x, y = pixel_of(editor, "box")
    far = pixel_of(editor, "far")
    drag(editor, (x, y), (x + 150, y + 20), button="middle")
    # What was taken hold of is the box's face, half a metre before its middle.
    shift = abs(pixel_of(editor, "box")[0] - x)
    assert shift < 80
    assert abs(pixel_of(editor, "far")[0] - far[0]) > 3 * shift


def test_the_wheel_zooms_to_what_is_under_the_mouse(editor):
    insert(editor, "box", standing(1, 1))
    x, y = pixel_of(editor, "box")
    size = "(() => { const box = editor.view.bounds('box'); return box.max[0]; })()"
    assert editor.get(size) == approx(1.5)
    insert(editor, "beside", standing(1, 3))
    gap = abs(pixel_of(editor, "beside")[0] - x)
    editor.page.mouse.move(x, y)
    editor.page.mouse.wheel(0, -300)
    wait_for(lambda: abs(pixel_of(editor, "beside")[0] - pixel_of(editor, "box")[0]) > 1.2 * gap,
             "a nearer view")
    assert pixel_of(editor, "box") == approx([x, y], abs=25)


def test_a_drag_beside_everything_shifts_the_view_and_selects_nothing(editor):
    insert(editor, "box", standing(0, 0))
    x, y = pixel_of(editor, "box")
    drag(editor, (x + 250, y + 150), (x + 350, y + 150))
    wait_for(lambda: pixel_of(editor, "box")[0] > x + 40, "a shifted view")
    assert editor.get("editor.store.selection") == []


def test_double_click_flies_to_a_thing(editor):
    insert(editor, "box", standing(-4, 4))
    editor.page.mouse.dblclick(*pixel_of(editor, "box"))
    box = editor.page.locator("#view").bounding_box()
    middle = [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2]
    wait_for(lambda: pixel_of(editor, "box") == approx(middle, abs=3), "a flight to the box")


def test_views_from_the_top_look_down(editor):
    insert(editor, "low", standing(1, 1))
    insert(editor, "high", (1, 1, 5, 0, 0, 0, 1))
    editor.get("editor.actions.viewFrom('top')")
    editor.get("editor.actions.orthographic()")
    wait_for(lambda: pixel_of(editor, "low") == approx(pixel_of(editor, "high"), abs=1),
             "one above the other")


def middle_of_view(editor):
    box = editor.page.locator("#view").bounding_box()
    return [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2]


def test_f_frames_the_selection_and_with_shift_all_models(editor):
    insert(editor, "near", standing(2, 0))
    insert(editor, "far", standing(-30, 40))
    editor.get("editor.store.select(['far'])")
    editor.page.keyboard.press("f")
    wait_for(lambda: pixel_of(editor, "far") == approx(middle_of_view(editor), abs=3),
             "the framed selection")
    editor.page.keyboard.press("Shift+F")
    x, y = middle_of_view(editor)
    wait_for(lambda: all(0 < at[0] < 2 * x and 0 < at[1] < 2 * y for at in (
        pixel_of(editor, "near"), pixel_of(editor, "far"))), "both models in the view")


def test_home_shows_all_models_if_the_first_view_is_inside_of_one(editor):
    shape = "<geometry><box><size>30 30 10</size></box></geometry>"
    house = (f"<sdf version='1.7'><model name='house'><static>1</static><link name='l'>"
             f"<visual name='v'>{shape}</visual></link></model></sdf>")
    editor.get(f"editor.request('edit', {{op: {{kind: 'insert', sdf: `{house}`}}}})")
    editor.until("editor.view.pixelOf('house') !== null", "the house")
    editor.page.keyboard.press("Home")
    outside = "Math.max(...editor.view.camera.position.slice(0, 2).map(Math.abs)) > 15"
    editor.until(outside, "a camera outside of the house")


def test_an_orthographic_view_keeps_the_size_of_what_is_seen(editor):
    insert(editor, "a", standing(20, 0))
    insert(editor, "b", standing(-20, 0))
    editor.page.keyboard.press("Shift+F")
    editor.rest()

    def width():
        return math.dist(pixel_of(editor, "a"), pixel_of(editor, "b"))

    before = width()
    editor.get("editor.actions.orthographic()")
    editor.until("editor.store.camera.projection === 'orthographic'", "the projection")
    editor.rest()
    assert width() == approx(before, rel=0.3)
    editor.get("editor.actions.perspective()")


def test_following_keeps_a_moving_thing_in_its_place(editor):
    insert(editor, "box", standing(0, 0))
    x, y = pixel_of(editor, "box")
    editor.get("editor.store.select(['box']), editor.actions.follow()")
    editor.get("editor.actions.move({box: [3, 2, 0.5, 0, 0, 0, 1]})")
    editor.until("Math.abs(editor.store.worldPose('box')[0] - 3) < 1e-6", "the move")
    assert at_rest(editor, "box") == approx([x, y], abs=2)
    editor.page.keyboard.press("Escape")
    assert editor.get("editor.store.camera.following") is None


def test_two_clicks_put_a_face_on_a_face(editor):
    insert(editor, "moves", standing(1, -2))
    insert(editor, "stays", standing(-1, 1))
    editor.page.keyboard.press("n")
    editor.page.mouse.click(*pixel_of(editor, "moves"))
    editor.page.mouse.click(*pixel_of(editor, "stays"))
    editor.until("editor.store.history.undo[0]?.startsWith('Snap')", "the snap")
    wait_for(lambda: 0.9 < distance(editor, "moves", "stays") < 1.45, "touching boxes")
    editor.until("editor.store.mode === 'select'", "the mode of before")


def test_a_face_is_snapped_from_where_its_body_has_gone_meanwhile(editor):
    insert(editor, "moves", standing(1, -2))
    insert(editor, "stays", standing(-1, 1))
    editor.page.keyboard.press("n")
    editor.page.mouse.click(*pixel_of(editor, "moves"))
    editor.until("editor.store.selection[0] === 'moves'", "the first face")
    editor.get("editor.actions.move({moves: [2, -4, 0.5, 0, 0, 0, 1]})")
    editor.until("Math.abs(editor.store.worldPose('moves')[0] - 2) < 1e-6", "the move")
    editor.page.mouse.click(*pixel_of(editor, "stays"))
    editor.until("editor.store.history.undo[0]?.startsWith('Snap')", "the snap")
    wait_for(lambda: 0.9 < distance(editor, "moves", "stays") < 1.45, "touching boxes")


def test_a_face_of_what_was_deleted_is_not_waited_for(editor):
    for name, x, y in (("gone", 1, -2), ("moves", -1, -2), ("stays", -1, 1)):
        insert(editor, name, standing(x, y))
    editor.page.keyboard.press("n")
    editor.page.mouse.click(*pixel_of(editor, "gone"))
    editor.until("editor.store.selection[0] === 'gone'", "the first face")
    editor.get("editor.actions.remove(['gone'])")
    editor.until("!editor.store.model('gone')", "the end of it")
    editor.page.mouse.click(*pixel_of(editor, "moves"))
    editor.until("editor.store.selection[0] === 'moves'", "another first face")
    editor.page.mouse.click(*pixel_of(editor, "stays"))
    editor.until("editor.store.history.undo[0]?.startsWith('Snap')", "the snap")


def test_the_box_round_a_light_and_the_camera_go_with_it(editor):
    name = editor.get("editor.actions.edit({kind: 'insert_light', light: {pose: "
                      "[0, 0, 2, 0, 0, 0, 1]}}).then(({value}) => value.name)")
    editor.until(f"Boolean(editor.store.light('{name}'))", "the light")
    editor.get(f"editor.store.select(['{name}']), editor.actions.follow()")
    eye = editor.get("editor.view.camera.position")
    assert editor.get("editor.view.selectionBoxes") == [[0, 0, 2]]
    editor.get(f"editor.actions.setProperty('{name}', 'pose', [3, 2, 2, 0, 0, 0, 1])")
    editor.until("editor.view.selectionBoxes[0][0] === 3", "the box at the light")
    assert editor.get("editor.view.camera.position") == approx([eye[0] + 3, eye[1] + 2, eye[2]])
    editor.get("editor.actions.undo()")
    editor.until("editor.view.selectionBoxes[0][0] === 0", "the box at the light")


def test_contacts_of_the_running_world_are_not_shown_over_a_log(editor):
    insert(editor, "box", standing(0, 0))
    editor.get("editor.actions.setOverlay('contacts', true)")
    for action in ("logStart('flight')", "step(200)"):
        assert editor.get(f"editor.actions.{action}.then(({{ok}}) => ok)")
    editor.until("editor.view.contactMarks > 0", "marks of contacts")
    for action in ("logStop()", "logOpen('flight')"):
        assert editor.get(f"editor.actions.{action}.then(({{ok}}) => ok)")
    editor.until("editor.store.showsLog", "the log")
    assert editor.get("editor.view.contactMarks") == 0
    assert editor.get("editor.actions.logClose().then(({ok}) => ok)")
    editor.until("editor.view.contactMarks > 0", "marks of the world that stands still")


def distance(editor, one, other):
    a, b = (editor.model(name)["pose"][:3] for name in (one, other))
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


def test_aligning_shows_first_and_moves_then(editor):
    insert(editor, "first", standing(0, 0))
    insert(editor, "second", standing(2, -1), shape="cylinder")
    editor.get("editor.store.select(['first', 'second'])")
    before = pixel_of(editor, "second")
    editor.get("editor.actions.alignPreview({axis: 'y', at: 'center'})")
    assert pixel_of(editor, "second") != before
    assert editor.model("second")["pose"][1] == approx(-1)
    editor.get("editor.actions.alignPreview(null)")
    assert pixel_of(editor, "second") == approx(before)
    editor.get("(async () => { await editor.actions.align({axis: 'y', at: 'center'}); })()")
    editor.until("Math.abs(editor.store.worldPose('second')[1]) < 1e-6", "the alignment")


def test_copy_and_paste_by_keys_and_a_click(editor):
    insert(editor, "box", standing(0, 0))
    editor.page.mouse.click(*pixel_of(editor, "box"))
    editor.page.keyboard.press("Control+c")
    editor.until("Boolean(editor.store.clipboard)", "the copy")
    editor.page.keyboard.press("Control+v")
    editor.until("Boolean(editor.store.placing)", "the ghost")
    editor.click((2.0, 1.0, 0.0))
    editor.until("editor.store.selection[0] === 'box_clone'", "the clone")
    assert editor.model("box_clone")["pose"][:3] == approx([2, 1, 0.5], abs=0.02)


def test_while_physics_runs_a_drag_moves_the_body_and_then_lets_it_fall(editor, node):
    insert(editor, "box", standing(0, 0))
    editor.get("editor.store.select(['box']), editor.actions.translateMode()")
    editor.get("editor.actions.play()")
    editor.until("!editor.store.stats.paused", "running physics")
    x, y = pixel_of(editor, "box")
    mouse, keyboard = editor.page.mouse, editor.page.keyboard
    mouse.move(x - 40, y + 20)
    keyboard.down("z")
    mouse.down()

    def height():
        return node.ask("get_model_state", GetModelState, model_name="box").pose.position.z

    lifted = [0]

    def is_up():
        lifted[0] = min(lifted[0] + 8, 160)
        mouse.move(x - 40, y + 20 - lifted[0])
        return lifted[0] == 160 and height() > 1.0

    wait_for(is_up, "a lifted body")
    mouse.up()
    keyboard.up("z")
    wait_for(lambda: height() == approx(0.5, abs=0.01), "the body's fall")
    editor.get("editor.actions.pause()")
    editor.until("editor.store.history.undo[0].startsWith('Translate')", "the drag in the history")


def test_a_drag_ends_with_its_button_also_while_another_is_down(editor):
    insert(editor, "box", standing(0, 0))
    editor.get("editor.store.select(['box']), editor.actions.translateMode()")
    x, y = pixel_of(editor, "box")
    mouse = editor.page.mouse
    mouse.move(x - 40, y + 20)
    mouse.down()
    mouse.move(x + 60, y + 30, steps=6)
    mouse.down(button="right")
    mouse.up()
    editor.until("editor.store.history.undo[0].startsWith('Translate')", "the end of the drag")
    there = at_rest(editor, "box")
    mouse.up(button="right")
    mouse.move(x - 200, y + 60, steps=6)
    assert at_rest(editor, "box") == approx(there, abs=1)


def test_escape_during_a_drag_brings_the_body_back(editor):
    insert(editor, "box", standing(0, 0))
    editor.get("editor.store.select(['box']), editor.actions.translateMode()")
    x, y = pixel_of(editor, "box")
    steps = editor.get("editor.store.history.undo.length")
    editor.page.mouse.move(x - 40, y + 20)
    editor.page.mouse.down()
    editor.page.mouse.move(x + 100, y + 40, steps=6)
    editor.page.keyboard.press("Escape")
    editor.page.mouse.up()
    wait_for(lambda: editor.model("box")["pose"][:3] == approx([0, 0, 0.5], abs=1e-5), "the return")
    wait_for(lambda: pixel_of(editor, "box") == approx([x, y], abs=1), "its return in the view")
    assert editor.get("editor.store.history.undo.length") == steps


def test_the_picture_comes_back_after_the_graphics_were_lost(editor):
    insert(editor, "box", standing(0, 0))
    editor.get("""(() => { const canvas = document.querySelector('#view canvas');
        window.graphics = canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
        window.graphics.loseContext(); })()""")
    editor.until("document.querySelector('#view canvas').getContext('webgl2').isContextLost()",
                 "the loss")
    editor.get("window.graphics.restoreContext()")
    blank = "(async () => { const blob = await editor.view.picture(); return blob?.size ?? 0; })()"
    wait_for(lambda: editor.get(blank) > 5000, "a picture")


def test_the_page_finds_a_node_that_was_started_again(launch, browser):
    port = free_port()
    first = launch("worlds/empty.world", f"editor_port:={port}", "editor_token:=false")
    editor = browser.open(first.url)
    insert(editor, "box", standing(0, 0))
    editor.get("editor.actions.viewFrom('top')")
    wait_for(lambda: abs(at_rest(editor, "ground_plane")[0] - pixel_of(editor, "box")[0]) < 2,
             "the view from the top")
    first.close()
    editor.until("!editor.store.connected", "the loss of the line")
    launch("worlds/empty.world", f"editor_port:={port}", "editor_token:=false")
    editor.until("editor.store.connected && !editor.store.model('box')", "the new node's world")
    insert(editor, "other", standing(0, 0))
    ground = pixel_of(editor, "ground_plane")
    assert pixel_of(editor, "other") == approx(ground, abs=2), "still seen from the top"
    assert editor.faults == []
    editor.close()


def test_without_webgl_the_page_says_so_and_the_rest_works(node, browser):
    chromium = browser.launch("--disable-3d-apis")
    page = chromium.new_page()
    page.goto(node.url)
    alert = page.locator("#view [role=alert]")
    alert.wait_for()
    assert "WebGL" in alert.inner_text()
    page.get_by_role("treeitem", name="ground_plane", exact=True).wait_for()
    chromium.close()


CREEP = """(metres) => {
  const {id} = editor.store.model('box').links[0];
  const pose = [...editor.store.poses.get(id)];
  const bytes = new ArrayBuffer(72), view = new DataView(bytes);
  view.setUint32(0, 1, true);
  view.setUint32(32, 1, true);
  view.setUint32(40, id, true);
  clearInterval(window.creeping);
  window.creeping = setInterval(() => {
    pose[0] += metres;
    pose.forEach((part, at) => view.setFloat32(44 + 4 * at, part, true));
    editor.store.receiveFrame(bytes);
  }, 33);
}"""
"""Poses of the box as the simulator sends them, each so far beside the one before."""

SHARPNESS = "document.querySelector('.view-canvas').width / innerWidth"


def test_what_moves_less_than_a_pixel_leaves_the_picture_at_full_resolution(editor):
    insert(editor, "box", standing(0, 0))
    editor.rest()
    full = editor.get(SHARPNESS)
    editor.page.evaluate(CREEP, 0.02)
    wait_for(lambda: editor.get(SHARPNESS) < full, "coarser pictures of what moves")
    # Creeping by 1 mm/s, 0.2 pixels a second here, is rest.
    editor.page.evaluate(CREEP, 0.001 / 30)
    wait_for(lambda: editor.get(SHARPNESS) == full, "the full picture of what creeps")
    for _ in range(20):
        assert editor.get(SHARPNESS) == full
        editor.get("new Promise((done) => setTimeout(done, 50))")
    editor.get("clearInterval(window.creeping)")


def test_a_single_picture_after_a_long_rest_is_soon_drawn_in_full(editor):
    insert(editor, "box", standing(0, 0))
    editor.rest()
    full = editor.get(SHARPNESS)
    editor.get("(() => { const now = performance.now.bind(performance);"
               " performance.now = () => now() + 3.6e6; })()")
    editor.page.keyboard.press("f")
    wait_for(lambda: editor.get(SHARPNESS) < full, "the coarse picture of the flight")
    wait_for(lambda: editor.get(SHARPNESS) == full, "the full picture")
