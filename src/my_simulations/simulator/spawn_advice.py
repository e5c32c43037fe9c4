"""Warnings about models that were just spawned or moved."""
from __future__ import annotations

from dataclasses import replace
from typing import Callable, List, Optional, Sequence, Tuple

from ..description.model import Model
from ..description.shapes import MeshTable
from ..engine.ring import LINK_WIDTH, Snapshot
from ..errors import Issue
from ..formats.loading_advice import UNKNOWN, Written, advice_issues
from ..geometry import IDENTITY, Pose, Twist
from .entity import Entity
from .simulator import Simulator

_INSIDE = "starts-inside"

NEIGHBOURS = 64
"""Most models for which overlaps are checked, so that spawning stays fast."""


def _with_present_poses(entity: Entity, state: Callable[[int], Tuple[Pose, Twist]]) -> Model:
    """Return the model with its links at their present poses.

    `state` returns the state of the link in a row.
    """
    links = [replace(link, pose=state(entity.first_link_row + n)[0])
             for n, link in enumerate(entity.model.links)]
    return replace(entity.model, pose=IDENTITY, links=links)


def _find_near(new: Entity, entities: Sequence[Entity], snapshot: Snapshot) -> List[Entity]:
    """The new entity, and those of which a link may overlap one of its links."""
    values = snapshot.links
    spheres = [(*values[at:at + 3], reach) for at, reach in _locate_links(new)]
    return [entity for entity in entities if entity is new or any(
        (values[at] - x) ** 2 + (values[at + 1] - y) ** 2 + (values[at + 2] - z) ** 2
        <= (reach + mine) ** 2
        for at, reach in _locate_links(entity) for x, y, z, mine in spheres)]


def _locate_links(entity: Entity) -> List[Tuple[int, float]]:
    """Return the start of the row and the reach of each link."""
    return [((entity.first_link_row + n) * LINK_WIDTH, reach)
            for n, reach in enumerate(entity.reaches)]


def placement_warnings(simulator: Simulator, name: str, meshes: Optional[MeshTable],
                   written: Written = UNKNOWN) -> List[Issue]:
    """Warnings about implausible inertia, thin shapes, and overlaps with other models.

    `written` says where the new model is written.
    """
    if simulator.models.count > NEIGHBOURS:
        models = [_with_present_poses(simulator.models.entity(name), simulator.states.link_at)]
    else:
        entities, snapshot = simulator.states.latest()
        models = [_with_present_poses(entity, snapshot.link) for new in entities
                  if new.model.name == name for entity in _find_near(new, entities, snapshot)]
    return advice_issues(models, {name: meshes or {}}, written, only=name)


def overlap_warnings(simulator: Simulator, names: Sequence[str]) -> List[Issue]:
    """Warnings about overlaps of models with others, at most one for each model.

    None for more than `NEIGHBOURS` names.
    """
    if len(names) > NEIGHBOURS:
        return []
    found: List[Issue] = []
    for name in names:
        inside = [issue for issue in placement_warnings(simulator, name, None)
                  if issue.code == _INSIDE] if simulator.models.has(name) else []
        if inside:
            others = len(inside) - 1
            more = f", and {others} more of its overlaps" if others else ""
            found.append(replace(inside[0], message=inside[0].message + more))
    return found
