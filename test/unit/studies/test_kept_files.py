"""Reading worlds and models once."""
from __future__ import annotations

import os

import pytest

from my_simulations.errors import InputError
from my_simulations.python_api import WorldChoice
from my_simulations.python_api.kept_files import FileCache
from my_simulations.resources.resolver import Resolver

BOX = """<sdf version="1.7"><model name="box"><link name="link"><collision name="c">
<geometry><box><size>{0} 1 1</size></box></geometry></collision></link></model></sdf>"""
WORLD = """<sdf version="1.7"><world name="w">
<model name="box"><static>1</static><link name="l"/></model>{}</world></sdf>"""
POPULATION = """<population name="p"><model name="can"><link name="l"/></model>
<pose>0 0 0 0 0 0</pose><box><size>9 9 1</size></box><model_count>2</model_count>
<distribution><type>random</type></distribution></population>"""


def files(keep):
    return FileCache(Resolver.from_environment(), keep)


def silent(issue):
    """Ignore an issue."""


def test_a_kept_world_is_read_once_and_given_as_copies(tmp_path):
    path = tmp_path / "w.world"
    path.write_text(WORLD.format(""))
    kept, fresh, choice = files(4), files(0), WorldChoice(str(path))
    first = kept.world(choice, silent).world
    assert fresh.world(choice, silent).world == first
    path.write_text(WORLD.format("<model name='more'><link name='l'/></model>"))
    again = kept.world(choice, silent).world
    assert again == first and again is not first and again.models[0] is not first.models[0]
    again.models.clear()
    assert [model.name for model in kept.world(choice, silent).world.models] == ["box"]
    assert len(fresh.world(choice, silent).world.models) == 2


def test_issues_are_told_each_time(tmp_path):
    path = tmp_path / "w.world"
    path.write_text(WORLD.format("<nonsense/>"))
    kept, told = files(4), []
    for _ in range(2):
        kept.world(WorldChoice(str(path)), told.append)
    assert told and len(told) % 2 == 0 and told[:len(told) // 2] == told[len(told) // 2:]


def test_the_seed_places_populations_anew(tmp_path):
    path = tmp_path / "w.world"
    path.write_text(WORLD.format(POPULATION))
    kept = files(8)
    places = [[model.pose.position for model in
               kept.world(WorldChoice(str(path), seed=seed), silent).world.models]
              for seed in (1, 2, 1)]
    assert places[0] == places[2] != places[1]


def test_models_are_read_once(tmp_path):
    path = tmp_path / "box.sdf"
    path.write_text(BOX.format(1))
    kept = files(8)
    first = kept.model(str(path))[0]
    path.write_text(BOX.format(2))
    assert kept.model(str(path))[0] == first != files(0).model(str(path))[0]
    text = BOX.format(3)
    assert kept.model(text)[0] == files(0).model(text)[0]


def test_no_more_is_kept_than_was_asked_for(tmp_path):
    kept = files(2)
    for size in range(5):
        kept.model(BOX.format(size + 1))
    assert len(kept._kept) == 2


def test_what_cannot_be_read_is_told_each_time(tmp_path):
    kept = files(4)
    for _ in range(2):
        with pytest.raises(InputError):
            kept.model(os.path.join(str(tmp_path), "nothing.sdf"))
