"""Has the engine make the shapes of large static models between steps, before they are loaded."""
from __future__ import annotations

from ..description.cost_budget import cost_of
from ..description.model import Model
from ..description.shapes import MeshTable
from ..engine.commands import ContinuePreparation, PrepareModel
from .session import Session

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
