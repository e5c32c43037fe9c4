"""Warnings about suspicious models: those of `description.advice`, and about mesh shapes."""
from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence

from ..description.advice import find_advice, first_with_count, links_of, thin_mesh
from ..description.flatten import flatten_model
from ..description.model import Link, Model
from ..description.shapes import Mesh, MeshTable, mesh_key
from ..description.validate import Fault
from ..errors import Issue, warning

ADVICE_LIMIT = 20
"""Most findings logged for one world: overlapping models cause one for each pair."""


@dataclass(frozen=True)
class Written:
    """Where models are written.

    Attributes:
        file: for the issues; "" if unknown.
        root: root element of the file, for line and XPath; None if unknown.
        name: of the one model that is wanted, in the file; "" where it has the same in the world.
    """

    file: str = ""
    root: Any = None
    name: str = ""


UNKNOWN = Written()
"""Models whose place in a file is unknown."""


def findings(models: Sequence[Model], meshes: Mapping[str, MeshTable],
             only: str = "") -> Iterator[Fault]:
    """Findings about the models of one world.

    Args:
        models: the models.
        meshes: their loaded collision meshes by model name.
        only: name of the model whose findings are wanted, "" for all models.
    """
    yield from find_advice(models, only)
    for model in models:
        table = meshes.get(model.name)
        if table and only in ("", model.name):
            yield from first_with_count(list(_thin_meshes(model, table)), "collisions")


def advice_issues(models: Sequence[Model], meshes: Mapping[str, MeshTable],
                  written: Written = UNKNOWN, *, only: str = "",
                  limit: Optional[int] = ADVICE_LIMIT) -> List[Issue]:
    """The findings as warnings.

    Args:
        models: see `findings`.
        meshes: see `findings`.
        written: where the models are written, or the one that `only` names.
        only: see `findings`.
        limit: greatest number of findings; one more warning says how to get the others. None for
            all findings.
    """
    found = findings(models, meshes, only)
    listed = list(found if limit is None else islice(found, limit + 1))
    issues = [located_issue(one, [model for model in models if only in ("", model.name)], written)
              for one in listed[:limit]]
    if len(listed) > len(issues):
        # What is spawned is called by more than its file's name.
        file = "FILE" if written.name else written.file or "FILE"
        issues.append(warning("advice-many", "there are more warnings of this kind",
                              file=written.file, hint=f"rosrun my_simulations check_model {file}"))
    return issues


def located_issue(fault: Fault, models: Sequence[Model], written: Written) -> Issue:
    """The finding as an issue, located at its element or at the `<include>` of the model."""
    where: Dict[str, Any] = {"file": written.file}
    element = _element_of(fault.subject, models, written) if written.root is not None else None
    if element is not None:
        where["line"] = element.sourceline or 0
        where["xpath"] = element.getroottree().getpath(element)
    return Issue(fault.severity, fault.code, fault.message, hint=fault.hint, **where)


def _element_of(subject: Any, models: Sequence[Model], written: Written) -> Any:
    for model in models:
        for link in flatten_model(model).links:
            if subject is link.inertial or any(subject is one for one in link.collisions):
                return _find_element(written.root, written.name or model.name, model.uri, link,
                                     getattr(subject, "name", ""))
    return None


def _find_element(root: Any, model: str, uri: str, link: Link, collision: str) -> Any:
    """The innermost element with the names of model, link and collision; None if not found."""
    holder = root if root.tag == "robot" else None
    for element in root.iter("model", "include"):
        name = element.get("name") if element.tag == "model" else element.findtext("name")
        included = (element.findtext("uri") or "").strip()
        if name == model or (name is None and included and included == uri):
            holder = element
            break
    if holder is None:
        return None
    plain = link.name.rpartition("::")[2]
    for inner in holder.iter("link"):
        if inner.get("name") == plain:
            return next((one for one in inner.iter("collision")
                         if collision and one.get("name") == collision), inner)
    return holder


def _thin_meshes(model: Model, meshes: MeshTable) -> Iterator[Fault]:
    for name, link, _pose, _static in links_of(model):
        for collision in link.collisions:
            shape = collision.geometry
            data = meshes.get(mesh_key(shape)) if isinstance(shape, Mesh) else None
            if data is not None:
                extents = data.vertices.max(axis=0) - data.vertices.min(axis=0)
                yield from thin_mesh(collision, name, [float(edge) for edge in extents])
