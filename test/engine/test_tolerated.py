"""What is read of files that break the rules can be simulated."""
from __future__ import annotations

import math
import os
from pathlib import Path

import pytest
from running_simulator import running

from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.errors import InputError, errors_of
from my_simulations.formats.reading import read_entity, read_file, read_world_text
from my_simulations.resources.resolver import Resolver

INVALID = Path(__file__).resolve().parents[1] / "data/invalid"
CUBE = INVALID.parent / "valid/cube.stl"
GROUND = ("<model name='ground'><static>1</static><link name='l'><collision name='c'><geometry>"
          "<plane/></geometry></collision></link></model>")


def after(world, meshes=None, steps=500):
    """Poses by model, and what was logged, after some steps."""
    faults = []
    with running(world, BulletBackend, log=faults.append, meshes=meshes or {}) as sim:
        sim.clock.advance(steps)
        return {name: sim.states.model_state(name)[0] for name in sim.models.names()}, faults


def tolerated_files():
    for name in sorted(os.listdir(INVALID)):
        if name.endswith((".sdf", ".urdf")):
            try:
                _, issues = read_file(str(INVALID / name), Resolver())
            except InputError:
                continue
            if not errors_of(issues):
                yield name


@pytest.mark.parametrize("name", list(tolerated_files()))
def test_a_tolerated_model_moves_on_finite_numbers(name):
    model, _ = read_file(str(INVALID / name), Resolver())
    poses, _ = after(World(models=[model]))
    assert all(math.isfinite(value) for value in poses[model.name].position)


@pytest.mark.parametrize("static", ["true", "false"])
def test_things_lie_on_a_mesh_that_is_scaled_flat(static):
    text = f"""<sdf version='1.7'><world name='w'>{GROUND}
        <model name='plate'><static>{static}</static><pose>0 0 0.02 0 0 0</pose><link name='l'>
        <collision name='c'><pose>-0.5 -0.5 0 0 0 0</pose><geometry><mesh><uri>{CUBE}</uri>
        <scale>1 1 0</scale></mesh></geometry></collision></link></model>
        <model name='box'><pose>0 0 0.2 0 0 0</pose><link name='l'><inertial><inertia>
        <ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial><collision name='c'>
        <geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision></link></model></world>
        </sdf>"""
    loaded = read_world_text(text, Resolver())
    poses, _ = after(loaded.world, loaded.meshes, 1000)
    assert errors_of(loaded.issues) == []
    assert -0.005 < poses["plate"].position[2] < 0.025
    assert 0.09 < poses["box"].position[2] < 0.15


def test_a_model_without_links_takes_part_in_the_world():
    model, _ = read_entity("<sdf version='1.7'><model name='m'><pose>1 0 0 0 0 0</pose></model>"
                           "</sdf>", Resolver())
    poses, faults = after(World(models=[model]))
    assert poses["m"].position == (1, 0, 0) and faults == []
