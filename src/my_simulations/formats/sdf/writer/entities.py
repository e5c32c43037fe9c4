"""Writes a description as SDF 1.7, by the readers' tables.

Values equal to the format's defaults are omitted unless required. Numbers are written as the
shortest text that reads back as the same double. Kept XML returns to its original place. Equal
descriptions give equal bytes. Source: SDF specification 1.7.
"""
from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import Any, Callable, Dict, Iterable, Iterator, List, Optional, Tuple, Union

from lxml import etree

from ....description.compare import differences
from ....description.light import Light
from ....description.model import Joint, JointAxis, Link, Mimic, Model, PluginSpec
from ....description.saved_state import SavedState
from ....description.shapes import Collision, Geometry, Polyline, Visual
from ....description.world import World
from ....errors import CommandError
from ....geometry import Vec3
from ...xml.binding import has_prefix
from ...xml.tables import Table
from ...xml.values import FLOAT, TEXT, VECTOR2, VECTOR3
from ..model_tables import (
    AXIS,
    COLLISION,
    GEOMETRIES,
    INCLUDE,
    INERTIAL,
    JOINT,
    LIGHT,
    LINK,
    MODEL,
    PHYSICS,
    VISUAL,
    WORLD,
)
from .fields import fill_element, write_each
from .material_element import write_material
from .state_element import write_state
from .surroundings_elements import write_actor, write_gui, write_plugins, write_road
from .xml_text import serialize_sdf, write_value

VERSION = "1.7"
_OLDER = "1.6"

IsPlainInclude = Callable[[Model], Optional[Model]]
"""Returns the model that the URI of an included model refers to now; None if unknown. A model that
differs from it only in name, pose, static, added plugins and elements with a prefix is written
as an `<include>`."""


def write_world(world: World, state: Optional[SavedState] = None,
                included: Optional[IsPlainInclude] = None) -> bytes:
    """A whole document with one world.

    Args:
        world: the description.
        state: a `<state>` to add.
        included: called for each included model, to write it as an `<include>` if possible; None
            writes all models in full.

    Returns:
        UTF-8 text with an XML declaration.

    Raises:
        CommandError: a text that XML cannot hold; the message names the model or light.
    """
    writer = _Writer(included)
    with _naming("the world"):
        return serialize_sdf(_version(world.models), lambda root: writer.world(root, world, state))


def write_entity(entity: Union[Model, Light]) -> bytes:
    """A whole document with one model or light, in full; UTF-8, with an XML declaration.

    `reading.read_entity` reads it as an equal object. Relative URIs are written as absolute paths,
    so that the document does not depend on its location. Raises
    CommandError, as `write_world`.
    """
    writer = _Writer(None)
    if isinstance(entity, Light):
        light = entity
        return serialize_sdf(VERSION, lambda root: writer.light(root, light))
    model = entity
    return serialize_sdf(_version([model]), lambda root: writer.model(root, model))


def _version(models: Iterable[Model]) -> str:
    """The newest SDF version that allows the names in the models.

    From 1.7 on a joint and a link of one model cannot have the same name. The written elements have
    the same meaning in 1.6, where joint axes are in the joint frame, too.
    """
    return _OLDER if any(_has_namesakes(model) for model in models) else VERSION


def _has_namesakes(model: Model) -> bool:
    others = {link.name for link in model.links} | {inner.name for inner in model.models}
    return any(joint.name in others for joint in model.joints) or any(
        map(_has_namesakes, model.models))


