"""Limits of what one model and one world may cost, checked before the engine builds anything.

Simulated time stands still while the engine builds a model. The limits of a model keep that short;
those of a world bound the memory of the engine. The figures below were measured on a machine with
two processors.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Iterator, List, Optional, Tuple

from .flatten import flatten_model
from .model import WORLD, Model
from .model_plugins import plugin_count
from .self_collision import requests_self_collision
from .shapes import SOLIDS, MeshTable, mesh_key
from .validate import Fault


@dataclass(frozen=True)
class Cost:
    """What the engine has to build.

    Attributes:
        links: links, including those without collisions.
        shapes: collisions; a mesh that is divided counts as its convex parts.
        triangles: triangles of all collision meshes; a mesh counts for each collision that uses it.
        pairs: pairs of links of one model of which the engine stores whether they collide. Links
            that joints connect to one tree count only if one of them has self_collide.
        colliding_pairs: those of them that collide because of self_collide.
        plugins: plugins, those of sensors included.
    """

    links: int = 0
    shapes: int = 0
    triangles: int = 0
    pairs: int = 0
    colliding_pairs: int = 0
    plugins: int = 0

    def __add__(self, other: "Cost") -> "Cost":
        return Cost(self.links + other.links, self.shapes + other.shapes,
                    self.triangles + other.triangles, self.pairs + other.pairs,
                    self.colliding_pairs + other.colliding_pairs, self.plugins + other.plugins)

    def __sub__(self, other: "Cost") -> "Cost":
        return Cost(self.links - other.links, self.shapes - other.shapes,
                    self.triangles - other.triangles, self.pairs - other.pairs,
                    self.colliding_pairs - other.colliding_pairs, self.plugins - other.plugins)


MODEL_BUDGET = Cost(links=2000, shapes=10_000, triangles=2_500_000, pairs=100_000,
                    colliding_pairs=50_000, plugins=200)
"""Limits of one model.

Processor time of a load at each limit: 2000 links 0.3 s, 10 000 shapes of a moving link 0.35 s,
100 000 pairs (447 moving links without joints) 0.2 s. 2000 moving links take 0.14 s for each step;
50 000 pairs that collide are 316 links, which take 0.5 s for a step if all overlap. A mesh takes
1 s for each 600 000 triangles, and is built in pieces between steps. The largest height map has
2 097 152 triangles. A plugin takes 2 to 4 ms to start, mostly for the registration of its topics,
while simulated time stands still.
"""

WORLD_BUDGET = Cost(links=16_384, shapes=100_000, triangles=5_000_000, pairs=1_000_000,
                    colliding_pairs=200_000, plugins=20_000)
"""Limits of all models of a world together.

The first is the number of rows for links in the shared memory. A million triangles take about
200 MB of the engine, and 100 000 shapes 400 MB.
"""

_HINTS: Dict[str, str] = {
    "links": "divide it into several models",
    "shapes": "use fewer or larger collisions",
    "triangles": "use a simpler mesh for <collision>; <visual> may keep the detailed one",
    "pairs": "connect the links by joints, or divide the model into several models",
    "colliding_pairs": "set self_collide for the links that need it only",
    "plugins": "divide it into several models",
}
_NAMES: Dict[str, str] = {
    "links": "links", "shapes": "collisions", "triangles": "triangles in its collision meshes",
    "pairs": "pairs of links that the engine has to tell apart",
    "colliding_pairs": "pairs of links that collide because of self_collide",
    "plugins": "plugins"}


def cost_of(model: Model, meshes: Optional[MeshTable] = None) -> Cost:
    """The cost of a model; collisions whose mesh is not in `meshes` have no triangles."""
    flat = flatten_model(model)
    table = meshes or {}
    shapes = triangles = 0
    for link in flat.links:
        moves = not (flat.static or link.kinematic)
        for collision in link.collisions:
            data = (table.get(mesh_key(collision.geometry))
                    if table and isinstance(collision.geometry, SOLIDS) else None)
            shapes += len(data.parts) if data is not None and data.parts and moves else 1
            triangles += 0 if data is None else len(data.triangles)
    return Cost(len(flat.links), shapes, triangles, *_pairs(flat), plugin_count(flat))


def budget_faults(cost: Cost, model: Model) -> Iterator[Fault]:
    """What a model of this cost exceeds of `MODEL_BUDGET`."""
    for name in _list_exceeded(cost, MODEL_BUDGET):
        yield Fault("model-too-large", f"model {model.name!r} has {getattr(cost, name)}"
                    f" {_NAMES[name]}; {getattr(MODEL_BUDGET, name)} are possible", model,
                    hint=_HINTS[name])


def world_excess(cost: Cost) -> str:
    """The first limit of `WORLD_BUDGET` that a world of this cost exceeds; "" if none."""
    for name in _list_exceeded(cost, WORLD_BUDGET):
        what = _NAMES[name].replace("its", "all")
        return f"the world would have {getattr(cost, name)} {what}; " \
               f"{getattr(WORLD_BUDGET, name)} are possible"
    return ""


def _list_exceeded(cost: Cost, budget: Cost) -> List[str]:
    return [name for name in _NAMES if getattr(cost, name) > getattr(budget, name)]


def _pairs(model: Model) -> Tuple[int, int]:
    """`Cost.pairs` and `Cost.colliding_pairs` of a flattened model."""
    if model.static:
        return 0, 0
    solid = [link for link in model.links if link.collisions]
    root = _trees(model)
    counts: Dict[str, int] = {}
    asking: Dict[str, int] = {}
    for link in solid:
        tree = root[link.name]
        counts[tree] = counts.get(tree, 0) + 1
        if requests_self_collision(link, model):
            asking[tree] = asking.get(tree, 0) + 1
    pairs = _of_two(len(solid)) - sum(
        _of_two(count) for tree, count in counts.items() if tree not in asking)
    silent = len(solid) - sum(asking.values())
    return pairs, _of_two(len(solid)) - _of_two(silent)


def _of_two(count: int) -> int:
    return count * (count - 1) // 2


def _trees(model: Model) -> Dict[str, str]:
    """Of each link the name of the link that stands for all that joints connect to it."""
    above: Dict[str, str] = {link.name: link.name for link in model.links}

    def root(name: str) -> str:
        while above[name] != name:
            above[name] = name = above[above[name]]
        return name

    joints: Any = model.joints
    for joint in joints:
        if joint.parent in above and joint.child in above and WORLD not in (joint.parent,
                                                                            joint.child):
            above[root(joint.child)] = root(joint.parent)
    return {name: root(name) for name in above}
