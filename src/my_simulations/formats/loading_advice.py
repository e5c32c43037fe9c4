"""What is said, besides faults, about models that are loaded: `description.advice`, and meshes."""
from __future__ import annotations

from itertools import islice
from typing import Iterator, List, Mapping, Sequence

from ..description.advice import advice, links_of, thin_mesh
from ..description.model import Model
from ..description.shapes import Mesh, MeshTable, mesh_key
from ..description.validate import Fault
from ..errors import Issue, warning

MOST = 20
"""Findings told of one world; a pile that starts in itself has one for each pair."""


def findings(models: Sequence[Model], meshes: Mapping[str, MeshTable],
             only: str = "") -> Iterator[Fault]:
    """Findings about models that stand in one world; `meshes` by model name, as loaded.

    With `only`, those that have to do with the model of that name.
    """
    yield from advice(models, only)
    for model in models:
        table = meshes.get(model.name)
        if table and only in ("", model.name):
            yield from _thin_meshes(model, table)


def advised(models: Sequence[Model], meshes: Mapping[str, MeshTable], file: str = "",
            only: str = "") -> List[Issue]:
    """The findings as warnings for the log, at most `MOST` and how to get the others."""
    told = list(islice(findings(models, meshes, only), MOST + 1))
    issues = [Issue(one.severity, one.code, one.message, file=file, hint=one.hint)
              for one in told[:MOST]]
    if len(told) > MOST:
        issues.append(warning("advice-many", "there is more to say of this kind", file=file,
                              hint=f"rosrun my_simulations check_model {file or 'FILE'}"))
    return issues


def _thin_meshes(model: Model, meshes: MeshTable) -> Iterator[Fault]:
    for name, link, _pose, _static in links_of(model):
        for collision in link.collisions:
            shape = collision.geometry
            data = meshes.get(mesh_key(shape)) if isinstance(shape, Mesh) else None
            if data is not None:
                extents = data.vertices.max(axis=0) - data.vertices.min(axis=0)
                yield from thin_mesh(collision, name, [float(edge) for edge in extents])
