"""Make the pictures of the editor in doc/images, of our own worlds.

screenshots.py FOLDER [NAME...]
"""
from __future__ import annotations

import io
import math
import os
import sys
import tempfile

from PIL import Image
from support import Browser, Node, wait_for


def main(folder, *wanted):
    os.makedirs(folder, exist_ok=True)
    browser = Browser()
    try:
        with tempfile.TemporaryDirectory() as home:
            for name, world, color_scheme, prepare in PICTURES:
                if wanted and name not in wanted:
                    continue
                node = Node(os.path.join(home, name), world)
                try:
                    editor = browser.open(node.url, color_scheme=color_scheme, scale=1)
                    without_hints(editor)
                    prepare(editor)
                    settle(editor)
                    editor.page.screenshot(path=os.path.join(folder, f"{name}.png"))
                    editor.close()
                finally:
                    node.close()
            if not wanted or FILM in wanted:
                node = Node(os.path.join(home, FILM), "worlds/empty.world")
                try:
                    editor = browser.open(node.url, size=(1280, 720), color_scheme="dark",
                                          scale=0.75)
                    film(editor, os.path.join(folder, f"{FILM}.webp"))
                    editor.close()
                finally:
                    node.close()
    finally:
        browser.close()


def without_hints(editor):
    editor.button("Close the hints").click()


def settle(editor):
    """Waits until two pictures in a row are the same."""
    pictures = []

    def still():
        pictures.append(editor.page.locator("#view").screenshot())
        return len(pictures) > 2 and pictures[-1] == pictures[-2]

    wait_for(still, "a picture that stays")


def look(editor, eye, target):
    """Puts the camera somewhere, as the world's gui/camera: it looks along its x axis."""
    ahead = [to - start for to, start in zip(target, eye)]
    yaw = math.atan2(ahead[1], ahead[0]) / 2
    pitch = -math.atan2(ahead[2], math.hypot(ahead[0], ahead[1])) / 2
    pose = [*eye, -math.sin(pitch) * math.sin(yaw), math.sin(pitch) * math.cos(yaw),
            math.cos(pitch) * math.sin(yaw), math.cos(pitch) * math.cos(yaw)]
    editor.get("editor.request('edit', {op: {kind: 'set', target: '', path: 'gui_camera', "
               f"value: {{pose: {pose}}}}}}})")


def room(editor):
    """A room with furniture; a table chosen, with its handles."""
    look(editor, (4.9, -6.3, 7.0), (0.0, 0.1, 0.0))
    editor.row("bench_2").click()
    editor.page.keyboard.press("t")


def library(editor):
    """The model database beside a few things just built."""
    for tool, place in (("Box", (-1.2, -1.6, 0)), ("Sphere", (0.6, -0.6, 0)),
                        ("Cylinder", (1.6, 0.9, 0))):
        editor.place(tool, place)
    editor.page.get_by_role("tab", name="Insert").click()
    wait_for(lambda: editor.get("[...document.querySelectorAll('.thumb img')].length") > 12,
             "thumbnails")
    editor.get("editor.store.select(['unit_box'])")
    editor.page.keyboard.press("r")


def plots(editor):
    """A bouncing start, plotted."""
    for number, tool in enumerate(("Box", "Sphere", "Cylinder")):
        name = editor.place(tool, (-1.4 + 1.5 * number, -0.7 + 0.7 * number, 0))
        x, y = editor.model(name)["pose"][:2]
        editor.get(f"editor.actions.move({{{name!r}: [{x}, {y}, {2.0 + number}, "
                   f"{0.3 * number}, 0.2, 0, 0.9]}})")
    editor.page.keyboard.press("Control+p")
    for name in ("unit_box", "unit_sphere", "unit_cylinder"):
        editor.page.get_by_label("Find a variable").fill(f"{name}.z")
        editor.page.get_by_role("option", name=f"{name}.z").click()
    editor.get("editor.actions.play()")
    editor.until("editor.store.stats.sim_ns > 2.5e9", "two seconds")
    editor.get("editor.actions.pause()")
    editor.page.get_by_label("Find a variable").fill("")


