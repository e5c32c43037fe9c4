"""Actors as the page gets them: their path, and where their skin can be had."""
from __future__ import annotations

import pytest

from my_simulations.description.actor import Actor, Animation, Trajectory, Waypoint
from my_simulations.description.plugin import PluginSpec
from my_simulations.editor.scene.scene_json import Documents
from my_simulations.editor.transport.http_pages import Pages
from my_simulations.editor.transport.protocol import Protocol
from my_simulations.geometry import Pose
from my_simulations.resources.resolver import Resolver


@pytest.fixture
def documents(tmp_path):
    (tmp_path / "models/man/meshes").mkdir(parents=True)
    (tmp_path / "models/man/meshes/man.dae").write_text("<COLLADA/>")
    return Documents(Resolver([str(tmp_path / "models")]))


def told(documents, actor):
    found = documents.actor(actor)
    Protocol.from_folder(Pages.own_folder()).types.check(found, "Actor", "actor")
    return found


def test_the_path_of_an_actor_is_told(documents):
    waypoints = [Waypoint(0.0, Pose((1.0, 0.0, 0.0))), Waypoint(2.0, Pose((3.0, 0.0, 0.0)))]
    found = told(documents, Actor("man", Pose((0.0, 0.0, 1.0)), loop=False, delay_start=1.5,
                                  trajectories=[Trajectory(4, "walk", 0.0, waypoints)]))
    assert found["pose"] == [0, 0, 1, 0, 0, 0, 1]
    assert (found["loop"], found["delay_start"], found["auto_start"]) == (False, 1.5, True)
    [trajectory] = found["trajectories"]
    assert trajectory["waypoints"][1] == {"time": 2.0, "pose": [3, 0, 0, 0, 0, 0, 1]}


def test_the_skin_is_served_like_a_mesh(documents, tmp_path):
    found = told(documents, Actor("man", skin="model://man/meshes/man.dae", skin_scale=2.0))
    geometry = found["geometry"]
    assert (geometry["type"], geometry["format"], geometry["scale"]) == ("mesh", "dae", [2, 2, 2])
    _, resource, root, inside = geometry["url"].split("/", 3)
    assert resource == "resource"
    assert documents.served.path(root, inside) == str(tmp_path / "models/man/meshes/man.dae")


def test_a_skin_beside_the_world_is_found(documents, tmp_path):
    (tmp_path / "walk.dae").write_text("<COLLADA/>")
    documents.served.add_root(str(tmp_path))
    found = told(documents, Actor("man", skin="walk.dae", base_dir=str(tmp_path)))
    assert found["geometry"]["url"].endswith("/walk.dae")


def test_a_missing_skin_is_told_with_its_name(documents):
    geometry = told(documents, Actor("man", skin="model://man/meshes/other.dae"))["geometry"]
    assert geometry["url"] is None and "model://man/meshes/other.dae" in geometry["problem"]


def test_an_actor_without_a_skin_has_no_shape(documents):
    assert told(documents, Actor("man"))["geometry"] == {"type": "empty"}


def test_the_files_of_animations_are_served_too(documents, tmp_path):
    (tmp_path / "run.bvh").write_text("HIERARCHY")
    documents.served.add_root(str(tmp_path))
    walk = Animation("walk", "model://man/meshes/man.dae")
    found = told(documents, Actor("man", animations=[walk, Animation("run", "run.bvh")],
                                  base_dir=str(tmp_path)))
    [first, second] = found["animations"]
    assert first["name"] == "walk" and first["geometry"]["url"].endswith("/man.dae")
    assert second["geometry"]["url"].endswith("/run.bvh")
    assert second["geometry"]["format"] == "bvh"


def test_an_actor_with_actor_plugin_is_told_with_the_script_of_its_walk(documents):
    found = told(documents, Actor(
        "man", animations=[Animation("walking")],
        plugins=[PluginSpec("walk", "libActorPlugin.so", "<plugin/>")]))
    (trajectory,) = found["trajectories"]
    assert trajectory["type"] == "walking" and len(trajectory["waypoints"]) > 100
