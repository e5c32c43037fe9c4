#!/usr/bin/env python3
"""Prints what a step of common scenes costs: ours against bare PyBullet with the same bodies.

usage: step_cost.py [PAIRS [SCENE …]]     PAIRS: 5 by default; SCENE: words in its name

Each scene runs in a process of its own, ours and bare alternately, in steps of 1 ms unless its name
says more, in bursts of ten as a running world makes them. Bare is PyBullet with its default
settings: it damps, holds joints with motors unless told, lets wheels yaw and parked robots drift,
so its time is a yardstick and no aim.
The shortest of ten parts of a run counts: it is the one that other processes disturbed least.

At the end it prints what a simulated second costs with larger steps, as a share of what it costs
with 1 ms, and what a falling pile costs beside bare PyBullet, each with its bar.
"""
from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Callable, Dict, List, Tuple

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "engine")]
import bare_world
import pairs
import pybullet
from structures import Piece, model_of

PARTS = 10
BALLS, BALLS_STEPS = "216 balls, falling, {} ms", (1, 2, 5, 10)
PILE, PILE_BAR = "10 boxes, 10 cans, falling", 1.5
Steps = Callable[[int], None]

STEPS: Dict[str, Tuple[int, int]] = {  # before the measurement, and of it
    "one box, awake": (500, 4000), "100 boxes, asleep": (4000, 4000),
    "100 cylinders, asleep": (4000, 4000), "30 boxes, tumbling": (0, 1500),
    "50 boxes, flying": (0, 1500), "20 stacks of 10": (300, 500), "a parked base": (1500, 2000),
    "a driving base": (500, 2000), "an arm of 6, swinging": (200, 2000), PILE: (0, 1500),
    **{BALLS.format(ms): (0, 10000 // ms) for ms in BALLS_STEPS}}


def step_size(scene: str) -> float:
    """In seconds."""
    return int(scene.split()[-2]) * 1e-3 if scene.endswith(" ms") else 1e-3


def _robot(name: str) -> str:
    """A base on two wheels and a caster, or an arm that is fixed to the world, as URDF."""
    if "arm" in name:
        parts = ['<link name="world"/>']
        for n in range(6):
            parts.append(_link(f"l{n}", 1.0, "0.1 0 0", '<box size="0.16 0.05 0.05"/>', 0.003))
            parts.append(_joint(f"j{n}", f"l{n - 1}" if n else "world", f"l{n}",
                                "0.2 0 0" if n else "0 0 1", "0 1 0" if n % 2 else "0 0 1", 0.1))
    else:
        parts = [_link("base", 6.0, "0 0 0", '<box size="0.4 0.3 0.08"/>', 0.06),
                 _link("caster", 0.2, "0 0 0", '<sphere radius="0.03"/>', 2e-4),
                 _joint("mount", "base", "caster", "-0.15 0 -0.09", "", 0.0)]
        for n, y in enumerate((0.18, -0.18)):
            parts.append(_link(f"w{n}", 0.5, "0 0 0", '<cylinder radius="0.1" length="0.04"/>',
                               0.002))
            parts.append(_joint(f"j{n}", "base", f"w{n}", f"0.05 {y} -0.02", "0 1 0", 0.0))
    return f'<robot name="robot">{"".join(parts)}</robot>'


def _link(name: str, mass: float, at: str, shape: str, moment: float) -> str:
    turn = f'{-math.pi / 2} 0 0' if "cylinder" in shape else "0 0 0"
    return (f'<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{mass}"/><inertia '
            f'ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial>'
            f'<collision><origin xyz="{at}" rpy="{turn}"/><geometry>{shape}</geometry>'
            f'</collision></link>')


def _joint(name: str, parent: str, child: str, at: str, axis: str, damping: float) -> str:
    kind, tail = ("continuous", f'<axis xyz="{axis}"/><dynamics damping="{damping}"/>') if axis \
        else ("fixed", "")
    return (f'<joint name="{name}" type="{kind}"><origin xyz="{at}"/><parent link="{parent}"/>'
            f'<child link="{child}"/>{tail}</joint>')


def _pieces(scene: str) -> List[Piece]:
    """Of scenes without robots: unit boxes in a grid or in stacks, or smaller things in a heap."""
    unit = (1.0, 1.0, 1.0)
    if "balls" in scene:
        return [Piece(f"b{n}", (0.2, 0.2, 0.2), 1.0, 1.0, (
            0.3 * (n % 6) + 0.01 * (n // 36 % 2), 0.3 * (n // 6 % 6) + 0.013 * (n // 36 % 3),
            0.3 + 0.3 * (n // 36))) for n in range(216)]
    if scene == PILE:
        return [Piece(f"b{n}", (0.1, 0.1, 0.15) if n % 2 else (0.2, 0.2, 0.2), 1.0, 1.0, (
            0.25 * (n % 4), 0.25 * (n // 4 % 2), 0.3 + 0.35 * (n // 8))) for n in range(20)]
    if "stacks" in scene:
        return [Piece(f"b{n}", unit, 1.0, 1.0, (4.0 * (n // 10), 0.0, 0.5 + n % 10))
                for n in range(200)]
    if "tumbling" in scene:
        return [Piece(f"b{n}", (0.3, 0.3, 0.3), 1.0, 1.0, (
            0.2 * (n % 3), 0.2 * (n // 3 % 2), 0.3 + 0.35 * (n // 2))) for n in range(30)]
    count = 1 if "one" in scene else 50 if "flying" in scene else 100
    height = 50.0 if "flying" in scene else 0.5
    return [Piece(f"b{n}", unit, 1.0, 1.0, (3.0 * (n % 10), 3.0 * (n // 10), height))
            for n in range(count)]


def _turn(scene: str, n: int) -> Tuple[float, float, float, float]:
    turned = "tumbling" in scene or scene == PILE
    turn = pybullet.getQuaternionFromEuler((0.3 * n, 0.2 * n, 0.0) if turned else (0.0, 0.0, 0.0))
    return (turn[0], turn[1], turn[2], turn[3])


def _shape(scene: str, n: int) -> str:
    """Return the shape that fills the box of a piece's size: `box`, `cylinder` or `sphere`."""
    if "balls" in scene:
        return "sphere"
    return "cylinder" if "cylinders" in scene or scene == PILE and n % 2 else "box"


def _robot_file(scene: str, folder: str) -> str:
    path = Path(folder) / "robot.urdf"
    path.write_text(_robot(scene), encoding="utf-8")
    return str(path)


def _ours(scene: str) -> Steps:
    from conftest import Lab, ground, inertial_of_box, link_of

    from my_simulations.description.model import Model
    from my_simulations.description.shapes import Cylinder, Sphere
    from my_simulations.engine.drive_commands import JointMotor, SetMotors
    from my_simulations.formats.reading import read_file
    from my_simulations.resources.resolver import Resolver
    lab = Lab()
    lab.configure(step_size=step_size(scene))
    lab.load(ground(1.0))
    if "base" in scene or "arm" in scene:
        with tempfile.TemporaryDirectory() as folder:
            model, _ = read_file(_robot_file(scene, folder), Resolver())
        robot = lab.load(model, (0, 0, 0.12 if "base" in scene else 0.0))
        if "driving" in scene:
            lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[robot, f"j{n}"], 5.0, 5.0)
                                      for n in range(2))))
    else:
        for n, piece in enumerate(_pieces(scene)):
            model = model_of(piece, asleep="asleep" in scene)[0]
            if _shape(scene, n) != "box":
                shape = Sphere(piece.size[0] / 2) if _shape(scene, n) == "sphere" else Cylinder(
                    piece.size[0] / 2, piece.size[2])
                model = Model(piece.name, links=[link_of(
                    shape, inertial_of_box(1.0, *piece.size))])
            number = lab.load(model, piece.position, _turn(scene, n))
            if "flying" in scene:
                lab.push(number, (1, 0, 5), (1, 2, 0))

    def steps(count: int) -> None:
        for _ in range(count // 10):
            lab.backend.step(lab.step, 10)
            lab.step += 10
    return steps


def _bare(scene: str) -> Steps:
    bare_world.begin(step_size(scene))
    if "base" in scene or "arm" in scene:
        with tempfile.TemporaryDirectory() as folder:
            robot = pybullet.loadURDF(_robot_file(scene, folder), (0, 0, 0.12) if "base" in scene
                                      else (0, 0, 0), useFixedBase="arm" in scene)
        for joint in range(pybullet.getNumJoints(robot)):
            drives = "driving" in scene and joint > 0
            pybullet.setJointMotorControl2(robot, joint, pybullet.VELOCITY_CONTROL,
                                           targetVelocity=5.0 * drives, force=5.0 * drives)
    else:
        for n, piece in enumerate(_pieces(scene)):
            shape = {
                "box": lambda size: pybullet.createCollisionShape(
                    pybullet.GEOM_BOX, halfExtents=[side / 2 for side in size]),
                "cylinder": lambda size: pybullet.createCollisionShape(
                    pybullet.GEOM_CYLINDER, radius=size[0] / 2, height=size[2]),
                "sphere": lambda size: pybullet.createCollisionShape(
                    pybullet.GEOM_SPHERE, radius=size[0] / 2)}[_shape(scene, n)](piece.size)
            body = pybullet.createMultiBody(piece.mass, shape, -1, piece.position,
                                            _turn(scene, n), useMaximalCoordinates=1)
            pybullet.changeDynamics(body, -1, lateralFriction=1.0)
            if "asleep" in scene:
                pybullet.changeDynamics(
                    body, -1, activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
                    sleepThreshold=0.01)
            if "flying" in scene:
                pybullet.resetBaseVelocity(body, (1, 0, 5), (1, 2, 0))
    return bare_world.steps


def child(kind: str, scene: str) -> None:
    """Run a scene once; prints the processor time of a step, us."""
    steps = (_ours if kind == "ours" else _bare)(scene)
    before, count = STEPS[scene]
    steps(before)
    parts = []
    for _ in range(PARTS):
        began = time.process_time()
        steps(count // PARTS)
        parts.append((time.process_time() - began) / (count // PARTS) * 1e6)
    # The cost of falling or tumbling pieces changes during the run: all parts count.
    print(min(parts) if before else sum(parts) / PARTS)


def print_bars(medians: Dict[str, Tuple[float, float]]) -> None:
    """Print those ratios with a bar that were measured. `medians`: see `pairs.rows`."""
    first = medians.get(BALLS.format(1))
    for ms in BALLS_STEPS[1:]:
        found = medians.get(BALLS.format(ms))
        if first is not None and found is not None:
            _print_bar(f"a second of 216 balls, {ms} ms over 1 ms", found[0] / ms / first[0], 1.0)
    if PILE in medians:
        _print_bar(f"{PILE}: over bare", medians[PILE][1], PILE_BAR)


def _print_bar(what: str, ratio: float, bar: float) -> None:
    print(f"{what:<42} {ratio:>5.2f}   bar {bar:g}   {'met' if ratio <= bar else 'NOT MET'}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        child(sys.argv[2], sys.argv[3])
    else:
        seen: Dict[str, Tuple[float, float]] = {}
        pairs.rows(__file__, list(STEPS), sys.argv[1:], medians=seen)
        print_bars(seen)