def model(editor):
    """A cart in the model editor."""
    from test_model_editor import build_cart

    build_cart(editor)
    look(editor, (1.9, -2.3, 1.5), (-0.15, 0.0, 0.4))
    editor.get("editor.store.select(['untitled::link_1'])")
    editor.get("editor.actions.setOverlay('joints', true, 'untitled')")


class Film:
    """Pictures of the page, one after the other, with a mouse that can be seen."""

    def __init__(self, editor):
        self.editor = editor
        self.frames = []
        self.durations = []
        self.at = (480.0, 300.0)
        editor.page.evaluate(CURSOR)

    def take(self, milliseconds=120):
        data = self.editor.page.screenshot()
        self.frames.append(Image.open(io.BytesIO(data)).convert("RGB"))
        self.durations.append(milliseconds)

    def go(self, start, end, steps):
        for step in range(1, steps + 1):
            self.editor.page.mouse.move(*(a + (b - a) * step / steps for a, b in zip(start, end)))
            self.take()
        self.at = end

    def press(self, element):
        """Goes to the middle of an element and clicks."""
        element.wait_for()
        box = element.bounding_box()
        self.go(self.at, (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2), 3)
        element.click()

    def save(self, path):
        first, *others = self.frames
        first.save(path, save_all=True, append_images=others, duration=self.durations, loop=0,
                   quality=72, method=4)


CURSOR = """(() => {
  const cursor = document.createElement('div');
  cursor.innerHTML = '<svg width="18" height="24"><path d="M2 1v17l4-4 3 7 3-1-3-7h6z"' +
    ' fill="#fff" stroke="#111" stroke-width="1.3"/></svg>';
  Object.assign(cursor.style,
    {position: 'fixed', zIndex: 9999, pointerEvents: 'none', left: '-30px'});
  document.body.append(cursor);
  addEventListener('pointermove', ({clientX, clientY}) =>
    Object.assign(cursor.style, {left: `${clientX - 2}px`, top: `${clientY - 1}px`}), true);
})()"""


def film(editor, path):
    """Film a house that is drawn and furnished, a car driven into it, and the world saved."""
    without_hints(editor)
    strip = Film(editor)
    strip.take(700)
    draw_house(editor, strip)
    look(editor, *ABOVE)
    strip.take(900)
    furnish(editor, strip)
    build_car(editor, strip)
    drive_in(editor, strip)
    save_world(editor, strip)
    open_again(editor, strip)
    strip.save(path)


ABOVE = (-1.7, -4.0, 8.6), (1.0, -0.2, 0.0)
"""The camera's eye, and what it looks at: all of the house and the floors of both rooms."""


def draw_house(editor, strip):
    """Two rooms with doors and a window, saved and kept in the world."""
    from test_building import Sheet

    sheet = Sheet(editor)
    sheet.open()
    sheet.wheel(-2)
    strip.take(300)
    for tool, points in (
            ("wall", ((-1, -2.1), (4, -2.1), (4, 2.1), (-1, 2.1), (-1, -2.1))),
            ("wall", ((1.4, -2.1), (1.4, 2.1))), ("door", ((-1, 0),)), ("door", ((1.4, 0),)),
            ("window", ((0.2, 2.1),)), ("window", ((2.8, 2.1),))):
        strip.press(editor.page.locator(f"[data-tool={tool}]"))
        for point in points:
            strip.go(strip.at, sheet.pixel(point), 3)
            sheet.click(point)
        if tool == "wall":
            editor.page.keyboard.press("Escape")
        strip.take(300)
    for wall in ((2.5, -2.1), (4, 0.5)):
        strip.press(editor.button("Bricks"))
        strip.go(strip.at, sheet.pixel(wall), 3)
        sheet.click(wall)
        strip.take(300)
    strip.press(editor.button("Done"))
    strip.press(editor.button("Save and Exit"))
    dialog = editor.page.get_by_role("dialog", name="Save Building")
    dialog.get_by_role("textbox").first.fill("House")
    strip.take(600)
    strip.press(dialog.get_by_role("button", name="Save", exact=True))
    wait_for(lambda: "House" in editor.names(), "the house in the world")


