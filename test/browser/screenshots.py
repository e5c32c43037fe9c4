"""Make the pictures of the editor in doc/images, of our own worlds: screenshots.py FOLDER."""
from __future__ import annotations

import math
import os
import sys
import tempfile

from support import Browser, Node, wait_for


def main(folder):
    os.makedirs(folder, exist_ok=True)
    browser = Browser()
    try:
        with tempfile.TemporaryDirectory() as home:
            for name, world, color_scheme, prepare in PICTURES:
                node = Node(os.path.join(home, name), world)
                try:
                    editor = browser.open(node.url, color_scheme=color_scheme)
                    prepare(editor)
                    settle(editor)
                    editor.page.screenshot(path=os.path.join(folder, f"{name}.png"))
                    editor.close()
                finally:
                    node.close()
    finally:
        browser.close()


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
    look(editor, (2.6, -6.6, 6.0), (0.3, -0.2, 0.0))
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


PICTURES = [
    ("editor-room", "lab_room.world", "dark", room),
    ("editor-library", "worlds/empty.world", "light", library),
    ("editor-plots", "worlds/empty.world", "dark", plots),
]

if __name__ == "__main__":
    main(sys.argv[1])
