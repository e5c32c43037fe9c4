"""The world as the page gets it: the description as JSON, with present poses and URLs."""
from __future__ import annotations

import os
from typing import Any, Dict, List, Optional, Sequence, Union

from ...appearance import materials
from ...appearance.looks import Look
from ...appearance.mesh_formats import MOVEMENTS, PAGE_FORMATS
from ...description.actor import Actor
from ...description.light import Light
from ...description.model import Joint, Link, Model
from ...description.model_group import group_of
from ...description.picture_size import picture_size_of
from ...description.random_walk import with_random_walk
from ...description.shapes import (
    Box,
    Capsule,
    Collision,
    Color,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Heightmap,
    ImageMap,
    Material,
    Mesh,
    Plane,
    Polyline,
    Sphere,
    Visual,
)
from ...description.world import World
from ...engine.ring import Snapshot
from ...formats.sdf.sensor_parameters import sensor_parameters
from ...geometry import Pose, Vec3
from ...resources.resolver import Resolver, ResourceNotFoundError
from ...simulator.entity import Entity
from .generated_meshes import Solids
from .plain_json import fields_to_json, to_json
from .served_files import MESHES, ServedFiles

NAMES = {Box: "box", Sphere: "sphere", Cylinder: "cylinder", Capsule: "capsule", Cone: "cone",
         Ellipsoid: "ellipsoid", Plane: "plane", Mesh: "mesh", Heightmap: "heightmap",
         Polyline: "polyline", ImageMap: "image"}
"""`type` of a geometry; other kinds are "empty"."""

_SCALABLE = (Box, Sphere, Cylinder, Capsule, Cone, Ellipsoid, Mesh, Polyline)


class Documents:
    """Makes documents. Safe from any thread."""

    def __init__(self, resolver: Resolver) -> None:
        self.served = ServedFiles(resolver)
        self.solids = Solids()
        self._materials = Materials(resolver, self.served)
        self._resolver = resolver

    def world(self, world: World, physics: Any, gravity: Vec3, models: Sequence[Dict[str, Any]],
              ) -> Dict[str, Any]:
        """The protocol's `World` around documents of its models."""
        if world.file:
            self.served.add_root(os.path.dirname(os.path.abspath(world.file)))
        return {**self.surroundings(world, physics, gravity), "models": list(models),
                "lights": [self.light(light) for light in world.lights],
                "roads": [{**fields_to_json(road, "material"),
                           "material": self._materials.document(road.material)}
                          for road in world.roads],
                "actors": [self.actor(actor) for actor in world.actors]}

    def surroundings(self, world: World, physics: Any, gravity: Vec3) -> Dict[str, Any]:
        """Everything of a world but models, lights, roads and actors."""
        return {"name": world.name, "file": world.file, "gravity": list(gravity),
                "physics": to_json(physics), "plugins": [to_json(p) for p in world.plugins],
                **{name: to_json(getattr(world, name))
                   for name in ("magnetic_field", "scene", "gui_camera", "wind", "atmosphere",
                                "spherical_coordinates")}}

    def entity(self, entity: Entity, snapshot: Snapshot) -> Dict[str, Any]:
        """A model of the running world; with the ids of its links."""
        return self.model(entity.model, entity.state(snapshot)[0], entity.link_ids.start)

    def model(self, model: Model, pose: Pose, first_id: int = 0) -> Dict[str, Any]:
        """The protocol's `Model` of a flattened model at a world pose."""
        return {
            "name": model.name, "pose": to_json(pose), "static": model.static,
            "self_collide": model.self_collide, "allow_auto_disable": model.allow_auto_disable,
            "enable_wind": model.enable_wind,
            "canonical_link": model.canonical_link,
            "links": [self._link(link, first_id + n) for n, link in enumerate(model.links)],
            "joints": [_joint(joint) for joint in model.joints],
            "plugins": [to_json(plugin) for plugin in model.plugins],
            "uri": model.uri, "scalable": is_scalable(model), "group": group_of(model),
        }

    @staticmethod
    def light(light: Light) -> Dict[str, Any]:
        """The protocol's `Light`."""
        return {**fields_to_json(light), "group": group_of(light)}

    def actor(self, actor: Actor) -> Dict[str, Any]:
        """The protocol's `Actor`: its skin is a geometry, "empty" for an actor without one."""
        return {**fields_to_json(with_random_walk(actor), "plugins", "skin_scale", "include"),
                "geometry": self._found_mesh(actor.skin, actor.base_dir, actor.skin_scale),
                "animations": [{**fields_to_json(one, "scale"), "geometry":
                                self._found_mesh(one.filename, actor.base_dir, one.scale)}
                               for one in actor.animations]}

    def _found_mesh(self, uri: str, base_dir: str, scale: float) -> Dict[str, Any]:
        if not uri:
            return {"type": "empty"}
        try:
            path = self._resolver.resolve(uri, base_dir)
        except ResourceNotFoundError:
            path = ""
        return self.geometry(Mesh(uri, path, (scale, scale, scale)))

    def _link(self, link: Link, known: int) -> Dict[str, Any]:
        return {**fields_to_json(link, "collisions", "visuals"), "id": known,
                "sensors": sensor_documents(link),
                "collisions": [self._collision(one) for one in link.collisions],
                "visuals": [self._visual(one) for one in link.visuals]}

    def _collision(self, collision: Collision) -> Dict[str, Any]:
        return {**fields_to_json(collision, "geometry"),
                "geometry": self.geometry(collision.geometry)}

    def _visual(self, visual: Visual) -> Dict[str, Any]:
        geometry = self.geometry(visual.geometry)
        if isinstance(visual.geometry, Heightmap):
            geometry["layers"] = self._materials.layers(visual)
        return {**fields_to_json(visual, "geometry", "material"), "geometry": geometry,
                "material": self._materials.document(visual.material),
                "picture_size": picture_size_of(visual)}

    def geometry(self, shape: Geometry) -> Dict[str, Any]:
        """The protocol's `Geometry`, with a URL where the page must load something."""
        found = {"type": NAMES.get(type(shape), "empty"),
                 **fields_to_json(shape, "textures", "blends")}
        if isinstance(shape, Mesh):
            found.update(self._mesh(shape))
        elif isinstance(shape, Heightmap):
            found.update(url=self.solids.url(shape), format="terrain", layers=[])
        elif isinstance(shape, (Polyline, ImageMap)):
            found.update(url=self.solids.url(shape), format="stl")
        return found

    def _mesh(self, mesh: Mesh) -> Dict[str, Any]:
        """Where the page gets the triangles, or why it cannot."""
        extension = os.path.splitext(mesh.path)[1].lower()
        if not mesh.path or not os.path.isfile(mesh.path):
            return {"url": None, "format": None, "problem": f"{mesh.uri} was not found"}
        url = self.served.url(mesh.path)
        if url is None and extension in MESHES:
            return {"url": None, "format": None,
                    "problem": f"{mesh.uri} lies outside of all model and resource folders"}
        if url is not None and extension in PAGE_FORMATS:
            return {"url": url, "format": PAGE_FORMATS[extension],
                    "fallback": self.solids.url(mesh)}
        if url is not None and extension in MOVEMENTS:
            return {"url": url, "format": MOVEMENTS[extension], "fallback": None}
        return {"url": self.solids.url(mesh), "format": self.solids.extension(mesh), "submesh": "",
                "center": False}