def furnish(editor, strip):
    editor.page.get_by_role("tab", name="Insert").click()
    find = editor.page.get_by_role("searchbox", name="Find a model", exact=True)
    for card, place in (("Coffee table", (0.2, 1.2)), ("Armchair", (0.4, -1.2)),
                        ("Bed", (2.86, -1.0)), ("Potted plant", (3.5, 1.5))):
        find.fill(card)
        strip.press(editor.button(card))
        put(editor, strip, place)
    find.fill("")


def build_car(editor, strip):
    strip.press(editor.button("Template: Four wheels"))
    form = editor.page.get_by_role("dialog", name="Four wheels")
    form.get_by_label("Model name").fill("taxi")
    # A machine without a GPU that also takes the pictures of the film draws ten a second too late.
    form.get_by_label("Camera rate").fill("4")
    strip.take(900)
    strip.press(form.get_by_role("button", name="Insert"))
    form.wait_for(state="detached")
    put(editor, strip, (-2.3, 0.0))


def put(editor, strip, place):
    """Clicks where what follows the mouse is to stand."""
    before = len(editor.names())
    editor.until("editor.store.mode === 'insert'", "what follows the mouse")
    strip.go(strip.at, editor.pixel((*place, 0.0)), 4)
    editor.click((*place, 0.0))
    wait_for(lambda: len(editor.names()) > before, "a model")
    strip.take(300)


def drive_in(editor, strip):
    """Through the doors by the arrow keys; the camera's picture shows the way."""
    editor.page.keyboard.press("Space")
    editor.until("!editor.store.stats.paused", "the running world")
    wait_for(lambda: editor.page.get_by_text("320 x 240").is_visible(), "the camera's picture")
    strip.take(900)
    editor.page.keyboard.down("ArrowUp")
    while editor.model("taxi")["pose"][0] < 1.4:
        strip.take(90)
    editor.page.keyboard.up("ArrowUp")
    editor.page.keyboard.press("Space")
    editor.until("editor.store.stats.paused", "the standing world")
    strip.take(900)


def save_world(editor, strip):
    editor.page.keyboard.press("Control+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    dialog.get_by_role("textbox", name="File name").fill("my_house.world")
    strip.take(900)
    strip.press(dialog.get_by_role("button", name="Save", exact=True))
    editor.until("!editor.store.history.dirty", "the saved world")
    strip.take(1200)


def open_again(editor, strip):
    """All is there in the world that is opened after an empty one."""
    editor.page.keyboard.press("Alt+n")
    editor.until("editor.store.document.models.length === 1", "an empty world")
    strip.take(700)
    editor.page.keyboard.press("Control+o")
    dialog = editor.page.get_by_role("dialog", name="Open World")
    strip.press(dialog.get_by_role("option", name="my_house.world"))
    strip.take(500)
    strip.press(dialog.get_by_role("button", name="Open", exact=True))
    editor.until("editor.store.document.models.length === 7", "the saved world")
    look(editor, *ABOVE)
    settle(editor)
    strip.take(2500)


def house(editor):
    """The first view of the world itself, which its file gives."""
    editor.page.keyboard.press("Home")


FILM = "editor-film"
PICTURES = [
    ("editor-room", "lab_room.world", "dark", room),
    ("editor-house", "house.world", "dark", house),
    ("editor-library", "worlds/empty.world", "light", library),
    ("editor-plots", "worlds/empty.world", "dark", plots),
    ("editor-model", "worlds/empty.world", "dark", model),
]

if __name__ == "__main__":
    main(*sys.argv[1:])
