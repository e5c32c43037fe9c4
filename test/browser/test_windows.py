"""Small windows, fingers, and what is found in other editors: box selection, measuring, links."""
from __future__ import annotations

import io
import os
import pathlib

import pytest
from PIL import Image
from pytest import approx
from support import wait_for

LAB_COURSE = str(pathlib.Path(__file__).resolve().parents[2] / "world" / "lab_course.world")
OVERLAPS = """(() => {
  const texts = [...document.querySelectorAll('#bars *, #timebar *')].filter((one) =>
    one.childElementCount === 0 && one.textContent.trim() && one.offsetParent !== null &&
    one.tagName !== 'OPTION').map((one) =>
      ({text: one.textContent, box: one.getBoundingClientRect()}));
  const found = texts.filter(({box}) => box.left < -1 || box.right > innerWidth + 1)
    .map(({text}) => `${text} is cut off`);
  texts.forEach((a, at) => texts.slice(at + 1).forEach((b) => {
    const [p, q] = [a.box, b.box];
    const beside = p.left >= q.right - 1 || q.left >= p.right - 1;
    if (!beside && p.top < q.bottom - 1 && q.top < p.bottom - 1) {
      found.push(`${a.text} lies on ${b.text}`);
    }
  }));
  return found;
})()"""


@pytest.fixture
def open_page(node, browser, visit):
    """Opens pages on a world with a box and a sphere; `first` is open, the others end with it."""
    pages = []

    def open_one(address="", **options):
        pages.append(browser.open(node.url + address, **options))
        return pages[-1]

    first = visit(node.url)
    first.get("(async () => { await editor.actions.newWorld({discard: true}); })()")
    for shape, x in (("box", 0.0), ("sphere", 1.5)):
        first.get(f"editor.actions.edit({{kind: 'insert', shape: '{shape}', "
                  f"name: '{shape}', pose: [{x}, 0, 0.5, 0, 0, 0, 1]}})")
    first.until("editor.store.model('box') && editor.store.model('sphere')", "both shapes")
    first.frame()
    open_one.first = first
    yield open_one
    faults = [fault for page in (first, *pages) for fault in page.faults]
    for page in pages:
        page.close()
    assert faults == []


@pytest.mark.parametrize("size", [(1024, 768), (800, 600)], ids=str)
def test_no_text_of_the_bars_lies_on_another(open_page, size):
    editor = open_page(size=size)
    editor.until("document.querySelector('.figure[aria-label=FPS]').textContent === 'idle'", "rest")
    assert editor.get(OVERLAPS) == []


def test_a_phone_has_a_view_and_panels_over_it(open_page):
    editor = open_page(size=(400, 800), has_touch=True)
    box = editor.page.locator("#view").bounding_box()
    assert box["width"] >= 390 and box["height"] > 450
    assert editor.get("document.documentElement.scrollWidth") <= 400
    assert editor.page.locator("#left").is_hidden()
    editor.page.get_by_role("button", name="Panels").tap()
    editor.row("box").tap()
    editor.until("editor.store.selection.join() === 'box'", "the row")
    editor.page.touchscreen.tap(380, 500)
    editor.page.locator("#left").wait_for(state="hidden")


def test_fingers_select_orbit_pan_zoom_and_open_the_menu(open_page):
    editor = open_page(size=(400, 800), has_touch=True)
    fingers = editor.context.new_cdp_session(editor.page)

    def touch(kind, *points):
        fingers.send("Input.dispatchTouchEvent", {
            "type": kind, "touchPoints": [{"x": x, "y": y, "id": n}
                                          for n, (x, y) in enumerate(points)]})

    def view():
        return editor.get("editor.view.camera")

    x, y = editor.get("editor.view.pixelOf('box')")
    editor.page.touchscreen.tap(x, y)
    editor.until("editor.store.selection.join() === 'box'", "the tap's selection")
    before = view()
    touch("touchStart", (x, y))
    for step in range(1, 9):
        touch("touchMove", (x + 25 * step, y))
    touch("touchEnd")
    turned = view()
    assert abs(turned["yaw"] - before["yaw"]) > 0.2
    x, y = editor.get("editor.view.pixelOf('box')")
    touch("touchStart", (x, y))
    editor.page.get_by_role("menuitem", name="Move To").wait_for()
    touch("touchEnd")
    editor.page.keyboard.press("Escape")
    turned = view()
    touch("touchStart", (150, 400), (250, 400))
    for step in range(1, 9):
        touch("touchMove", (150 - 6 * step, 400), (250 + 6 * step, 400))
    touch("touchEnd")
    near = view()
    assert near["yaw"] == approx(turned["yaw"])
    assert near["position"] != turned["position"]


