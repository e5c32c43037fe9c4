"""Operations of the model editor: parts of a model come, go and change."""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Callable, Dict, List, Optional, Tuple

from ...description.compare import BUILT_IN
from ...description.model import WORLD, Joint, Link, Model
from ...description.plugin import PluginSpec
from ...description.shapes import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Material,
    Mesh,
    Polyline,
    Sphere,
)
from ...errors import CommandError, Issue
from ...geometry import IDENTITY, Pose, compose, inverse, normalised
from ...resources.resolver import Resolver, ResourceNotFoundError
from ...simulator.operations import AddModel, EditModel, Operation, SetWorldPlugins
from ...simulator.simulator import Simulator
from ..scene.plain_json import pose_of as pose_from
from ..scene.scene_json import NAMES
from . import model_parts as parts
from .inserts import check_meshes, entity_of_text, entity_of_uri, shape_material, used_names
from .model_parts import free_name
from .part_inertia import inertial_of
from .property_path import dataclass_from_json
from .property_target import split_target
from .sensor_edits import sensor_of, with_new_sensor, without_sensor

Planned = Tuple[str, Operation, Dict[str, Any]]
NEW_MODEL = "untitled"
_MOST_CORNERS = 5000

_SHAPES: Dict[str, Geometry] = {
    "box": Box((1.0, 1.0, 1.0)), "sphere": Sphere(0.5), "cylinder": Cylinder(0.5, 1.0),
    "capsule": Capsule(0.25, 0.5), "cone": Cone(0.5, 1.0), "ellipsoid": Ellipsoid((0.5, 0.4, 0.3)),
}


