"""Finds the links and joints of a model by the names that a plugin uses."""
from __future__ import annotations

from typing import Callable, Container, Iterable, List, Optional

from ..description.model import Joint as JointSpec
from ..description.model import Model
from ..description.transmission import Transmission
from ..errors import InputError
from ..simulator.entity import Entity
from .context import PluginError


class ModelRows:
    """The rows of one model. Names are searched in the plugin's scope (`inner::`) first.

    As in Gazebo, a name may begin with that of the model; one that begins with the name of another
    model is not found.

    Attributes:
        entity: the model as it is now.
    """

    def __init__(self, entity: Entity, scope: str) -> None:
        self.entity, self._scope = entity, scope

    def has_link(self, name: str) -> bool:
        return self._full(name, self.entity.link_names) is not None

    def link(self, name: str) -> int:
        """The row of a link; PluginError with the names that there are."""
        names = self.entity.link_names
        full = self._full(name, names)
        if full is None:
            raise PluginError(f"model '{self.entity.model.name}' has no link '{name}'"
                              + _list(names))
        return self.entity.first_link_row + names.index(full)

    def joint(self, name: str) -> JointSpec:
        """The description of a joint; PluginError with the names that there are."""
        known = {joint.name: joint for joint in self.entity.model.joints}
        full = self._full(name, known)
        if full is None:
            raise PluginError(f"model '{self.entity.model.name}' has no joint '{name}'"
                              + _list(known))
        return known[full]

    def _full(self, name: str, known: Container[str]) -> Optional[str]:
        """Return the name of a link or joint in the model; None for an unknown one."""
        if self._scope + name in known:
            return self._scope + name
        if name in known:
            return name
        model, _, rest = name.partition("::")
        return rest if model == self.entity.model.name and rest in known else None

    def axis(self, joint: str) -> int:
        """The row of a joint by its full name; PluginError for one that does not move."""
        row = self.entity.axis_row(joint, 0)
        if row is None:
            raise PluginError(f"joint '{joint}' of model '{self.entity.model.name}' does not move")
        return row


def transmissions_of(model: Model, parameter: str,
                     read: Callable[[], object]) -> List[Transmission]:
    """The transmissions of a model, else of the URDF in a parameter that `read` returns.

    Raises PluginError for URDF that cannot be read.
    """
    text = "" if model.transmissions else read()
    if not isinstance(text, str) or not text.strip():
        return model.transmissions
    from ..formats.urdf import transmission

    try:
        return transmission.transmissions_of(text, f"parameter {parameter}")
    except InputError as fault:
        raise PluginError(str(fault)) from fault


def _list(names: Iterable[str]) -> str:
    found = list(names)
    if not found:
        return "; it has none"
    return "; there are " + ", ".join(found[:8]) + (", ..." if len(found) > 8 else "")
