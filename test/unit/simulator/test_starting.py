import time

import pytest
from inline_engine import InlineEngine

from my_simulations.errors import InputError, Severity, warning
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.lifecycle.engine_supply import EngineSupply
from my_simulations.simulator.issue_log import IssueLog
from my_simulations.simulator.world_loading import load_world, start_world

WORLD = """<sdf version="1.6"><world name="w">
<model name="good"><static>true</static><link name="l"><collision name="c"><geometry>
<box><size>1 1 1</size></box></geometry></collision></link></model>
<model name="bad"><static>true</static><link name="l"><collision name="c"><geometry>
<mesh><uri>broken.stl</uri></mesh></geometry></collision></link></model>
</world></sdf>"""


def test_a_world_that_is_nowhere_lists_the_places(tmp_path):
    with pytest.raises(InputError) as fault:
        load_world("none.world", Resolver(resource_paths=[str(tmp_path)]), lambda issue: None)
    assert "none.world" in str(fault.value) and str(tmp_path) in str(fault.value)


def test_a_collision_whose_mesh_is_broken_stays_without_a_mesh_and_the_rest_loads(tmp_path):
    (tmp_path / "broken.stl").write_text("solid nothing\nendsolid nothing\n")
    (tmp_path / "room.world").write_text(WORLD)
    issues = []
    loaded = load_world("room.world", Resolver(resource_paths=[str(tmp_path)]),
                        issues.append)
    good, bad = loaded.world.models
    assert (good.name, len(good.links[0].collisions)) == ("good", 1)
    # Still in the description, so that saving the world keeps it.
    assert (bad.name, [c.name for c in bad.links[0].collisions]) == ("bad", ["c"])
    assert loaded.meshes["bad"] == {}
    assert any(issue.tolerated and "broken.stl" in str(issue)
               for issue in issues)


def test_what_is_rarely_meant_is_told_with_the_world(tmp_path):
    (tmp_path / "w.world").write_text(WORLD.replace("broken.stl", "flat.stl").replace(
        "</world>", "<model name='in'><link name='l'><collision name='c'><geometry><sphere><radius>"
        "0.2</radius></sphere></geometry></collision></link></model></world>"))
    (tmp_path / "flat.stl").write_text(
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid s\n")
    issues = []
    load_world("w.world", Resolver(resource_paths=[str(tmp_path)]), issues.append)
    assert {(one.code, one.severity) for one in issues} == {
        (code, Severity.WARNING) for code in ("inertia-odd", "starts-inside", "shape-thin")}
    assert {one.file for one in issues} == {str(tmp_path / "w.world")}
    assert all(one.line and one.xpath.startswith("/sdf/world/model") for one in issues)


def test_issues_wait_until_there_is_a_log():
    log, heard = IssueLog(), []
    log(warning("early", "before the node"))
    assert heard == []
    log.open(heard.append)
    log(warning("late", "after it"))
    assert [issue.code for issue in heard] == ["early", "late"]


class FakeEngine:
    def __init__(self):
        self.closed = False

    def close(self):
        self.closed = True


def test_the_first_engine_is_made_ahead_and_handed_out_once():
    made = []

    def make():
        made.append(FakeEngine())
        return made[-1]

    supply = EngineSupply(make)
    assert len(made) == 1
    assert supply() is made[0]
    assert supply() is made[1]
    supply.close()
    assert not made[0].closed


def test_an_engine_nobody_took_is_ended():
    supply = EngineSupply(FakeEngine)
    first = supply._first
    supply.close()
    assert first.closed


PRESETS = """<sdf version="1.6"><world name="w">
<physics name="usual" default="true" type="ode"><max_step_size>0.001</max_step_size></physics>
<physics name="fast" type="ode"><max_step_size>0.004</max_step_size></physics>
</world></sdf>"""


@pytest.mark.parametrize("profile, step", [("", 0.001), ("fast", 0.004), ("none", 0.001)])
def test_a_physics_preset_is_chosen_by_name(tmp_path, profile, step):
    (tmp_path / "a.world").write_text(PRESETS)
    issues = []
    loaded = load_world(str(tmp_path / "a.world"), Resolver(), issues.append, profile=profile)
    assert loaded.world.physics.max_step_size == step
    assert [issue.code for issue in issues] == (["physics-profile"] if profile == "none" else [])


RANDOM = """<sdf version="1.6"><world name="w"><population name="p">
<model name="m"><static>true</static><link name="l"/></model><model_count>5</model_count>
<box><size>9 9 9</size></box></population></world></sdf>"""


def test_a_seed_decides_where_a_population_stands(tmp_path):
    (tmp_path / "a.world").write_text(RANDOM)

    def places(seed):
        loaded = load_world(str(tmp_path / "a.world"), Resolver(), lambda issue: None, seed=seed)
        return [model.pose.position for model in loaded.world.models]

    assert len(places(1)) == 5
    assert places(1) == places(1) != places(2)


def test_a_world_starts_paused_with_its_seed_and_preset_and_stands_after_its_steps(tmp_path):
    (tmp_path / "a.world").write_text(RANDOM.replace("<population", PRESETS.split('"w">')[1].split(
        "</world>")[0] + "<population"))
    engine, told = InlineEngine(), []
    sim = start_world(str(tmp_path / "a.world"), Resolver(), lambda: engine, told.append, seed=3,
                      profile="fast", steps=20, read=lambda: told.append("read"))
    try:
        assert (sim.clock.paused, sim.clock.step, told) == (True, 0, ["read"])
        assert sim.physics.settings.max_step_size == 0.004
        again = load_world(str(tmp_path / "a.world"), Resolver(), lambda issue: None, seed=3)
        assert [sim.models.get(name).pose for name in sim.models.names()] == [
            model.pose for model in again.world.models]
        sim.clock.unpause()
        deadline = time.monotonic() + 60
        while sim.clock.step < 20:
            assert time.monotonic() < deadline, "it stands too early"
            sim.clock.wait_step(sim.clock.step, 0.1)
        assert sim.clock.advance(0) == 20
    finally:
        sim.close()