class ModelBuilding:
    """Plans the operations `add_link`, `add_joint` and so on; see the protocol.

    Args:
        simulator: has the models.
        resolver: finds meshes and models.
        report: receives warnings.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver,
                 report: Callable[[Issue], None]) -> None:
        self._world = simulator
        self._resolver = resolver
        self._report = report

    def planners(self) -> Dict[str, Callable[[Dict[str, Any]], Planned]]:
        """By kind of operation. They raise CommandError, InputError."""
        return {"add_link": self._add_link, "add_shape": self._add_shape,
                "add_joint": self._add_joint, "edit_joint": self._edit_joint,
                "add_model": self._add_model, "remove_part": self._remove,
                "copy_link": self._copy_link, "rename_link": self._rename_link,
                "set_plugins": self._set_plugins,
                "add_sensor": self._add_sensor,
                "compute_inertial": self._compute_inertial}

    # -- links and shapes ------------------------------------------------------------------------

    def _add_link(self, op: Dict[str, Any]) -> Planned:
        pose = _pose(op) or IDENTITY
        geometry = self._geometry(op)
        if not op.get("model"):
            return self._new_model(geometry, pose)
        model = self._world.models.get(op["model"])
        name = parts.numbered_name("link", parts.part_names(model))
        link = _solid_link(name, geometry, self._in_model(model, pose))
        return self._plan_edit(f"Add {name} to {model.name}", model,
                               replace(model, links=[*model.links, link]), f"{model.name}::{name}")

    def _new_model(self, geometry: Geometry, pose: Pose) -> Planned:
        name = free_name(NEW_MODEL, used_names(self._world))
        x, y, z = pose.position
        place = Pose((x, y, 0.0))
        link = _solid_link("link_0", geometry, Pose((0.0, 0.0, z), pose.orientation))
        model = Model(name, place, links=[link])
        return (f"Begin model {name}", AddModel(model, place, self._check_model(model)),
                {"name": f"{name}::link_0"})

    def _add_shape(self, op: Dict[str, Any]) -> Planned:
        model, link = self._link(op["link"])
        geometry = self._geometry(op)
        changed = parts.with_shape(link, geometry, _material(geometry), op["part"])
        return self._plan_edit(f"Add {op['part']} to {op['link']}", model,
                               _with_link(model, link, changed), op["link"])

    def _geometry(self, op: Dict[str, Any]) -> Geometry:
        if sum(bool(op.get(name)) for name in ("shape", "uri", "polyline")) != 1:
            raise CommandError("a shape needs exactly one of shape, uri and polyline")
        if op.get("polyline"):
            return _polyline(op["polyline"])
        if op.get("shape"):
            return _SHAPES[op["shape"]]
        try:
            return Mesh(uri=op["uri"], path=self._resolver.resolve(op["uri"]))
        except ResourceNotFoundError as missing:
            raise CommandError(str(missing)) from missing

    def _copy_link(self, op: Dict[str, Any]) -> Planned:
        model, link = self._link(op["link"])
        name = free_name(f"{link.name}_clone", parts.part_names(model))
        copied = replace(link, name=name, pose=self._in_model(model, _pose(op) or IDENTITY))
        return self._plan_edit(f"Copy {op['link']}", model,
                               replace(model, links=[*model.links, copied]),
                               f"{model.name}::{name}")

    def _rename_link(self, op: Dict[str, Any]) -> Planned:
        model, link = self._link(op["link"])
        to = op["to"].strip()
        return self._plan_edit(f"Rename {op['link']} to {to}", model,
                               parts.with_link_renamed(model, link.name, to), f"{model.name}::{to}")

    def _compute_inertial(self, op: Dict[str, Any]) -> Planned:
        model, rest = split_target(self._world, op["target"])
        density = op.get("density")
        links: List[Link] = []
        for link in model.links:
            if rest in ("", link.name) and (rest or link.collisions):
                link = replace(link, inertial=inertial_of(
                    link.collisions, density=density, mass=link.inertial.mass))
            links.append(link)
        if rest and all(link.name != rest for link in links):
            raise CommandError(f"model {model.name!r} has no link {rest!r}")
        return self._plan_edit(f"Compute inertia of {op['target']}", model,
                               replace(model, links=links), op["target"])

    # -- joints ----------------------------------------------------------------------------------

    def _add_joint(self, op: Dict[str, Any]) -> Planned:
        model = self._world.models.get(op["model"])
        joint = dataclass_from_json(Joint, {"name": "", **op["joint"]})
        self._ends_exist(model, joint)
        changed = parts.with_joint(model, joint)
        name = changed.joints[-1].name
        return self._plan_edit(f"Connect {joint.parent} to {joint.child} by {name}", model, changed,
                               f"{model.name}::{name}")

    def _edit_joint(self, op: Dict[str, Any]) -> Planned:
        model, rest = split_target(self._world, op["joint"])
        old = next((one for one in model.joints if one.name == rest), None)
        if old is None:
            raise CommandError(f"model {model.name!r} has no joint {rest!r}")
        new = dataclass_from_json(Joint, op["values"], old)
        if new.name != old.name and (not new.name or new.name in parts.part_names(model)):
            raise CommandError(f"{new.name!r} is not a free name in model {model.name!r}")
        self._ends_exist(model, new)
        return self._plan_edit(f"Edit joint {op['joint']}", model,
                               parts.with_changed_joint(model, old, new),
                               f"{model.name}::{new.name}")

    @staticmethod
    def _ends_exist(model: Model, joint: Joint) -> None:
        links = [link.name for link in model.links]
        for end, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links and not (end == "parent" and name == WORLD):
                raise CommandError(f"model {model.name!r} has no link {name!r} to be the {end}"
                                   " of a joint")

    # -- models and plugins ----------------------------------------------------------------------

    def _add_model(self, op: Dict[str, Any]) -> Planned:
        model = self._world.models.get(op["model"])
        nested, issues = entity_of_uri(op["uri"], self._resolver)
        for issue in issues:
            self._report(issue)
        if not isinstance(nested, Model):
            raise CommandError(f"{op['uri']} is no model")
        taken = parts.part_names(model)
        name = free_name(nested.name, taken)
        pose = _pose(op) or nested.pose
        changed = parts.with_nested(model, replace(nested, name=name,
                                                   pose=self._in_model(model, pose)))
        return self._plan_edit(f"Add {name} to {model.name}", model, changed, model.name)

    def _set_plugins(self, op: Dict[str, Any]) -> Planned:
        plugins = self._plugins_of(op["text"])
        if not op["model"]:
            return "Set plugins of the world", SetWorldPlugins(tuple(plugins)), {}
        model = self._world.models.get(op["model"])
        return self._plan_edit(f"Set plugins of {model.name}", model,
                               replace(model, plugins=plugins), model.name)

    def _plugins_of(self, elements: str) -> List[PluginSpec]:
        """Read `<plugin>` elements. Raises CommandError, InputError."""
        text = ('<sdf version="1.7"><model name="plugins"><link name="link"/>\n'
                f"{elements}\n</model></sdf>")
        _check_xml(text)
        found, issues = entity_of_text(text, self._resolver)
        for issue in issues:
            self._report(issue)
        if not isinstance(found, Model) or len(found.links) != 1 or found.joints or found.models \
                or found.extra:
            raise CommandError("the text must contain <plugin> elements only")
        names = [plugin.name for plugin in found.plugins]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise CommandError(f"two plugins are called {twice!r}")
        return found.plugins

    def _remove(self, op: Dict[str, Any]) -> Planned:
        model, rest = split_target(self._world, op["target"])
        if not rest:
            raise CommandError(f"{op['target']} is a whole model")
        left = without_sensor(model, rest) if sensor_of(rest) else parts.without_part(model, rest)
        return self._plan_edit(f"Remove {op['target']}", model, left, model.name)

    def _add_sensor(self, op: Dict[str, Any]) -> Planned:
        model, rest = split_target(self._world, op["link"])
        changed, name = with_new_sensor(model, rest, op["sensor"], self._resolver)
        return self._plan_edit(f"Add {name} to {op['link']}", model, changed, op["link"])

    # -- common ----------------------------------------------------------------------------------

    def _link(self, target: str) -> Tuple[Model, Link]:
        model, rest = split_target(self._world, target)
        link = next((one for one in model.links if one.name == rest), None)
        if link is None:
            raise CommandError(f"model {model.name!r} has no link {rest!r}")
        return model, link

    def _in_model(self, model: Model, pose: Pose) -> Pose:
        """A world pose in the frame of a model as it stands."""
        return compose(inverse(self._world.states.model_state(model.name)[0]), pose)

    def _check_model(self, model: Model) -> Any:
        meshes, issues = check_meshes(model)
        for issue in issues:
            self._report(issue)
        return meshes

    def _plan_edit(self, label: str, old: Model, new: Model, name: str) -> Planned:
        return label, EditModel(old.name, new, self._check_model(new)), {"name": name}


def _check_xml(text: str) -> None:
    """Raise CommandError for text that is no XML: only files are repaired, as Gazebo does."""
    from lxml import etree

    try:
        etree.fromstring(text, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as fault:
        # The first line is ours.
        line, _ = fault.position
        raise CommandError(f"line {max(line - 1, 1)}: {fault.msg}") from None


def _pose(op: Dict[str, Any]) -> Optional[Pose]:
    """The pose of an operation with a unit quaternion; None without one."""
    if not op.get("pose"):
        return None
    pose = pose_from(op["pose"])
    return Pose(pose.position, normalised(pose.orientation))


def _material(geometry: Geometry) -> Optional[Material]:
    """The color of a new shape; None for a mesh, whose file has its own."""
    if isinstance(geometry, Mesh):
        return None
    if isinstance(geometry, Polyline):
        return Material(script_uris=[BUILT_IN], script_name="Gazebo/Grey")
    return shape_material(NAMES[type(geometry)])


def _solid_link(name: str, geometry: Geometry, pose: Pose) -> Link:
    """A link of 1 kg."""
    link = parts.with_shape(Link(name, pose), geometry, _material(geometry))
    return replace(link, inertial=inertial_of(link.collisions, mass=1.0))


def _polyline(given: Dict[str, Any]) -> Polyline:
    """An extruded outline. Raises CommandError."""
    shape = dataclass_from_json(Polyline, given)
    corners = sum(map(len, shape.loops))
    if not shape.loops or min(map(len, shape.loops)) < 3 or corners > _MOST_CORNERS:
        raise CommandError("a polyline needs outlines of at least 3 corners, and has at most "
                           f"{_MOST_CORNERS} corners; found {corners}")
    return shape


def _with_link(model: Model, old: Link, new: Link) -> Model:
    return replace(model, links=[new if one is old else one for one in model.links])
