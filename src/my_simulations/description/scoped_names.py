"""Scoped names, `model::link`, and the one rule that splits them.

Gazebo separates the names of nested entities by `::` (SDF spec 1.8, "frame semantics"). A world
keeps nested models flattened, so a link's own name may contain the separator as well:
`outer::inner::link` is link `inner::link` of model `outer`, unless there is a model `outer::inner`.
"""
from __future__ import annotations

from typing import Callable, Tuple

SCOPE = "::"
"""Separator between the names of a model and its link, joint or nested model."""


def split_scoped(name: str, is_model: Callable[[str], bool]) -> Tuple[str, str]:
    """Split a scoped name into a model and the rest.

    The longest name of an existing model wins; the page splits names by the same rule
    (`web/js/scoped_names.ts`).

    Args:
        name: `model`, `model::link`, `model::link::collision`, …, or a plain name.
        is_model: whether a model has this name.

    Returns:
        (model, rest). rest is "" for a model itself. If no model matches, model is "" and rest is
        the whole name.
    """
    if is_model(name):
        return name, ""
    end = name.rfind(SCOPE)
    while end > 0:
        if is_model(name[:end]):
            return name[:end], name[end + len(SCOPE):]
        # Overlapping separators (`a:::b`) are tried at every character.
        end = name.rfind(SCOPE, 0, end + len(SCOPE) - 1)
    return "", name