def test_a_rectangle_selects_what_is_in_it(open_page):
    editor = open_page.first
    (x0, y0), (x1, y1) = (editor.get(f"editor.view.pixelOf('{name}')") for name in
                          ("box", "sphere"))
    editor.page.keyboard.down("Control")
    editor.page.mouse.move(min(x0, x1) - 60, min(y0, y1) - 70)
    editor.page.mouse.down()
    editor.page.mouse.move(max(x0, x1) + 60, max(y0, y1) + 70, steps=6)
    assert editor.page.locator(".box-select").is_visible()
    editor.page.mouse.up()
    editor.page.keyboard.up("Control")
    editor.until("[...editor.store.selection].sort().join() === 'box,sphere'", "both")


def test_two_clicks_measure_a_distance_and_escape_ends_it(open_page):
    editor = open_page.first
    editor.page.keyboard.press("m")
    for name in ("box", "sphere"):
        editor.page.mouse.click(*editor.get(f"editor.view.pixelOf('{name}')"))
    text = wait_for(lambda: editor.get("editor.view.measured")[:1], "the distance")[0]
    assert float(text.split(" m")[0]) == approx(1.5, abs=0.3)
    editor.page.keyboard.press("Escape")
    editor.until("editor.view.measured.length === 0", "the end of the measure")


def test_a_link_opens_at_this_camera_and_selection(open_page):
    editor = open_page.first
    editor.get("editor.store.select(['box'])")
    editor.get("editor.actions.viewFrom('top')")
    wait_for(lambda: editor.get("editor.view.camera.pitch") < -1.5, "the view from above")
    editor.rest()
    link = editor.get("editor.actions.viewLink()")
    other = open_page("#" + link.split("#")[1])
    assert other.get("editor.store.selection") == ["box"]
    there, here = other.get("editor.view.camera"), editor.get("editor.view.camera")
    assert there["position"] == approx(here["position"], abs=1e-3)
    assert there["pitch"] == approx(here["pitch"], abs=1e-3)


def test_numbers_are_shown_while_dragging(open_page):
    editor = open_page.first
    editor.page.keyboard.press("t")
    x, y = editor.get("editor.view.pixelOf('box')")
    editor.page.mouse.move(x, y)
    editor.page.mouse.down()
    editor.page.mouse.move(x + 40, y, steps=5)
    wait_for(lambda: "moved" in editor.page.locator(".readout").inner_text(), "the numbers")
    numbers = editor.page.locator(".readout").bounding_box()
    hints = editor.page.get_by_role("note", name="Hints").bounding_box()
    assert numbers["y"] + numbers["height"] <= hints["y"]   # a newcomer has both
    editor.page.mouse.up()
    editor.page.locator(".readout").wait_for(state="hidden")


def test_a_face_of_the_cube_is_a_view_and_home_comes_back(open_page):
    # No view: the page begins at its home.
    editor = open_page("#select=box", motion="no-preference")
    home = editor.get("editor.view.camera")
    editor.page.get_by_role("group", name="Orientation").get_by_text("Top").dispatch_event("click")
    wait_for(lambda: editor.get("editor.view.camera.pitch") < -1.5, "the view from above")
    editor.page.keyboard.press("Home")
    wait_for(lambda: editor.get("editor.view.camera.position") == approx(home["position"]), "home")


def test_the_camera_flies_unless_the_user_wants_less_motion(open_page):
    editor = open_page.first
    arrives_at_once = "(editor.actions.viewFrom('top'), editor.view.camera.pitch < -1.5)"
    assert editor.get(arrives_at_once)
    editor.page.keyboard.press("Home")
    editor.page.emulate_media(reduced_motion="no-preference")
    assert not editor.get(arrives_at_once)
    wait_for(lambda: editor.get("editor.view.camera.pitch") < -1.5, "the view from above")
    editor.page.emulate_media(reduced_motion="reduce")


