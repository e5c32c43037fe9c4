"""A house drawn by mouse: saved, put into the world, loaded in a fresh node, and driven through."""
from __future__ import annotations

import os

import pytest
from gazebo_msgs.msg import ModelState
from gazebo_msgs.srv import GetModelState, GetWorldProperties, SetModelState, SpawnModel
from geometry_msgs.msg import Pose
from PIL import Image
from pytest import approx
from std_srvs.srv import Empty
from support import wait_for
from test_lab_sheet import save_as

BALL = """<sdf version="1.6"><model name="ball"><link name="link">
  <inertial><mass>1</mass><inertia><ixx>0.016</ixx><iyy>0.016</iyy><izz>0.016</izz></inertia></inertial>
  <collision name="c"><geometry><sphere><radius>0.2</radius></sphere></geometry></collision>
  <visual name="v"><geometry><sphere><radius>0.2</radius></sphere></geometry></visual>
</link></model></sdf>"""

INNER = 2 * 0.075
"""What the walls on both sides take from a room."""


class Sheet:
    """The building editor's sheet under a person's hands; points in metres of the plan."""

    def __init__(self, editor):
        self.editor, self.page = editor, editor.page

    def open(self):
        self.page.keyboard.press("Control+b")
        self.editor.until("Boolean(document.querySelector('.plan-sheet'))", "the building editor")
        wait_for(lambda: self.page.locator("[data-tool=wall]").is_visible(), "the palette")

    def pixel(self, point):
        """The scale bar, the axes and the 100 px a metre are what a person goes by."""
        box = self.page.locator(".axes .x").evaluate(
            "(line) => { const to = line.getScreenCTM(); return [to.e, to.f, to.a * 100]; }")
        return box[0] + point[0] * box[2], box[1] - point[1] * box[2]

    def wheel(self, notches):
        """Turns the mouse wheel over the origin; away from oneself is nearer."""
        self.page.mouse.move(*self.pixel((0.0, 0.0)))
        for _ in range(abs(notches)):
            self.page.mouse.wheel(0, -100 if notches > 0 else 100)

    def tool(self, name):
        self.page.click(f"[data-tool={name}]")

    def click(self, *points, count=1):
        for point in points:
            x, y = self.pixel(point)
            self.page.mouse.move(x - 6, y - 4)
            self.page.mouse.move(x, y)
            self.page.mouse.click(x, y, click_count=count)

    def items(self, kind):
        return self.page.locator(f".plan-sheet .layer.{kind} > g").count()

    def shows(self, **counts):
        """Waits until the sheet has so many items of some kinds: it is drawn once a frame."""
        wait_for(lambda: all(self.items(kind) == count for kind, count in counts.items()),
                 f"a sheet with {counts}")

    def texts(self):
        return self.page.locator(".plan-sheet .labels text").all_text_contents()


def draw_two_rooms(sheet):
    sheet.wheel(-2)
    sheet.tool("wall")
    # Near to where they shall be: angles, lengths and ends are snapped to.
    sheet.click((-3.0, -2.0), (2.9, -1.95), (2.8, 1.8), (-3.05, 1.9), (-2.9, -1.9))
    sheet.click((0.0, -2.0), (0.03, 1.7))
    sheet.page.mouse.click(*sheet.pixel((1.0, 1.0)), button="right")
    sheet.page.keyboard.press("Escape")
    sheet.shows(walls=5)
    height = 3.85 - INNER
    wanted = [(2.85 - INNER) * height, (3.0 - INNER) * height]
    wait_for(lambda: sorted(float(text.split()[0]) for text in sheet.texts() if "m²" in text) ==
             approx(wanted, abs=0.011), f"areas of {wanted}")


def add_features(sheet):
    sheet.tool("door")
    sheet.click((0.05, 0.0))
    sheet.tool("window")
    sheet.click((-1.5, -2.1))
    sheet.tool("stairs")
    sheet.click((1.7, 0.0))
    sheet.shows(doors=1, windows=1, stairs=1)


def add_level(sheet):
    sheet.page.get_by_role("button", name="Add level", exact=True).click()
    sheet.shows(floors=1, walls=5, doors=0, windows=0, stairs=0)


def save_building(sheet, name):
    sheet.page.keyboard.press("Control+s")
    dialog = sheet.page.get_by_role("dialog")
    dialog.get_by_role("textbox").first.fill(name)
    dialog.get_by_role("button", name="Save", exact=True).click()
    wait_for(lambda: sheet.page.get_by_role("dialog").count() == 0, "the end of saving")


