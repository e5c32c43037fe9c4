"""A world that takes long to load: an address and a page first, then its content."""
from __future__ import annotations

import contextlib
import os
import re
import signal
import threading
from pathlib import Path

import pytest
import trimesh
from support import wait_for

HEAVY = 2
"""Meshes that must be divided before the world can run."""

WORLD = """<?xml version="1.0"?>
<sdf version="1.6"><world name="heavy">{}</world></sdf>
"""
MODEL = """<model name="angle_{0}"><pose>{0} 0 0.5 0 0 0</pose><link name="link">
  <collision name="c"><geometry><mesh><uri>{1}</uri></mesh></geometry></collision>
  <visual name="v"><geometry><mesh><uri>{1}</uri></mesh></geometry></visual>
</link></model>
"""


DIVIDER = b"my_simulations.engine.convex.worker"


OUTLINE = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.2, 0.2), (0.2, 1.0), (0.0, 1.0))
"""An angle's, in m; the corner inside sees all others."""


def angle(width):
    """A concave mesh that is divided within a second."""
    count, inside = len(OUTLINE), 3
    corners = [(x, y, z) for z in (0.0, width) for x, y in OUTLINE]
    fan = [(inside, (inside + n) % count, (inside + n + 1) % count) for n in range(1, count - 1)]
    sides = [(n, (n + 1) % count) for n in range(count)]
    faces = [(c, b, a) for a, b, c in fan] + [tuple(n + count for n in face) for face in fan]
    faces += [(a, b, b + count) for a, b in sides] + [(a, b + count, a + count) for a, b in sides]
    return trimesh.Trimesh(corners, faces, process=False)


def heavy_world(folder):
    """A world of meshes that `divisions` keeps from being divided fast."""
    models = ""
    for number in range(HEAVY):
        path = folder / f"angle_{number}.stl"
        angle(0.2 + 0.1 * number).export(str(path))
        models += MODEL.format(number, path)
    path = folder / "heavy.world"
    path.write_text(WORLD.format(models))
    return str(path)


class Divisions:
    """Stops each process of a node that divides a mesh, as if it took long, until all may go on."""

    def __init__(self, home):
        self._home = b"HOME=" + os.fsencode(home)
        self._may_go_on = threading.Event()
        self._stopped = set()
        self._watch = threading.Thread(target=self._stop_all, daemon=True)
        self._watch.start()

    def go_on(self):
        self._may_go_on.set()
        self._watch.join()
        for pid in self._stopped:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGCONT)

    def _stop_all(self):
        while not self._may_go_on.wait(0.02):
            for folder in Path("/proc").glob("[0-9]*"):
                with contextlib.suppress(OSError):
                    if int(folder.name) not in self._stopped and self._is_one(folder):
                        os.kill(int(folder.name), signal.SIGSTOP)
                        self._stopped.add(int(folder.name))

    def _is_one(self, folder):
        return (DIVIDER in (folder / "cmdline").read_bytes()
                and self._home in (folder / "environ").read_bytes().split(b"\0"))


@pytest.fixture
def divisions(tmp_path):
    held = Divisions(tmp_path)
    yield held
    held.go_on()


def test_a_heavy_world_has_a_page_first_which_tells_the_progress(
        launch, browser, tmp_path, divisions):
    node = launch(heavy_world(tmp_path))
    editor = browser.open(node.url, wait=False)
    note = editor.page.locator(".connection-note")
    note.get_by_text(re.compile(r"mesh \d of 2")).wait_for()
    editor.page.wait_for_function("typeof editor !== 'undefined'")
    assert editor.get("editor.store.document") is None
    assert "world editor is at" in node.said()
    divisions.go_on()
    wait_for(lambda: editor.get("Boolean(editor.store.document)"), "the divided meshes", 300.0)
    editor.wait_for_world()
    assert editor.names() == [f"angle_{number}" for number in range(HEAVY)]
    note.wait_for(state="hidden")
    assert editor.faults == []
    assert editor.get("editor.store.issues.filter(({severity}) => severity === 'error')") == []
    editor.close()