@pytest.mark.parametrize("place", ["menu", "row", "tool", "tab"])
def test_home_comes_back_from_wherever_the_mouse_was(open_page, place):
    editor = open_page.first
    editor.get("editor.view.viewFrom('top')")
    wait_for(lambda: editor.get("editor.view.camera.pitch") < -1.5, "the view from above")
    if place == "menu":
        editor.page.get_by_role("menuitem", name="Camera", exact=True).click()
        editor.page.get_by_role("menuitemcheckbox", name="Perspective").click()
    else:
        {"row": editor.row("ground_plane"), "tool": editor.page.locator("#toolbar button").nth(1),
         "tab": editor.page.get_by_role("tab", name="World")}[place].click()
    editor.page.keyboard.press("Home")
    wait_for(lambda: editor.get("editor.view.camera.pitch") > -1.2, "home")
    editor.page.keyboard.press("Escape")


def draw_after(editor, change):
    """Waits for the first picture after a change; the page does, for it counts a moment only."""
    editor.get(f"""(async () => {{
        {change};
        while (editor.view.fps === 0) await new Promise(requestAnimationFrame);
    }})()""")


def test_collisions_of_infinite_planes_are_not_laid_over_everything(open_page):
    editor = open_page.first
    assert "ground_plane" in editor.names()
    corner = {"x": 700, "y": 690, "width": 40, "height": 30}
    before = editor.settled_picture(corner)
    draw_after(editor, "editor.actions.toggleOverlay('collisions')")
    assert editor.settled_picture(corner) == before


def test_a_picture_without_new_shadows_is_as_large_as_one_with_them(open_page):
    editor = open_page.first
    editor.rest()
    height = editor.get("document.querySelector('#view').clientHeight")
    assert height % 2 == 1, "pictures at rest, drawn 1.5 times as large, have half a pixel more"
    draw_after(editor, "editor.view.redraw()")
    editor.rest()
    drawn, there = editor.get("""(() => {
        const canvas = document.querySelector('.view-canvas'), gl = canvas.getContext('webgl2');
        return [[...gl.getParameter(gl.VIEWPORT)], [0, 0, canvas.width, canvas.height]];
    })()""")
    assert drawn == there


def test_the_building_editor_has_the_window_and_shows_the_world_in_its_plan(open_page):
    editor = open_page.first
    editor.page.keyboard.press("Control+b")
    editor.page.locator(".context [data-model=box]").wait_for()
    assert editor.page.locator(".context text").all_text_contents() == ["box", "sphere"]
    assert editor.page.locator("#menubar").is_hidden()
    assert editor.page.locator("#left").is_hidden()
    assert editor.page.locator("#centre").bounding_box()["width"] == approx(1366)
    editor.page.get_by_role("menuitem", name="File", exact=True).click()
    editor.page.get_by_role("menuitem", name="Exit Building Editor").click()
    editor.page.locator("#menubar").wait_for()


def choose(editor, menu, item):
    editor.page.get_by_role("menuitem", name=menu, exact=True).click()
    editor.page.get_by_role("menu").get_by_role("menuitem", name=item).click()


def from_top(editor):
    editor.get("editor.actions.viewFrom('top')")
    wait_for(lambda: editor.get("editor.view.camera.pitch") < -1.5, "the view from above")
    editor.rest()
    return editor.get("editor.view.camera.position")


def test_a_request_that_takes_long_is_shown_until_it_is_answered(open_page):
    editor = open_page.first
    asked = "{id: 1e6, type: 'edit', fields: {op: {kind: 'delete', names: ['a', 'b']}}}"
    editor.get(f"editor.connection.emit('asked', {asked})")
    note = editor.page.locator(".connection-note")
    note.get_by_text("Deleting 2 models…").wait_for()
    assert note.get_by_role("progressbar").is_visible()
    editor.get("editor.connection.emit('answered', {id: 1e6})")
    note.wait_for(state="hidden")


def test_a_bookmark_brings_the_camera_back(open_page):
    editor = open_page.first
    above = from_top(editor)
    editor.page.keyboard.press("Alt+b")
    editor.page.keyboard.press("Home")
    wait_for(lambda: editor.get("editor.view.camera.pitch") > -1, "home")
    choose(editor, "Camera", "View 1")
    wait_for(lambda: editor.get("editor.view.camera.position") == approx(above), "the bookmark")
    choose(editor, "Camera", "Clear Bookmarks")
    assert editor.get("editor.actions.bookmarks()") == []


def test_a_saved_configuration_is_how_the_next_visit_begins(open_page):
    editor = open_page("#")
    home = editor.get("editor.view.camera.position")
    editor.get("editor.store.setOverlay('grid', false)")
    above = from_top(editor)
    for item, position, grid in (("Save Configuration", above, False),
                                 ("Reset Configuration", home, True)):
        choose(editor, "File", item)
        editor.page.reload()
        editor.wait_for_world()
        fetched = editor.get("performance.getEntriesByType('resource').filter(file =>"
                             " /[.](js|css)$/.test(file.name) && file.transferSize > 0).length")
        assert fetched == 0
        wait_for(lambda where=position: editor.get("editor.view.camera.position") == approx(where),
                 f"the camera after {item}")
        assert editor.get("editor.store.overlays.scene.grid") is grid


