"""A robot of a template: built in a form, placed, driven by the arrow keys, and its picture."""
from __future__ import annotations

from pytest import approx
from support import wait_for


def bottom_of(element):
    box = element.bounding_box()
    return box["y"] + box["height"]


def form_of(editor, title):
    editor.page.get_by_role("tab", name="Insert").click()
    editor.page.get_by_role("button", name=f"Template: {title}", exact=True).click()
    return editor.page.get_by_role("dialog", name=title)


def test_a_car_with_a_camera_is_built_driven_and_shows_its_picture(editor):
    form = form_of(editor, "Differential drive")
    form.get_by_label("Model name").fill("taxi")
    form.get_by_label("Body mass").fill("-1")
    form.get_by_role("button", name="Insert").click()
    form.get_by_text("Body mass must be 0.1 to 2000 kg").wait_for()
    form.get_by_label("Body mass").fill("2.5")
    form.get_by_label("Image width").fill("160")
    form.get_by_label("Image height").fill("120")
    form.get_by_role("button", name="Insert").click()
    form.wait_for(state="detached")
    editor.until("editor.store.mode === 'insert'", "the car at the mouse")
    editor.page.mouse.move(*editor.pixel((0.5, 0.0, 0.0)))
    editor.click((1.0, 0.0, 0.0))
    wait_for(lambda: "taxi" in editor.names(), "the car")
    editor.until("editor.store.selection.join() === 'taxi'", "its selection")
    before = editor.model("taxi")["pose"][0]
    assert before == approx(1.0, abs=0.02)
    assert editor.model("taxi")["links"][0]["inertial"]["mass"] == 2.5
    hints = editor.page.get_by_role("note", name="Hints")
    hints.get_by_text("play, then").wait_for()
    editor.page.keyboard.press("Space")
    editor.until("!editor.store.stats.paused", "the running world")
    hints.get_by_text("drive taxi").wait_for()
    editor.page.keyboard.down("ArrowUp")
    wait_for(lambda: editor.model("taxi")["pose"][0] > before + 0.3, "the car's way")
    editor.page.keyboard.up("ArrowUp")
    picture = editor.page.get_by_role("region", name="/camera/image_raw")
    picture.get_by_text("160 x 120").wait_for()
    editor.get("editor.store.emit('issue', {severity: 'warning', message: 'a warning'})")
    warning = editor.page.locator(".notice").last
    for element in (picture, warning):
        assert bottom_of(element) <= hints.bounding_box()["y"], "the hints are covered"
    editor.page.keyboard.press("Control+p")
    plots = editor.page.locator("#dock")
    plots.wait_for()
    wait_for(lambda: bottom_of(picture) <= plots.bounding_box()["y"], "the picture above the plots")
    editor.page.keyboard.press("Control+p")


def test_a_second_robot_gets_a_namespace_of_its_own(editor):
    form = form_of(editor, "Differential drive")
    assert form.get_by_label("ROS namespace").input_value() == ""
    form.get_by_role("button", name="Insert").click()
    form.wait_for(state="detached")
    editor.page.keyboard.press("Enter")
    editor.until("editor.store.selection.join() === 'car'", "the car")
    form = form_of(editor, "Differential drive")
    form.get_by_text("car may use the same topics").wait_for()
    assert form.get_by_label("ROS namespace").input_value() == "car_0"
    editor.page.keyboard.press("Escape")


def test_a_template_is_inserted_by_the_keyboard_alone(editor):
    editor.page.get_by_role("tab", name="Insert").click()
    card = editor.page.get_by_role("button", name="Template: IMU", exact=True)
    card.focus()
    editor.page.keyboard.press("Enter")
    form = editor.page.get_by_role("dialog", name="IMU")
    editor.until("getSelection().toString() === 'imu_box'", "the suggested name, selected")
    editor.page.keyboard.type("my_box")
    editor.page.keyboard.press("Enter")
    form.wait_for(state="detached")
    editor.until("editor.store.mode === 'insert' && document.activeElement.id === 'view'",
                 "the box, and the keys with the view")
    editor.page.keyboard.press("Enter")
    wait_for(lambda: "my_box" in editor.names(), "the box")
    middle = editor.get("editor.view.pixelOf('my_box')")
    box = editor.page.locator("#view").bounding_box()
    assert middle[0] == approx(box["x"] + box["width"] / 2, abs=40)
