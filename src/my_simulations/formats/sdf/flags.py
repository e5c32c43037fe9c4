"""What a model says of itself as a whole, itself or by a model that it includes.

libsdformat 9 dissolves a model that is included in another one (`addNestedModel`): links, joints,
frames, nested models, plugins and grippers move out, and so does every other child of it but
`<pose>`. Gazebo asks for the first `<static>` it finds; of a model that says nothing of it before
it includes a static one, the whole becomes static. A `<model>` written inside another one is not
dissolved: it keeps what it says for itself.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Iterable, Mapping, Optional, Tuple

from ...description.model import Model
from ...description.validate import link_names
from ...errors import Issue, Severity
from ..xml.source import Source

FLAGS = ("static", "self_collide", "allow_auto_disable")
"""Children of `<model>` that hold a truth about the whole; `enable_wind` is kept as XML."""


@dataclass(frozen=True)
class Said:
    """The words of a model, its includes' among them; None for what nothing is said about."""

    static: Optional[bool] = None
    self_collide: Optional[bool] = None
    allow_auto_disable: Optional[bool] = None


def says(model: Model, element: Any) -> Said:
    """What the children of a `<model>` say, of which `model` holds the values."""
    own = {flag: getattr(model, flag) for flag in FLAGS if element.find(flag) is not None}
    return Said(**own)


def settle(model: Model, element: Any, included: Iterable[Tuple[Any, Said]],
           source: Source) -> Said:
    """Give a model the flags of the models it includes where they come first, and say so once.

    Args:
        model: with its own flags.
        element: its `<model>`.
        included: the `<include>`s in it that were read, and what each says.
        source: what hears of it.

    Returns:
        what the whole says.
    """
    by_include = dict(included)
    own = says(model, element)
    result = Said()
    for flag in FLAGS:
        for child in element:
            value = getattr(own if child.tag == flag else by_include.get(child, Said()), flag)
            if value is None:
                continue
            result = replace(result, **{flag: value})
            if child.tag != flag:
                _take_over(model, flag, value, child, source)
            break
    return result


def _take_over(model: Model, flag: str, value: bool, element: Any, source: Source) -> None:
    if getattr(model, flag) == value:
        return
    setattr(model, flag, value)
    kind = f"include-flag {flag} {value}"
    if kind in source.log.told:
        return  # said once: a world may be full of such models
    source.log.told.add(kind)
    what = {"static": "static" if value else "able to move",
            "self_collide": "made of links that collide with each other" if value
            else "made of links that pass through each other",
            "allow_auto_disable": "allowed to sleep" if value else "kept awake"}[flag]
    source.log.add(Issue(
        Severity.NOTE, "include-flag", f"model {model.name!r} is {what} as a whole, since the model"
        f" included here says <{flag}>{'true' if value else 'false'}</{flag}>; so are all such",
        hint=f"say <{flag}> in {model.name!r} itself, before the include",
        **source.where(element)))


def first_link(element: Any, included: Mapping[Any, Model]) -> str:
    """The link of an include that stands before the model's own links; "" where none does.

    It is Gazebo's first link, then, and with it the one that the model's frame travels with.
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
