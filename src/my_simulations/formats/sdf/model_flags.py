"""The flags of a model: `<static>`, `<self_collide>`, `<allow_auto_disable>`, `<enable_wind>`.

libsdformat 9 dissolves a model that is included in another one (`addNestedModel`): links, joints,
frames, nested models, plugins and grippers move to the outer model, and so does every other child
but `<pose>`. Gazebo takes the first `<static>` it finds, so a model that includes a static one
before it has a `<static>` of its own becomes static as a whole. A `<model>` written inside another
one is not dissolved: it keeps its own flags.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Iterable, Mapping, Optional, Tuple

from ...description.model import Model
from ...description.validate import link_names
from ...errors import Issue, Severity
from ..xml.source import Source

FLAGS = ("static", "self_collide", "allow_auto_disable", "enable_wind")
"""Children of `<model>` that included models may override."""


@dataclass(frozen=True)
class ModelFlags:
    """The flags that a model or one of its includes sets; None for a flag that none sets.

    Attributes:
        static: the model does not move.
        self_collide: links of the model collide with each other.
        allow_auto_disable: the physics engine may put the model to sleep.
        enable_wind: wind acts on the model.
    """

    static: Optional[bool] = None
    self_collide: Optional[bool] = None
    allow_auto_disable: Optional[bool] = None
    enable_wind: Optional[bool] = None


def own_flags(model: Model, element: Any) -> ModelFlags:
    """The flags that a `<model>` element sets itself; `model` holds their values."""
    own = {flag: getattr(model, flag) for flag in FLAGS if element.find(flag) is not None}
    return ModelFlags(**own)


def apply_include_flags(model: Model, element: Any, included: Iterable[Tuple[Any, ModelFlags]],
                        source: Source) -> ModelFlags:
    """Set the flags of a model from its includes, where these precede the model's own.

    Args:
        model: the model, with its own flags; changed in place.
        element: its `<model>`.
        included: the `<include>` elements in it that were read, and the flags that each sets.
        source: receives a note for the first such model.

    Returns:
        The flags that the model and its includes set.
    """
    by_include = dict(included)
    own = own_flags(model, element)
    result = ModelFlags()
    for flag in FLAGS:
        for child in element:
            value = getattr(own if child.tag == flag else by_include.get(child, ModelFlags()), flag)
            if value is None:
                continue
            result = replace(result, **{flag: value})
            if child.tag != flag:
                _apply_flag(model, flag, value, child, source)
            break
    return result


def _apply_flag(model: Model, flag: str, value: bool, element: Any, source: Source) -> None:
    if getattr(model, flag) == value:
        return
    setattr(model, flag, value)
    kind = f"include-flag {flag} {value}"
    if kind in source.log.reported:
        return  # one note per flag: a world may contain many such models
    source.log.reported.add(kind)
    what = {"static": "static" if value else "able to move",
            "self_collide": "made of links that collide with each other" if value
            else "made of links that pass through each other",
            "allow_auto_disable": "allowed to sleep" if value else "kept awake",
            "enable_wind": "moved by wind" if value else "not moved by wind"}[flag]
    source.log.add(Issue(
        Severity.NOTE, "include-flag", f"model {model.name!r} is {what} as a whole, since the model"
        f" included here says <{flag}>{'true' if value else 'false'}</{flag}>; reported once",
        hint=f"say <{flag}> in {model.name!r} itself, before the include",
        **source.where(element)))


def first_link(element: Any, included: Mapping[Any, Model]) -> str:
    """The canonical link of an include that precedes the model's own links; "" if there is none.

    Gazebo takes the first link in the file as the canonical one, included links too.
    """
    if element.find("link") is None:
        return ""
    for child in element:
        if child.tag == "link":
            break
        inner = included.get(child)
        body = inner and (inner.canonical_link or next(link_names(inner), ""))
        if inner and body:
            return f"{inner.name}::{body}"
    return ""
