"""Reads surroundings and actors of a world: scene, GUI, wind, atmosphere, place, roads, actors."""
from __future__ import annotations

from typing import Any, List

from ...description.actor import Actor, Animation, Trajectory, Waypoint
from ...description.surroundings import Fog, GuiCamera, Road, Scene, Sky, SphericalCoordinates
from ...description.world import World
from ..xml.binding import Found, fill
from ..xml.source import Source
from .collision_visual import fill_material
from .plugin import read_plugin
from .world_tables import (
    ACTOR,
    ANIMATION,
    ATMOSPHERE,
    FOG,
    GUI,
    GUI_CAMERA,
    ROAD,
    SCENE,
    SKY,
    SPHERICAL,
    TRAJECTORY,
    WAYPOINT,
    WIND,
)


def read_surroundings(found: Found, world: World, source: Source) -> None:
    """Set the world's fields from `scene` to `roads`. Source: SDF spec 1.7, world."""
    for element in found.get("scene", ()):
        _read_scene(element, world.scene, source)
    for element in found.get("gui", ()):
        inside = fill(world.gui, element, GUI, source, world.gui.extra)
        world.gui.plugins += [read_plugin(plugin, source) for plugin in inside.get("plugin", ())]
        for camera in inside.get("camera", ()):
            world.gui_camera = GuiCamera()
            fill(world.gui_camera, camera, GUI_CAMERA, source, world.gui_camera.extra)
    for element in found.get("wind", ()):
        fill(world.wind, element, WIND, source, world.wind.extra)
    for element in found.get("atmosphere", ()):
        fill(world.atmosphere, element, ATMOSPHERE, source, world.atmosphere.extra)
    for element in found.get("spherical_coordinates", ()):
        place = world.spherical_coordinates = SphericalCoordinates()
        fill(place, element, SPHERICAL, source, place.extra)
    world.roads += [_read_road(element, source) for element in found.get("road", ())]
    world.actors += [read_actor(element, source) for element in found.get("actor", ())]


def _read_scene(element: Any, scene: Scene, source: Source) -> None:
    found = fill(scene, element, SCENE, source, scene.extra)
    for child in found.get("sky", ()):
        scene.sky = Sky()
        fill(scene.sky, child, SKY, source, scene.sky.extra)
    for child in found.get("fog", ()):
        scene.fog = Fog()
        fill(scene.fog, child, FOG, source, scene.fog.extra)


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
    for child in found.get("animation", ()):
        animation = Animation(child.get("name", ""))
        fill(animation, child, ANIMATION, source, animation.extra)
        actor.animations.append(animation)
    actor.trajectories = _read_trajectories(found.get("trajectory", []), source)
    return actor


def _read_trajectories(elements: List[Any], source: Source) -> List[Trajectory]:
    trajectories: List[Trajectory] = []
    for element in elements:
        trajectory = Trajectory()
        found = fill(trajectory, element, TRAJECTORY, source, trajectory.extra)
        for child in found.get("waypoint", ()):
            waypoint = Waypoint()
            fill(waypoint, child, WAYPOINT, source, waypoint.extra)
            trajectory.waypoints.append(waypoint)
        trajectories.append(trajectory)
    return sorted(trajectories, key=lambda trajectory: trajectory.id)
