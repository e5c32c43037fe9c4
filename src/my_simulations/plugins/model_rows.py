"""Finds the links and joints of a model by the names that a plugin uses."""
from __future__ import annotations

from typing import Iterable

from ..description.model import Joint as JointSpec
from ..simulator.registry import Entity
from .context import PluginError


class ModelRows:
    """The rows of one model. Names are looked for in the plugin's scope (`inner::`) first.

    Attributes:
        entity: the model as it is now.
    """

    def __init__(self, entity: Entity, scope: str) -> None:
        self.entity, self._scope = entity, scope

    def has_link(self, name: str) -> bool:
        """Whether a link of the model has this name."""
        names = self.entity.link_names
        return name in names or self._scope + name in names

    def link(self, name: str) -> int:
        """The row of a link; PluginError with the names that there are."""
        names = self.entity.link_names
        for full in (self._scope + name, name, name.partition("::")[2]):
            if full in names:
                return self.entity.first_link_row + names.index(full)
        raise PluginError(f"model '{self.entity.model.name}' has no link '{name}'" + _list(names))

    def joint(self, name: str) -> JointSpec:
        """The description of a joint; PluginError with the names that there are."""
        known = {joint.name: joint for joint in self.entity.model.joints}
        spec = known.get(self._scope + name) or known.get(name)
        if spec is None:
            raise PluginError(f"model '{self.entity.model.name}' has no joint '{name}'"
                              + _list(known))
        return spec

    def axis(self, joint: str) -> int:
        """The row of a joint by its full name; PluginError for one that does not move."""
        row = self.entity.axis_row(joint, 0)
        if row is None:
            raise PluginError(f"joint '{joint}' of model '{self.entity.model.name}' does not move")
        return row


def _list(names: Iterable[str]) -> str:
    found = list(names)
    if not found:
        return "; it has none"
    return "; there are " + ", ".join(found[:8]) + (", ..." if len(found) > 8 else "")
