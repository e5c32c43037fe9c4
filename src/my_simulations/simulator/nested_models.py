"""Nested models of a flattened model: their descriptions, and what their frames move with."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Iterator, Tuple

from ..description.flatten import flatten_model
from ..description.model import Model
from ..description.scoped_names import SCOPE
from ..geometry import Pose, inverse


@dataclass(frozen=True)
class NestedModel:
    """A model inside a model of the world.

    Attributes:
        model: its description, with nested models.
        parent: plain name of the model that contains it.
        links: indexes of its links, nested ones too, among those of the flattened outermost model.
        frame_link: index of the link that its frame moves with.
        link_from_model: pose of its frame in that link.
    """

    model: Model
    parent: str
    links: Tuple[int, ...]
    frame_link: int
    link_from_model: Pose


def find_nested_models(outermost: Model) -> Dict[str, NestedModel]:
    """Return the nested models of a flattened model that have links, by scoped name.

    The order is depth-first, as in Gazebo's search for a name.
    """
    if outermost.guide is None:
        return {}
    rows = {link.name: row for row, link in enumerate(outermost.links)}
    found: Dict[str, NestedModel] = {}
    for scope, parent, model in _walk(outermost.guide, ""):
        flat = flatten_model(model)
        links = tuple(rows[scope + link.name] for link in flat.links if scope + link.name in rows)
        frame_link = flat.frame_link
        if frame_link is not None and scope + frame_link.name in rows:
            found[scope[:-len(SCOPE)]] = NestedModel(
                model, parent, links, rows[scope + frame_link.name], inverse(frame_link.pose))
    return found


def _walk(model: Model, scope: str) -> Iterator[Tuple[str, str, Model]]:
    """Yield (scope with its separator, name of the parent, nested model), depth-first."""
    for nested in model.models:
        inner = scope + nested.name + SCOPE
        yield inner, model.name, nested
        yield from _walk(nested, inner)
