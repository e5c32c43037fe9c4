"""What there is to see: bodies by name, lights, surroundings, scenery; known on both sides."""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Tuple

from ..appearance.looks import Look
from ..appearance.mesh_formats import MOVEMENTS, PAGE_FORMATS
from ..description.actor import Actor
from ..description.light import Light
from ..description.model import Model
from ..description.random_walk import with_random_walk
from ..description.shapes import Mesh
from ..description.surroundings import Scene
from ..description.world import World
from ..resources.resolver import ResourceNotFoundError
from .api import (
    AddBody,
    Body,
    Change,
    Figure,
    LoadScene,
    PaintedRoad,
    RemoveBody,
    SetLights,
    SetScenery,
)

if TYPE_CHECKING:
    from ..appearance.materials import Materials
    from ..resources.resolver import Resolver


def body(name: str, model: Model, first_link_row: int, materials: "Materials") -> Body:
    """A flattened model to look at, its materials resolved."""
    looks: Dict[Tuple[int, int], Look] = {}
    for n, link in enumerate(model.links):
        for m, visual in enumerate(link.visuals):
            look = materials.of_visual(visual)
            if look is not None:
                looks[n, m] = look
    return Body(name, model, first_link_row, looks)


def scenery(world: World, materials: "Materials", resolver: "Resolver") -> SetScenery:
    """Roads with their materials resolved, and actors with their files found."""
    return SetScenery(
        tuple(PaintedRoad(road, materials.resolve(road.material) or Look(pattern="road"))
              for road in world.roads),
        tuple(_figure(actor, resolver) for actor in world.actors))


def _figure(actor: Actor, resolver: "Resolver") -> Figure:
    """The page's rule: an animation is the skin's own unless another file may have it."""
    def path_of(uri: str) -> str:
        try:
            return resolver.resolve(uri, actor.base_dir) if uri else ""
        except ResourceNotFoundError:
            return ""

    skin = Mesh(actor.skin, path_of(actor.skin), (actor.skin_scale,) * 3)
    paths = [path_of(animation.filename) for animation in actor.animations]
    return Figure(with_random_walk(actor), skin, tuple(
        path if path.lower().endswith((*PAGE_FORMATS, *MOVEMENTS)) and path != skin.path else ""
        for path in paths))


class SceneState:
    """Changes, summed up."""

    def __init__(self) -> None:
        self.bodies: Dict[str, Body] = {}
        self.lights: List[Light] = []
        self.scene = Scene()
        self.scenery = SetScenery()

    def apply(self, change: Change) -> None:
        if isinstance(change, AddBody):
            self.bodies[change.body.name] = change.body
        elif isinstance(change, RemoveBody):
            self.bodies.pop(change.name, None)
        elif isinstance(change, SetLights):
            self.lights, self.scene = change.lights, change.scene
        elif isinstance(change, SetScenery):
            self.scenery = change
        else:
            self.bodies = {one.name: one for one in change.bodies}
            self.lights, self.scene = change.lights, change.scene
            self.scenery = change.scenery

    def load_command(self) -> LoadScene:
        """Return the change that creates this scene from an empty one."""
        return LoadScene(list(self.bodies.values()), self.lights, self.scene, self.scenery)
