"""Reads GUI, roads and actors of a world; `world_tables.SURROUNDINGS` has the rest."""
from __future__ import annotations

from typing import Any

from ...description.actor import Actor
from ...description.surroundings import GuiCamera, Road
from ...description.world import World
from ..xml.binding import Found, fill
from ..xml.source import Source
from .collision_visual import fill_material
from .plugin import read_plugin
from .world_tables import ACTOR, GUI, GUI_CAMERA, ROAD


def read_surroundings(found: Found, world: World, source: Source) -> None:
    """Set the world's GUI, roads and actors. Source: SDF spec 1.7, world."""
    for element in found.get("gui", ()):
        inside = fill(world.gui, element, GUI, source, world.gui.extra)
        world.gui.plugins += [read_plugin(plugin, source) for plugin in inside.get("plugin", ())]
        for camera in inside.get("camera", ()):
            world.gui_camera = GuiCamera()
            fill(world.gui_camera, camera, GUI_CAMERA, source, world.gui_camera.extra)
    world.roads += [_read_road(element, source) for element in found.get("road", ())]
    world.actors += [read_actor(element, source) for element in found.get("actor", ())]


def _read_road(element: Any, source: Source) -> Road:
    road = Road(element.get("name", ""))
    for material in fill(road, element, ROAD, source, road.extra).get("material", ()):
        road.material = fill_material(material, source, road.extra)
    return road


def read_actor(element: Any, source: Source) -> Actor:
    """An actor with its trajectories; drawn, not simulated. Source: SDF spec 1.7, actor."""
    actor = Actor(element.get("name", ""), base_dir=source.base_dir)
    found = fill(actor, element, ACTOR, source, actor.extra)
    actor.plugins = [read_plugin(plugin, source) for plugin in found.get("plugin", ())]
    actor.trajectories.sort(key=lambda trajectory: trajectory.id)
    return actor
