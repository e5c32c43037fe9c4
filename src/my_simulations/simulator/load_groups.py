"""Divides the models of a world into groups that the engine loads by one command each."""
from __future__ import annotations

from typing import Iterator, List, Sequence

from ..description.cost_budget import cost_of
from ..description.flatten import flatten_model
from ..description.model import Model
from ..description.shapes import SOLIDS, MeshTable
from ..engine.body_plan import BodyPlanError, plan_bodies
from ..engine.commands import ContinuePreparation, PrepareModel
from ..geometry import pose_is_finite
from .session import Session

_MOST_MODELS, _MOST_LINKS, _MOST_SHAPES = 100, 300, 2000
"""Of one group: the engine takes less than a second for it."""


def small_groups(models: Sequence[Model]) -> Iterator[List[Model]]:
    """Yield the models in order; those with meshes, or that the engine may refuse, are alone.

    If the engine refuses a part of a command, it has to be restarted.
    """
    group: List[Model] = []
    names = set()
    links = shapes = 0
    for model in models:
        flat = flatten_model(model)
        many, more = len(flat.links), sum(len(link.collisions) for link in flat.links)
        full = (len(group) == _MOST_MODELS or links + many > _MOST_LINKS
                or shapes + more > _MOST_SHAPES)
        alone = model.name in names or not _is_simple(flat)
        if group and (full or alone):
            yield group
            group, links, shapes = [], 0, 0
        names.add(model.name)
        if alone:
            yield [model]
            continue
        group.append(model)
        links, shapes = links + many, shapes + more
    if group:
        yield group


def _is_simple(model: Model) -> bool:
    """Whether a flattened model has no meshes, and the engine has no reason to refuse it."""
    if not model.name or not pose_is_finite(model.pose) or any(
            isinstance(collision.geometry, SOLIDS)
            for link in model.links for collision in link.collisions):
        return False
    try:
        plan_bodies(model)
    except BodyPlanError:
        return False
    return True


PLAIN_TRIANGLES = 50_000
"""Models of at most this size are loaded at once: the engine takes about 0.1 s for them."""


def prepare_shapes(session: Session, model: Model, meshes: MeshTable) -> None:
    """Prepare the shapes of a flattened model, if it is large and time runs.

    Simulated time goes on meanwhile. Call it without locks. Raises CommandError if no engine runs.
    """
    if (not model.static or not session.ring.running
            or cost_of(model, meshes).triangles <= PLAIN_TRIANGLES):
        return
    with session.structure_lock:
        number = session.new_id()
    more = session.call(PrepareModel(number, model, meshes)).value
    while more:
        more = session.call(ContinuePreparation(number)).value