def test_a_house_drawn_by_mouse_stands_in_a_fresh_node(launch, browser):
    node = launch("worlds/empty.world")
    editor = browser.open(node.url)
    sheet = Sheet(editor)
    sheet.open()
    draw_two_rooms(sheet)
    add_features(sheet)
    add_level(sheet)
    editor.until("editor.store.preview?.links.length === 12", "the house in the 3D view")
    save_building(sheet, "Two Rooms")
    folder = os.path.join(node.home, "building_editor_models", "Two_Rooms")
    wait_for(lambda: os.path.isdir(folder) and {
        "model.config", "model.sdf", "building.json"} <= set(os.listdir(folder)), "the files")
    editor.page.keyboard.press("Control+b")
    wait_for(lambda: "Two_Rooms" in editor.names(), "the house in the world")
    wait_for(lambda: editor.get("editor.store.preview") is None, "the end of the preview")
    assert len(editor.model("Two_Rooms")["links"]) == 11 + 1
    world = save_as(editor, node, "house")
    assert editor.faults == []
    editor.close()
    node.close()

    fresh = launch(world)
    wait_for(lambda: "Two_Rooms" in fresh.ask("get_world_properties",
                                              GetWorldProperties).model_names, "the saved house")
    fresh.ask("unpause_physics", Empty)
    assert roll(fresh, "through", (-1.5, 0.0)) > 0.5
    assert roll(fresh, "against", (-1.5, 1.2)) == approx(-0.075 - 0.2, abs=0.02)
    open_again(browser, fresh)


def roll(node, name, start):
    """Rolls a ball along x towards the inner wall; where it is when it rests or is through."""
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = (*start, 0.2)
    answer = node.ask("spawn_sdf_model", SpawnModel, model_name=name, model_xml=BALL,
                      initial_pose=pose)
    assert answer.success, answer.status_message
    state = ModelState(model_name=name, pose=pose)
    state.twist.linear.x, state.twist.angular.y = 2.0, 10.0
    node.ask("set_model_state", SetModelState, model_state=state)
    seen = []

    def ended():
        seen.append(node.ask("get_model_state", GetModelState, model_name=name))
        x, speed = seen[-1].pose.position.x, seen[-1].twist.linear.x
        return x > 0.5 or (x > start[0] + 0.5 and abs(speed) < 0.05)

    wait_for(ended, f"the way of the ball {name}")
    return seen[-1].pose.position.x


def open_again(browser, node):
    """The saved house is drawn further, and takes its own place in the world."""
    editor = browser.open(node.url)
    sheet = Sheet(editor)
    sheet.open()
    editor.page.keyboard.press("Control+o")
    editor.page.get_by_role("option", name="Two_Rooms").dblclick()
    sheet.shows(walls=5)
    sheet.shows(doors=1, windows=1, stairs=1)
    sheet.tool("window")
    sheet.click((-1.5, 1.85))
    sheet.shows(windows=2)
    editor.page.keyboard.press("Control+s")
    wait_for(lambda: "Saved to" in editor.page.locator(".building-hint").inner_text(), "saving")
    before = editor.names()
    editor.page.keyboard.press("Control+b")
    editor.until("!document.querySelector('.plan-sheet')", "leaving")
    wait_for(lambda: len(wall_parts(editor)) == 4, "the new window in the world")
    assert sorted(editor.names()) == sorted(before)
    assert editor.faults == []
    editor.close()


def wall_parts(editor):
    """The collisions of the wall that got the second window; none while the house is replaced."""
    model = editor.model("Two_Rooms") or {"links": []}
    return [part for link in model["links"] if link["name"] == "Wall_2"
            for part in link["collisions"]]


@pytest.fixture
def sheet(node, visit):
    """The empty sheet of the building editor in a page."""
    editor = visit(node.url)
    editor.get("editor.request('new', {discard: true})")

    def accept(question):
        question.accept()

    editor.page.on("dialog", accept)
    opened = Sheet(editor)
    opened.open()
    yield opened
    assert editor.faults == []
    editor.page.remove_listener("dialog", accept)


@pytest.fixture
def drawn(sheet):
    """A page with two rooms drawn in the building editor, and its sheet."""
    draw_two_rooms(sheet)
    return sheet.editor, sheet


def test_the_palette_is_whole_on_a_small_laptop(sheet):
    high, shown = sheet.editor.get("(() => { const palette = document.querySelector("
                                   "'.building-palette');"
                                   " return [palette.scrollHeight, palette.clientHeight]; })()")
    assert high <= shown


def place_of_a_wall(editor):
    """x and y of the first pixel of a coarse grid where a wall is seen, and what is picked."""
    box = editor.page.locator("#view").bounding_box()
    for part in range(1, 16):
        for across in range(1, 16):
            x, y = box["x"] + box["width"] * across / 16, box["y"] + box["height"] * part / 16
            picked = editor.get(f"editor.actions.previewPick({x}, {y})")
            if picked and picked["link"].startswith("Wall"):
                return x, y, picked
    return None


