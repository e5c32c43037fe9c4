"""A world that takes long to load: an address and a page first, then its content."""
from __future__ import annotations

import re

import trimesh
from support import wait_for

HEAVY = 2
"""Meshes that must be divided before the world can run."""

WORLD = """<?xml version="1.0"?>
<sdf version="1.6"><world name="heavy">{}</world></sdf>
"""
MODEL = """<model name="ring_{0}"><pose>{0} 0 0.5 0 0 0</pose><link name="link">
  <collision name="c"><geometry><mesh><uri>{1}</uri></mesh></geometry></collision>
  <visual name="v"><geometry><mesh><uri>{1}</uri></mesh></geometry></visual>
</link></model>
"""


def heavy_world(folder):
    models = ""
    for number in range(HEAVY):
        path = folder / f"ring_{number}.stl"
        trimesh.creation.torus(0.4, 0.1 + 0.02 * number, 64, 32).export(str(path))
        models += MODEL.format(number, path)
    path = folder / "heavy.world"
    path.write_text(WORLD.format(models))
    return str(path)


def test_a_heavy_world_has_a_page_first_which_tells_the_progress(launch, browser, tmp_path):
    node = launch(heavy_world(tmp_path))
    editor = browser.open(node.url, wait=False)
    note = editor.page.locator(".connection-note")
    note.get_by_text(re.compile(r"mesh \d of 2")).wait_for()
    editor.page.wait_for_function("typeof editor !== 'undefined'")
    assert editor.get("editor.store.document") is None
    assert "world editor is at" in node.said()
    wait_for(lambda: editor.get("Boolean(editor.store.document)"), "the divided meshes", 300.0)
    editor.wait_for_world()
    assert editor.names() == [f"ring_{number}" for number in range(HEAVY)]
    note.wait_for(state="hidden")
    assert editor.faults == []
    assert editor.get("editor.store.issues.filter(({severity}) => severity === 'error')") == []
    editor.close()
