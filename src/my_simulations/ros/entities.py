"""Finding what a request names, with the words Gazebo's clients know."""
from __future__ import annotations

import difflib
from typing import Iterable

from ..description.model import Model
from ..errors import CommandError
from ..simulator.simulator import Simulator


def closest(name: str, known: Iterable[str]) -> str:
    """A hint with the most similar names, "" when nothing is similar."""
    found = difflib.get_close_matches(name, list(known), n=3, cutoff=0.5)
    return f"; did you mean {', '.join(repr(near) for near in found)}?" if found else ""


def require_model(simulator: Simulator, name: str) -> Model:
    """The description of a model.

    Raises:
        CommandError: there is none of that name; the text starts as Gazebo's does.
    """
    if not simulator.has_model(name):
        raise CommandError(f"model does not exist: no model is named {name!r}"
                           + closest(name, simulator.model_names()))
    return simulator.model(name)
