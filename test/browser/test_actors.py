"""Actors in the 3D view: where the path of a world file has them, by sim time alone."""
from __future__ import annotations

import io

import pytest
from PIL import Image
from support import wait_for

HALF = 30
"""cm; the skin is a red cube about its own origin that shines, so that no light changes it."""

CORNERS = " ".join(f"{x} {y} {z}" for x in (-HALF, HALF) for y in (-HALF, HALF)
                   for z in (-HALF, HALF))
SKIN = f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="cm" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_effects><effect id="red"><profile_COMMON><technique sid="look"><lambert>
<emission><color>1 0 0 1</color></emission><diffuse><color>0 0 0 1</color></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="paint"><instance_effect url="#red"/></material></library_materials>
<library_geometries><geometry id="cube"><mesh>
<source id="points"><float_array id="numbers" count="24">{CORNERS}</float_array><technique_common>
<accessor source="#numbers" count="8" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="corners"><input semantic="POSITION" source="#points"/></vertices>
<triangles count="12" material="paint"><input semantic="VERTEX" source="#corners" offset="0"/>
<p>0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene"><node id="body"><instance_geometry url="#cube">
<bind_material><technique_common><instance_material symbol="paint" target="#paint"/>
</technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>
"""
WORLD = """<sdf version="1.6"><world name="walk">
<actor name="walker"><pose>0 -2 0.5 0 0 0</pose><skin><filename>cube.dae</filename></skin>
<script><loop>false</loop><delay_start>0.5</delay_start><trajectory id="0" type="walk">
<waypoint><time>0</time><pose>-2 0 0.5 0 0 0</pose></waypoint>
<waypoint><time>2</time><pose>2 0 0.5 0 0 0</pose></waypoint></trajectory></script></actor>
<actor name="lost"><skin><filename>nowhere.dae</filename></skin></actor>
<model name="post"><static>true</static><pose>-3 3 0.5 0 0 0</pose><link name="link">
<visual name="visual"><geometry><mesh><uri>cube.dae</uri></mesh></geometry></visual>
</link></model></world></sdf>
"""
BEFORE, MIDDLE, END = (0.0, -2.0, 0.5), (0.0, 0.0, 0.5), (2.0, 0.0, 0.5)
POST = (-3.0, 3.0, 0.5)


@pytest.fixture
def editor(launch, browser, tmp_path):
    folder = tmp_path / "actors"
    folder.mkdir()
    (folder / "cube.dae").write_text(SKIN)
    (folder / "walk.world").write_text(WORLD)
    page = browser.open(launch(str(folder / "walk.world")).url)
    yield page
    page.close()


def red_at(editor, points):
    """Which of these points of the world are seen in red."""
    picture = Image.open(io.BytesIO(editor.page.screenshot())).convert("RGB")
    colors = [picture.getpixel(tuple(map(round, editor.pixel(point)))) for point in points]
    return [red > 150 and green < 80 and blue < 80 for red, green, blue in colors]


def step(editor, steps):
    editor.get(f"editor.actions.ask('step', {{steps: {steps}}})")


def seen(editor, *expected):
    points = (BEFORE, MIDDLE, END, POST)
    wait_for(lambda: red_at(editor, points) == [point in expected for point in points],
             f"red at {expected} only")


def test_an_actor_walks_its_path_by_sim_time_and_stands_while_time_stands(editor):
    seen(editor, BEFORE, POST)
    step(editor, 1500)
    seen(editor, MIDDLE, POST)
    editor.until("editor.view.fps === 0", "the end of drawing")
    step(editor, 1500)
    seen(editor, END, POST)
    assert editor.faults == []


def test_a_missing_skin_is_told_once(editor):
    told = "editor.store.issues.filter((issue) => issue.message.includes('nowhere.dae')).length"
    seen(editor, BEFORE, POST)
    editor.until(f"{told} > 0", "a word about the skin")
    editor.get("editor.store.emit('document')")
    editor.rest()
    assert editor.get(told) == 1