def _joint(joint: Joint) -> Dict[str, Any]:
    return {**fields_to_json(joint), "sensors": sensor_documents(joint)}


def is_scalable(model: Model) -> bool:
    """One link, and nothing in it that has no size along three axes."""
    if len(model.links) != 1:
        return False
    link = model.links[0]
    shapes = [one.geometry for one in link.collisions] + [one.geometry for one in link.visuals]
    return bool(shapes) and all(isinstance(shape, _SCALABLE) for shape in shapes)


def sensor_documents(holder: Union[Link, Joint]) -> List[Dict[str, Any]]:
    """The protocol's `Sensor`s of a link or joint."""
    texts = [xml for xml in holder.extra if xml.startswith("<sensor")]
    return [{"name": sensor.name, "type": sensor.type,
             "parameters": [{"path": one.path, "kind": one.kind, "value": to_json(one.value)}
                            for one in sensor_parameters(xml, sensor)]}
            for sensor, xml in zip(holder.sensors, texts)]


class Materials:
    """Documents of materials, with URLs for pictures. Safe from any thread."""

    def __init__(self, resolver: Resolver, served: ServedFiles) -> None:
        self._looks = materials.Materials(resolver, served)
        self._served = served

    def document(self, material: Optional[Material]) -> Optional[Dict[str, Any]]:
        """A material as the protocol's `Material`; None for none."""
        look = self._looks.resolve(material)
        if look is None:
            return None
        return {"ambient": _color_json(look.ambient), "diffuse": _color_json(look.diffuse),
                "specular": _color_json(look.specular), "emissive": _color_json(look.emissive),
                "name": look.name, "texture": self._texture(look),
                "transparency": look.transparency, "lighting": look.lit,
                "alpha_test": look.alpha_test, "blended": look.blended}

    def layers(self, visual: Visual) -> List[Dict[str, Any]]:
        """The protocol's `TerrainLayer`s of a visual; none for what is no terrain."""
        look = self._looks.of_visual(visual)
        return [{"url": self._url(one.texture), "pattern": one.pattern or None,
                 "normal_url": self._url(one.normal), "size": one.size,
                 "min_height": one.min_height, "fade_dist": one.fade_dist}
                for one in (look.layers if look else ())]

    def _url(self, path: str) -> Optional[str]:
        return self._served.url(path) if path else None

    def _texture(self, look: Look) -> Optional[Dict[str, Any]]:
        url = self._url(look.texture)
        if url is None and not look.pattern:
            return None
        return {"url": url, "pattern": look.pattern or None, "scale": list(look.scale)}


def _color_json(color: Optional[Color]) -> Any:
    return None if color is None else list(color)
