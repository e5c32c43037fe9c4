"""Joints of nested models name links and joints in the scope that they get."""
from __future__ import annotations

from dataclasses import replace

from my_simulations.description.flatten import flatten_model
from my_simulations.description.model import Joint, JointAxis, Link, Mimic, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.unflatten import unflatten_model

INNER = Model("in", links=[Link("base"), Link("a"), Link("b")], joints=[
    Joint("ja", "revolute", "base", "a", axis=JointAxis()),
    Joint("jb", "revolute", "base", "b", axis=JointAxis(mimic=Mimic("ja", 2.0))),
    Joint("gears", "gearbox", "a", "b", axis=JointAxis(), axis2=JointAxis(),
          gearbox_reference="base"),
    Joint("to_world", "fixed", "world", "base")])
OUTER = Model("out", links=[Link("l")], models=[INNER])


def test_what_a_nested_joint_follows_and_measures_about_is_scoped():
    ja, jb, gears, to_world = flatten_model(OUTER).joints
    assert jb.axis.mimic.joint == ja.name == "in::ja"
    assert (gears.parent, gears.child, gears.gearbox_reference) == ("in::a", "in::b", "in::base")
    assert to_world.parent == "world"


def test_nested_joints_come_back_as_they_were():
    assert unflatten_model(flatten_model(OUTER)).models[0].joints == INNER.joints


def test_nested_models_without_links_stay():
    plugin = PluginSpec("p", "f.so", "<plugin name='p' filename='f.so'/>")
    empty = Model("empty", plugins=[plugin], models=[Model("deeper")])
    for models in ([empty], [INNER, empty]):
        whole = replace(OUTER, models=models)
        assert unflatten_model(flatten_model(whole)) == whole


def test_a_nested_model_that_lost_its_links_goes():
    flat = flatten_model(OUTER)
    left = unflatten_model(replace(flat, links=flat.links[:1], joints=[]))
    assert left.models == []
