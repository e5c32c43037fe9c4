"""Objects whose file has them 1 mm inside the ground stay where they are, at all step sizes."""
from __future__ import annotations

import math
from typing import List, Sequence, Tuple

import pytest
from laws import Laws

import my_simulations

Point = Tuple[float, float, float]

GROUNDS = {
    "plane": "<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>",
    "box": "<pose>0 0 -0.5 0 0 0</pose><geometry><box><size>100 100 1</size></box></geometry>"}
WORLD = """<sdf version="1.7"><world name="w">
<physics type="ode"><max_step_size>{step}</max_step_size></physics>
<model name="ground"><static>true</static><link name="link"><collision name="c">{ground}
</collision></link></model></world></sdf>"""
MODEL = """<sdf version="1.7"><model name="object"><link name="link">{inertial}
<collision name="c"><pose>0 0 {raised} 0 0 0</pose><geometry>{shape}</geometry></collision>
</link></model></sdf>"""
DEFAULT = ("<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>"
           "</inertial>")   # what SDF says for a link without one: of a body 2 m wide


def ring(radius: float, height: float) -> List[Point]:
    return [(radius * math.cos(math.pi * n / 12), radius * math.sin(math.pi * n / 12), height)
            for n in range(24)]


def prism(bottom: Sequence[Point], top: Sequence[Point]) -> List[Sequence[Point]]:
    """Triangles of a solid between two polygons of the same number of corners."""
    found: List[Sequence[Point]] = []
    for n in range(len(bottom)):
        a, b, c, d = bottom[n - 1], bottom[n], top[n], top[n - 1]
        found += [(a, b, c), (a, c, d), (b, a, bottom[0]), (d, c, top[0])]
    return [one for one in found if len(set(one)) == 3]


def square(width: float, height: float) -> List[Point]:
    return [(x * width / 2, y * width / 2, height) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


MESHES = {
    "cone": prism(square(0.4, 0.0), square(0.4, 0.03)) + prism(ring(0.14, 0.03), ring(0.03, 0.75)),
    "bottle": prism(ring(0.04, 0.0), ring(0.04, 0.15)) + prism(ring(0.015, 0.15), ring(0.015, 0.2)),
    "crate": prism(square(0.3, 0.0), square(0.3, 0.2))}
SOLIDS = {
    "box": ("<box><size>0.1 0.1 0.2</size></box>", 0.1),
    "can": ("<cylinder><radius>0.04</radius><length>0.15</length></cylinder>", 0.075)}


def stl(triangles: Sequence[Sequence[Point]]) -> str:
    facets = "".join("facet normal 0 0 0\nouter loop\n"
                     + "".join("vertex {} {} {}\n".format(*point) for point in corners)
                     + "endloop\nendfacet\n" for corners in triangles)
    return f"solid mesh\n{facets}endsolid mesh\n"


@pytest.fixture
def models(tmp_path):
    """SDF of each object, whose lowest points are at z = 0."""
    found = {}
    for name, triangles in MESHES.items():
        path = tmp_path / f"{name}.stl"
        path.write_text(stl(triangles))
        found[name] = MODEL.format(inertial=DEFAULT, raised=0.0,
                                   shape=f"<mesh><uri>{path}</uri></mesh>")
    for name, (shape, raised) in SOLIDS.items():
        found[name] = MODEL.format(inertial=DEFAULT, raised=raised, shape=shape)
    return found


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("step", [0.001, 0.002, 0.005, 0.01])
def test_an_object_one_millimetre_in_the_ground_stays(models, tmp_path, laws: Laws, step, ground):
    path = tmp_path / "ground.world"
    path.write_text(WORLD.format(step=step, ground=GROUNDS[ground]))
    with my_simulations.open_world(str(path)) as world:
        for n, (name, text) in enumerate(models.items()):
            for turn in range(3):
                world.spawn(text, f"{name}_{turn}", [2.0 * n, 2.0 * turn, -0.001, 0, 0, 0.4 * turn])
        start = world.states().pose
        for _ in range(round(2.0 / step / 10)):
            world.step(10)
            for name, (x, y, z, qx, qy, _, _) in world.states().pose.items():
                laws.at_most("objects 1 mm in the ground, 1 to 10 ms steps: tilt, degrees",
                             2 * math.degrees(math.hypot(qx, qy)), 0.3)
                laws.at_most("the same: way sideways, mm",
                             1e3 * math.hypot(x - start[name][0], y - start[name][1]), 0.2)
                laws.at_most("the same: jump, mm", 1e3 * z, 0.2)
