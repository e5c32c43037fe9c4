"""Writes scene, GUI, wind, atmosphere, place, roads and actors of a world. Source: SDF spec 1.7.

Each function writes its element below the given `<world>`, or nothing if all values are defaults.
"""
from __future__ import annotations

from typing import Any, List, Optional

from ....description.actor import Actor, Animation, Trajectory, Waypoint
from ....description.model import PluginSpec
from ....description.surroundings import (
    Atmosphere,
    Fog,
    Gui,
    GuiCamera,
    Road,
    Scene,
    Sky,
    SphericalCoordinates,
    Wind,
)
from ...xml.binding import Table
from ..world_tables import (
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
from .fields import fill_element, write_each
from .material_element import write_material
from .xml_text import append_fragment, parsed_fragment


def write_scene(parent: Any, scene: Scene) -> None:
    """`<scene>`."""
    if scene != Scene():
        fill_element(_element(parent, "scene"), scene, SCENE, {
            "sky": lambda at: _write_sky(at, scene.sky),
            "fog": lambda at: _write_fog(at, scene.fog),
        }, scene.extra, required=("ambient", "background", "shadows"))


def write_gui(parent: Any, gui: Gui, camera: Optional[GuiCamera]) -> None:
    """`<gui>` with its `<camera>`."""
    if camera is not None or gui != Gui():
        fill_element(_element(parent, "gui"), gui, GUI, {
            "camera": lambda at: _write_camera(at, camera),
            "plugin": lambda at: write_plugins(at, gui.plugins, GUI),
        }, gui.extra)


def write_wind(parent: Any, wind: Wind) -> None:
    """`<wind>`."""
    if wind != Wind():
        fill_element(_element(parent, "wind"), wind, WIND, {}, wind.extra,
                     required=("linear_velocity",))


def write_atmosphere(parent: Any, atmosphere: Atmosphere) -> None:
    """`<atmosphere>`."""
    if atmosphere != Atmosphere():
        fill_element(_element(parent, "atmosphere"), atmosphere, ATMOSPHERE, {}, atmosphere.extra,
                     required=("@type",))


def write_spherical_coordinates(parent: Any, place: Optional[SphericalCoordinates]) -> None:
    """`<spherical_coordinates>`."""
    if place is not None:
        fill_element(_element(parent, "spherical_coordinates"), place, SPHERICAL, {}, place.extra,
                     required=("surface_model", "latitude_deg", "longitude_deg", "elevation",
                               "heading_deg"))


def write_road(parent: Any, road: Road) -> None:
    """`<road>`."""
    fill_element(_element(parent, "road", road.name), road, ROAD, {
        "material": lambda at: write_material(at, road.material),
    }, road.extra, required=("width",))


def write_actor(parent: Any, actor: Actor) -> None:
    """`<actor>`, or the `<include>` that it was read from."""
    from lxml import etree

    if actor.include:
        parent.append(parsed_fragment(actor.include))
        return
    element = _element(parent, "actor", actor.name)
    fill_element(element, actor, ACTOR, {
        "animation": lambda at: write_each(_write_animation, at, actor.animations),
        "script/trajectory": lambda at: write_each(_write_trajectory, at, actor.trajectories),
        "plugin": lambda at: write_plugins(at, actor.plugins, ACTOR),
    }, actor.extra, required=("skin/filename",) if actor.skin else ())
    if element.find("script") is None:
        etree.SubElement(element, "script")  # required by the format


def write_plugins(parent: Any, plugins: List[PluginSpec], table: Table) -> None:
    """The `<plugin>` elements, as read."""
    for plugin in plugins:
        append_fragment(parent, plugin.xml, table)


def _write_sky(parent: Any, sky: Optional[Sky]) -> None:
    if sky is not None:
        fill_element(_element(parent, "sky"), sky, SKY, {}, sky.extra)


def _write_fog(parent: Any, fog: Optional[Fog]) -> None:
    if fog is not None:
        fill_element(_element(parent, "fog"), fog, FOG, {}, fog.extra, required=("type",))


def _write_camera(parent: Any, camera: Optional[GuiCamera]) -> None:
    if camera is not None:
        fill_element(_element(parent, "camera"), camera, GUI_CAMERA, {}, camera.extra,
                     required=("@name", "pose"))


def _write_animation(parent: Any, animation: Animation) -> None:
    fill_element(_element(parent, "animation", animation.name), animation, ANIMATION, {},
                 animation.extra, required=("filename",))


def _write_trajectory(parent: Any, trajectory: Trajectory) -> None:
    fill_element(_element(parent, "trajectory"), trajectory, TRAJECTORY, {
        "waypoint": lambda at: write_each(_write_waypoint, at, trajectory.waypoints),
    }, trajectory.extra, required=("@id", "@type"))


def _write_waypoint(parent: Any, waypoint: Waypoint) -> None:
    fill_element(_element(parent, "waypoint"), waypoint, WAYPOINT, {}, waypoint.extra,
                 required=("time", "pose"))


def _element(parent: Any, tag: str, name: Optional[str] = None) -> Any:
    from lxml import etree

    element = etree.SubElement(parent, tag)
    if name is not None:
        element.set("name", name)
    return element
