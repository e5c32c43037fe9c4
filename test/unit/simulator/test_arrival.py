"""Advice about a model that was put into a running world."""
from __future__ import annotations

from dataclasses import replace

import pytest
from running_simulator import running

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Plane
from my_simulations.description.world import World
from my_simulations.formats.loading_advice import ADVICE_LIMIT, Written, advice_issues
from my_simulations.formats.reading import parse_document
from my_simulations.geometry import STILL, Pose
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator import spawn_advice
from my_simulations.simulator.spawn_advice import overlap_warnings, placement_warnings


def cube(name, height, size=1.0, moment=0.17):
    inertial = Inertial(1.0, ixx=moment, iyy=moment, izz=moment)
    return Model(name, Pose((0, 0, height)), links=[
        Link("l", inertial=inertial, collisions=[Collision("c", Box((size,) * 3))])])


GROUND = Model("ground", static=True, links=[Link("l", collisions=[Collision("c", Plane())])])


@pytest.fixture
def sim():
    with running(World(models=[GROUND, cube("deep", 0.2), cube("high", 5.0)]),
                 log=lambda issue: pytest.fail(str(issue))) as made:
        yield made


def said(sim, model):
    sim.models.spawn(model, model.pose)
    return [(one.code, one.message) for one in placement_warnings(sim, model.name, {})]


def test_a_model_that_stands_alone_needs_no_advice(sim):
    assert said(sim, cube("new", 2.0)) == []


def test_a_model_inside_others_is_told_with_them_and_them_alone(sim):
    found = said(sim, cube("new", 4.5))
    assert [code for code, _ in found] == ["starts-inside"]
    assert "new::l" in found[0][1] and "high::l" in found[0][1]
    (ground,) = said(sim, cube("low", -30.0))
    assert "ground::l" in ground[1]


def test_a_model_in_several_others_is_one_overlap_advice(sim):
    sim.models.spawn(cube("near", 5.2), Pose((0.0, 0.5, 5.2)))
    sim.models.spawn(cube("new", 4.8), Pose((0.0, 0.2, 4.8)))
    (issue,) = overlap_warnings(sim, ["new"])
    assert issue.message.endswith(", and 1 more of its overlaps")
    assert len([one for one in placement_warnings(sim, "new", {}) if one.code == issue.code]) == 2


def test_others_count_where_they_are_now(sim):
    sim.states.set_model_state("high", Pose((9, 0, 5)), sim.states.model_state("high")[1])
    assert said(sim, cube("new", 4.5)) == []


def test_legs_count_as_they_are_folded(sim):
    """With straight legs the robot would stand half a metre in the ground.

    The engine of these tests has no joints, so the test places the leg at the joint's position.
    """
    leg = Link("leg", Pose((0, 0, -1.0)), Inertial(1.0, ixx=0.1, iyy=0.1, izz=0.1),
               [Collision("c", Box((0.1, 0.1, 0.2)))])
    body = Link("body", inertial=Inertial(5.0, ixx=0.1, iyy=0.1, izz=0.1))
    robot = Model("robot", Pose((20, 0, 0.6)), links=[body, leg], joints=[
        Joint("hip", "prismatic", "body", "leg", axis=JointAxis((0, 0, 1), lower=0, upper=1))])
    (text,) = (text for code, text in said(sim, robot) if code == "starts-inside")
    assert "robot::leg" in text
    sim.states.set_link_state("robot::leg", Pose((20, 0, 0.5)), STILL)
    assert "starts-inside" not in [one.code for one in placement_warnings(sim, "robot", {})]


def test_its_own_oddities_are_told(sim):
    assert [code for code, _ in said(sim, cube("new", 9.0, moment=20.0))] == ["inertia-odd"]


def test_in_a_crowd_only_the_model_itself_is_looked_at(sim, monkeypatch):
    monkeypatch.setattr(spawn_advice, "NEIGHBOURS", 2)
    assert said(sim, cube("new", 4.5)) == []
    assert [code for code, _ in said(sim, cube("odd", 4.5, moment=20.0))] == ["inertia-odd"]


def test_a_pile_is_told_of_up_to_a_number_of_findings():
    pile = advice_issues([cube(f"c{n}", 3.0) for n in range(9)], {}, Written("w.world"))
    assert len(pile) == ADVICE_LIMIT + 1 and pile[-1].code == "advice-many"
    assert "check_model w.world" in pile[-1].hint


URDF = """<robot name="written">
  <link name="l">
    <inertial><mass value="1"/>
      <inertia ixx="20" ixy="0" ixz="0" iyy="20" iyz="0" izz="20"/></inertial>
    <collision name="c"><geometry><box size="1 1 1"/></geometry></collision>
  </link>
</robot>"""
SDF = """<sdf version="1.6">
  <model name="written">
    <link name="l">
      <inertial><mass>1</mass><inertia><ixx>20</ixx><iyy>20</iyy><izz>20</izz></inertia></inertial>
      <collision name="c">
        <geometry><box><size>1 1 1</size></box></geometry>
      </collision>
    </link>
  </model>
</sdf>"""


@pytest.mark.parametrize(("text", "link", "collision"), [
    (URDF, (2, "/robot/link"), (2, "/robot/link")),
    (SDF, (3, "/sdf/model/link"), (5, "/sdf/model/link/collision"))], ids=["URDF", "SDF"])
def test_advice_says_file_and_line_of_a_model_that_is_spawned_by_another_name(
        sim, text, link, collision):
    document = parse_document(text, Resolver(), "odd.file")
    entity, _ = document.read_entity()
    sim.models.spawn(replace(entity, name="new"), Pose((0, 0, 4.5)))
    found = {one.code: one for one in placement_warnings(
        sim, "new", {}, document.written(entity.name))}
    assert sorted(found) == ["inertia-odd", "starts-inside"]
    for code, where in (("inertia-odd", link), ("starts-inside", collision)):
        assert (found[code].file, found[code].line, found[code].xpath) == ("odd.file", *where)


def test_advice_gives_no_line_of_another_document(sim):
    """The link of the model that is met has the same name; its file is not the one at hand."""
    document = parse_document(URDF, Resolver(), "odd.file")
    entity, _ = document.read_entity()
    sim.models.spawn(replace(entity, name="new", static=True), Pose((0, 0, 4.5)))
    (met,) = (one for one in placement_warnings(sim, "new", {}, document.written(entity.name))
              if one.code == "starts-inside")
    assert (met.file, met.line) == ("odd.file", 0)
