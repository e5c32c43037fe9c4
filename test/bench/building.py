#!/usr/bin/env python3
"""Prints what a large building costs. Run it in a shell with the workspace, on a quiet machine.

usage: building.py [ROW …]   rows: convert edits speed (default: all)

500 walls with 200 openings: plan to SDF, edits in the page, and the speed with 20 boxes awake in it
beside bare PyBullet with the same bodies.
Nothing here fails on a slow machine.
"""
from __future__ import annotations

import json
import multiprocessing
import statistics
import time
from typing import Any, List, Tuple

import scenes
from bench import EMPTY
from clock import Clock
from editor import browser, editor_url
from row_table import Row, shown_with_ros
from server import Server, wait

ROWS, COLUMNS, OPENINGS, BOXES = 25, 10, 200, 20
SDF_SECONDS, SHARE, EDIT_MS = 0.5, 0.85, 50.0

EDITS = """async (plan) => {
  const {mount} = await import('/js/building/building.js');
  const {onSheet} = await import('/js/building/svg.js');
  const element = document.getElementById('building');
  element.hidden = false;
  document.body.classList.add('building');
  const {session, canvas} = await mount(element, window.editor);
  session.open(plan);
  canvas.fit();
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  await frame();
  let spent = 0;
  const draw = canvas.draw.bind(canvas);
  canvas.draw = () => {
    const began = performance.now();
    draw();
    spent += performance.now() - began;
  };
  const sheet = canvas.element;
  sheet.setPointerCapture = () => {};
  const send = (type, point) => {
    const {left, top} = sheet.getBoundingClientRect();
    const {x: across, y: down, zoom} = canvas.view;
    const [x, y] = onSheet(point);
    const [clientX, clientY] = [left + across + x * zoom, top + down + y * zoom];
    const began = performance.now();
    sheet.dispatchEvent(new PointerEvent(type, {clientX, clientY, button: 0, bubbles: true}));
    spent += performance.now() - began;
  };
  const wall = session.level.walls[340];
  const from = [(wall.start[0] + wall.end[0]) / 2, (wall.start[1] + wall.end[1]) / 2];
  const took = [];
  send('pointerdown', from);
  for (let step = 1; step <= 60; step++) {
    spent = 0;
    send('pointermove', [from[0] + step * 0.03, from[1] + step * 0.03]);
    await frame();
    await frame();
    took.push(spent);
  }
  send('pointerup', [from[0] + 1.8, from[1] + 1.8]);
  return took;
}"""
"""Drags a wall in the page: milliseconds each move takes, drawing the plan included."""


def plan() -> Any:
    """The plan's JSON, as the page sends it."""
    from my_simulations.building.building_plan import Level, Opening, Plan, Wall
    from my_simulations.building.plan_json import plan_to_json

    level = Level("Level 1")
    for row in range(ROWS):
        for column in range(COLUMNS):
            x, y = 4.0 * column, 4.0 * row
            for end in ((x + 4.0, y), (x, y + 4.0)):
                level.walls.append(Wall(len(level.walls), (x, y), end))
    for number in range(OPENINGS):
        of = level.windows if number % 2 else level.doors
        height, elevation = (0.8, 0.5) if number % 2 else (2.0, 0.0)
        of.append(Opening(number, 0.8, height, elevation, wall=number, along=2.0))
    return json.loads(json.dumps(plan_to_json(Plan("large", [level]))))


