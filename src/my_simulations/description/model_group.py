"""The group of a model or light: the world editor selects and moves all members together.

It is an element with a prefix, `<my_simulations:group>`, among the kept XML of the entity. Gazebo
and libsdformat ignore elements with a prefix.
"""
from __future__ import annotations

import re
from dataclasses import replace
from typing import List, TypeVar, Union
from xml.sax.saxutils import escape, unescape

from .light import Light
from .model import Model

Member = TypeVar("Member", bound=Union[Model, Light])
_GROUP = re.compile(r"<my_simulations:group(?:\s[^<>]*)?>([^<]*)</my_simulations:group\s*>")


def group_of(entity: Union[Model, Light]) -> str:
    """Return the name of the group of a model or light; "" for none."""
    for xml in entity.extra:
        found = _GROUP.fullmatch(xml.strip())
        if found:
            return unescape(found.group(1)).strip()
    return ""


def with_group(entity: Member, group: str) -> Member:
    """Return the model or light in another group; "" for none."""
    return replace(entity, extra=extra_with_group(entity.extra, group))


def extra_with_group(extra: List[str], group: str) -> List[str]:
    """Return the kept XML of an entity in another group; "" for none."""
    others = [xml for xml in extra if not _GROUP.fullmatch(xml.strip())]
    if not group:
        return others
    return [*others, f'<my_simulations:group xmlns:my_simulations="urn:my_simulations">'
                     f"{escape(group)}</my_simulations:group>"]
