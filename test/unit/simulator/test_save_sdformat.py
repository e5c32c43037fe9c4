"""libsdformat, whose format this is, reads every file that is written."""
from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from reading import VALID, model_of, sdf, world_of
from running_simulator import running

from my_simulations.description.model import Joint, JointAxis, Link, Mimic, Model
from my_simulations.description.world import World
from my_simulations.formats.reading import read_file, read_world
from my_simulations.formats.sdf.writer.entities import write_entity, write_world
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.saving import save_world

ROOT = Path(__file__).resolve().parents[3]
WORLDS = sorted(ROOT.glob("world/**/*.world"))
MODELS = [*sorted(ROOT.glob("models/*/model.sdf")), *sorted(ROOT.glob("objects/*.urdf")),
          *sorted(ROOT.glob("objects/*.sdf")), ROOT / "urdf/robo.urdf",
          Path(VALID) / "everything.sdf"]


def is_packaged(name):
    """Whether the distribution has a package of this name."""
    return subprocess.run(["apt-cache", "show", name], capture_output=True,
                          timeout=60).returncode == 0


@pytest.fixture(scope="session")
def faults(tmp_path_factory):
    """What libsdformat says of files."""
    program = tmp_path_factory.mktemp("parse_sdf") / "parse_sdf"
    # The pkg-config of Debian 11 has no option for the names alone.
    known = subprocess.run(["pkg-config", "--list-all"], capture_output=True, text=True,
                           check=True, timeout=60).stdout.splitlines()
    package = next((line.split()[0] for line in known if line.startswith("sdformat")), None)
    if package is None and not is_packaged("libsdformat-dev"):
        pytest.skip("this distribution has no libsdformat")
    assert package is not None, "libsdformat-dev is not installed: tools/test installs it"
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", package], capture_output=True,
                           text=True, check=True, timeout=60).stdout.split()
    built = subprocess.run(["g++", "-std=c++17", str(ROOT / "tools/generate/parse_sdf.cc"), "-o",
                            str(program), *flags], capture_output=True, text=True, timeout=300)
    assert built.returncode == 0, built.stderr

    def run(*paths):
        done = subprocess.run([str(program), *map(str, paths)], capture_output=True, text=True,
                              timeout=120)
        return done.stdout + "".join(line for line in done.stderr.splitlines(True)
                                     if "Error" in line)

    return run


def test_it_finds_errors_where_there_are_some(faults, tmp_path):
    path = tmp_path / "bad.sdf"
    path.write_text(sdf('<model name="m"><link/></model>', "1.7"))
    assert "bad.sdf" in faults(path)


def test_it_reads_every_world_that_is_written(faults, tmp_path):
    paths = []
    for number, path in enumerate(WORLDS):
        paths.append(tmp_path / f"{number}.world")
        paths[-1].write_bytes(write_world(read_world(
            str(path), Resolver.from_environment()).world))
    assert faults(*paths) == ""


def test_it_reads_every_model_that_is_written(faults, tmp_path):
    paths = []
    for number, path in enumerate(MODELS):
        paths.append(tmp_path / f"{number}.sdf")
        model, _ = read_file(str(path), Resolver.from_environment())
        paths[-1].write_bytes(write_entity(model))
    assert faults(*paths) == ""


def test_it_reads_a_running_world_with_joints_and_nested_models(faults, tmp_path):
    arm = Model("arm", links=[Link("base"), Link("tip")], joints=[
        Joint("hinge", "revolute", "base", "tip", axis=JointAxis()),
        Joint("screw", "screw", "world", "base", axis=JointAxis(mimic=Mimic("hinge", 2.0)))])
    outer = Model("outer", links=[Link("l")], models=[arm])
    with running(World("w", models=[outer, Model("wall", static=True, links=[Link("l")])]),
                 log=lambda issue: pytest.fail(str(issue))) as sim:
        sim.clock.advance(7)
        path = save_world(sim, "s.world", roots=[str(tmp_path)])
    assert faults(path) == ""


def test_it_reads_a_joint_called_as_a_link_and_friction_without_bound(faults, tmp_path):
    model, _ = model_of(
        '<link name="a"/><link name="b"><collision name="c"><geometry><box/></geometry><surface>'
        "<friction><ode><mu>-1</mu></ode></friction></surface></collision></link>"
        '<joint name="b" type="revolute"><parent>a</parent><child>b</child><axis/></joint>', "1.4")
    path = tmp_path / "names.sdf"
    path.write_bytes(write_entity(model))
    assert faults(path) == ""


def test_it_reads_joints_between_models(faults, tmp_path):
    world, _ = world_of('<model name="a"><link name="l"/></model><model name="b"><link name="l"/>'
                        '<joint name="j" type="fixed"><parent>a::l</parent><child>l</child></joint>'
                        "</model>")
    path = tmp_path / "between.world"
    path.write_bytes(write_world(world))
    assert b'<joint name="b::j"' in path.read_bytes() and faults(path) == ""


def test_it_reads_what_was_kept_and_the_newer_shapes(faults, tmp_path):
    shapes = ("<capsule><radius>0.1</radius><length>1</length></capsule>",
              "<ellipsoid><radii>1 2 3</radii></ellipsoid>",
              "<polyline><point>0 0</point><point>1 0</point><point>0 1</point><height>2</height>"
              "</polyline>")
    links = "".join(f'<link name="l{n}"><collision name="c"><geometry>{shape}</geometry>'
                    "</collision></link>" for n, shape in enumerate(shapes))
    world, _ = world_of(
        f'<model name="m"><static>1</static>{links}</model>'
        "<scene><sky/><ignition:odd>1</ignition:odd></scene><gui><camera name='c'>"
        "<pose>1 2 3 0 0 0</pose></camera></gui><audio><device>d</device></audio>"
        '<plugin name="p" filename="libp.so"><deep><er>1</er></deep></plugin>', "1.8")
    path = tmp_path / "kept.world"
    path.write_bytes(write_world(world))
    assert faults(path) == ""
