"""What a world shows or tells without moving: scene, view, weather, place, roads, actors."""
from __future__ import annotations

from typing import Any, List

from ...description.world import (
    Actor,
    Animation,
    Fog,
    GuiCamera,
    Road,
    Sky,
    SphericalCoordinates,
    Trajectory,
    Waypoint,
    World,
)
from ..xml.binding import Found, fill
from ..xml.source import Source
from .collision_visual import fill_material
from .sensor import read_plugin
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
    """Fill the world's fields from `scene` to `roads`. Source: SDF spec 1.7, world."""
    for element in found.get("scene", ()):
        _scene(element, world, source)
    for element in found.get("gui", ()):
        for camera in fill(GuiCamera(), element, GUI, source, []).get("camera", ()):
            world.gui_camera = GuiCamera()
            fill(world.gui_camera, camera, GUI_CAMERA, source, [])
    for element in found.get("wind", ()):
        fill(world.wind, element, WIND, source, [])
    for element in found.get("atmosphere", ()):
        fill(world.atmosphere, element, ATMOSPHERE, source, [])
    for element in found.get("spherical_coordinates", ()):
        world.spherical_coordinates = SphericalCoordinates()
        fill(world.spherical_coordinates, element, SPHERICAL, source, [])
    world.roads += [_road(element, source) for element in found.get("road", ())]
    world.actors += [read_actor(element, source) for element in found.get("actor", ())]


def _scene(element: Any, world: World, source: Source) -> None:
    found = fill(world.scene, element, SCENE, source, [])
    for child in found.get("sky", ()):
        world.scene.sky = Sky()
        fill(world.scene.sky, child, SKY, source, [])
    for child in found.get("fog", ()):
        world.scene.fog = Fog()
        fill(world.scene.fog, child, FOG, source, [])


def _road(element: Any, source: Source) -> Road:
    road = Road(element.get("name", ""))
    for material in fill(road, element, ROAD, source, []).get("material", ()):
        road.material = fill_material(material, source, [])
    return road


def read_actor(element: Any, source: Source) -> Actor:
    """An actor: who walks where; nothing of it is simulated. Source: SDF spec 1.7, actor."""
    actor = Actor(element.get("name", ""), base_dir=source.base_dir)
    found = fill(actor, element, ACTOR, source, [])
    actor.plugins = [read_plugin(plugin, source) for plugin in found.get("plugin", ())]
    for child in found.get("animation", ()):
        animation = Animation(child.get("name", ""))
        fill(animation, child, ANIMATION, source, [])
        actor.animations.append(animation)
    actor.trajectories = _trajectories(found.get("trajectory", []), source)
    return actor


def _trajectories(elements: List[Any], source: Source) -> List[Trajectory]:
    trajectories: List[Trajectory] = []
    for element in elements:
        trajectory = Trajectory()
        for child in fill(trajectory, element, TRAJECTORY, source, []).get("waypoint", ()):
            waypoint = Waypoint()
            fill(waypoint, child, WAYPOINT, source, [])
            trajectory.waypoints.append(waypoint)
        trajectories.append(trajectory)
    return sorted(trajectories, key=lambda trajectory: trajectory.id)