def test_a_clone_is_another_file_and_the_world_keeps_its_own(node, open_page):
    editor = open_page.first
    own = editor.get("editor.store.history.file")
    choose(editor, "File", "Clone World")
    editor.field("File name").fill("second.world")
    editor.page.keyboard.press("Enter")
    dialog = editor.page.get_by_role("dialog", name="World Cloned")
    command = dialog.get_by_label("Command").input_value()
    dialog.get_by_role("button", name="Close").last.click()
    clone = os.path.join(node.typed, "second.world")
    assert command.endswith(f"gazebo {clone}")
    assert editor.get("editor.store.history.file") == own
    outcome = editor.get(f"editor.actions.open({clone!r}, {{discard: true}})")
    assert outcome["ok"], outcome
    wait_for(lambda: {"box", "sphere"} <= set(editor.names()), "the clone's models")


def test_a_name_typed_before_the_folder_is_known_is_saved_in_that_folder(node, open_page):
    editor = open_page.first
    editor.get("""(() => { const {connection} = editor, ask = connection.request.bind(connection);
        connection.request = async (kind, ...rest) => {
          if (kind === 'folders') await new Promise((go) => { window.tellFolder = go; });
          return ask(kind, ...rest);
        }; })()""")
    choose(editor, "File", "Clone World")
    editor.field("File name").fill("early.world")
    editor.page.keyboard.press("Enter")
    editor.page.get_by_role("alert").get_by_text("Working ...").wait_for()
    editor.get("window.tellFolder()")
    dialog = editor.page.get_by_role("dialog", name="World Cloned")
    command = dialog.get_by_label("Command").input_value()
    assert command.endswith(f"gazebo {os.path.join(node.typed, 'early.world')}")


def test_what_moves_is_seen_in_the_first_view_of_a_walled_room(open_page):
    outcome = open_page.first.get(f"editor.actions.open({LAB_COURSE!r}, {{discard: true}})")
    assert outcome["ok"], outcome
    editor = open_page("#")
    editor.rest()
    for name in ("box", "sphere", "cylinder"):
        editor.page.mouse.click(*editor.get(f"editor.view.pixelOf('{name}')"))
        editor.until(f"editor.store.selection.join() === '{name}'", f"{name} under the mouse")


def test_the_ground_is_darker_where_something_stands_on_it(open_page):
    editor = open_page.first
    editor.get("editor.store.setOverlay('grid', false)")
    editor.rest()

    def brightness(point):
        x, y = editor.pixel(point)
        clip = {"x": x - 2, "y": y - 2, "width": 5, "height": 5}
        picture = Image.open(io.BytesIO(editor.page.screenshot(clip=clip))).convert("L")
        return sum(picture.getdata()) / 25

    # On this side the sun throws no shadow of the box.
    assert brightness((0.2, -0.54, 0.0)) < 0.93 * brightness((0.2, -1.5, 0.0))


BROKEN = """<?xml version="1.0"?><sdf version="1.6"><model name="broken"><link name="link">
  <visual name="v"><geometry><mesh><uri>model://broken/missing.dae</uri></mesh></geometry></visual>
  <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>
  </link></model></sdf>"""


def test_a_picture_of_the_library_says_nothing_of_what_its_model_lacks(node, open_page):
    folder = os.path.join(node.home, ".gazebo", "models", "broken")
    os.makedirs(folder)
    for name, text in (("model.sdf", BROKEN), ("model.config", """<?xml version="1.0"?><model>
        <name>broken</name><version>1.0</version><sdf version="1.6">model.sdf</sdf></model>""")):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as out:
            out.write(text)
    editor = open_page.first
    before = editor.get("editor.store.issues.length")
    editor.get("editor.view.thumbnail('model://broken')")
    assert editor.get("editor.store.issues.length") == before
    editor.get("editor.actions.insertModel('model://broken')")
    editor.get("editor.actions.place([0, 3, 0.5, 0, 0, 0, 1])")
    wait_for(lambda: "missing.dae" in editor.get(
        "editor.store.issues.map(({message}) => message).join()"), "what the placed model lacks")