def places() -> List[Tuple[float, float, float]]:
    """One box in each of some rooms."""
    return [(2.0 + 4.0 * (n % COLUMNS), 2.0 + 4.0 * (n // COLUMNS), 0.5) for n in range(BOXES)]


def sdf_text() -> str:
    """The model element of the building."""
    from my_simulations.building.building_operations import building_sdf

    text = building_sdf(plan())[1]
    return text[text.index("<model"):text.rindex("</sdf>")]


def convert() -> Row:
    from my_simulations.building.building_operations import building_sdf

    tree = plan()
    took = []
    for _ in range(5):
        began = time.perf_counter()
        building_sdf(tree)
        took.append(time.perf_counter() - began)
    middle = statistics.median(took)
    return (f"{2 * ROWS * COLUMNS} walls, {OPENINGS} openings to SDF, median / first",
            f"{middle:.2f} / {took[0]:.2f} s", f"{SDF_SECONDS} s", middle <= SDF_SECONDS)


def edits() -> Row:
    """A wall dragged by the mouse: every move changes the plan and draws it."""
    with Server(EMPTY, "_gui:=true"), browser() as page:
        page.goto(editor_url())
        page.wait_for_selector("#view canvas")
        took = sorted(page.evaluate(EDITS, plan()))
    middle, worst = took[len(took) // 2], took[int(0.95 * len(took))]
    return ("an edit of it in the page, median / p95", f"{middle:.1f} / {worst:.1f} ms",
            f"{EDIT_MS:g} ms", worst <= EDIT_MS)


def bare(seconds: float = 4.0) -> float:
    """Real-time factor of PyBullet alone, in a process of its own."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return float(pool.apply(_bare, (seconds,)))


def _bare(seconds: float) -> float:
    import pybullet

    from my_simulations.building.plan_json import plan_from_json
    from my_simulations.building.plan_to_model import building_model
    from my_simulations.geometry import compose

    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.8)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=0.001, numSolverIterations=50, numSubSteps=0,
                                       contactERP=0.01)
    pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE),
                             useMaximalCoordinates=1)
    model = building_model(plan_from_json(plan()))
    for link in model.links:
        pose = compose(model.pose, link.pose)
        shape = pybullet.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_BOX] * len(link.collisions),
            halfExtents=[[size / 2 for size in part.geometry.size] for part in link.collisions],
            collisionFramePositions=[part.pose.position for part in link.collisions],
            collisionFrameOrientations=[part.pose.orientation for part in link.collisions])
        pybullet.createMultiBody(0, shape, -1, pose.position, pose.orientation,
                                 useMaximalCoordinates=1)
    for at in places():
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.5] * 3)
        body = pybullet.createMultiBody(1.0, box, -1, at, useMaximalCoordinates=1)
        pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0, lateralFriction=1.0)
        pybullet.changeDynamics(body, -1, contactProcessingThreshold=0.0)
        pybullet.changeDynamics(body, -1,
                                activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)
    for _ in range(300):
        pybullet.stepSimulation()
    steps, started = 0, time.perf_counter()
    while time.perf_counter() - started < seconds:
        for _ in range(20):
            pybullet.stepSimulation()
        steps += 20
    return 0.001 * steps / (time.perf_counter() - started)


def ours(seconds: float = 4.0) -> float:
    """Real-time factor of the node at full speed, with /clock subscribed."""
    import rospy

    boxes = "".join(
        f"<model name='b{n}'><pose>{x} {y} {z} 0 0 0</pose>"
        f"<allow_auto_disable>false</allow_auto_disable>{scenes.box_link()}</model>"
        for n, (x, y, z) in enumerate(places()))
    world = scenes.world("boxes", 0, False, 0.0)
    world = world.replace("</world>", f"{boxes}{sdf_text()}</world>").replace(
        "<real_time_update_rate>0.0<", "<real_time_update_rate>0<")
    clock = Clock()
    with Server(world):
        rospy.wait_for_service("/gazebo/get_world_properties", 60)
        wait(lambda: clock.sim > 0.3, 120, "settled world")
        sim, since = clock.sim, time.perf_counter()
        time.sleep(seconds)  # the time over which the speed is measured
        factor = (clock.sim - sim) / (time.perf_counter() - since)
    clock.close()
    return factor


def speed() -> Row:
    before = bare()
    mine = ours()
    alone = statistics.mean([before, bare()])
    return ("the world made from it, 20 boxes awake", f"{mine:.2f} = {mine / alone:.2f} of bare"
            f" {alone:.2f}", f"{SHARE} of bare", mine / alone >= SHARE)

if __name__ == "__main__":
    shown_with_ros({"convert": lambda: [convert()], "edits": lambda: [edits()],
                    "speed": lambda: [speed()]}, __doc__)
