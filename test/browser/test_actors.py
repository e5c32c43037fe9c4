"""Actors in the 3D view: where the path of a world file has them, by sim time alone."""
from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image
from support import wait_for
from walking_figures import BVH, QUARTER, RAISED, STILL, animation, rod, swinging

from my_simulations.description.actor import Actor, Animation, Trajectory, Waypoint
from my_simulations.description.shapes import Mesh
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.sensing.actors.figure_shape import FigureShape
from my_simulations.sensing.api import Figure
from my_simulations.sensing.poses import matrix

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
    page = browser.open(launch(str(folder / "walk.world")).url, scale=1)
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


AWAY = STILL.replace("1 0 0 0", "1 0 0 50", 1)
SKINS = {
    "rod.dae": rod(), "swinging.dae": swinging(seconds=1.5),
    "going.dae": rod(moves=animation((0.0, 1.0, 2.5), (STILL, AWAY, STILL), "lower")),
    "sitting.dae": rod(moves=animation((0.0, 1.5), (RAISED, RAISED.replace("100", "50")), "lower"),
                       root=RAISED).replace("high", "arm").replace('meter="0.01"', 'meter="0.02"'),
    "branching.dae": rod(moves=animation((0.2, 1.9), (RAISED, QUARTER))).replace(
        "</node></node>", '<node id="hand" sid="hand" type="JOINT"/></node></node>', 1),
    "captured.bvh": BVH,
    "stepping.dae": rod(moves=animation((0.0, 0.7, 1.6), (STILL, AWAY.replace("50", "20"), AWAY),
                                        "lower").replace("a-", "b-").replace("'a'", "'b'").replace(
        "</library_animations>", "") + animation((0.2, 1.6), (RAISED, QUARTER)).replace(
        "<library_animations>", "")),
    "mover.dae": rod(moves=animation((0.5, 1.7), (RAISED, QUARTER.replace("100", "300")))),
}
PATH = [Waypoint(0.0, Pose((1.0, 0.0, 0.0))),
        Waypoint(2.0, Pose((1.0, 4.0, 0.5), quat_from_rpy(0.0, 0.3, 2.0)))]
TURNS = [Waypoint(0.0, Pose((0.0, 0.0, 0.0))), Waypoint(1.0, Pose((1.0, 0.0, 0.0))),
         Waypoint(2.5, PATH[1].pose)]
FIGURES = {
    "still": Actor("still", Pose((0.0, 1.0, 0.0), quat_from_rpy(0.1, 0.2, 0.3)), "rod.dae", 0.5),
    "swinging": Actor("swinging", Pose((3.0, 0.0, 0.0)), "swinging.dae"),
    "late": Actor("late", Pose((3.0, 0.0, 0.0)), "swinging.dae", delay_start=1.0),
    "never": Actor("never", Pose((3.0, 0.0, 0.0)), "swinging.dae", auto_start=False),
    "going": Actor("going", Pose(), "going.dae"),
    "walking": Actor("walking", Pose(), "going.dae", 1.5, trajectories=[
        Trajectory(0, "walk", waypoints=PATH)]),
    "borrowing": Actor("borrowing", Pose(), "swinging.dae",
                       animations=[Animation("fall", "mover.dae")], loop=False,
                       trajectories=[Trajectory(0, "fall", waypoints=PATH)]),
    "changing": Actor("changing", Pose(), "going.dae",
                      animations=[Animation("none", "rod.dae"), Animation("fall", "mover.dae"),
                                  Animation("go", "going.dae")],
                      trajectories=[Trajectory(n, kind, waypoints=PATH[:2]) for n, kind in
                                    enumerate(("fall", "go", "none", "unknown", "fall"))]),
    "stepping": Actor("stepping", Pose((0.0, 2.0, 0.0)), "rod.dae", 1.5, animations=[
        Animation("step", "stepping.dae", 0.8, interpolate_x=True)], trajectories=[
        Trajectory(0, "step", waypoints=PATH), Trajectory(1, "step"),
        Trajectory(2, "unknown"), Trajectory(3, "step", 0.5, waypoints=TURNS)]),
    "on its own way": Actor("on its own way", Pose(), "stepping.dae", 0.5, loop=False, animations=[
        Animation("step", "stepping.dae", interpolate_x=True)], trajectories=[
        Trajectory(0, "step", waypoints=TURNS), Trajectory(1, "step")]),
    "sitting": Actor("sitting", Pose(), "rod.dae", 0.5,
                     animations=[Animation("sit", "sitting.dae", 0.7)]),
    "branching": Actor("branching", Pose(), "rod.dae",
                       animations=[Animation("fall", "branching.dae")]),
    "captured": Actor("captured", Pose(), "rod.dae", 0.5,
                      animations=[Animation("fall", "captured.bvh", 0.7)]),
    "vain": Actor("vain", Pose(), "swinging.dae", animations=[Animation("none", "rod.dae")]),
}
TIMES = (0.0, 0.4, 1.0, 1.6, 2.2, 3.9, 4.4, 6.9, 8.5, 10.3)