def test_a_wall_is_painted_in_the_3d_view(drawn):
    editor, sheet = drawn
    editor.until("editor.store.preview?.links.length === 5", "the rooms in the 3D view")
    x, y, picked = wait_for(lambda: place_of_a_wall(editor), "a wall in the 3D view")
    editor.page.get_by_role("button", name="Color #fe7905", exact=True).click()
    editor.page.mouse.move(x - 5, y)
    editor.page.mouse.move(x, y)
    shown = ("editor.store.preview.links.find((link) => link.name === "
             f"'{picked['link']}').visuals[0].material.ambient[2]")
    wait_for(lambda: editor.get(shown) < 0.1, "the colour before the click")
    editor.page.mouse.click(x, y)
    painted = sheet.page.locator(".layer.walls path[fill='#fe7905']")
    wait_for(lambda: painted.count() == 1, "the painted wall on the sheet")
    assert editor.get("editor.store.selection.length") == 0
    editor.page.mouse.move(10, 10)
    editor.page.get_by_role("menuitem", name="Edit", exact=True).last.click()
    editor.page.get_by_role("menuitem", name="Undo").first.click()
    wait_for(lambda: painted.count() == 0, "the wall as it was")


def test_keys_change_the_plan_after_a_click_in_the_3d_view(drawn):
    editor, sheet = drawn
    page = editor.page
    before = editor.names()
    steps = editor.get("editor.store.history.depth")
    box = page.locator("#view").bounding_box()

    def press(*keys):
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] - 20)
        for key in keys:
            page.keyboard.press(key)

    press("Control+z")
    sheet.shows(walls=4)
    press("Control+Shift+z")
    sheet.shows(walls=5)
    press("Control+a", "Delete")
    sheet.shows(walls=0)
    press("Control+z")
    sheet.shows(walls=5)
    press("Control+s")
    page.get_by_role("dialog", name="Save Building").wait_for()
    page.keyboard.press("Escape")
    name = page.get_by_role("textbox", name="Model Name", exact=True)
    name.click()
    page.keyboard.press("Control+s")
    page.get_by_role("dialog", name="Save Building").wait_for()
    page.keyboard.press("Escape")
    assert editor.names() == before
    assert editor.get("editor.store.history.depth") == steps


def test_a_floor_plan_is_scaled_by_a_line_and_a_file_that_is_none_refused(drawn, tmp_path):
    editor, sheet = drawn
    page = editor.page
    (tmp_path / "none.png").write_bytes(b"MZ no picture")
    Image.new("RGB", (800, 400), (230, 230, 250)).save(tmp_path / "plan.png")
    page.click("[data-act=import]")
    dialog = page.get_by_role("dialog")
    dialog.locator("input[type=file]").set_input_files(str(tmp_path / "none.png"))
    dialog.get_by_role("button", name="Import", exact=True).click()
    wait_for(lambda: "not a valid image" in dialog.get_by_role("alert").inner_text(), "the refusal")
    dialog.locator("input[type=file]").set_input_files(str(tmp_path / "plan.png"))
    dialog.get_by_role("button", name="Import", exact=True).click()
    width = page.locator(".plan-image")
    wait_for(lambda: width.get_attribute("width") == "800", "the picture, 8 m wide")
    page.mouse.move(*sheet.pixel((-2.0, 0.0)))
    page.mouse.down()
    page.mouse.move(*sheet.pixel((0.0, 0.0)))
    page.mouse.move(*sheet.pixel((2.0, 0.0)))
    page.mouse.up()
    page.get_by_label("Length in meters").fill("2")
    page.keyboard.press("Enter")
    wait_for(lambda: abs(float(width.get_attribute("width")) - 400) < 8, "the picture, 4 m wide")


def test_a_plan_that_was_not_saved_is_offered_again(drawn):
    editor, sheet = drawn
    wait_for(lambda: editor.get("localStorage.getItem('world-editor.building-draft')"),
             "the draft")
    editor.page.reload()
    editor.until("Boolean(window.editor && editor.store.document)", "the page")
    sheet.open()
    editor.page.get_by_role("button", name="Restore", exact=True).click()
    sheet.shows(walls=5)


def test_a_floor_plan_is_calibrated_by_two_clicks_and_typing(sheet, tmp_path):
    editor = sheet.editor
    picture = tmp_path / "plan.png"
    Image.new("RGB", (400, 400), "white").save(picture)
    editor.page.get_by_role("button", name="Import", exact=True).click()
    asked = editor.page.get_by_role("dialog", name="Import Floor Plan")
    asked.get_by_label("Image", exact=True).set_input_files(str(picture))
    asked.get_by_role("button", name="Import").click()
    asked.wait_for(state="detached")
    sheet.click((-1.0, 0.0), (1.0, 0.0))
    length = editor.page.get_by_role("dialog", name="Length of the line")
    length.wait_for()
    editor.page.wait_for_timeout(100)  # the click is over, with all that browsers do after it
    editor.page.keyboard.press("Control+x")  # belongs to the field, not to the building editor
    editor.page.keyboard.type("4")
    length.get_by_text("Length (m)").click()
    editor.page.keyboard.press("Enter")
    length.wait_for(state="detached")
    assert editor.page.locator(".plan-sheet").is_visible()
    drawn = editor.page.locator(".plan-sheet image")
    # 400 pixels, of which 200 are 4 m; 100 units a metre.
    wait_for(lambda: drawn.evaluate("(image) => image.width.baseVal.value") ==
             approx(800, rel=0.02), "the new size")
