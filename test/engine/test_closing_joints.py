"""Joints that close loops: Bullet has no axis for them, and they read as in Gazebo all the same."""
from __future__ import annotations

import pytest

import my_simulations

BODY = """<gravity>0</gravity><inertial><mass>1</mass>
<inertia><ixx>.02</ixx><iyy>.02</iyy><izz>.02</izz></inertia></inertial>"""


def link(name, x, z):
    return f'<link name="{name}"><pose>{x} 0 {z} 0 0 0</pose>{BODY}</link>'


def joint(name, parent, child, x=0.0, kind="revolute", axis="0 1 0"):
    return (f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
            f"<pose>{x} 0 0 0 0 0</pose><axis><xyz>{axis}</xyz></axis></joint>")


BASE = link("base", 0, 0.5) + ('<joint name="fix" type="fixed"><parent>world</parent>'
                               "<child>base</child></joint>")
PARALLELOGRAM = (BASE + link("l", 0, 1) + link("r", 1, 1) + link("top", 0.5, 2)
                 + joint("j1", "base", "l") + joint("j2", "base", "r")
                 + joint("j3", "l", "top", -0.5) + joint("j4", "r", "top", 0.5))
GUIDE = (BASE + link("a", 0, 1) + link("b", 1, 1)
         + joint("j1", "base", "a", 0.0, "prismatic", "1 0 0") + joint("j2", "a", "b")
         + joint("j4", "world", "b", 0.0, "prismatic", "1 0 0"))


@pytest.fixture
def world():
    with my_simulations.open_world() as opened:
        yield opened


def spawned(world, content):
    world.spawn(f'<sdf version="1.7"><model name="m">{content}</model></sdf>')
    world.apply_effort("m::j1", 0.3, duration=0.5)
    world.step(400)
    return world.joints()


def test_a_closing_hinge_tells_its_angle_and_rate(world):
    told = spawned(world, PARALLELOGRAM)
    assert told.position["m::j1"] > 0.01
    for name, sign in (("j2", 1), ("j3", -1), ("j4", -1)):
        assert told.position[f"m::{name}"] == pytest.approx(sign * told.position["m::j1"], abs=1e-4)
        assert told.rate[f"m::{name}"] == pytest.approx(sign * told.rate["m::j1"], abs=1e-3)


def test_a_closing_slide_to_the_world_tells_its_way(world):
    told = spawned(world, GUIDE)
    assert told.position["m::j1"] > 0.01
    assert told.position["m::j4"] == pytest.approx(told.position["m::j1"], abs=1e-4)
    assert told.rate["m::j4"] == pytest.approx(told.rate["m::j1"], abs=1e-3)


def test_a_world_with_a_loop_is_kept_saved_and_reset(world, tmp_path):
    told = spawned(world, PARALLELOGRAM)
    kept, path = world.save(), str(tmp_path / "loop.world")
    world.save_world(path)
    world.step(300)
    world.restore(kept)
    again = world.joints()
    with my_simulations.open_world(path) as opened:
        saved = opened.joints()
        for name, position in told.position.items():
            assert again.position[name] == pytest.approx(position, abs=1e-6)
            assert saved.position[name] == pytest.approx(position, abs=1e-4)
    world.simulator.resets.reset_simulation()
    assert all(position == 0.0 for position in world.joints().position.values())


def test_a_loop_leaves_nothing_in_the_rows_of_the_next_model(world):
    told = spawned(world, PARALLELOGRAM)
    world.remove("m")
    world.spawn(f'<sdf version="1.7"><model name="m"><static>true</static>{PARALLELOGRAM}'
                "</model></sdf>")
    assert told.position["m::j4"] != 0.0
    assert all(position == 0.0 for position in world.joints().position.values())


def urdf_link(name):
    return (f'<link name="{name}"><inertial><mass value="1"/><inertia ixx=".02" ixy="0" ixz="0"'
            ' iyy=".02" iyz="0" izz=".02"/></inertial></link>')


def urdf_joint(name, parent, child, xyz, kind="continuous"):
    return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}"/><axis xyz="0 1 0"/></joint>')


def test_a_plugin_closes_the_loop_of_a_robot(world):
    """A parallelogram: bars `l` and `r` carry `top`, whose second end the plugin joins to `r`."""
    loop = ('<gazebo><plugin name="p" filename="libpegasus_gazebo_closed_loop_plugin.so"><joint>j4'
            "</joint><parent>r</parent><child>top</child><position>1 0 0</position></plugin>"
            "</gazebo>")
    free = "".join(f'<gazebo reference="{name}"><gravity>false</gravity></gazebo>'
                   for name in ("l", "r", "top"))
    world.spawn('<robot name="m"><link name="world"/>' + "".join(map(
        urdf_link, ("base", "l", "r", "top")))
        + urdf_joint("fix", "world", "base", "0 0 1", "fixed")
        + urdf_joint("j1", "base", "l", "0 0 0") + urdf_joint("j2", "base", "r", "1 0 0")
        + urdf_joint("j3", "l", "top", "0 0 1") + loop + free + "</robot>")
    world.apply_effort("m::j1", 0.3, duration=0.5)
    world.step(400)
    told = world.joints()
    assert told.position["m::j1"] > 0.01
    for name, sign in (("j2", 1), ("j3", -1), ("j4", -1)):
        assert told.position[f"m::{name}"] == pytest.approx(sign * told.position["m::j1"], abs=1e-3)