VERTICES = """async ({actor, times}) => {
  const [{Figure}, {Meshes}, {sourceOf}] = await Promise.all(
    ['actors', 'mesh_files', 'mesh_files'].map((name) => import(`/js/view/${name}.js`)));
  const meshes = new Meshes((problem) => { throw new Error(problem); });
  const figure = new Figure(actor);
  figure.dress(await meshes.figure(sourceOf(actor.geometry)),
    await Promise.all(figure.foreign.map((file) => file && meshes.figure(file))));
  return times.map((time) => {
    figure.show(time);
    figure.group.updateMatrixWorld(true);
    const found = [];
    figure.group.traverse((object) => {
      if (!object.isMesh) return;
      const at = object.position.clone();
      for (let n = 0; n < object.geometry.attributes.position.count; n++) {
        object.getVertexPosition(n, at).applyMatrix4(object.matrixWorld);
        found.push([at.x, at.y, at.z]);
      }
    });
    return found;
  });
}"""


def element(actor):
    """An actor as a world file has it."""
    def pose(at):
        roll_pitch_yaw = {
            name: f"{x} {y} {z}" for name, (x, y, z) in {
                "still": (0.1, 0.2, 0.3), "end": (0.0, 0.3, 2.0), "level": (0, 0, 0)}.items()}
        turn = ("end" if at is PATH[1].pose else "still" if actor.name == "still" else "level")
        return f"<pose>{' '.join(map(str, at.position))} {roll_pitch_yaw[turn]}</pose>"

    path = "".join(f"<trajectory id='{one.id}' type='{one.type}' tension='{one.tension}'>"
                   + "".join(f"<waypoint><time>{at.time}</time>{pose(at.pose)}</waypoint>"
                             for at in one.waypoints) + "</trajectory>"
                   for one in actor.trajectories)
    animations = "".join(f"<animation name='{one.name}'><filename>{one.filename}</filename>"
                         f"<scale>{one.scale}</scale>"
                         f"<interpolate_x>{str(one.interpolate_x).lower()}</interpolate_x>"
                         "</animation>" for one in actor.animations)
    return (f"<actor name='{actor.name}'>{pose(actor.pose)}<skin><filename>{actor.skin}</filename>"
            f"<scale>{actor.skin_scale}</scale></skin>{animations}<script>"
            f"<loop>{str(actor.loop).lower()}</loop><delay_start>{actor.delay_start}</delay_start>"
            f"<auto_start>{str(actor.auto_start).lower()}</auto_start>{path}</script></actor>")


def seen_by_cameras(folder, actor, time):
    """The places of the vertices that cameras and rays see."""
    animations = tuple("" if one.filename == actor.skin else str(folder / one.filename)
                       for one in actor.animations)
    shape = FigureShape(Figure(actor, Mesh(actor.skin, str(folder / actor.skin),
                                           (actor.skin_scale,) * 3), animations),
                        pytest.fail, "cameras")
    frame = matrix(shape.pose_at(time))
    return np.concatenate([rows[:, :3] @ frame[:3, :3].T + frame[:3, 3]
                           for rows in shape.rows_at(shape.form_at(time))])


def test_the_page_and_cameras_have_actors_in_the_same_shape_at_the_same_place(
        launch, browser, tmp_path):
    folder = tmp_path / "figures"
    folder.mkdir()
    for name, text in SKINS.items():
        (folder / name).write_text(text)
    (folder / "figures.world").write_text(
        "<sdf version='1.6'><world name='figures'>"
        + "".join(element(one) for one in FIGURES.values()) + "</world></sdf>")
    page = browser.open(launch(str(folder / "figures.world")).url, scale=1)
    documents = {one["name"]: one for one in page.get("editor.store.document.actors")}
    assert set(documents) == set(FIGURES)
    for name, actor in FIGURES.items():
        shown = page.page.evaluate(VERTICES, {"actor": documents[name], "times": TIMES})
        for time, points in zip(TIMES, shown):
            # Both have all corners; each of one is one of the other.
            ours, theirs = seen_by_cameras(folder, actor, time), np.array(points)
            apart = np.linalg.norm(ours[:, None] - theirs[None], axis=2)
            assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-4, (name, time)
    page.close()
