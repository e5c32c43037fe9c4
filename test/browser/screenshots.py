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
                    editor = browser.open(node.url, size=(960, 540), color_scheme="dark", scale=1)
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
                   quality=72, method=6, minimize_size=True)


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
    """Film a house that is drawn and furnished, a car that is built and driven out, and saving."""
    without_hints(editor)
    strip = Film(editor)
    strip.take(700)
    draw_house(editor, strip)
    look(editor, (4.6, -2.9, 7.4), (0.9, -0.1, 0.0))
    strip.take(600)
    editor.page.get_by_role("tab", name="Insert").click()
    for card, place in (("Desk", (-1.2, 0.9)), ("Armchair", (-1.2, -0.8)),
                        ("Potted plant", (0.4, 1.1))):
        editor.page.get_by_role("searchbox", name="Find a model", exact=True).fill(card)
        strip.press(editor.page.get_by_role("button", name=card, exact=True))
        put(editor, strip, place)
    editor.page.get_by_role("searchbox", name="Find a model", exact=True).fill("")
    strip.press(editor.page.get_by_role("button", name="Template: Differential drive"))
    form = editor.page.get_by_role("dialog", name="Differential drive")
    for label, value in (("Model name", "taxi"), ("Image width", "160"), ("Image height", "120")):
        form.get_by_label(label).fill(value)
        strip.take(300)
    strip.press(form.get_by_role("button", name="Insert"))
    form.wait_for(state="detached")
    put(editor, strip, (0.2, 0.0))
    drive_out(editor, strip)
    save_world(editor, strip)
    strip.save(path)


def draw_house(editor, strip):
    """Four walls, a door and a window, saved and kept in the world."""
    from test_building import Sheet, save_building

    sheet = Sheet(editor)
    sheet.open()
    sheet.wheel(-3)
    strip.take(300)
    for tool, points in (("wall", ((-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5), (-2, -1.5))),
                         ("door", ((2, 0),)), ("window", ((0, -1.5),))):
        strip.press(editor.page.locator(f"[data-tool={tool}]"))
        for point in points:
            strip.go(strip.at, sheet.pixel(point), 3)
            sheet.click(point)
        strip.take(300)
    save_building(sheet, "House")
    strip.take(600)
    editor.page.keyboard.press("Control+b")
    wait_for(lambda: "House" in editor.names(), "the house in the world")


def put(editor, strip, place):
    """Clicks where what follows the mouse is to stand."""
    before = len(editor.names())
    editor.until("editor.store.mode === 'insert'", "what follows the mouse")
    strip.go(strip.at, editor.pixel((*place, 0.0)), 4)
    editor.click((*place, 0.0))
    wait_for(lambda: len(editor.names()) > before, "a model")
    strip.take(300)


def drive_out(editor, strip):
    """Through the door by the arrow keys; the camera's picture shows the way."""
    editor.page.keyboard.press("Space")
    editor.until("!editor.store.stats.paused", "the running world")
    editor.page.keyboard.down("ArrowUp")
    while editor.model("taxi")["pose"][0] < 3.0:
        strip.take(90)
    editor.page.keyboard.up("ArrowUp")
    editor.page.keyboard.press("Space")
    strip.take(500)


def save_world(editor, strip):
    editor.page.keyboard.press("Control+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    dialog.get_by_role("textbox", name="File name").fill("my_house.world")
    strip.take(900)
    strip.press(dialog.get_by_role("button", name="Save", exact=True))
    editor.until("!editor.store.history.dirty", "the saved world")
    strip.take(1500)


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
