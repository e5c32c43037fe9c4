"""Several ties at a time: those that stay are not harmed by those that go."""
from __future__ import annotations

from dataclasses import replace

import pytest

import my_simulations

BOX = """<sdf version="1.6"><model name="b"><link name="link"><inertial><mass>1</mass>
<inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial>
<collision name="c"><geometry><box><size>.2 .2 .2</size></box></geometry></collision>
</link></model></sdf>"""
GEARED = """<sdf version="1.6"><model name="g"><static>false</static>
<link name="base"/><link name="l"><pose>1 0 0 0 0 0</pose></link>
<link name="r"><pose>2 0 0 0 0 0</pose></link>
<joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
<joint name="j1" type="revolute"><parent>base</parent><child>l</child><axis><xyz>0 0 1</xyz></axis>
</joint>
<joint name="j2" type="revolute"><parent>base</parent><child>r</child><axis><xyz>0 0 1</xyz></axis>
</joint>
<joint name="gears" type="gearbox"><parent>l</parent><child>r</child>
<gearbox_ratio>2</gearbox_ratio><gearbox_reference_body>base</gearbox_reference_body>
<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2></joint></model></sdf>"""
PAIR, TO_WORLD = ("a::link", "b::link"), ("world", "c::link")


@pytest.fixture
def world():
    """Four boxes side by side, in the air."""
    with my_simulations.open_world() as opened:
        for n, name in enumerate("abcd"):
            opened.spawn(BOX, name, (n, 0, 3))
        yield opened


def height(world, name):
    return world.states().pose[name][2]


def apart(world, one, other):
    return world.states().pose[other][0] - world.states().pose[one][0]


@pytest.mark.parametrize("ties", [[PAIR, TO_WORLD], [TO_WORLD, PAIR]])
@pytest.mark.parametrize("edited", ["aca", "caca", "cbac"])
def test_models_that_are_tied_can_be_edited_one_after_the_other(world, ties, edited):
    models = world.simulator.models
    for n, ends in enumerate(ties):
        models.attach(f"tie_{n}", *ends)
    for name in edited:
        models.edit(name, replace(models.get(name)))
    world.step(300)
    assert height(world, "c") == pytest.approx(3.0, abs=1e-3)
    assert height(world, "a") == pytest.approx(height(world, "d"), abs=1e-3)
    assert apart(world, "a", "b") == pytest.approx(1.0, abs=1e-3)


def test_a_geared_model_can_go_while_others_are_tied(world):
    world.spawn(GEARED, "g", (0, 5, 3))
    world.simulator.models.attach("pair", *PAIR)
    world.remove("g")
    world.spawn(GEARED, "g", (0, 5, 3))
    world.simulator.models.detach("pair")
    world.simulator.models.attach("pair", *PAIR)
    world.remove("g")
    world.step(300)
    assert apart(world, "a", "b") == pytest.approx(1.0, abs=1e-3)


def test_one_of_several_ties_can_be_undone(world):
    models = world.simulator.models
    models.attach("first", *PAIR)
    models.attach("second", "b::link", "c::link")
    models.detach("first")
    world.set_pose("a", (1, 0, 4))
    world.step(1000)
    assert height(world, "a") == pytest.approx(height(world, "b") + 0.2, abs=0.3)
    assert apart(world, "b", "c") == pytest.approx(1.0, abs=1e-2)


@pytest.mark.parametrize("reset", ["reset_world", "reset_simulation"])
def test_a_reset_undoes_several_ties(world, reset):
    models = world.simulator.models
    models.attach("first", *PAIR)
    models.attach("second", "b::link", "c::link")
    getattr(world.simulator.resets, reset)()
    world.apply_wrench("a::link", (0, 5, 0), duration=0.2)
    world.step(300)
    assert world.states().pose["a"][1] > 0.05
    assert world.states().pose["b"][1] == pytest.approx(0.0, abs=1e-6)


def test_the_next_model_does_not_pass_through_what_the_last_one_was_tied_to(world):
    models = world.simulator.models
    world.set_pose("b", (0, 0, 0.1))
    models.edit("b", replace(models.get("b"), static=True))
    world.set_pose("a", (0, 0, 0.3))
    models.attach("held", *PAIR)
    world.remove("a")
    world.spawn(BOX, "e", (0, 0, 0.5))
    world.step(1000)
    assert height(world, "e") == pytest.approx(0.3, abs=2e-3)
