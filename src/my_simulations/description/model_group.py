"""The group of a model, which selects and moves several models together in the world editor.

It is an element with a prefix, `<my_simulations:group>`, among the kept XML of the model. Gazebo
and libsdformat ignore elements with a prefix.
"""
from __future__ import annotations

import re
from dataclasses import replace
from typing import List
from xml.sax.saxutils import escape, unescape

from .model import Model

_GROUP = re.compile(r"<my_simulations:group(?:\s[^<>]*)?>([^<]*)</my_simulations:group\s*>")


def group_of(model: Model) -> str:
    """Return the name of the group of a model; "" for none."""
    for xml in model.extra:
        found = _GROUP.fullmatch(xml.strip())
        if found:
            return unescape(found.group(1)).strip()
    return ""


def with_group(model: Model, group: str) -> Model:
    """Return the model in another group; "" for none."""
    return replace(model, extra=extra_with_group(model.extra, group))


def extra_with_group(extra: List[str], group: str) -> List[str]:
    """Return the kept XML of a model in another group; "" for none."""
    others = [xml for xml in extra if not _GROUP.fullmatch(xml.strip())]
    if not group:
        return others
    return [*others, f'<my_simulations:group xmlns:my_simulations="urn:my_simulations">'
                     f"{escape(group)}</my_simulations:group>"]