class _Writer:
    """Writes elements below lxml elements; one method for each element with its own reader."""

    def __init__(self, included: Optional[IsPlainInclude]) -> None:
        self._included = included

    def world(self, parent: Any, world: World, state: Optional[SavedState]) -> None:
        """`<world>`; `state` replaces a `<state>` that was read."""
        element = _element(parent, "world", world)
        fill_element(element, world, WORLD, {
            "physics": lambda at: self.physics(at, world.physics),
            "light": lambda at: write_each(self.light, at, world.lights),
            "model": lambda at: write_each(self.model_or_include, at, world.models),
            "plugin": lambda at: write_plugins(at, world.plugins, WORLD),
            "joint": lambda at: write_each(self.joint, at, world.joints),
            "gui": lambda at: write_gui(at, world.gui, world.gui_camera),
            "actor": lambda at: write_each(write_actor, at, world.actors),
            "road": lambda at: write_each(write_road, at, world.roads),
        }, world.extra, required=("gravity",))
        state = state or world.state
        if state is not None:
            write_state(element, state, self.model, self.light)

    def physics(self, parent: Any, physics: Any) -> None:
        """`<physics>`, the preset in use."""
        element = _element(parent, "physics", physics)
        fill_element(element, physics, PHYSICS, {}, [],
                     required=("@name", "@type", "max_step_size", "real_time_factor",
                               "real_time_update_rate"))

    def light(self, parent: Any, light: Light) -> None:
        with _naming(f"light {light.name!r}"):
            element = _element(parent, "light", light)
            fill_element(element, light, LIGHT, {}, light.extra, required=("@type",))

    def model_or_include(self, parent: Any, model: Model) -> None:
        """`<model>`, or the `<include>` of an unchanged included model."""
        bare = self._included(model) if self._included is not None and model.uri else None
        added = _find_additions(model, bare) if bare is not None else None
        if bare is None or added is None:
            self.model(parent, model)
            return
        plugins, extra = added
        element = _element(parent, "include", None)
        fill_element(element, model, INCLUDE, {
            "plugin": lambda at: write_plugins(at, plugins, INCLUDE),
        }, extra, required=("uri", "name", "pose", *(
            ("static",) if model.static != bare.static else ())),
            leave_out=() if model.static != bare.static else ("static",))

    def model(self, parent: Any, model: Model) -> None:
        with _naming(f"model {model.name!r}"):
            element = _element(parent, "model", model)
            fill_element(element, model, MODEL, {
                "link": lambda at: write_each(self.link, at, model.links),
                "joint": lambda at: write_each(self.joint, at, model.joints),
                "model": lambda at: write_each(self.model_or_include, at, model.models),
                "plugin": lambda at: write_plugins(at, model.plugins, MODEL),
            }, model.extra)

    def link(self, parent: Any, link: Link) -> None:
        element = _element(parent, "link", link)
        fill_element(element, link, LINK, {
            "inertial": lambda at: self.inertial(at, link),
            "collision": lambda at: write_each(self.collision, at, link.collisions),
            "visual": lambda at: write_each(self.visual, at, link.visuals),
        }, link.extra)

    def inertial(self, parent: Any, link: Link) -> None:
        """`<inertial>`; omitted if it has default values."""
        element = etree.SubElement(parent, "inertial")
        fill_element(element, link.inertial, INERTIAL, {}, [])
        if not len(element):
            parent.remove(element)

    def collision(self, parent: Any, collision: Collision) -> None:
        element = _element(parent, "collision", collision)
        fill_element(element, collision, COLLISION, {
            "geometry": lambda at: write_geometry(at, collision.geometry),
        }, collision.extra)

    def visual(self, parent: Any, visual: Visual) -> None:
        element = _element(parent, "visual", visual)
        fill_element(element, visual, VISUAL, {
            "geometry": lambda at: write_geometry(at, visual.geometry),
            "material": lambda at: write_material(at, visual.material),
        }, visual.extra)

    def joint(self, parent: Any, joint: Joint) -> None:
        element = _element(parent, "joint", joint)
        element.set("type", joint.type)
        fill_element(element, joint, JOINT, {
            "axis": lambda at: self.axis(at, "axis", joint.axis),
            "axis2": lambda at: self.axis(at, "axis2", joint.axis2),
        }, joint.extra, required=("parent", "child"))

    def axis(self, parent: Any, tag: str, axis: Optional[JointAxis]) -> None:
        """`<axis>` or `<axis2>`; the direction is in the joint frame."""
        if axis is not None:
            element = _element(parent, tag, None)
            fill_element(element, axis, AXIS, {
                "xyz": lambda at: write_value(at, "xyz", VECTOR3, _direction(axis.xyz)),
                "mimic": lambda at: self.mimic(at, axis.mimic),
            }, [])

    def mimic(self, parent: Any, mimic: Optional[Mimic]) -> None:
        """`<mimic>` (SDF 1.11; older readers ignore it)."""
        if mimic is not None:
            element = etree.SubElement(parent, "mimic", joint=mimic.joint)
            write_value(element, "multiplier", FLOAT, mimic.multiplier)
            write_value(element, "offset", FLOAT, mimic.offset)


@contextlib.contextmanager
def _naming(what: str) -> Iterator[None]:
    """Say what it was that lxml refused to write: a text with characters that XML cannot hold."""
    try:
        yield
    except ValueError as fault:
        raise CommandError(f"{what} cannot be written: {fault}") from fault


def _element(parent: Any, tag: str, named: Any) -> Any:
    element = etree.SubElement(parent, tag)
    if named is not None and hasattr(named, "name"):
        element.set("name", named.name)
    return element


def _direction(xyz: Vec3) -> Vec3:
    """A unit vector that keeps its text when it is read and normalised again."""
    return (round(xyz[0], 14), round(xyz[1], 14), round(xyz[2], 14))


def _find_additions(model: Model, bare: Model) -> Optional[Tuple[List[PluginSpec], List[str]]]:
    """The plugins and XML that an include adds to its model; None if more than that differs."""
    kept = model.plugins[:len(bare.plugins)]
    extra = [xml for xml in model.extra if has_prefix(xml) and xml not in bare.extra]
    as_bare = replace(model, name=bare.name, pose=bare.pose, static=bare.static, uri=bare.uri,
                      plugins=kept, extra=[xml for xml in model.extra if xml not in extra])
    if differences(as_bare, bare):
        return None
    return model.plugins[len(bare.plugins):], extra


def write_geometry(parent: Any, geometry: Geometry) -> None:
    """`<geometry>` with one shape, sizes included even if they are the defaults.

    A relative URI, which is valid in its own file only, is replaced by the absolute path it
    resolved to; `model://`, `package://` and `file://` URIs are kept (Gazebo behaviour).
    """
    holder = etree.SubElement(parent, "geometry")
    if isinstance(geometry, Polyline):
        _write_polyline(holder, geometry)
        return
    table = tables_by_shape()[type(geometry)]
    element = etree.SubElement(holder, table.name)
    needed = tuple(path for path, value, _ in table.values() if path in _ALWAYS)
    fill_element(element, geometry, table, {}, getattr(geometry, "extra", []), required=needed,
                 leave_out=("uri", "filename"))
    if hasattr(geometry, "uri"):
        write_value(element, "uri", TEXT, uri_of(geometry))
        element.insert(0, element[-1])


_ALWAYS = ("size", "radius", "length", "normal", "radii")


def tables_by_shape() -> Dict[Any, Table]:
    return {table.of: table for table in GEOMETRIES.values()}


def uri_of(geometry: Any) -> str:
    """A URI that does not depend on the location of the file."""
    uri: str = geometry.uri
    if "://" in uri or not geometry.path:
        return uri
    return str(geometry.path)


def _write_polyline(holder: Any, polyline: Polyline) -> None:
    for loop in polyline.loops:
        element = etree.SubElement(holder, "polyline")
        for point in loop:
            write_value(element, "point", VECTOR2, point)
        write_value(element, "height", FLOAT, polyline.height)
