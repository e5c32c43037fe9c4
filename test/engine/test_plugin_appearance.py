"""Plugins that change lights and materials: cameras, other plugins and physics afterwards."""
from __future__ import annotations

import os

import numpy as np
import pytest

import my_simulations

PLUGIN = """
from dataclasses import replace

from my_simulations.description.shapes import Material
from my_simulations.plugins.base import Plugin
from my_simulations.plugins.context import PluginError

class Lamp(Plugin):
    def load(self):
        self.loaded = self.context.publish("loaded", "std_msgs/Float64")
        self.context.subscribe("colour", "std_msgs/ColorRGBA", self.paint)
        self.context.subscribe("sun", "std_msgs/Float64", self.shine)
        self.context.subscribe("wrong", "std_msgs/Float64", self.err)
        self.joint = self.context.joint("wheel")
        self.joint.drive(1.0, 10.0)
        self.age = 0
        self.context.every(100.0, self.tell)

    def tell(self):
        self.age += 1
        message = self.context.message("std_msgs/Float64")
        message.data = float(self.age)
        self.loaded.publish(message)

    def paint(self, message):
        colour = (message.r, message.g, message.b, 1.0)
        self.context.set_material("body", "shell", Material(ambient=colour, diffuse=colour))

    def shine(self, message):
        sun = self.context.lights()["sun"]
        self.context.set_light(replace(sun, diffuse=(message.data,) * 3 + (1.0,)))

    def err(self, message):
        for call in (lambda: self.context.set_material("body", "roof", Material()),
                     lambda: self.context.set_light(replace(
                         self.context.lights()["sun"], name="moon"))):
            try:
                call()
            except PluginError as fault:
                self.context.warn(str(fault))
"""
WORLD = """<sdf version="1.6"><world name="w"><include><uri>model://sun</uri></include>
<model name="lamp"><link name="body"><pose>0 0 0.5 0 0 0</pose>
<collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>
<visual name="shell"><geometry><box><size>1 1 1</size></box></geometry></visual></link>
<link name="arm"><pose>0 0 2 0 0 0</pose></link>
<joint name="held" type="fixed"><parent>world</parent><child>body</child></joint>
<joint name="wheel" type="revolute"><parent>body</parent><child>arm</child>
<axis><xyz>0 0 1</xyz></axis></joint>
<plugin name="p" filename="liblamp.so"/></model></world></sdf>"""


@pytest.fixture(params=[False, True], ids=["in the host", "isolated"])
def world(request, tmp_path, monkeypatch):
    (tmp_path / "lamp_of_test.py").write_text(PLUGIN)
    (tmp_path / "lamp.world").write_text(WORLD)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}")
    monkeypatch.syspath_prepend(str(tmp_path))
    with my_simulations.open_world(tmp_path / "lamp.world", isolate=request.param,
                                   plugins={"liblamp.so": "lamp_of_test:Lamp"}) as opened:
        yield opened


def seen(world):
    """The colour in the middle of a picture of the box."""
    picture = world.render((3.0, 1.0, 2.5), look_at=(0.0, 0.0, 0.5), width=32, height=24)
    return np.asarray(picture.rgb[12, 16], dtype=float)


def test_cameras_see_what_a_plugin_paints_and_lights(world):
    ages = world.topics["/loaded"]
    world.publish("/colour", {"r": 1.0, "g": 0.0, "b": 0.0})
    world.step(100)
    red = seen(world)
    assert red[0] > 100.0 and red[1] < 20.0 and red[2] < 20.0
    world.publish("/colour", {"r": 0.0, "g": 0.0, "b": 1.0})
    world.step(100)
    blue = seen(world)
    assert blue[2] > 100.0 and blue[0] < 20.0
    world.publish("/sun", {"data": 0.1})
    world.step(100)
    assert seen(world)[2] < 0.8 * blue[2]
    # The plugin goes on, and so does what it drives.
    assert ages.latest.data == pytest.approx(30.0, abs=1.0)
    assert world.joints().rate["lamp::wheel"] == pytest.approx(1.0, abs=1e-3)
    assert world.description("lamp").links[0].visuals[0].material.diffuse == (0.0, 0.0, 1.0, 1.0)


def test_a_visual_or_light_that_is_not_there_is_told(world):
    world.publish("/wrong", {"data": 0.0})
    world.step(100)
    told = " ".join(issue.message for issue in world.issues)
    assert "has no visual 'roof'; it has shell" in told and "unknown light 'moon'" in told
